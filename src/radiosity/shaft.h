// SPDX-License-Identifier: MIT
// What can stand between two groups of sides, so that rays are cast only where something may, and meet no more.
#ifndef VPL_RADIOSITY_SHAFT_H
#define VPL_RADIOSITY_SHAFT_H

#include "radiosity/form_factors.h"

// The box around the sides of a block, in its `low` and `high`.
void vplFactorBlock_Bound(vplFactorBlock* block);

// What rays between two blocks of sides are traced through: a few triangles, or all.
enum { VPL_MOST_BLOCKERS = VPL_BRUTE_BLOCKS * VPL_BVH_WIDTH };

typedef struct vplBlockers {
    int32_t ids[VPL_MOST_BLOCKERS];
    int count; // 0: nothing stands between; -1: more than fit, or not known
    vplTriangleBlock blocks[VPL_BRUTE_BLOCKS];
    vplBvh bvh; // of the blocks, without nodes
} vplBlockers;

// Triangles that reach between sides of a and sides of b. Those in whose plane, to `tolerance`, or on one side of it all
// of them lie are no obstacle.
void vplBlockers_Find(const vplGeometry* geometry, const vplFactorBlock* a, const vplFactorBlock* b,
                      float tolerance, vplBlockers* blockers);

#endif
