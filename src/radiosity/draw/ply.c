// SPDX-License-Identifier: MIT
// Writes a lit mesh with baked vertex colours.
// Based on: Turk, The PLY Polygon File Format, 1994.
#include <vpl/imagetools.h>

#include "base/arena.h"
#include "base/bytes.h"
#include "math/vec.h"
#include "radiosity/sides/side.h"

#include <stdio.h>
#include <string.h>

// A vertex of the file but for its position, which comes first: three floats, or doubles in a scene with an origin.
typedef struct PlyVertex {
    float normal[3];
    uint8_t code[3]; // sRGB
    float colour[3]; // linear
} PlyVertex;

typedef struct PlyFace {
    uint32_t vertices[3];
} PlyFace;

// Bytes in the file: without padding, and with the number of corners before a face.
enum { VERTEX_BYTES = 3 * 4 + 3 + 3 * 4, FACE_BYTES = 1 + 3 * 4 };

// A list of the file's vertices for one vertex of the mesh, each with another reflectance.
typedef struct Entry {
    vplRgb reflectance;
    int next; // -1: the last
} Entry;

typedef struct Baker {
    vplContext* context;
    vplArena* arena; // owns the arrays
    const vplPatchMesh* mesh;
    const vplRgb* irradiance;
    float scale;
    int* heads; // per vertex of the mesh: the first entry for the face that is being written; -1: none
    PlyVertex* vertices;
    uint32_t* positions; // of each vertex, in the mesh
    Entry* entries;
    size_t vertexCount, vertexCapacity, entryCapacity, positionCapacity;
    PlyFace* faces;
    size_t faceCount, faceCapacity;
} Baker;

// ---- vertices

static PlyVertex makeVertex(const Baker* b, uint32_t vertex, int face, vplRgb reflectance)
{
    const vplPatchMesh* m = b->mesh;
    const vplVec3 n = face == 0 ? m->normals[vertex] : vplNegate(m->normals[vertex]);
    const vplRgb c = vplRgbMul(reflectance, b->irradiance[2 * (size_t)vertex + (size_t)face]);
    return (PlyVertex){
        {n.x, n.y, n.z},
        {vplSrgb_Code(b->scale * c.r), vplSrgb_Code(b->scale * c.g), vplSrgb_Code(b->scale * c.b)},
        {c.r, c.g, c.b}};
}

// Finds or adds the file's vertex for a vertex of the mesh and a reflectance.
static vplResult findVertex(Baker* b, uint32_t vertex, int face, vplRgb reflectance, int32_t* indexOut)
{
    for (int at = b->heads[vertex]; at >= 0; at = b->entries[at].next) {
        const vplRgb known = b->entries[at].reflectance;
        if (known.r == reflectance.r && known.g == reflectance.g && known.b == reflectance.b) {
            *indexOut = at;
            return VPL_SUCCESS;
        }
    }
    if (b->vertexCount == INT32_MAX) {
        return vplFail(b->context, VPL_LIMIT, "a PLY file has at most %d vertices", INT32_MAX);
    }
    const size_t count = b->vertexCount + 1;
    TRY(vplArena_Reserve(b->arena, &b->vertices, &b->vertexCapacity, count, sizeof *b->vertices));
    TRY(vplArena_Reserve(b->arena, &b->positions, &b->positionCapacity, count, sizeof *b->positions));
    TRY(vplArena_Reserve(b->arena, &b->entries, &b->entryCapacity, count, sizeof *b->entries));
    const int index = (int)b->vertexCount++;
    b->positions[index] = vertex;
    b->vertices[index] = makeVertex(b, vertex, face, reflectance);
    b->entries[index] = (Entry){reflectance, b->heads[vertex]};
    b->heads[vertex] = *indexOut = index;
    return VPL_SUCCESS;
}

// ---- faces

// Adds a face of a triangle. Backs that light does not reach are left out; such fronts take the values at
// their corners.
static vplResult addTriangle(Baker* b, int triangle, int face)
{
    const vplPatchMesh* m = b->mesh;
    const int side = vplSideOf(m->sides, m->patchOf[triangle], face);
    if (side < 0 && face == 1) {
        return VPL_SUCCESS;
    }
    const vplRgb reflectance = vplReflectanceOf(m->sides, m->triangleOf[triangle], side);
    PlyFace out;
    for (int k = 0; k < 3; k++) {
        const int corner = face == 0 ? k : 2 - k;
        int32_t index = 0;
        TRY(findVertex(b, m->indices[3 * (size_t)triangle + (size_t)corner], face, reflectance, &index));
        out.vertices[k] = (uint32_t)index;
    }
    TRY(vplArena_Reserve(b->arena, &b->faces, &b->faceCapacity, b->faceCount + 1, sizeof *b->faces));
    b->faces[b->faceCount++] = out;
    return VPL_SUCCESS;
}

