// SPDX-License-Identifier: MIT
// Buffers and buffer views of glTF files: data in base64, files beside, and the chunk of a .glb file.
#include "scene/gltf.h"

#include "base/file.h"

#include <string.h>

// The value of a character of base64, or -1.
static int valueOf(char c)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const char* at = c != 0 ? strchr(digits, c) : NULL;
    return at != NULL ? (int)(at - digits) : -1;
}

static vplResult decodeBase64(vplGltf* g, const vplJson* at, const char* text, const uint8_t** bytesOut,
                              size_t* sizeOut)
{
    size_t length = strlen(text), size = 0;
    while (length > 0 && text[length - 1] == '=') {
        length--;
    }
    uint8_t* bytes = vplArena_Alloc(g->scratch, length / 4 * 3 + 3, 1);
    TRY(vplArena_Check(g->scratch));
    uint32_t bits = 0;
    for (size_t i = 0; i < length; i++) {
        const int value = valueOf(text[i]);
        if (value < 0) {
            return vplJson_Fail(at, "has the character %d at %zu of its data, must be base64",
                                (int)(unsigned char)text[i], i);
        }
        bits = bits << 6 | (uint32_t)value;
        if (i % 4 > 0) {
            bytes[size++] = (uint8_t)(bits >> (6 - 2 * (i % 4)));
        }
    }
    *bytesOut = bytes;
    *sizeOut = size;
    return VPL_SUCCESS;
}

static int hexOf(char c)
{
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
}

// Replaces %20 and the like; `out` is as large as the URI.
static void decodePercents(const char* uri, char* out)
{
    while (*uri != 0) {
        const int high = *uri == '%' ? hexOf(uri[1]) : -1, low = high >= 0 ? hexOf(uri[2]) : -1;
        const bool code = low >= 0 && high + low > 0; // a NUL byte would end the name
        if (code) {
            *out++ = (char)(unsigned char)(16 * high + low);
            uri += 3;
        } else {
            *out++ = *uri++;
        }
    }
    *out = 0;
}

vplResult vplGltf_FindBeside(vplGltf* g, const char* uri, const char** pathOut)
{
    char* name = vplArena_Alloc(g->scratch, strlen(uri) + 1, 1);
    TRY(vplArena_Check(g->scratch));
    decodePercents(uri, name);
    char* path = vplPathBeside(g->context, g->path, name, strlen(name));
    if (path == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *pathOut = vplArena_CopyString(g->scratch, path);
    vplFree(g->context, path);
    return vplArena_Check(g->scratch);
}

vplResult vplGltf_ReadUri(vplGltf* g, const vplJson* owner, const uint8_t** bytesOut, size_t* sizeOut)
{
    const vplJson member = vplJson_Member(owner, "uri");
    const char* uri = NULL;
    TRY(vplJson_ReadString(owner, "uri", &uri));
    if (uri == NULL) {
        return vplJson_Fail(owner, "lacks the key \"uri\"");
    }
    if (strncmp(uri, "data:", 5) == 0) {
        const char* data = strstr(uri, ";base64,");
        return data != NULL ? decodeBase64(g, &member, data + 8, bytesOut, sizeOut)
                            : vplJson_Fail(&member, "begins with \"%.40s\", must be data in base64", uri);
    }
    if (strstr(uri, "://") != NULL) {
        return vplJson_Fail(&member, "is \"%.80s\", must be a file beside this one", uri);
    }
    const char* path = NULL;
    char* bytes = NULL;
    TRY(vplGltf_FindBeside(g, uri, &path));
    if (!vplIsRegularFile(g->context, path)) { // a device or a pipe would make us wait
        return vplJson_Fail(&member, "is \"%.80s\", but there is no file %.200s", uri, path);
    }
    TRY(vplReadFile(g->context, path, &bytes, sizeOut));
    *bytesOut = vplArena_Copy(g->scratch, bytes, *sizeOut, 1);
    vplFree(g->context, bytes);
    return vplArena_Check(g->scratch);
}

static vplResult readBuffer(vplGltf* g, int index)
{
    vplGltfBuffer* b = &g->buffers[index];
    const vplJson buffer = vplGltf_Item(g, VPL_GLTF_BUFFERS, index),
                  member = vplJson_Member(&buffer, "byteLength");
    const uint8_t* bytes = NULL;
    size_t size = 0;
    int64_t length = -1;
    TRY(vplGltf_ReadWhole(&buffer, "byteLength", &length));
    if (length < 0) {
        return vplJson_Fail(&buffer, "lacks the key \"byteLength\"");
    }
    if (index == 0 && g->chunk != NULL && json_object_get(buffer.value, "uri") == NULL) {
        bytes = g->chunk;
        size = g->chunkSize;
    } else {
        TRY(vplGltf_ReadUri(g, &buffer, &bytes, &size));
    }
    if ((uint64_t)length > size) {
        return vplJson_Fail(&member, "is %lld, but there are only %zu bytes", (long long)length, size);
    }
    *b = (vplGltfBuffer){bytes, (size_t)length};
    return VPL_SUCCESS;
}

vplResult vplGltf_ReadView(vplGltf* g, int index, const uint8_t** bytesOut, size_t* sizeOut,
                           size_t* strideOut)
{
    const vplJson view = vplGltf_Item(g, VPL_GLTF_VIEWS, index);
    int buffer = -1;
    int64_t offset = 0, length = -1, stride = 0;
    TRY(vplGltf_ReadIndex(&view, "buffer", vplGltf_Count(g, VPL_GLTF_BUFFERS), &buffer));
    TRY(vplGltf_ReadWhole(&view, "byteOffset", &offset));
    TRY(vplGltf_ReadWhole(&view, "byteLength", &length));
    TRY(vplGltf_ReadWhole(&view, "byteStride", &stride));
    if (buffer < 0 || length < 0) {
        return vplJson_Fail(&view, "lacks the key \"%s\"", buffer < 0 ? "buffer" : "byteLength");
    }
    TRY(g->buffers[buffer].bytes == NULL ? readBuffer(g, buffer) : VPL_SUCCESS);
    const vplGltfBuffer* b = &g->buffers[buffer];
    if ((uint64_t)offset > b->size || (uint64_t)length > b->size - (uint64_t)offset) {
        return vplJson_Fail(&view, "has %lld bytes from %lld on, must be inside its buffer of %zu bytes",
                            (long long)length, (long long)offset, b->size);
    }
    *bytesOut = b->bytes + offset;
    *sizeOut = (size_t)length;
    *strideOut = (size_t)stride;
    return VPL_SUCCESS;
}
