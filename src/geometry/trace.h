// SPDX-License-Identifier: MIT
// Parts of ray queries that searches of other trees share.
#ifndef VPL_GEOMETRY_TRACE_H
#define VPL_GEOMETRY_TRACE_H

#include "geometry/bvh.h"

// The closest hit in a tree, for directions of any length.
void vplTraceOneTree(const vplBvh* bvh, vplIsa isa, const vplRay* ray, float tMax, vplRawHit* hitOut);

// Locates the hit on a triangle: by the formula of the quad or box that it belongs to, if any.
vplHit vplFinishHit(const vplGeometry* geometry, const vplRay* ray, const vplRawHit* raw);

#endif
