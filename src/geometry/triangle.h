// SPDX-License-Identifier: MIT
// Corners, areas, barycentrics and faces of single triangles.
#ifndef VPL_GEOMETRY_TRIANGLE_H
#define VPL_GEOMETRY_TRIANGLE_H

#include "math/vec.h"

#include <vpl/geometry.h>

enum { VPL_TRIANGLE_CHUNK = 4096 }; // triangles, their vertices or their blocks that one task takes

typedef struct vplTriangleCorners {
    vplVec3 corner[3];
} vplTriangleCorners;

static inline vplTriangleCorners vplCornersOf(const vplVec3* positions, const uint32_t* index)
{
    return (vplTriangleCorners){{positions[index[0]], positions[index[1]], positions[index[2]]}};
}

// The largest magnitude of a coordinate, metres.
static inline float vplGeometry_LargestCoordinate(const vplGeometry* g)
{
    return vplMaxf(vplLargestOf(g->boundsMin), vplLargestOf(g->boundsMax));
}

// The corners of a triangle in world space.
static inline vplTriangleCorners vplGeometry_Corners(const vplGeometry* g, int triangle)
{
    return vplCornersOf(g->positions + g->objects[g->owners[triangle]].firstVertex,
                        g->indices + 3 * (size_t)triangle);
}

// The cross product of two edges: twice the area, along the normal of the counter-clockwise side. Computed in
// double, where differences of floats lose nothing.
void vplTriangle_Cross(const vplTriangleCorners* triangle, double cross[3]);

// Area in square metres, computed in double from the rounded corners.
double vplTriangle_Area(const vplTriangleCorners* triangle);

// The same, of a triangle's cross product.
double vplAreaOfCross(const double cross[3]);

double vplGeometry_TriangleArea(const vplGeometry* geometry, int triangle);

// The face that a triangle belongs to, as in vplHit.face.
int vplGeometry_FaceOf(const vplGeometry* geometry, int triangle);

// Moves a point of a triangle's plane just inside the triangle, by clamping its barycentrics. Points that are
// interpolated from pixels may lie beyond an edge, and so behind the surface that meets the triangle there.
vplVec3 vplGeometry_Inside(const vplGeometry* geometry, int triangle, vplVec3 point);

// The same, with the barycentrics of corners 1 and 2.
vplVec3 vplGeometry_InsideAt(const vplGeometry* geometry, int triangle, vplVec3 point, float* uOut,
                             float* vOut);

// Barycentrics of a point in a triangle's plane, or of its projection onto the plane; 1, 0, 0 without area.
void vplTriangle_Barycentrics(const vplVec3 corners[3], vplVec3 point, double barycentricsOut[3]);

// Intersects a ray that is known to hit a face with its plane, at local coordinate `side`, and clamps the
// point to the face. False where t is not positive and finite.
bool vplRay_HitFace(const vplRay* ray, const vplPlacement* placement, int face, double side, vplHit* hitOut);

static inline bool vplPatches_IsGroup(const vplPatches* patches, int patch)
{
    return patch >= patches->patchCount - patches->groupCount;
}

// The triangles of all groups.
static inline int vplPatches_CountGrouped(const vplPatches* patches)
{
    return patches->groupCount > 0 ? patches->firstMember[patches->groupCount] : 0;
}

// The triangle of a patch, or the first of a group.
static inline int vplPatches_TriangleOf(const vplPatches* patches, int patch)
{
    return patches->nodes[patches->patches[patch]].triangle;
}

// Bisects patches until there are `count`, as vplPatches_Create does, each at most `rounds` times. `isKept`: nodes that stay
// as they are; NULL: none. The old patches stay. (patch_refine.c)
vplResult vplPatches_BisectLongest(const vplPatches* patches, const uint8_t* isKept, int count, int rounds,
                                   vplPatches** patchesOut);

#endif
