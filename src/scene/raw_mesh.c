// SPDX-License-Identifier: MIT
// Turns the triangles of a file into a mesh of the scene, corner by corner: a vertex is made when a triangle first
// needs it.
#include "scene/raw_mesh.h"

#include "math/double3.h"
#include "scene/hash_index.h"
#include "scene/obj.h"

#include <string.h>

enum { KEY_WORDS = 11, ASK_EVERY = 65536 };

typedef struct Welder {
    const vplRawMesh* raw;
    vplArena* scratch;
    vplHashIndex index; // of the new vertices
    uint32_t* fromOf;   // per new vertex: that of the file
    vplVec3* normalOf;  // per new vertex, a unit vector; NULL: the mesh has none
    uint32_t* newOf;    // per vertex of the file, unless its normal is its triangle's
    size_t fromCapacity, normalCapacity;
    long long empty;         // triangles without area
    long long directionless; // corners whose normal has no direction
} Welder;

vplResult vplRawMesh_AddTriangle(vplRawMesh* raw, vplContext* context, const uint32_t corners[3],
                                 int material)
{
    const size_t count = raw->triangleCount;
    if (count == VPL_MAX_TRIANGLES) {
        return vplFail(context, VPL_LIMIT, "%s: more than %d triangles", raw->file, VPL_MAX_TRIANGLES);
    }
    TRY(vplArena_Reserve(raw->arena, &raw->indices, &raw->indexCapacity, count + 1,
                         3 * sizeof *raw->indices));
    TRY(vplArena_Reserve(raw->arena, &raw->materials, &raw->materialCapacity, count + 1,
                         sizeof *raw->materials));
    memcpy(raw->indices + 3 * count, corners, 3 * sizeof *corners);
    raw->materials[count] = material;
    raw->triangleCount++;
    return VPL_SUCCESS;
}

// The unit vector along a normal of the file; false if it has no direction.
static bool findDirection(vplVec3 n, vplVec3* out)
{
    double v[3];
    vplToDouble3(n, v);
    const double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!vplIsFiniteVec(n) || !(largest > 0)) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        v[k] /= largest;
    }
    const double length = sqrt(vplDot3(v, v));
    *out = vplVec((float)(v[0] / length), (float)(v[1] / length), (float)(v[2] / length));
    return true;
}

// Writes all that two equal vertices share; adding 0 makes -0 and 0 the same.
static void makeKey(const vplRawMesh* raw, uint32_t from, vplVec3 normal, uint32_t key[KEY_WORDS])
{
    float values[KEY_WORDS] = {0};
    memcpy(values, &raw->positions[from], sizeof *raw->positions);
    memcpy(values + 3, &normal, sizeof normal);
    if (raw->colors != NULL) {
        memcpy(values + 6, &raw->colors[from], sizeof *raw->colors);
    }
    if (raw->texcoords != NULL) {
        memcpy(values + 9, &raw->texcoords[2 * (size_t)from], 2 * sizeof *raw->texcoords);
    }
    for (int i = 0; i < KEY_WORDS; i++) {
        values[i] += 0.0f;
    }
    memcpy(key, values, sizeof values);
}

static vplResult addVertex(Welder* w, uint32_t hash, uint32_t from, vplVec3 normal)
{
    const size_t count = w->index.count;
    TRY(vplArena_Reserve(w->scratch, &w->fromOf, &w->fromCapacity, count + 1, sizeof *w->fromOf));
    if (w->raw->normals != NULL) {
        TRY(vplArena_Reserve(w->scratch, &w->normalOf, &w->normalCapacity, count + 1, sizeof *w->normalOf));
        w->normalOf[count] = normal;
    }
    w->fromOf[count] = from;
    return vplHashIndex_Add(&w->index, hash);
}

static vplResult findVertex(Welder* w, uint32_t from, vplVec3 normal, uint32_t* out)
{
    uint32_t key[KEY_WORDS], other[KEY_WORDS];
    makeKey(w->raw, from, normal, key);
    const uint32_t hash = vplHashKey(key, KEY_WORDS);
    for (*out = vplHashIndex_First(&w->index, hash); *out != VPL_NO_ENTRY;
         *out = vplHashIndex_Next(&w->index, *out)) {
        makeKey(w->raw, w->fromOf[*out], w->normalOf != NULL ? w->normalOf[*out] : vplVec(0, 0, 0), other);
        if (memcmp(key, other, sizeof key) == 0) {
            return VPL_SUCCESS;
        }
    }
    *out = w->index.count;
    return addVertex(w, hash, from, normal);
}

// Replaces a vertex of the file by the new one.
static vplResult placeCorner(Welder* w, vplVec3 flat, uint32_t* corner)
{
    const uint32_t from = *corner;
    vplVec3 normal = {0, 0, 0};
    if (w->newOf[from] != VPL_NO_ENTRY) {
        *corner = w->newOf[from];
        return VPL_SUCCESS;
    }
    const bool own = w->raw->normals == NULL || findDirection(w->raw->normals[from], &normal);
    if (!own) {
        normal = flat;
        w->directionless++;
    }
    TRY(findVertex(w, from, normal, corner));
    w->newOf[from] = own ? *corner : VPL_NO_ENTRY;
    return VPL_SUCCESS;
}

