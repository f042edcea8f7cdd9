// SPDX-License-Identifier: MIT
// The file of a glTF scene: JSON, or chunks of a .glb file, and the checks of what it requires.
#include "scene/gltf.h"

#include "base/bytes.h"
#include "base/file.h"

#include <stdlib.h>
#include <math.h>
#include <string.h>

// ---- typed reading

int vplGltf_Count(const vplGltf* g, vplGltfList list)
{
    return (int)json_array_size(g->lists[list].value);
}

vplJson vplGltf_Item(const vplGltf* g, vplGltfList list, int index)
{
    return vplJson_Element(&g->lists[list], index);
}

vplResult vplGltf_ReadWhole(const vplJson* object, const char* key, int64_t* out)
{
    const vplJson member = vplJson_Member(object, key);
    double number = 0;
    if (member.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_ReadNumber(object, key, &number));
    if (!(number >= 0 && number <= 0x1p53 && number == floor(number))) {
        return vplJson_Fail(&member, "is %g, must be a whole number, at least 0", number);
    }
    *out = (int64_t)number;
    return VPL_SUCCESS;
}

static vplResult requireBelow(const vplJson* at, int64_t index, int count, int* out)
{
    if (index >= count) {
        return vplJson_Fail(at, "is %lld, but there %s %d", (long long)index,
                            count == 1 ? "is only" : "are only", count);
    }
    *out = (int)index;
    return VPL_SUCCESS;
}

vplResult vplGltf_ReadIndex(const vplJson* object, const char* key, int count, int* out)
{
    const vplJson member = vplJson_Member(object, key);
    int64_t index = 0;
    TRY(vplGltf_ReadWhole(object, key, &index));
    return member.value != NULL ? requireBelow(&member, index, count, out) : VPL_SUCCESS;
}

vplResult vplGltf_ReadElement(const vplJson* element, int count, int* out)
{
    const double number = json_number_value(element->value); // 0 if it is no number
    if (!json_is_number(element->value) || !(number >= 0 && number <= 0x1p53 && number == floor(number))) {
        return vplJson_Fail(element, "must be an index, a whole number");
    }
    return requireBelow(element, (int64_t)number, count, out);
}

// ---- .glb

static uint32_t wordAt(const char* bytes)
{
    return vplTakeWord((const uint8_t*)bytes);
}

static vplResult failAt(const vplGltf* g, size_t byte, const char* found, uint64_t number,
                        const char* expected)
{
    return vplFail(g->context, VPL_PARSE_ERROR, "%s: byte %zu: found %s %llu, expected %s", g->path, byte,
                   found, (unsigned long long)number, expected);
}

// Finds the chunks of JSON and of the first buffer.
static vplResult findChunks(vplGltf* g, size_t size, const char** textOut, size_t* textSizeOut)
{
    enum { JSON_CHUNK = 0x4E4F534A, BIN_CHUNK = 0x004E4942, HEAD = 12 };
    if (size < HEAD + 8) {
        return failAt(g, size, "the end of the file after bytes", size, "a header and a chunk of JSON");
    }
    if (wordAt(g->file + 4) != 2) {
        return failAt(g, 4, "version", wordAt(g->file + 4), "version 2");
    }
    if (wordAt(g->file + 8) > size || wordAt(g->file + 8) < HEAD) {
        return failAt(g, 8, "a length of bytes", wordAt(g->file + 8), "at most the size of the file");
    }
    size_t at = HEAD;
    const size_t end = wordAt(g->file + 8);
    for (int i = 0; end - at >= 8; i++) {
        const uint32_t length = wordAt(g->file + at), type = wordAt(g->file + at + 4);
        if (length > end - at - 8) {
            return failAt(g, at, "a chunk of bytes", length, "at most what is left of the file");
        }
        if (i == 0 && type != JSON_CHUNK) {
            return failAt(g, at + 4, "a chunk of type", type, "JSON first");
        }
        if (i == 0) {
            *textOut = g->file + at + 8;
            *textSizeOut = length;
        } else if (type == BIN_CHUNK && g->chunk == NULL) {
            g->chunk = (const uint8_t*)g->file + at + 8;
            g->chunkSize = length;
        }
        const size_t padded = ((size_t)length + 3) & ~(size_t)3;
        at = padded > end - at - 8 ? end : at + 8 + padded;
    }
    return *textOut != NULL ? VPL_SUCCESS : failAt(g, HEAD, "a length of bytes", end, "a chunk of JSON");
}

