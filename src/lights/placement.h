// SPDX-License-Identifier: MIT
// Points that a camera sees, by which lights are judged.
#ifndef VPL_LIGHTS_PLACEMENT_H
#define VPL_LIGHTS_PLACEMENT_H

#include <vpl/lights.h>

#include "base/arena.h"
#include "geometry/bvh.h"
#include "visibility/blocks.h"

// Sixteen points of one part of the picture.
typedef struct vplViewBlock {
    vplSurface surface;        // positions, and normals as they are shaded with
    float plane[3][VPL_LANES]; // the triangles' own normals, on the visible side
    float rho[3][VPL_LANES];   // reflectance; 0 where nothing is visible
    vplRayPacket rays;         // where shadow rays leave; without directions
} vplViewBlock;

vplResult vplPlacementDef_Check(const vplContext* context, const vplPlacementDef* def);

// Points that the def's camera sees; the arena owns the blocks.
vplResult vplSampleView(const vplGeometry* geometry, const vplPlacementDef* def, vplArena* arena,
                        const vplViewBlock** blocksOut, int* countOut);

#endif
