// SPDX-License-Identifier: MIT
#ifndef VPL_GEOMETRY_INTERSECT_H
#define VPL_GEOMETRY_INTERSECT_H

#include <vpl/geometry.h>

// Intersects a ray that is known to hit a face with its plane, at local coordinate `side`, and clamps the point to the
// face. False where t is not positive and finite.
bool vplRay_HitFace(const vplRay* ray, const vplPlacement* placement, int face, double side, vplHit* hitOut);

#endif
