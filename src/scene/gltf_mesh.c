// SPDX-License-Identifier: MIT
// Meshes of glTF files: the triangles of all primitives of a mesh become one mesh of the scene.
#include "scene/gltf.h"

#include <math.h>
#include <string.h>

enum { POSITION, NORMAL, COLOR, TEXCOORD, ATTRIBUTES };
enum { TRIANGLES = 4, STRIP, FAN };

typedef struct Primitive {
    int accessors[ATTRIBUTES]; // -1: none
    uint32_t first, count;     // its vertices, in the arrays of the mesh
    bool owns;                 // false: they are those of an earlier primitive
    int mode;
    int material; // of the scene
} Primitive;

typedef struct Reader {
    vplGltf* g;
    vplJson mesh, primitives;
    Primitive* list;
    size_t count;
    vplRawMesh raw;
} Reader;

static vplJson attributesOf(const vplJson* primitive)
{
    return vplJson_Member(primitive, "attributes");
}

// Opens an attribute of a primitive; its count is -1 if there is none.
static vplResult openAttribute(Reader* r, const vplJson* primitive, const Primitive* p, int attribute,
                               vplGltfAccessor* out)
{
    static const char* const names[] = {"POSITION", "NORMAL", "COLOR_0", "TEXCOORD_0"};
    static const unsigned components[] = {1 << 3, 1 << 3, 1 << 3 | 1 << 4, 1 << 2};
    const vplJson attributes = attributesOf(primitive),
                  member = vplJson_Member(&attributes, names[attribute]);
    *out = (vplGltfAccessor){.count = -1};
    if (p->accessors[attribute] < 0) {
        return VPL_SUCCESS;
    }
    TRY(vplGltf_OpenAccessor(r->g, &attributes, names[attribute], components[attribute], out));
    return attribute == POSITION || out->count == (int64_t)p->count
               ? VPL_SUCCESS
               : vplJson_Fail(&member, "has %lld elements, must have %u, as POSITION has",
                              (long long)out->count, p->count);
}

// ---- which vertices

static vplResult readNames(Reader* r, const vplJson* primitive, Primitive* p)
{
    static const char* const names[] = {"POSITION", "NORMAL", "COLOR_0", "TEXCOORD_0"};
    const vplJson attributes = attributesOf(primitive);
    if (attributes.value != NULL) {
        TRY(vplJson_RequireObject(&attributes));
    }
    for (int i = 0; i < ATTRIBUTES; i++) {
        p->accessors[i] = -1;
        TRY(vplGltf_ReadIndex(&attributes, names[i], vplGltf_Count(r->g, VPL_GLTF_ACCESSORS),
                              &p->accessors[i]));
    }
    r->g->losses[VPL_GLTF_MORPHS] += json_object_get(primitive->value, "targets") != NULL;
    return VPL_SUCCESS;
}

// Gives a primitive vertices of its own, or those of an earlier one with the same accessors.
static vplResult placeVertices(Reader* r, const vplJson* primitive, Primitive* p)
{
    vplGltfAccessor positions;
    for (size_t i = 0; i < r->count; i++) {
        if (r->list[i].owns && memcmp(r->list[i].accessors, p->accessors, sizeof p->accessors) == 0) {
            p->first = r->list[i].first;
            p->count = r->list[i].count;
            return VPL_SUCCESS;
        }
    }
    TRY(openAttribute(r, primitive, p, POSITION, &positions));
    if (r->raw.vertexCount + (size_t)positions.count > VPL_MAX_TRIANGLES) {
        return vplJson_Fail(primitive, "makes more than %d vertices of its mesh", VPL_MAX_TRIANGLES);
    }
    p->owns = true;
    p->first = (uint32_t)r->raw.vertexCount;
    p->count = (uint32_t)positions.count;
    r->raw.vertexCount += p->count;
    return VPL_SUCCESS;
}

// Adds a primitive of triangles to the list; others are left out.
static vplResult readPrimitive(Reader* r, int index)
{
    const vplJson primitive = vplJson_Element(&r->primitives, index);
    Primitive p = {.mode = TRIANGLES, .material = -1};
    int64_t mode = TRIANGLES;
    int material = -1;
    TRY(vplJson_RequireObject(&primitive));
    TRY(vplGltf_ReadWhole(&primitive, "mode", &mode));
    TRY(vplGltf_ReadIndex(&primitive, "material", vplGltf_Count(r->g, VPL_GLTF_MATERIALS), &material));
    TRY(readNames(r, &primitive, &p));
    if (mode > FAN) {
        const vplJson member = vplJson_Member(&primitive, "mode");
        return vplJson_Fail(&member, "is %lld, must be in [0, 6]", (long long)mode);
    }
    if (mode < TRIANGLES || p.accessors[POSITION] < 0) {
        r->g->losses[VPL_GLTF_POINTS]++;
        return VPL_SUCCESS;
    }
    p.mode = (int)mode;
    TRY(placeVertices(r, &primitive, &p));
    TRY(vplGltf_GetMaterial(r->g, material, &p.material));
    r->list[r->count++] = p;
    return VPL_SUCCESS;
}

