// SPDX-License-Identifier: MIT
// Turns patches into triangles with shared vertices.
#ifndef VPL_RADIOSITY_PATCH_MESH_H
#define VPL_RADIOSITY_PATCH_MESH_H

#include "base/arena.h"
#include "geometry/point_cells.h"
#include "geometry/triangle.h"
#include "radiosity/sides/side.h"

// ---- cuts at hanging vertices (hanging_vertices.c)

// A patch, or a part of one that was cut.
typedef struct vplPiece {
    uint32_t corners[3]; // in vplPatches.positions
    int patch;
    int triangle;  // of the geometry
    uint8_t edges; // as vplPatchMesh.edges
} vplPiece;

typedef struct vplPieces {
    vplPiece* pieces; // in the order of patches
    size_t count, capacity;
    int hanging; // positions at which edges were cut
} vplPieces;

// Cuts patches wherever a vertex lies on one of their edges, so that neighbouring pieces share whole edges.
vplResult vplCutPatches(vplArena* scratch, const vplPatches* patches, vplPieces* piecesOut);

// ---- vertices anywhere on edges (edge_vertices.c)

typedef struct vplEdgeVertices {
    const vplPatches* patches;
    vplPointCells cells; // of the corners of patches
    double tolerance;    // a vertex at most so far from an edge is on it, metres
} vplEdgeVertices;

vplResult vplEdgeVertices_Create(vplArena* scratch, const vplPatches* patches, vplEdgeVertices* verticesOut);

// The vertex on an edge that is nearest to its middle, among equally near ones the first; -1: none.
int vplEdgeVertices_Find(const vplEdgeVertices* vertices, uint32_t a, uint32_t b);

// ---- corners (mesh_corners.c)

// Corners of pieces, sorted by position: those at position p are first[p] .. first[p + 1] - 1.
typedef struct vplMeshCorners {
    const vplPatches* patches;
    const vplPieces* pieces;
    size_t count;
    size_t* first;
    uint32_t* at; // 3 * piece + corner, ascending at each position
    // [front, back]: the first corner at this position that light on that face continues to. The same array twice
    // where no surface stands on another.
    int* group[2];
    int* leader; // the first corner at this position that shares its vertex: both groups are the same
    uint8_t*
        blocked; // bits 0, 1: something stands on the front or back of the edge from the corner; 2, 3: to it
    vplVec3* normals; // of the surface there, unit
    float* angles;    // radians
    double tolerance; // of cuts, metres
} vplMeshCorners;

static inline const vplPiece* vplMeshCorners_Piece(const vplMeshCorners* corners, size_t i)
{
    return &corners->pieces->pieces[corners->at[i] / 3];
}

vplResult vplMeshCorners_Find(vplArena* scratch, const vplPatches* patches, const vplPieces* pieces,
                              vplMeshCorners* cornersOut);

// ---- vertices

// A patch that has a corner at a vertex, or an edge that was cut there, on the front or on the back.
typedef struct vplPatchAround {
    int patch;
    int triangle; // of the geometry: the first of a group's at this vertex
    float angle;  // radians, of all its pieces
    // Copies of the patch's sides, front and back, which halve the time of interpolation.
    int side[2];     // -1: light does not reach it, or a wall stands between it and the vertex
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

// ---- values at points (value_at.c)

typedef struct vplPatchPoint {
    int patch, face; // 0: front, 1: back
    vplVec3 position;
} vplPatchPoint;

// The triangles of patch p are those from firstOut[p] to firstOut[p + 1] - 1; there is one more than patches.
void vplPatchMesh_ListPatches(const vplPatchMesh* mesh, int* firstOut);

// The value at a point of a patch, interpolated between its corners. `first` comes from the function above,
// vertexValues are [vertex][front, back].
vplRgb vplPatchMesh_ValueAt(const vplPatchMesh* mesh, const int* first, const vplPatchPoint* point,
                            const vplRgb* vertexValues);

#endif
