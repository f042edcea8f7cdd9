// SPDX-License-Identifier: MIT
// What a camera sees, and what lights give to it.
#ifndef VPL_LIGHTS_PLACEMENT_H
#define VPL_LIGHTS_PLACEMENT_H

#include <vpl/lights.h>

#include "geometry/bvh.h"

// Sixteen points of one part of the picture.
typedef struct vplSeenBlock {
    vplSurface surface;        // positions, and normals as they are shaded with
    float plane[3][VPL_LANES]; // the triangles' own normals, on the side that is seen
    float rho[3][VPL_LANES];   // reflectance; 0 where nothing is seen
    vplRayPacket rays;         // where shadow rays leave; without directions
} vplSeenBlock;

vplResult vplPlacementDef_Check(const vplContext* context, const vplPlacementDef* def);

// Where the camera looks; free *blocksOut with vplFree.
vplResult vplFindSeen(const vplGeometry* geometry, const vplPlacementDef* def, vplSeenBlock** blocksOut,
                      int* countOut);

// What 16 points reflect of one light, without shadow, as the sum of three channels. inverseClamp is
// 1 / minDistance^2, infinity for no bound; it is not used by documented lighting.
typedef void vplReflectFcn(const vplSeenBlock* block, const vplShadeLight* light, float inverseClamp,
                           float reflectedOut[VPL_LANES]);

#endif
