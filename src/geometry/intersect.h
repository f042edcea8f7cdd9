// SPDX-License-Identifier: MIT
#ifndef VPL_GEOMETRY_INTERSECT_H
#define VPL_GEOMETRY_INTERSECT_H

#include <vpl/geometry.h>

// Where a ray meets the plane of a face at local coordinate `side`, moved into the face. For rays that are known
// to hit it. False where t is not positive and finite.
bool vplRay_HitFace(const vplRay* ray, const vplPlacement* placement, int face, double side, vplHit* hitOut);

// The face that a triangle belongs to, as in vplHit.
int vplGeometry_FaceOf(const vplGeometry* geometry, int triangle);

// The point of a triangle nearest to `point` by clamped weights, a hair inside: for points that were interpolated
// from pixels, which may lie beyond an edge and then behind the surface that meets it there.
vplVec3 vplGeometry_Inside(const vplGeometry* geometry, int triangle, vplVec3 point);

#endif
