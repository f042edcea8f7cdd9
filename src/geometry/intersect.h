// SPDX-License-Identifier: MIT
#ifndef VPL_GEOMETRY_INTERSECT_H
#define VPL_GEOMETRY_INTERSECT_H

#include <vpl/geometry.h>

// Where a ray meets the plane of a face at local coordinate `side`, moved into the face. For rays that are known
// to hit it. False where t is not positive and finite.
bool vplRay_HitFace(const vplRay* ray, const vplPlacement* placement, int face, double side, vplHit* hitOut);

#endif