static vplResult openJson(vplGltf* g)
{
    char* text = NULL;
    size_t size = 0;
    TRY(vplReadFile(g->context, g->path, &text, &size));
    if (size < 4 || memcmp(text, "glTF", 4) != 0) {
        return vplJsonFile_FromText(g->context, g->path, text, size, &g->json);
    }
    const char* chunk = NULL;
    size_t chunkSize = 0;
    g->file = text;
    TRY(findChunks(g, size, &chunk, &chunkSize));
    char* copy = vplAlloc(g->context, chunkSize + 1, 1);
    if (copy == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(copy, chunk, chunkSize);
    copy[chunkSize] = 0;
    return vplJsonFile_FromText(g->context, g->path, copy, chunkSize, &g->json);
}

// ---- what the file declares

static vplResult checkVersion(const vplGltf* g)
{
    const vplJson asset = vplJson_Member(&g->root, "asset"), version = vplJson_Member(&asset, "version");
    const char *text = NULL, *least = NULL;
    if (asset.value == NULL) {
        return vplJson_Fail(&g->root, "lacks the key \"asset\": it is no glTF file");
    }
    TRY(vplJson_RequireObject(&asset));
    TRY(vplJson_ReadString(&asset, "version", &text));
    TRY(vplJson_ReadString(&asset, "minVersion", &least));
    if (text == NULL) {
        return vplJson_Fail(&asset, "lacks the key \"version\"");
    }
    if (strncmp(text, "2.", 2) != 0 || (least != NULL && strcmp(least, "2.0") != 0)) {
        return vplJson_Fail(&version, "is \"%.20s\"%s%.20s, must be \"2.0\"", text,
                            least != NULL ? ", and minVersion is " : "", least != NULL ? least : "");
    }
    return VPL_SUCCESS;
}

static vplResult checkExtensions(const vplGltf* g)
{
    static const char* const known[] = {"KHR_lights_punctual",       "KHR_materials_emissive_strength",
                                        "KHR_texture_transform",     "KHR_mesh_quantization",
                                        "KHR_materials_unlit",       "KHR_materials_pbrSpecularGlossiness",
                                        "KHR_materials_transmission"};
    const vplJson required = vplJson_Member(&g->root, "extensionsRequired");
    if (required.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireArray(&required));
    for (size_t i = 0; i < json_array_size(required.value); i++) {
        const vplJson element = vplJson_Element(&required, (int)i);
        const char* name = json_string_value(element.value);
        bool found = false;
        for (size_t k = 0; k < sizeof known / sizeof *known && name != NULL; k++) {
            found = found || strcmp(name, known[k]) == 0;
        }
        if (!found) {
            return vplJson_Fail(
                &element, "is \"%.60s\", an extension that is not supported; export the file without it",
                name != NULL ? name : "?");
        }
    }
    return VPL_SUCCESS;
}

static vplResult findLists(vplGltf* g)
{
    static const char* const names[] = {"accessors", "animations", "buffers", "bufferViews", "cameras",
                                        "images",    "materials",  "meshes",  "nodes",       "samplers",
                                        "scenes",    "textures",   "lights"};
    g->extensions = vplJson_Member(&g->root, "extensions");
    g->punctual = vplJson_Member(&g->extensions, "KHR_lights_punctual");
    for (int i = 0; i < VPL_GLTF_LISTS; i++) {
        g->lists[i] = vplJson_Member(i == VPL_GLTF_LIGHTS ? &g->punctual : &g->root, names[i]);
        if (g->lists[i].value == NULL) {
            continue;
        }
        TRY(vplJson_RequireArray(&g->lists[i]));
        if (json_array_size(g->lists[i].value) > VPL_MAX_TRIANGLES) {
            return vplJson_Fail(&g->lists[i], "has more than %d elements", VPL_MAX_TRIANGLES);
        }
        for (int k = 0; k < vplGltf_Count(g, (vplGltfList)i); k++) {
            const vplJson item = vplGltf_Item(g, (vplGltfList)i, k);
            TRY(vplJson_RequireObject(&item));
        }
    }
    return VPL_SUCCESS;
}

static int* allocateNumbers(vplGltf* g, vplGltfList list)
{
    const int count = vplGltf_Count(g, list);
    int* numbers = vplArena_Alloc(g->scratch, (size_t)count, sizeof *numbers);
    for (int i = 0; numbers != NULL && i < count; i++) {
        numbers[i] = VPL_GLTF_NOT_READ;
    }
    return numbers;
}

vplResult vplGltf_Open(vplGltf* g)
{
    TRY(openJson(g));
    g->json.subject = "the file";
    g->root = vplJson_Root(&g->json);
    TRY(vplJson_RequireObject(&g->root));
    TRY(checkVersion(g));
    TRY(checkExtensions(g));
    TRY(findLists(g));
    g->buffers =
        vplArena_AllocZero(g->scratch, (size_t)vplGltf_Count(g, VPL_GLTF_BUFFERS), sizeof *g->buffers);
    g->meshOf = allocateNumbers(g, VPL_GLTF_MESHES);
    g->materialOf = allocateNumbers(g, VPL_GLTF_MATERIALS);
    g->textureOf = allocateNumbers(g, VPL_GLTF_TEXTURES);
    g->defaultMaterial = VPL_GLTF_NOT_READ;
    g->means =
        vplArena_AllocZero(g->scratch, (size_t)vplGltf_Count(g, VPL_GLTF_IMAGES), 2 * sizeof *g->means);
    return vplArena_Check(g->scratch);
}

void vplGltf_Close(vplGltf* g)
{
    if (g->json.root != NULL) {
        vplJsonFile_Close(&g->json);
    }
    vplFree(g->context, g->file);
}