static vplResult addFaces(Baker* b)
{
    b->heads = vplArena_Alloc(b->arena, (size_t)b->mesh->vertexCount, sizeof *b->heads);
    TRY(vplArena_Check(b->arena));
    for (int face = 0; face < 2; face++) {
        for (int v = 0; v < b->mesh->vertexCount; v++) {
            b->heads[v] = -1;
        }
        for (int t = 0; t < b->mesh->triangleCount; t++) {
            TRY(addTriangle(b, t, face));
        }
    }
    return VPL_SUCCESS;
}

// ---- the file

// Puts a vertex, its position in the caller's space. Returns the byte behind it.
static uint8_t* putVertex(const Baker* b, size_t index, bool far, uint8_t* to)
{
    const PlyVertex* vertex = &b->vertices[index];
    const double* origin = b->mesh->sides->patches->geometry->origin;
    const vplVec3 p = b->mesh->positions[b->positions[index]];
    const float place[3] = {p.x, p.y, p.z};
    for (int k = 0; k < 3; k++) {
        to = far ? vplPutDouble(to, origin[k] + (double)place[k]) : vplPutFloats(to, &place[k], 1);
    }
    to = vplPutFloats(to, vertex->normal, 3);
    memcpy(to, vertex->code, 3);
    return vplPutFloats(to + 3, vertex->colour, 3);
}

static uint8_t* putFace(const PlyFace* face, uint8_t* to)
{
    *to++ = 3;
    for (int k = 0; k < 3; k++) {
        to = vplPutWord(to, face->vertices[k]);
    }
    return to;
}

static vplResult writeFile(const Baker* b, const char* path)
{
    const double* origin = b->mesh->sides->patches->geometry->origin;
    const bool far = origin[0] != 0 || origin[1] != 0 || origin[2] != 0;
    const char* type = far ? "double" : "float";
    char head[512];
    const int length = snprintf(head, sizeof head,
                                "ply\n"
                                "format binary_little_endian 1.0\n"
                                "comment radiosity in W/m^2, linear in r g b\n"
                                "element vertex %zu\n"
                                "property %s x\nproperty %s y\nproperty %s z\n"
                                "property float nx\nproperty float ny\nproperty float nz\n"
                                "property uchar red\nproperty uchar green\nproperty uchar blue\n"
                                "property float r\nproperty float g\nproperty float b\n"
                                "element face %zu\n"
                                "property list uchar int vertex_indices\n"
                                "end_header\n",
                                b->vertexCount, type, type, type, b->faceCount);
    const size_t positionBytes = far ? sizeof(double[3]) : sizeof(float[3]);
    const size_t size =
        (size_t)length + b->vertexCount * (positionBytes + VERTEX_BYTES) + b->faceCount * FACE_BYTES;
    uint8_t* bytes = vplArena_Alloc(b->arena, size, 1);
    TRY(vplArena_Check(b->arena));
    memcpy(bytes, head, (size_t)length);
    uint8_t* at = bytes + length;
    for (size_t i = 0; i < b->vertexCount; i++) {
        at = putVertex(b, i, far, at);
    }
    for (size_t i = 0; i < b->faceCount; i++) {
        at = putFace(&b->faces[i], at);
    }
    return vplWriteFile(b->context, path, bytes, size);
}

vplResult vplPatchMesh_WritePly(const vplPatchMesh* mesh, const vplRgb* vertexIrradiance, float scale,
                                const char* path)
{
    REQUIRE(CONTEXT_OF(mesh), mesh, vertexIrradiance, path);
    Baker baker = {.context = mesh->context, .mesh = mesh, .irradiance = vertexIrradiance, .scale = scale};
    if (!(scale >= 0 && isfinite(scale))) {
        return vplFail(mesh->context, VPL_INVALID_ARGUMENT,
                       "the scale of a PLY file's colours is %g, must be finite and at least 0",
                       (double)scale);
    }
    TRY(vplCheckRgb(mesh->context, "vertexIrradiance", vertexIrradiance, 2 * (size_t)mesh->vertexCount));
    baker.arena = vplArena_Create(mesh->context);
    vplResult result = addFaces(&baker);
    if (result == VPL_SUCCESS) {
        result = writeFile(&baker, path);
    }
    vplArena_Destroy(baker.arena);
    return result;
}
