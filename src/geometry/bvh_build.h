// SPDX-License-Identifier: MIT
// A hierarchy while it is built: triangles are split into a binary tree, which becomes the wide one.
#ifndef VPL_GEOMETRY_BVH_BUILD_H
#define VPL_GEOMETRY_BVH_BUILD_H

#include "geometry/bvh.h"

enum {
    VPL_BINARY_LEAF = 2,   // ranges of up to this many triangles are not split
    VPL_BUILD_TASKS = 64,  // subtrees that are built side by side
    VPL_TASK_LEAST = 1024, // triangles; smaller ranges make no tasks of their own
    VPL_BUILD_CHUNK = 4096 // triangles that one task boxes, and blocks that one task fills
};

// Four floats, so that one instruction works on all; the last of each is ignored.
typedef struct vplBuildBox {
    float low[4], high[4];
} vplBuildBox;

// A part of the items, with the boxes of their boxes and of their centres.
typedef struct vplBuildRange {
    vplBuildBox box, centres;
    int first, count;
} vplBuildRange;

// Expected work for a binary subtree that becomes at most 1 .. 8 children of some wide node, by this many less one.
typedef struct vplBuildCosts {
    float cost[VPL_BVH_WIDTH];
} vplBuildCosts;

// A node of the binary tree, with the ways in which it can become part of a wide one.
typedef struct vplBinary {
    float low[3], high[3];
    int first, count;
    int left, right;            // -1: none
    float promise;              // what any-hit rays expect of it: see vplFindCosts
    float surface;              // square metres of its triangles, in units of the builder
    int8_t take[VPL_BVH_WIDTH]; // of at most i + 1 children, so many are the left half's; 0: as of at most i
    int8_t wide;                // the same of its own eight, should it be a wide node
    bool isBlock;
} vplBinary;

typedef struct vplBuilder {
    const vplGeometry* geometry;
    vplBuildBox* items; // of triangles; low[3] is the area
    int32_t* ids;       // of the same triangles
    vplBinary* binary;
    float unit; // 1 / the longest side of all: areas are taken in this unit, and stay far from overflow
} vplBuilder;

extern const vplBuildBox vplNoBox;

static inline void vplGrowBox(vplBuildBox* restrict box, const vplBuildBox* restrict by)
{
    for (int i = 0; i < 4; i++) {
        box->low[i] = by->low[i] < box->low[i] ? by->low[i] : box->low[i];
    }
    for (int i = 0; i < 4; i++) {
        box->high[i] = by->high[i] > box->high[i] ? by->high[i] : box->high[i];
    }
}

// Half the surface.
static inline float vplHalfSurface(const vplBuilder* b, const float low[3], const float high[3])
{
    const float x = (high[0] - low[0]) * b->unit, y = (high[1] - low[1]) * b->unit,
                z = (high[2] - low[2]) * b->unit;
    return x * y + y * z + z * x;
}

// Adds item `index` to the boxes of a range.
static inline void vplRange_Add(vplBuildRange* restrict range, const vplBuildBox* restrict item)
{
    vplBuildBox centre;
    for (int i = 0; i < 4; i++) {
        centre.low[i] = centre.high[i] = 0.5f * item->low[i] + 0.5f * item->high[i];
    }
    vplGrowBox(&range->box, item);
    vplGrowBox(&range->centres, &centre);
}

// Cuts a range in two; in halves where no plane separates centres, or where the tree gets too deep.
void vplCutRange(const vplBuilder* builder, vplBuildRange* range, vplBuildRange* otherOut, int depth);

// What becomes of a node is found from its children's costs (NULL: it has none).
void vplFindCosts(const vplBuilder* builder, vplBinary* node, const vplBuildCosts* left,
                  const vplBuildCosts* right, vplBuildCosts* costsOut);

// Makes nodes and blocks of bvh from the binary tree at `root`.
vplResult vplWiden(const vplBuilder* builder, int root, vplBvh* bvh);

// The same without a tree: blocks of eight items in their order.
vplResult vplMakeBlocks(const vplBuilder* builder, int itemCount, vplBvh* bvh);

#endif
