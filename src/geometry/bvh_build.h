// SPDX-License-Identifier: MIT
// The hierarchy while it is built: ranges of triangles are split into a binary tree, which is collapsed into
// the wide one.
#ifndef VPL_GEOMETRY_BVH_BUILD_H
#define VPL_GEOMETRY_BVH_BUILD_H

#include "base/arena.h"
#include "geometry/bvh.h"

enum {
    VPL_BINARY_LEAF = 2 // ranges of up to this many triangles are not split
};

// Some of the items, with the bounds of their boxes and of the centres of these.
typedef struct vplBuildRange {
    vplBox box, centres;
    int first, count;
} vplBuildRange;

// Expected cost of a binary subtree: cost[i] if it becomes at most i + 1 children of one wide node.
typedef struct vplBuildCosts {
    float cost[VPL_BVH_WIDTH];
} vplBuildCosts;

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
    vplBox* items;     // bounds of triangles; high[3] is the area in square metres
    int32_t* ids;      // of the same triangles
    vplBinary* binary;
    float scale; // 1 / the longest side of the scene: keeps areas far from overflow
} vplBvhBuilder;

// Half the surface area of a scaled box.
static inline float vplHalfSurface(const vplBvhBuilder* b, const vplBox* box)
{
    const vplFour side = box->high * b->scale - box->low * b->scale;
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

// Fills items and ids with the triangles that can be hit.
vplResult vplCollectItems(vplBvhBuilder* builder, vplBuildRange* allOut);

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
