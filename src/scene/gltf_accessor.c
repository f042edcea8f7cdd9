// SPDX-License-Identifier: MIT
// Accessors of glTF files: typed, strided, sparse. All places are checked when an accessor is opened.
#include "scene/gltf.h"

#include "base/bytes.h"

#include <math.h>
#include <string.h>

enum { INT8 = 5120, UINT8, INT16, UINT16, UINT32 = 5125, FLOAT32 };

// Zeros of an accessor without a buffer view cost memory, but nothing in the file.
enum { MOST_ZEROS = 1 << 24 };

static size_t sizeOf(int type)
{
    return type <= UINT8 ? 1 : type <= UINT16 ? 2 : 4;
}

// Reads the type of components, which must be listed.
static vplResult readType(const vplJson* object, const char* expected, const int* types, int* out)
{
    const vplJson member = vplJson_Member(object, "componentType");
    int64_t type = -1;
    TRY(vplGltf_ReadWhole(object, "componentType", &type));
    if (member.value == NULL) {
        return vplJson_Fail(object, "lacks the key \"componentType\"");
    }
    for (int i = 0; types[i] != 0; i++) {
        if (type == types[i]) {
            *out = types[i];
            return VPL_SUCCESS;
        }
    }
    return vplJson_Fail(&member, "is %lld, must be %s", (long long)type, expected);
}

// Reads "bufferView" and "byteOffset" of an accessor or of a part of it. *bytesOut is NULL if there is no view.
static vplResult readPart(vplGltf* g, const vplJson* object, int64_t count, size_t size, vplGltfAccessor* out)
{
    int view = -1;
    int64_t offset = 0;
    size_t length = 0, stride = 0;
    const uint8_t* bytes = NULL;
    TRY(vplGltf_ReadIndex(object, "bufferView", vplGltf_Count(g, VPL_GLTF_VIEWS), &view));
    TRY(vplGltf_ReadWhole(object, "byteOffset", &offset));
    out->bytes = NULL;
    if (view < 0) {
        return VPL_SUCCESS;
    }
    TRY(vplGltf_ReadView(g, view, &bytes, &length, &stride));
    stride = stride == 0 ? size : stride;
    if (stride < size || stride > 252 + size) {
        return vplJson_Fail(object, "has elements of %zu bytes, but the stride of its view is %zu", size,
                            stride);
    }
    // Nothing here can overflow: offset <= length < 2^53, and the division comes before the comparison.
    const uint64_t room = (uint64_t)offset <= length ? length - (uint64_t)offset : 0;
    const uint64_t most = room < size ? 0 : (room - size) / stride + 1;
    if ((uint64_t)count > most) {
        return vplJson_Fail(object, "has %lld elements, but its view has room for %llu", (long long)count,
                            (unsigned long long)most);
    }
    out->bytes = count > 0 ? bytes + offset : bytes;
    out->stride = stride;
    return VPL_SUCCESS;
}

static uint32_t indexAt(const uint8_t* p, int type)
{
    return type == UINT8 ? p[0] : type == UINT16 ? p[0] | (uint32_t)p[1] << 8 : vplTakeWord(p);
}

static vplResult readSparse(vplGltf* g, const vplJson* object, vplGltfAccessor* a)
{
    static const int types[] = {UINT8, UINT16, UINT32, 0};
    const vplJson sparse = vplJson_Member(object, "sparse"), indices = vplJson_Member(&sparse, "indices"),
                  values = vplJson_Member(&sparse, "values");
    if (sparse.value == NULL) {
        return VPL_SUCCESS;
    }
    vplGltfAccessor part = {0};
    TRY(vplJson_RequireObject(&sparse));
    TRY(vplGltf_ReadWhole(&sparse, "count", &a->sparseCount));
    if (indices.value == NULL || values.value == NULL) {
        return vplJson_Fail(&sparse, "lacks the key \"%s\"", indices.value == NULL ? "indices" : "values");
    }
    TRY(readType(&indices, "5121, 5123 or 5125", types, &a->sparseType));
    const size_t size = sizeOf(a->sparseType), element = sizeOf(a->type) * (size_t)a->components;
    TRY(readPart(g, &indices, a->sparseCount, size, &part));
    a->sparseIndices = part.bytes;
    const size_t indexStride = part.stride;
    TRY(readPart(g, &values, a->sparseCount, element, &part));
    a->sparseValues = part.bytes;
    if (a->sparseIndices == NULL || a->sparseValues == NULL || indexStride != size ||
        part.stride != element) {
        return vplJson_Fail(&sparse, "needs buffer views without strides");
    }
    for (int64_t i = 0; i < a->sparseCount; i++) {
        const uint32_t index = indexAt(a->sparseIndices + (size_t)i * size, a->sparseType);
        if (index >= a->count) {
            return vplJson_Fail(&indices, "has the index %u, must be one of %lld", index,
                                (long long)a->count);
        }
    }
    return VPL_SUCCESS;
}

