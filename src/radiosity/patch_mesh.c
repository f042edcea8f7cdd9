// SPDX-License-Identifier: MIT
// The triangles that patches are drawn as. Patches share a vertex where their surfaces go on into each other.
// Based on: Baum, Mann, Smith and Winget, Making Radiosity Usable, SIGGRAPH 1991.
#include "base/context.h"
#include "math/vec.h"
#include "radiosity/mesh.h"

// A mesh while it is made; its arrays may be written.
typedef struct Maker {
    const vplPieces* pieces;
    const vplMeshCorners* corners;
    vplPatchMesh* mesh;
    vplVec3 *positions, *normals;
    uint32_t* indices;
    int* patchOf;
    uint8_t* edges;
    struct vplPatchesAround* around;
} Maker;

// ---- vertices

static vplPatchAround makeAround(const vplPatchSides* sides, int patch, float angle)
{
    vplPatchAround around = {.patch = patch, .angle = angle};
    for (int face = 0; face < 2; face++) {
        const int side = vplSideOf(sides, patch, face);
        around.side[face] = side;
        around.open[face] = side < 0 ? 0 : (uint8_t)__builtin_popcount(sides->sides[side].open);
    }
    return around;
}

// A corner joins the vertex that is being made.
static void addCorner(Maker* m, size_t i, int vertex, double normal[3])
{
    const vplVec3 n = m->corners->normals[i];
    const float angle = m->corners->angles[i];
    const int patch = vplMeshCorners_Piece(m->corners, i)->patch;
    size_t* end = &m->around->first[vertex + 1];
    m->indices[m->corners->at[i]] = (uint32_t)vertex;
    normal[0] += (double)angle * (double)n.x;
    normal[1] += (double)angle * (double)n.y;
    normal[2] += (double)angle * (double)n.z;
    // Pieces are in the order of patches, so those of one patch follow each other.
    if (*end > m->around->first[vertex] && m->around->list[*end - 1].patch == patch) {
        m->around->list[*end - 1].angle += angle;
    } else {
        m->around->list[(*end)++] = makeAround(m->mesh->sides, patch, angle);
    }
}

// The vertex of corner `leader` and of those up to `end` that are of its group.
static void addVertex(Maker* m, size_t leader, size_t end, int position)
{
    const vplMeshCorners* c = m->corners;
    const int vertex = m->mesh->vertexCount++;
    double sum[3] = {0, 0, 0};
    m->around->first[vertex + 1] = m->around->first[vertex];
    for (size_t i = leader; i < end; i++) {
        if (c->group[i] == (int)leader) {
            addCorner(m, i, vertex, sum);
        }
    }
    const vplVec3 normal = vplNormalize(vplVec((float)sum[0], (float)sum[1], (float)sum[2]));
    m->normals[vertex] = vplDot(normal, normal) > 0 ? normal : c->normals[leader];
    m->positions[vertex] = c->patches->positions[position];
}

static void addVertices(Maker* m)
{
    const vplMeshCorners* c = m->corners;
    m->around->first[0] = 0;
    for (int p = 0; p < c->patches->positionCount; p++) {
        for (size_t i = c->first[p]; i < c->first[p + 1]; i++) {
            if (c->group[i] == (int)i) {
                addVertex(m, i, c->first[p + 1], p);
            }
        }
    }
}

static void addTriangles(Maker* m)
{
    m->mesh->triangleCount = (int)m->pieces->count;
    m->mesh->hangingVertices = m->pieces->hanging;
    for (size_t i = 0; i < m->pieces->count; i++) {
        m->patchOf[i] = m->pieces->pieces[i].patch;
        m->edges[i] = m->pieces->pieces[i].edges;
    }
}

// ---- all of it

static size_t countVertices(const vplMeshCorners* corners)
{
    size_t count = 0;
    for (size_t i = 0; i < corners->count; i++) {
        count += corners->group[i] == (int)i;
    }
    return count;
}

static vplResult reserve(Maker* m)
{
    vplPatchMesh* mesh = m->mesh;
    vplContext* context = mesh->context;
    const size_t vertices = countVertices(m->corners), triangles = m->pieces->count;
    mesh->positions = m->positions = vplAlloc(context, vertices, sizeof *m->positions);
    mesh->normals = m->normals = m->positions ? vplAlloc(context, vertices, sizeof *m->normals) : NULL;
    mesh->indices = m->indices = m->normals ? vplAlloc(context, 3 * triangles, sizeof *m->indices) : NULL;
    mesh->patchOf = m->patchOf = m->indices ? vplAlloc(context, triangles, sizeof *m->patchOf) : NULL;
    mesh->edges = m->edges = m->patchOf ? vplAlloc(context, triangles, sizeof *m->edges) : NULL;
    mesh->around = m->around = m->edges ? vplAllocZero(context, 1, sizeof *m->around) : NULL;
    if (m->around != NULL) {
        m->around->first = vplAlloc(context, vertices + 1, sizeof *m->around->first);
        m->around->list =
            m->around->first ? vplAlloc(context, m->corners->count, sizeof *m->around->list) : NULL;
    }
    return m->around != NULL && m->around->list != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static vplResult make(const vplPatches* patches, vplPatchMesh* mesh)
{
    vplPieces pieces = {.context = mesh->context};
    vplMeshCorners corners = {.pieces = &pieces};
    Maker maker = {.pieces = &pieces, .corners = &corners, .mesh = mesh};
    vplResult result = vplCutPatches(patches, &pieces);
    if (result == VPL_SUCCESS) {
        result = vplMeshCorners_Create(patches, &pieces, &corners);
    }
    if (result == VPL_SUCCESS) {
        result = reserve(&maker);
    }
    if (result == VPL_SUCCESS) {
        addVertices(&maker);
        addTriangles(&maker);
    }
    vplMeshCorners_Release(&corners);
    vplFree(mesh->context, pieces.pieces);
    return result;
}

vplResult vplPatchMesh_Create(const vplPatchSides* sides, vplPatchMesh** meshOut)
{
    vplContext* context = sides->context;
    vplPatchMesh* mesh = vplAllocZero(context, 1, sizeof *mesh);
    if (mesh == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    mesh->sides = sides;
    mesh->context = context;
    const vplResult result = make(sides->patches, mesh);
    if (result != VPL_SUCCESS) {
        vplPatchMesh_Destroy(mesh);
        return result;
    }
    *meshOut = mesh;
    return VPL_SUCCESS;
}

void vplPatchMesh_Destroy(vplPatchMesh* mesh)
{
    if (mesh != NULL) {
        vplContext* context = mesh->context;
        vplFree(context, (void*)mesh->positions);
        vplFree(context, (void*)mesh->normals);
        vplFree(context, (void*)mesh->indices);
        vplFree(context, (void*)mesh->patchOf);
        vplFree(context, (void*)mesh->edges);
        if (mesh->around != NULL) {
            vplFree(context, mesh->around->first);
            vplFree(context, mesh->around->list);
        }
        vplFree(context, mesh->around);
        vplFree(context, mesh);
    }
}
