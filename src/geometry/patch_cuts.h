// SPDX-License-Identifier: MIT
// Cuts of triangles along the lines where other surfaces cross, touch or overlap them, so that no patch spans what
// cuts it.
#ifndef VPL_GEOMETRY_PATCH_CUTS_H
#define VPL_GEOMETRY_PATCH_CUTS_H

#include "base/arena.h"
#include "geometry/triangle.h"

// Lengths up to this count as 0, metres: eight rounding units of the largest coordinate, and so more than a rotated corner
// is off.
static inline double vplCutTolerance(const vplGeometry* geometry)
{
    return (double)vplGeometry_LargestCoordinate(geometry) * 0x1p-19;
}

// The segments of a geometry's triangles: those of triangle t are list[first[t]] .. list[first[t + 1] - 1].
typedef struct vplCutSegments {
    vplPatchCut* list;
    int* first;
    size_t count, capacity;
    double tolerance; // metres
} vplCutSegments;

// Finds where other surfaces meet each triangle, with the ray tree if there is one. `isUncut`: triangles that neither
// cut nor are cut; NULL: there are none. (cut_search.c)
vplResult vplCutSegments_Find(vplArena* scratch, const vplGeometry* geometry, const uint8_t* isUncut,
                              vplCutSegments* segmentsOut);

// The intersection of a triangle with a convex polygon: up to four segments if they lie in one plane, else up to
// one. Returns how many there are. (cut_segment.c)
typedef struct vplCutPolygon {
    double corners[4][3];
    int count;
} vplCutPolygon;

int vplCutSegment_Between(const vplTriangleCorners* triangle, const vplCutPolygon* polygon, double tolerance,
                          vplPatchCut segmentsOut[4]);

// The line of a segment in the plane of its triangle. (cut_line.c)
typedef struct vplCutLine {
    double start[3], along[3], across[3]; // unit vectors
    double length;                        // of the segment, metres
} vplCutLine;

// False for a segment without length.
bool vplCutLine_Make(const vplPatchCut* segment, vplVec3 normal, vplCutLine* lineOut);

// The coordinates of a point along and across a line.
void vplCutLine_Locate(const vplCutLine* line, vplVec3 point, double* alongOut, double* acrossOut);

// The line's way through a piece: the part of it that is deeper inside than the tolerance. False if there is none.
bool vplCutLine_PassThrough(const vplCutLine* line, const vplTriangleCorners* piece, double tolerance,
                            double wayOut[2]);

// Trees of the pieces of triangles: node t, t < geometry->triangleCount, is triangle t. (cut_pieces.c)
typedef struct vplCutPieces {
    vplPatchNode* nodes; // corners are indices in points
    vplVec3* points;     // 3 t + k is corner k of triangle t; those of cuts follow, not all different
    size_t nodeCount, nodeCapacity, pointCount, pointCapacity;
    int unresolved; // segments that some piece still spans
} vplCutPieces;

vplResult vplCutPieces_Make(vplArena* scratch, const vplGeometry* geometry, const vplCutSegments* segments,
                            vplCutPieces* piecesOut);

// Makes points of cuts that rounding alone separates equal. (cut_points.c)
vplResult vplCutPieces_Snap(vplArena* scratch, const vplGeometry* geometry, double tolerance,
                            vplCutPieces* pieces);

#endif