// ---- their attributes

static vplResult checkPosition(Reader* r, const vplJson* primitive, const float* p, uint32_t index)
{
    for (int k = 0; k < 3; k++) {
        if (!(fabsf(p[k]) <= VPL_MAX_MAGNITUDE)) {
            const vplJson attributes = attributesOf(primitive),
                          member = vplJson_Member(&attributes, "POSITION");
            return vplJson_Fail(&member, "has the number %g in element %u, must be in [%g, %g]", (double)p[k],
                                index, -(double)VPL_MAX_MAGNITUDE, (double)VPL_MAX_MAGNITUDE);
        }
    }
    (void)r;
    return VPL_SUCCESS;
}

static float clampUnit(float x)
{
    return x > 0 ? (x < 1 ? x : 1) : 0; // NaN is 0
}

// Stores one attribute of a primitive in the arrays of the mesh. Vertices without normals have 0, and without colours 1.
static void store(Reader* r, const Primitive* p, int attribute, const float* values, int components)
{
    for (uint32_t i = 0; i < p->count; i++) {
        const float* v = values + (size_t)i * (size_t)components;
        const size_t to = (size_t)p->first + i;
        if (attribute == POSITION) {
            r->raw.positions[to] = (vplVec3){v[0], v[1], v[2]};
        } else if (attribute == NORMAL) {
            r->raw.normals[to] = (vplVec3){v[0], v[1], v[2]};
        } else if (attribute == COLOR) {
            r->raw.colors[to] = (vplRgb){clampUnit(v[0]), clampUnit(v[1]), clampUnit(v[2])};
        } else {
            r->raw.texcoords[2 * to] = fabsf(v[0]) < 1e6f ? v[0] : 0;
            r->raw.texcoords[2 * to + 1] = fabsf(v[1]) < 1e6f ? 1 - v[1] : 0; // v grows downwards in glTF
        }
    }
}

static vplResult readAttributes(Reader* r, const vplJson* primitive, const Primitive* p)
{
    for (int i = 0; i < ATTRIBUTES; i++) {
        vplGltfAccessor a;
        TRY(openAttribute(r, primitive, p, i, &a));
        if (a.count < 0) {
            continue;
        }
        float* values = vplArena_Alloc(r->g->scratch, (size_t)a.count, (size_t)a.components * sizeof *values);
        TRY(vplArena_Check(r->g->scratch));
        vplGltfAccessor_CopyFloats(&a, values);
        for (uint32_t k = 0; i == POSITION && k < p->count; k++) {
            TRY(checkPosition(r, primitive, values + 3 * (size_t)k, k));
        }
        store(r, p, i, values, a.components);
        vplArena_Free(r->g->scratch, values);
    }
    return VPL_SUCCESS;
}

static void* allocate(Reader* r, size_t size)
{
    return vplArena_AllocZero(r->raw.arena, r->raw.vertexCount, size);
}

// Allocates the attributes that any primitive has.
static vplResult allocateVertices(Reader* r)
{
    bool has[ATTRIBUTES] = {false};
    for (size_t i = 0; i < r->count; i++) {
        for (int k = 0; k < ATTRIBUTES; k++) {
            has[k] = has[k] || r->list[i].accessors[k] >= 0;
        }
    }
    r->raw.positions = allocate(r, sizeof *r->raw.positions);
    r->raw.normals = has[NORMAL] ? allocate(r, sizeof *r->raw.normals) : NULL;
    r->raw.colors = has[COLOR] ? allocate(r, sizeof *r->raw.colors) : NULL;
    r->raw.texcoords = has[TEXCOORD] ? allocate(r, 2 * sizeof *r->raw.texcoords) : NULL;
    TRY(vplArena_Check(r->raw.arena));
    for (size_t i = 0; has[COLOR] && i < r->raw.vertexCount; i++) {
        r->raw.colors[i] = (vplRgb){1, 1, 1};
    }
    return VPL_SUCCESS;
}

// ---- triangles

