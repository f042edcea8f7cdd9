// SPDX-License-Identifier: MIT
// What is asked of one triangle of the frozen scene.
#ifndef VPL_GEOMETRY_TRIANGLE_H
#define VPL_GEOMETRY_TRIANGLE_H

#include <vpl/geometry.h>

typedef struct vplTriangleCorners {
    vplVec3 corner[3];
} vplTriangleCorners;

static inline vplTriangleCorners vplCornersOf(const vplVec3* positions, const uint32_t* index)
{
    return (vplTriangleCorners){{positions[index[0]], positions[index[1]], positions[index[2]]}};
}

// World space.
static inline vplTriangleCorners vplGeometry_Corners(const vplGeometry* g, int triangle)
{
    return vplCornersOf(g->positions + g->objects[g->owners[triangle]].firstVertex,
                        g->indices + 3 * (size_t)triangle);
}

// Twice the area, along the normal of the counter-clockwise side. Differences of floats keep all digits here.
void vplTriangle_Cross(const vplTriangleCorners* triangle, double cross[3]);

// In double from the rounded corners.
double vplTriangle_Area(const vplTriangleCorners* triangle);

// Square metres.
double vplGeometry_TriangleArea(const vplGeometry* geometry, int triangle);

// The face that a triangle belongs to, as in vplHit.
int vplGeometry_FaceOf(const vplGeometry* geometry, int triangle);

// The point of a triangle nearest to `point` by clamped weights, a hair inside: for points that were interpolated
// from pixels, which may lie beyond an edge and then behind the surface that meets it there.
vplVec3 vplGeometry_Inside(const vplGeometry* geometry, int triangle, vplVec3 point);

// The same with the weights of corners 1 and 2.
vplVec3 vplGeometry_InsideAt(const vplGeometry* geometry, int triangle, vplVec3 point, float* weight1Out,
                             float* weight2Out);

// Weights of a triangle's corners at a point in its plane, or at the point's foot there; of one without area 1, 0, 0.
void vplTriangle_Weigh(const vplVec3 corners[3], vplVec3 point, double weightsOut[3]);

static inline int vplPatches_TriangleOf(const vplPatches* patches, int patch)
{
    return patches->nodes[patches->patches[patch]].triangle;
}

#endif
