// SPDX-License-Identifier: MIT
// Turns patches into triangles with shared vertices.
#ifndef VPL_RADIOSITY_PATCH_MESH_H
#define VPL_RADIOSITY_PATCH_MESH_H

#include "base/arena.h"
#include "geometry/triangle.h"
#include "radiosity/sides/side.h"

// ---- cuts at hanging vertices (hanging_vertices.c)

// A patch, or a part of one that was cut.
typedef struct vplPiece {
    uint32_t corners[3]; // in vplPatches.positions
    int patch;
    uint8_t edges; // as vplPatchMesh.edges
} vplPiece;

typedef struct vplPieces {
    vplPiece* pieces; // in the order of patches
    size_t count, capacity;
    int hanging; // positions at which edges were cut
} vplPieces;

// Cuts patches wherever a vertex lies on one of their edges, so that neighbouring pieces share whole edges.
vplResult vplCutPatches(vplArena* scratch, const vplPatches* patches, vplPieces* piecesOut);

// ---- corners (mesh_corners.c)

// Corners of pieces, sorted by position: those at position p are first[p] .. first[p + 1] - 1.
typedef struct vplMeshCorners {
    const vplPatches* patches;
    const vplPieces* pieces;
    size_t count;
    size_t* first;
    uint32_t* at;     // 3 * piece + corner, ascending at each position
    int* group;       // the first corner at this position that shares its vertex
    vplVec3* normals; // of the surface there, unit
    float* angles;    // radians
} vplMeshCorners;

static inline const vplPiece* vplMeshCorners_Piece(const vplMeshCorners* corners, size_t i)
{
    return &corners->pieces->pieces[corners->at[i] / 3];
}

vplResult vplMeshCorners_Find(vplArena* scratch, const vplPatches* patches, const vplPieces* pieces,
                              vplMeshCorners* cornersOut);

// ---- vertices

// A patch that has a corner at a vertex, or an edge that was cut there.
typedef struct vplPatchAround {
    int patch;
    float angle; // radians, of all its pieces
    // Copies of the patch's sides, front and back, which halve the time of interpolation.
    int side[2];     // -1: light does not reach it
    uint8_t open[2]; // how many of its cells are open
} vplPatchAround;

// The patches at vertex v are list[first[v]] .. list[first[v + 1] - 1], in order.
struct vplPatchesAround {
    size_t* first; // one more than vertices
    vplPatchAround* list;
};

// One face of a triangle of the mesh, for sums of vertex values over sides.
typedef struct vplMeshFace {
    int side;
    size_t at[3];  // of its corners, in arrays [vertex][front, back]
    vplVec3 cross; // of two edges: twice the area long
} vplMeshFace;

// Finds the face (0: front, 1: back). False if light does not reach that side.
bool vplPatchMesh_GetFace(const vplPatchMesh* mesh, int triangle, int face, vplMeshFace* faceOut);

#endif
