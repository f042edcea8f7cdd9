// SPDX-License-Identifier: MIT
// The triangles that are drawn for patches. Patches share a vertex where their surfaces continue each other.
// Based on: Baum, Mann, Smith and Winget, Making Radiosity Usable, SIGGRAPH 1991.
#include "radiosity/mesh/patch_mesh.h"

#include "math/vec.h"

// The mesh in the making, with writable arrays.
typedef struct Builder {
    const vplMeshCorners* corners;
    vplPatchMesh* mesh;
    vplVec3 *positions, *normals;
    uint32_t* indices;
    int *patchOf, *triangleOf;
    uint8_t* edges;
    struct vplPatchesAround* around;
} Builder;

// ---- vertices

// The faces on which light continues from one corner to another at the same position.
static int sharedFaces(const vplMeshCorners* c, size_t i, size_t j)
{
    return (c->group[0][i] == c->group[0][j]) | (c->group[1][i] == c->group[1][j]) << 1;
}

// faces: bit 0: on the front; bit 1: on the back.
static vplPatchAround makeAround(const vplPatchSides* sides, const vplPiece* piece, int faces, float angle)
{
    const int patch = piece->patch;
    vplPatchAround around = {.patch = patch, .triangle = piece->triangle, .angle = angle};
    for (int face = 0; face < 2; face++) {
        const int side = faces >> face & 1 ? vplSideOf(sides, patch, face) : -1;
        around.side[face] = side;
        around.open[face] = side < 0 ? 0 : (uint8_t)__builtin_popcount(sides->sides[side].open);
    }
    return around;
}

// Adds a further piece of a patch, which may share another face.
static void addPiece(vplPatchAround* around, const vplPatchAround* piece)
{
    around->angle += piece->angle;
    for (int face = 0; face < 2; face++) {
        if (piece->side[face] >= 0) {
            around->side[face] = piece->side[face];
            around->open[face] = piece->open[face];
        }
    }
}

// Adds a corner to the vertex that is being made, on its front, its back or both.
static void addCorner(Builder* b, size_t i, int faces, double normal[3])
{
    const int vertex = b->mesh->vertexCount - 1;
    const vplVec3 n = b->corners->normals[i];
    const float angle = b->corners->angles[i];
    const vplPiece* whole = vplMeshCorners_Piece(b->corners, i);
    size_t* end = &b->around->first[vertex + 1];
    normal[0] += (double)angle * (double)n.x;
    normal[1] += (double)angle * (double)n.y;
    normal[2] += (double)angle * (double)n.z;
    // Pieces are in the order of patches, so those of one patch are consecutive.
    const vplPatchAround piece = makeAround(b->mesh->sides, whole, faces, angle);
    if (*end > b->around->first[vertex] && b->around->list[*end - 1].patch == piece.patch) {
        addPiece(&b->around->list[*end - 1], &piece);
    } else {
        b->around->list[(*end)++] = piece;
    }
}

// Adds the vertex of corner `leader`. Corners that share one of its faces only count on that face.
static void addVertex(Builder* b, size_t leader, int position)
{
    const vplMeshCorners* c = b->corners;
    const int vertex = b->mesh->vertexCount++;
    double sum[3] = {0, 0, 0};
    b->around->first[vertex + 1] = b->around->first[vertex];
    for (size_t i = c->first[position]; i < c->first[position + 1]; i++) {
        const int faces = sharedFaces(c, leader, i);
        if (faces != 0) {
            addCorner(b, i, faces, sum);
        }
        if (faces == 3) {
            b->indices[c->at[i]] = (uint32_t)vertex;
        }
    }
    const vplVec3 normal = vplNormalize(vplVec((float)sum[0], (float)sum[1], (float)sum[2]));
    b->normals[vertex] = vplDot(normal, normal) > 0 ? normal : c->normals[leader];
    b->positions[vertex] = c->patches->positions[position];
}

static void addVertices(Builder* b)
{
    const vplMeshCorners* c = b->corners;
    b->around->first[0] = 0;
    for (int p = 0; p < c->patches->positionCount; p++) {
        for (size_t i = c->first[p]; i < c->first[p + 1]; i++) {
            if (c->leader[i] == (int)i) {
                addVertex(b, i, p);
            }
        }
    }
}

