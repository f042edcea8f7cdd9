// SPDX-License-Identifier: MIT
// A hierarchy while it is built: triangles are split into a binary tree, which becomes the wide one.
#ifndef VPL_GEOMETRY_BVH_BUILD_H
#define VPL_GEOMETRY_BVH_BUILD_H

#include "geometry/bvh.h"
#include "geometry/four.h"

#include <math.h>

enum {
    VPL_BINARY_LEAF = 2,   // ranges of up to this many triangles are not split
    VPL_BUILD_TASKS = 64,  // subtrees that are built side by side
    VPL_TASK_LEAST = 1024, // triangles; smaller ranges make no tasks of their own
    VPL_BUILD_CHUNK = 4096 // triangles that one task boxes, and blocks that one task fills
};

// The last of each four is ignored.
typedef struct vplBuildBox {
    vplFour low, high;
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
    vplBuildBox box;
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
    vplBuildBox* items; // of triangles; high[3] is the area in square metres
    int32_t* ids;       // of the same triangles
    vplBinary* binary;
    bool alone; // on one thread
    float unit; // 1 / the longest side of all: areas are taken in this unit, and stay far from overflow
} vplBuilder;

static inline vplBuildBox vplNoBox(void)
{
    return (vplBuildBox){vplFour_Of(INFINITY), vplFour_Of(-INFINITY)};
}

static inline vplBuildBox vplJoinBoxes(vplBuildBox a, vplBuildBox b)
{
    return (vplBuildBox){vplFour_Min(a.low, b.low), vplFour_Max(a.high, b.high)};
}

// Half the surface.
static inline float vplHalfSurface(const vplBuilder* b, const vplBuildBox* box)
{
    const vplFour side = box->high * b->unit - box->low * b->unit;
    return side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
}

static inline vplFour vplCentre(const vplBuildBox* item)
{
    return 0.5f * item->low + 0.5f * item->high;
}

// Items first .. first + count - 1 with the boxes around them.
vplBuildRange vplMakeRange(const vplBuilder* builder, int first, int count);

// Runs tasks on all workers, or on this one.
void vplBuilder_Run(const vplBuilder* builder, int count, vplTaskFcn* task, void* data);

// Fills in items and ids, for which there is room.
vplResult vplCollectItems(const vplBuilder* builder, vplBuildRange* allOut);

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
