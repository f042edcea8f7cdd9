// SPDX-License-Identifier: MIT
// What rays of a geometry are traced through: made when rays are to be cast, and not before.
#ifndef VPL_GEOMETRY_RAY_TREE_H
#define VPL_GEOMETRY_RAY_TREE_H

#include "geometry/bvh.h"

vplResult vplRayTree_Create(vplContext* context, struct vplRayTree** treeOut);
void vplRayTree_Destroy(vplContext* context, struct vplRayTree* tree);

// Built here if nobody prepared it; NULL if that failed: then triangles are tested where they are.
const vplBvh* vplGeometry_GetBvh(const vplGeometry* geometry);

// The same hits without a tree and without memory, at any price.
void vplClosestOfTriangles(const vplGeometry* geometry, const vplRay* ray, vplRawHit* hitOut);
bool vplAnyOfTriangles(const vplGeometry* geometry, const vplRay* ray, float tMax);

#endif