static vplResult readComponents(const vplJson* object, const char* user, unsigned allowed, int* out)
{
    static const char* const names[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
    const vplJson member = vplJson_Member(object, "type");
    const char* type = NULL;
    TRY(vplJson_ReadString(object, "type", &type));
    if (type == NULL) {
        return vplJson_Fail(object, "lacks the key \"type\"");
    }
    for (int i = 0; i < 4; i++) {
        if (strcmp(type, names[i]) == 0 && (allowed >> (i + 1) & 1) != 0) {
            *out = i + 1;
            return VPL_SUCCESS;
        }
    }
    int least = 1;
    while ((allowed >> least & 1) == 0) {
        least++;
    }
    return vplJson_Fail(&member, "is \"%.20s\", must be \"%s\" for %s", type, names[least - 1], user);
}

vplResult vplGltf_OpenAccessor(vplGltf* g, const vplJson* object, const char* key, unsigned components,
                               vplGltfAccessor* out)
{
    static const int types[] = {INT8, UINT8, INT16, UINT16, UINT32, FLOAT32, 0};
    int index = -1;
    *out = (vplGltfAccessor){.count = -1};
    TRY(vplGltf_ReadIndex(object, key, vplGltf_Count(g, VPL_GLTF_ACCESSORS), &index));
    if (index < 0) {
        return VPL_SUCCESS;
    }
    const vplJson accessor = vplGltf_Item(g, VPL_GLTF_ACCESSORS, index);
    TRY(vplGltf_ReadWhole(&accessor, "count", &out->count));
    if (out->count < 0 || out->count > VPL_MAX_TRIANGLES) {
        const vplJson member = vplJson_Member(&accessor, "count");
        return out->count < 0 ? vplJson_Fail(&accessor, "lacks the key \"count\"")
                              : vplJson_Fail(&member, "is %lld, must be at most %d", (long long)out->count,
                                             VPL_MAX_TRIANGLES);
    }
    TRY(readType(&accessor, "5120 to 5123, 5125 or 5126", types, &out->type));
    TRY(readComponents(&accessor, key, components, &out->components));
    const vplJson normalized = vplJson_Member(&accessor, "normalized");
    out->normalized = json_is_true(normalized.value) && out->type < UINT32;
    TRY(readPart(g, &accessor, out->count, sizeOf(out->type) * (size_t)out->components, out));
    if (out->bytes == NULL && out->count > MOST_ZEROS) {
        return vplJson_Fail(&accessor, "has %lld elements but no bufferView, must have at most %d",
                            (long long)out->count, MOST_ZEROS);
    }
    return readSparse(g, &accessor, out);
}

// ---- numbers

static float numberAt(const uint8_t* p, const vplGltfAccessor* a)
{
    const uint32_t bits = indexAt(p, a->type == INT8 || a->type == UINT8     ? UINT8
                                     : a->type == INT16 || a->type == UINT16 ? UINT16
                                                                             : UINT32);
    float value;
    switch (a->type) {
    case INT8:
        value = (float)(int8_t)bits;
        return a->normalized ? fmaxf(value / 127.0f, -1) : value;
    case UINT8:
        return a->normalized ? (float)bits / 255.0f : (float)bits;
    case INT16:
        value = (float)(int16_t)bits;
        return a->normalized ? fmaxf(value / 32767.0f, -1) : value;
    case UINT16:
        return a->normalized ? (float)bits / 65535.0f : (float)bits;
    case UINT32:
        return (float)bits;
    default:
        memcpy(&value, &bits, sizeof value);
        return value;
    }
}

void vplGltfAccessor_CopyFloats(const vplGltfAccessor* a, float* out)
{
    const size_t n = (size_t)a->components, size = sizeOf(a->type);
    for (size_t i = 0; i < (size_t)a->count; i++) {
        for (size_t k = 0; k < n; k++) {
            out[i * n + k] = a->bytes != NULL ? numberAt(a->bytes + i * a->stride + k * size, a) : 0;
        }
    }
    for (size_t i = 0; i < (size_t)a->sparseCount; i++) {
        const size_t to = indexAt(a->sparseIndices + i * sizeOf(a->sparseType), a->sparseType);
        for (size_t k = 0; k < n; k++) {
            out[to * n + k] = numberAt(a->sparseValues + (i * n + k) * size, a);
        }
    }
}

void vplGltfAccessor_CopyIndices(const vplGltfAccessor* a, uint32_t* out)
{
    for (size_t i = 0; i < (size_t)a->count; i++) {
        out[i] = a->bytes != NULL ? indexAt(a->bytes + i * a->stride, a->type) : 0;
    }
    for (size_t i = 0; i < (size_t)a->sparseCount; i++) {
        const size_t to = indexAt(a->sparseIndices + i * sizeOf(a->sparseType), a->sparseType);
        out[to] = indexAt(a->sparseValues + i * sizeOf(a->type), a->type);
    }
}