static void addTriangles(Builder* b)
{
    const vplPieces* pieces = b->corners->pieces;
    b->mesh->triangleCount = (int)pieces->count;
    b->mesh->hangingVertices = pieces->hanging;
    for (size_t i = 0; i < pieces->count; i++) {
        b->patchOf[i] = pieces->pieces[i].patch;
        b->triangleOf[i] = pieces->pieces[i].triangle;
        b->edges[i] = pieces->pieces[i].edges;
    }
}

// ---- the mesh

static size_t countVertices(const vplMeshCorners* corners)
{
    size_t count = 0;
    for (size_t i = 0; i < corners->count; i++) {
        count += corners->leader[i] == (int)i;
    }
    return count;
}

// Corners count once for each vertex that they share a face with.
static size_t countAround(const vplMeshCorners* c)
{
    size_t count = 0;
    for (int p = 0; p < c->patches->positionCount && c->blocked != NULL; p++) {
        for (size_t i = c->first[p]; i < c->first[p + 1]; i++) {
            for (size_t j = c->first[p]; c->leader[i] == (int)i && j < c->first[p + 1]; j++) {
                count += sharedFaces(c, i, j) != 0;
            }
        }
    }
    return c->blocked != NULL ? count : c->count;
}

static vplResult reserve(Builder* b)
{
    vplPatchMesh* mesh = b->mesh;
    vplArena* arena = mesh->arena;
    const size_t vertices = countVertices(b->corners), triangles = b->corners->pieces->count;
    mesh->positions = b->positions = vplArena_Alloc(arena, vertices, sizeof *b->positions);
    mesh->normals = b->normals = vplArena_Alloc(arena, vertices, sizeof *b->normals);
    mesh->indices = b->indices = vplArena_Alloc(arena, 3 * triangles, sizeof *b->indices);
    mesh->patchOf = b->patchOf = vplArena_Alloc(arena, triangles, sizeof *b->patchOf);
    mesh->triangleOf = b->triangleOf = vplArena_Alloc(arena, triangles, sizeof *b->triangleOf);
    mesh->edges = b->edges = vplArena_Alloc(arena, triangles, sizeof *b->edges);
    mesh->around = b->around = vplArena_AllocZero(arena, 1, sizeof *b->around);
    TRY(vplArena_Check(arena));
    b->around->first = vplArena_Alloc(arena, vertices + 1, sizeof *b->around->first);
    b->around->list = vplArena_Alloc(arena, countAround(b->corners), sizeof *b->around->list);
    return vplArena_Check(arena);
}

static vplResult build(vplArena* scratch, vplPatchMesh* mesh)
{
    const vplPatches* patches = mesh->sides->patches;
    vplPieces pieces;
    vplMeshCorners corners;
    Builder builder = {.corners = &corners, .mesh = mesh};
    TRY(vplCutPatches(scratch, patches, &pieces));
    TRY(vplMeshCorners_Find(scratch, patches, &pieces, &corners));
    TRY(reserve(&builder));
    addVertices(&builder);
    addTriangles(&builder);
    return VPL_SUCCESS;
}

vplResult vplPatchMesh_Create(const vplPatchSides* sides, vplPatchMesh** meshOut)
{
    REQUIRE(CONTEXT_OF(sides), sides, meshOut);
    vplContext* context = sides->context;
    vplArena *arena = vplArena_Create(context), *scratch = vplArena_Create(context);
    vplPatchMesh* mesh = vplArena_AllocZero(arena, 1, sizeof *mesh);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        *mesh = (vplPatchMesh){.sides = sides, .arena = arena, .context = context};
        result = build(scratch, mesh);
    }
    vplArena_Destroy(scratch);
    return vplArena_Deliver(arena, result, mesh, meshOut);
}

void vplPatchMesh_Destroy(vplPatchMesh* mesh)
{
    vplArena_Destroy(mesh != NULL ? mesh->arena : NULL);
}

bool vplPatchMesh_GetFace(const vplPatchMesh* mesh, int triangle, int face, vplMeshFace* faceOut)
{
    const uint32_t* index = mesh->indices + 3 * (size_t)triangle;
    const vplVec3 p = mesh->positions[index[0]];
    faceOut->side = vplSideOf(mesh->sides, mesh->patchOf[triangle], face);
    if (faceOut->side < 0) {
        return false;
    }
    for (int k = 0; k < 3; k++) {
        faceOut->at[k] = 2 * (size_t)index[k] + (size_t)face;
    }
    faceOut->cross = vplCross(vplSub(mesh->positions[index[1]], p), vplSub(mesh->positions[index[2]], p));
    return true;
}
