// SPDX-License-Identifier: MIT
// The hierarchy while it is built: ranges of triangles are split into a binary tree, which is collapsed into
// the wide one.
#ifndef VPL_GEOMETRY_BVH_BUILD_H
#define VPL_GEOMETRY_BVH_BUILD_H

#include "base/arena.h"
#include "geometry/bvh.h"

// Some of the items, with the bounds of their boxes and of the centres of these.
typedef struct vplBuildRange {
    vplBox box, centres;
    int first, count;
} vplBuildRange;

// Expected cost of a binary subtree: cost[i] if it becomes at most i + 1 children of one wide node.
typedef struct vplBuildCosts {
    float cost[VPL_BVH_WIDTH];
} vplBuildCosts;

// Places in a list of triangles.
typedef struct vplItemRange {
    int first, count;
} vplItemRange;

// A node of the binary tree, with the cheapest ways to collapse it.
typedef struct vplBinary {
    vplBox box;
    int first, count;
    int left, right;   // -1: none
    float hitsPerCost; // expected hits of any-hit rays for the work spent on this subtree
    float surface;     // area of its triangles, scaled as vplHalfSurface
    int8_t
        leftShare[VPL_BVH_WIDTH]; // of at most i + 1 children, the left half's; 0: as with at most i children
    int8_t wideShare;             // the left half's share of its own eight children, should it be a wide node
    bool isBlock;
} vplBinary;

typedef struct vplBvhBuilder {
    const vplGeometry* geometry;
    vplArena* scratch; // owns the arrays below
    vplBox* items;     // bounds of triangles or clusters; high[3] is the area of triangles in square metres
    int32_t* ids;      // of the same triangles or clusters
    int leaf;          // ranges of up to this many items are not split
    int perBlock;      // at most this many items are one block
    vplBinary* binary;
    float scale;                  // 1 / the longest side of the scene: keeps areas far from overflow
    const vplItemRange* clusters; // of up to eight triangles each, in `members`; NULL: items are triangles
    const int32_t* members;       // triangles
} vplBvhBuilder;

// Half the surface area of a scaled box.
static inline float vplHalfSurface(const vplBvhBuilder* b, const vplBox* box)
{
    const vplFour side = box->high * b->scale - box->low * b->scale;
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

static inline vplFour vplCentreOf(const vplBox* item)
{
    return 0.5f * item->low + 0.5f * item->high;
}

// The factors that map the extent of centres along each axis to 0 ... count; 0 where all centres are in one place.
static inline vplFour vplScaleCentres(const vplBox* centres, int count)
{
    vplFour scale = vplFour_Of(0);
    for (int axis = 0; axis < 3; axis++) {
        const float size = centres->high[axis] - centres->low[axis];
        scale[axis] = size > 0x1p-100f && size < INFINITY ? (float)count / size : 0;
    }
    return scale;
}

vplBuildRange vplMakeRange(const vplBvhBuilder* builder, int first, int count);

// Fills items and ids with the triangles that can be hit.
vplResult vplCollectItems(vplBvhBuilder* builder, vplBuildRange* allOut);

// Replaces the triangles among the items by clusters of up to eight that lie next to each other.
vplResult vplGroupItems(vplBvhBuilder* builder, vplBuildRange* all);

// Splits a range where the surface area heuristic is least; in halves where no plane separates centres or the
// tree gets too deep. Reorders the items of the range.
void vplSplitRange(const vplBvhBuilder* builder, const vplBuildRange* range, int depth,
                   vplBuildRange halvesOut[2]);

// Decides how a node collapses, from the costs of its children, which are not read for a leaf.
void vplFinishNode(const vplBvhBuilder* builder, vplBinary* node, const vplBuildCosts* left,
                   const vplBuildCosts* right, vplBuildCosts* costsOut);

// Makes the nodes and blocks of the hierarchy from the binary tree at `root`.
vplResult vplCollapse(const vplBvhBuilder* builder, int root, vplBvh* bvh);

// Makes only blocks, of eight items each.
vplResult vplMakeBlocks(const vplBvhBuilder* builder, int itemCount, vplBvh* bvh);

#endif
