// SPDX-License-Identifier: MIT
// From patches to triangles whose vertices are shared, from the inside.
#ifndef VPL_RADIOSITY_MESH_H
#define VPL_RADIOSITY_MESH_H

#include <vpl/radiosity.h>

#include "geometry/triangle.h"
#include "radiosity/side.h"

// ---- cuts

// A patch, or a piece of one that was cut.
typedef struct vplPiece {
    uint32_t corners[3]; // in vplPatches.positions
    int patch;
    uint8_t edges; // as vplPatchMesh.edges
} vplPiece;

typedef struct vplPieces {
    vplContext* context;
    vplPiece* pieces; // in the order of patches
    size_t count, capacity;
    int hanging; // positions at which edges were cut
} vplPieces;

// Cuts patches wherever a vertex lies on one of their edges, so that all edges of pieces have pieces with the very same
// edge on their other side. Start with {context}; the caller frees `pieces`, whatever the result.
vplResult vplCutPatches(const vplPatches* patches, vplPieces* pieces);

// ---- corners

// Corners of pieces, sorted by position: those at position p are first[p] .. first[p + 1).
typedef struct vplMeshCorners {
    const vplPatches* patches;
    const vplPieces* pieces;
    size_t count;
    size_t* first;
    uint32_t* at;     // 3 * piece + corner, ascending at each position
    int* group;       // the first corner here that is of the same surface: itself, where a vertex begins
    vplVec3* normals; // of the surface there, unit
    float* angles;    // radians
} vplMeshCorners;

static inline const vplPiece* vplMeshCorners_Piece(const vplMeshCorners* corners, size_t i)
{
    return &corners->pieces->pieces[corners->at[i] / 3];
}

// The caller releases it, whatever the result.
vplResult vplMeshCorners_Create(const vplPatches* patches, const vplPieces* pieces,
                                vplMeshCorners* cornersOut);
void vplMeshCorners_Release(vplMeshCorners* corners);

// ---- vertices

// A patch at a vertex: with a corner, or with an edge that was cut there.
typedef struct vplPatchAround {
    int patch;
    float angle; // radians, of all its pieces
    int side[2]; // front and back, -1: no light reaches it. Here and not looked up when means are made, which
    uint8_t open[2]; // then takes half as long; how many of their cells are open
} vplPatchAround;

// Patches at vertex v: list[first[v] .. first[v + 1]), by index.
struct vplPatchesAround {
    size_t* first; // one more than vertices
    vplPatchAround* list;
};

// Of a patch whose side is `side`; -1: of what no light reaches, as its material says.
static inline vplRgb vplReflectanceOf(const vplPatchSides* sides, int patch, int side)
{
    if (side >= 0) {
        return sides->sides[side].reflectance;
    }
    const vplGeometry* g = sides->patches->geometry;
    return g->materials[g->triangleMaterials[vplPatches_TriangleOf(sides->patches, patch)]].diffuse;
}

// The position of corner `corner` of triangle `triangle` of the mesh.
static inline vplVec3 vplPatchMesh_Corner(const vplPatchMesh* mesh, int triangle, int corner)
{
    return mesh->positions[mesh->indices[3 * (size_t)triangle + (size_t)corner]];
}

// A sentence unless `values`, `name` in it, are finite.
vplResult vplCheckRgb(const vplContext* context, const char* name, const vplRgb* values, size_t count);

#endif