// The corners of triangle t of a list, strip or fan.
static void cornersOf(int mode, size_t t, size_t out[3])
{
    const size_t odd = t % 2;
    out[0] = mode == TRIANGLES ? 3 * t : mode == STRIP ? t : t + 1;
    out[1] = mode == TRIANGLES ? 3 * t + 1 : mode == STRIP ? t + 1 + odd : t + 2;
    out[2] = mode == TRIANGLES ? 3 * t + 2 : mode == STRIP ? t + 2 - odd : 0;
}

static vplResult addTriangles(Reader* r, const Primitive* p, const uint32_t* indices, size_t count)
{
    const size_t triangles = p->mode == TRIANGLES ? count / 3 : count < 3 ? 0 : count - 2;
    for (size_t t = 0; t < triangles; t++) {
        size_t at[3];
        uint32_t corners[3];
        cornersOf(p->mode, t, at);
        for (int k = 0; k < 3; k++) {
            corners[k] = p->first + (indices != NULL ? indices[at[k]] : (uint32_t)at[k]);
        }
        TRY(t % 65536 == 65535 ? vplAsk(r->g->context) : VPL_SUCCESS);
        TRY(vplRawMesh_AddTriangle(&r->raw, r->g->context, corners, p->material));
    }
    return VPL_SUCCESS;
}

static vplResult readTriangles(Reader* r, const vplJson* primitive, const Primitive* p)
{
    const vplJson member = vplJson_Member(primitive, "indices");
    vplGltfAccessor a;
    TRY(vplGltf_OpenAccessor(r->g, primitive, "indices", 1 << 1, &a));
    if (a.count < 0) {
        return addTriangles(r, p, NULL, p->count);
    }
    if (a.type != 5121 && a.type != 5123 && a.type != 5125) {
        return vplJson_Fail(&member, "has the component type %d, must be 5121, 5123 or 5125", a.type);
    }
    uint32_t* indices = vplArena_Alloc(r->g->scratch, (size_t)a.count, sizeof *indices);
    TRY(vplArena_Check(r->g->scratch));
    vplGltfAccessor_CopyIndices(&a, indices);
    for (int64_t i = 0; i < a.count; i++) {
        if (indices[i] >= p->count) {
            return vplJson_Fail(&member, "has the index %u in element %lld, must be one of %u vertices",
                                indices[i], (long long)i, p->count);
        }
    }
    const vplResult result = addTriangles(r, p, indices, (size_t)a.count);
    vplArena_Free(r->g->scratch, indices);
    return result;
}

// ---- the mesh

// Finds primitive k of the list again among those of the file, which may have others between.
static vplResult fill(Reader* r, const int* numbers)
{
    TRY(allocateVertices(r));
    for (size_t i = 0; i < r->count; i++) {
        const vplJson primitive = vplJson_Element(&r->primitives, numbers[i]);
        TRY(r->list[i].owns ? readAttributes(r, &primitive, &r->list[i]) : VPL_SUCCESS);
        TRY(readTriangles(r, &primitive, &r->list[i]));
    }
    return VPL_SUCCESS;
}

static vplResult readMesh(Reader* r)
{
    const size_t count = json_array_size(r->primitives.value);
    r->list = vplArena_Alloc(r->g->scratch, count, sizeof *r->list);
    int* numbers = vplArena_Alloc(r->g->scratch, count, sizeof *numbers);
    TRY(vplArena_Check(r->g->scratch));
    for (size_t i = 0; i < count; i++) {
        numbers[r->count] = (int)i;
        TRY(readPrimitive(r, (int)i));
    }
    const vplResult result = fill(r, numbers);
    vplArena_Free(r->g->scratch, numbers);
    vplArena_Free(r->g->scratch, r->list);
    return result;
}

vplResult vplGltf_GetMesh(vplGltf* g, int index, int* out)
{
    *out = g->meshOf[index];
    if (*out != VPL_GLTF_NOT_READ) {
        return VPL_SUCCESS;
    }
    Reader r = {.g = g, .mesh = vplGltf_Item(g, VPL_GLTF_MESHES, index)};
    r.primitives = vplJson_Member(&r.mesh, "primitives");
    if (r.primitives.value == NULL) {
        return vplJson_Fail(&r.mesh, "lacks the key \"primitives\"");
    }
    TRY(vplJson_RequireArray(&r.primitives));
    r.raw = (vplRawMesh){.file = g->path, .arena = vplArena_Create(g->context)};
    const vplResult result = readMesh(&r);
    if (result != VPL_SUCCESS) {
        vplArena_Destroy(r.raw.arena);
        return result;
    }
    TRY(vplScene_AddRawMesh(g->scene, &r.raw, out));
    g->losses[VPL_GLTF_EMPTY] += *out < 0;
    g->meshOf[index] = *out;
    return VPL_SUCCESS;
}
