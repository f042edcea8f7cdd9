// SPDX-License-Identifier: MIT
// Shaft culling: the triangles that can block rays between two blocks of sides.
#ifndef VPL_RADIOSITY_SHAFT_H
#define VPL_RADIOSITY_SHAFT_H

#include "radiosity/radiosity_kernels.h"

enum { VPL_MOST_BLOCKERS = VPL_BRUTE_BLOCKS * VPL_BVH_WIDTH };

typedef struct vplBlockers {
    int32_t ids[VPL_MOST_BLOCKERS];
    int count; // 0: nothing is in the way; -1: more than fit, or unknown
    vplTriangleBlock blocks[VPL_BRUTE_BLOCKS];
    vplBvh bvh; // of the blocks, without nodes
} vplBlockers;

// Finds the triangles that reach between sides of a and sides of b. A triangle blocks nothing if all sides
// lie on one side of its plane, or in it, to `tolerance` metres.
void vplBlockers_Find(const vplGeometry* geometry, const vplFactorBlock* a, const vplFactorBlock* b,
                      float tolerance, vplBlockers* blockers);

// One end of a shaft: a box around sides and, where they are in one plane, that plane.
typedef struct vplShaftEnd {
    float low[3], high[3];
    bool flat;
    vplVec3 normal, at; // the plane, if flat; the sides face along `normal`
} vplShaftEnd;

// Tests that no triangle reaches between sides at either end. A triangle blocks nothing if it is behind the plane
// of an end, or in it, or has both boxes on one side, to `tolerance` metres. May miss that the way is clear.
// *blocker: a triangle to try first, -1: none; then the one that was found.
bool vplShaft_IsClear(const vplGeometry* geometry, const vplShaftEnd* a, const vplShaftEnd* b,
                      float tolerance, int32_t* blocker);

#endif