// Places the corners of all triangles with area, which move to the front.
static vplResult placeCorners(Welder* w, vplRawMesh* raw, vplContext* context)
{
    size_t kept = 0;
    for (size_t t = 0; t < raw->triangleCount; t++) {
        uint32_t* from = raw->indices + 3 * t;
        uint32_t* to = raw->indices + 3 * kept;
        const vplVec3 at[3] = {raw->positions[from[0]], raw->positions[from[1]], raw->positions[from[2]]};
        vplVec3 flat;
        TRY(t % ASK_EVERY == ASK_EVERY - 1 ? vplAsk(context) : VPL_SUCCESS);
        if (!vplObj_FindNormal(at, &flat)) {
            w->empty++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            to[k] = from[k];
            TRY(placeCorner(w, flat, &to[k]));
        }
        raw->materials[kept++] = raw->materials[t];
    }
    raw->triangleCount = kept;
    return VPL_SUCCESS;
}

// A new array of the elements at `from`, in place of the old one.
static void* gather(vplArena* arena, void* array, const uint32_t* from, size_t count, size_t size)
{
    char* out = array != NULL ? vplArena_Alloc(arena, count, size) : NULL;
    for (size_t i = 0; out != NULL && i < count; i++) {
        memcpy(out + i * size, (const char*)array + from[i] * size, size);
    }
    vplArena_Free(arena, array);
    return out;
}

// A copy of the first `count` elements, in place of the array.
static void* cut(vplArena* arena, void* array, size_t count, size_t size)
{
    void* out = vplArena_Copy(arena, array, count, size);
    vplArena_Free(arena, array);
    return out;
}

static vplMeshDef makeDef(const Welder* w, vplRawMesh* raw)
{
    vplMeshDef def = vplDefaultMeshDef();
    const size_t vertices = w->index.count;
    def.vertexCount = (int)vertices;
    def.triangleCount = (int)raw->triangleCount;
    def.positions = gather(raw->arena, raw->positions, w->fromOf, vertices, sizeof *raw->positions);
    if (w->normalOf != NULL) {
        def.normals = vplArena_Copy(raw->arena, w->normalOf, vertices, sizeof *w->normalOf);
        vplArena_Free(raw->arena, raw->normals);
    }
    def.colors = gather(raw->arena, raw->colors, w->fromOf, vertices, sizeof *raw->colors);
    def.texcoords = gather(raw->arena, raw->texcoords, w->fromOf, vertices, 2 * sizeof *raw->texcoords);
    def.indices = cut(raw->arena, raw->indices, raw->triangleCount, 3 * sizeof *raw->indices);
    def.materials = cut(raw->arena, raw->materials, raw->triangleCount, sizeof *raw->materials);
    return def;
}

static vplResult weld(Welder* w, vplRawMesh* raw, vplContext* context)
{
    if (raw->vertexCount > VPL_MAX_TRIANGLES) {
        return vplFail(context, VPL_LIMIT, "%s: %zu vertices, at most %d are allowed", raw->file,
                       raw->vertexCount, VPL_MAX_TRIANGLES);
    }
    w->newOf = vplArena_Alloc(w->scratch, raw->vertexCount, sizeof *w->newOf);
    TRY(vplArena_Check(w->scratch));
    memset(w->newOf, 0xFF, raw->vertexCount * sizeof *w->newOf); // VPL_NO_ENTRY
    TRY(placeCorners(w, raw, context));
    if (w->index.count > VPL_MAX_TRIANGLES) {
        return vplFail(context, VPL_LIMIT, "%s: %u different corners, at most %d are allowed", raw->file,
                       w->index.count, VPL_MAX_TRIANGLES);
    }
    if (w->empty > 0 && raw->triangleCount > 0) {
        vplLog(context, VPL_LOG_INFO, "%s: left out %lld triangles without area", raw->file, w->empty);
    }
    if (w->directionless > 0) {
        vplLog(context, VPL_LOG_WARNING,
               "%s: %lld corners whose normal has no direction take that of their triangle", raw->file,
               w->directionless);
    }
    return VPL_SUCCESS;
}

vplResult vplScene_AddRawMesh(vplScene* scene, vplRawMesh* raw, int* indexOut)
{
    vplArena* scratch = vplArena_Create(scene->context);
    Welder w = {.raw = raw, .scratch = scratch, .index = {.arena = scratch}};
    vplResult result = weld(&w, raw, scene->context);
    *indexOut = -1;
    vplArena* arena = raw->arena;
    if (result == VPL_SUCCESS && raw->triangleCount > 0) {
        const vplMeshDef def = makeDef(&w, raw);
        result = vplScene_AdoptMesh(scene, &def, arena, indexOut);
        raw->arena = NULL;
    }
    vplArena_Destroy(raw->arena);
    raw->arena = NULL;
    vplArena_Destroy(scratch);
    return result;
}
