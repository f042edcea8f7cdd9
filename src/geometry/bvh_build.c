// SPDX-License-Identifier: MIT
// Builds the hierarchy: the upper splits of the binary tree in parallel waves, the subtrees below as parallel
// tasks. Work is divided by the number of triangles alone and each task writes its own slots, so the tree
// does not depend on the number of workers.
#include "geometry/bvh_build.h"

enum {
    SUBTREES = 64,        // tasks at most
    LEAST_SUBTREE = 1024, // triangles; smaller ranges are not divided among tasks
    TOP_NODES = 2 * SUBTREES
};

// A node of the upper tree. Its leaves are the subtrees that tasks build.
typedef struct TopNode {
    vplBuildRange range;
    int depth;
    int children; // the first of two; -1: a subtree
    vplBuildCosts costs;
} TopNode;

typedef struct TopTree {
    const vplBvhBuilder* builder;
    TopNode nodes[TOP_NODES];
    int count;
    int wave[SUBTREES]; // nodes that are split side by side
} TopTree;

// The place of a top node in the binary tree. The top nodes come first; a subtree of `count` items has fewer
// than 2 count nodes, so the one whose items begin at `first` is stored from 2 first on.
static int placeOf(const TopTree* top, int index)
{
    const TopNode* node = &top->nodes[index];
    return node->children >= 0 ? index : TOP_NODES + 2 * node->range.first;
}

static vplBinary* setNode(const vplBvhBuilder* b, int index, const vplBuildRange* range)
{
    b->binary[index] =
        (vplBinary){.box = range->box, .first = range->first, .count = range->count, .left = -1, .right = -1};
    return &b->binary[index];
}

// Builds the subtree of a range, its nodes from place *next on. Returns its root.
static int buildRange(const vplBvhBuilder* b, const vplBuildRange* range, int depth, int* next,
                      vplBuildCosts* costs)
{
    const int index = (*next)++;
    vplBinary* node = setNode(b, index, range);
    vplBuildCosts halfCosts[2];
    if (range->count > b->leaf) {
        vplBuildRange halves[2];
        vplSplitRange(b, range, depth, halves);
        node->left = buildRange(b, &halves[0], depth + 1, next, &halfCosts[0]);
        node->right = buildRange(b, &halves[1], depth + 1, next, &halfCosts[1]);
    }
    vplFinishNode(b, node, &halfCosts[0], &halfCosts[1], costs);
    return index;
}

static void buildSubtree(void* data, int index, int worker)
{
    (void)worker;
    TopTree* top = data;
    TopNode* node = &top->nodes[index];
    if (node->children < 0) {
        int next = placeOf(top, index);
        buildRange(top->builder, &node->range, node->depth, &next, &node->costs);
    }
}

static void splitTopNode(void* data, int index, int worker)
{
    (void)worker;
    TopTree* top = data;
    const TopNode* node = &top->nodes[top->wave[index]];
    vplBuildRange halves[2];
    vplSplitRange(top->builder, &node->range, node->depth, halves);
    for (int half = 0; half < 2; half++) {
        top->nodes[node->children + half] =
            (TopNode){.range = halves[half], .depth = node->depth + 1, .children = -1};
    }
}

// Splits all large ranges, level by level.
static vplResult splitTop(TopTree* top, const vplBuildRange* all)
{
    const int share = all->count / (SUBTREES / 2), large = share > LEAST_SUBTREE ? share : LEAST_SUBTREE;
    top->nodes[0] = (TopNode){.range = *all, .children = -1};
    top->count = 1;
    for (int begin = 0, end = 1; begin < end; begin = end, end = top->count) {
        int waveCount = 0;
        for (int i = begin; i < end && top->count + 2 < TOP_NODES; i++) {
            if (top->nodes[i].range.count > large) {
                top->nodes[i].children = top->count;
                top->count += 2;
                top->wave[waveCount++] = i;
            }
        }
        TRY(vplParallelForAsking(top->builder->geometry->context, waveCount, splitTopNode, top));
    }
    return VPL_SUCCESS;
}

// Adds the upper nodes to the binary tree, children before their parents.
static void finishTop(TopTree* top)
{
    for (int i = top->count - 1; i >= 0; i--) {
        TopNode* node = &top->nodes[i];
        if (node->children >= 0) {
            vplBinary* binary = setNode(top->builder, i, &node->range);
            binary->left = placeOf(top, node->children);
            binary->right = placeOf(top, node->children + 1);
            vplFinishNode(top->builder, binary, &top->nodes[node->children].costs,
                          &top->nodes[node->children + 1].costs, &node->costs);
        }
    }
}

static vplResult buildTree(vplBvhBuilder* b, const vplBuildRange* all, vplBvh* bvh)
{
    float half = 0x1p-100f; // of the longest side, because the side itself may exceed the largest float
    for (int axis = 0; axis < 3; axis++) {
        half = fmaxf(half, 0.5f * all->box.high[axis] - 0.5f * all->box.low[axis]);
    }
    b->scale = 0.5f / fminf(half, 0x1p127f);
    b->binary = vplArena_Alloc(b->scratch, TOP_NODES + 2 * (size_t)all->count, sizeof *b->binary);
    TopTree* top = vplArena_Alloc(b->scratch, 1, sizeof *top);
    TRY(vplArena_Check(b->scratch));
    top->builder = b;
    TRY(splitTop(top, all));
    TRY(vplParallelForAsking(b->geometry->context, top->count, buildSubtree, top));
    finishTop(top);
    return vplCollapse(b, placeOf(top, 0), bvh);
}

static vplResult build(vplBvhBuilder* b, int bruteBlocks, bool quick, vplBvh* bvh)
{
    vplBuildRange all;
    TRY(vplCollectItems(b, &all));
    if (all.count == 0) {
        return VPL_SUCCESS;
    }
    const bool brute = (all.count + VPL_BVH_WIDTH - 1) / VPL_BVH_WIDTH <= bruteBlocks;
    if (brute) {
        return vplMakeBlocks(b, all.count, bvh);
    }
    if (quick) {
        TRY(vplGroupItems(b, &all));
    }
    return buildTree(b, &all, bvh);
}

vplResult vplBvh_Create(const vplGeometry* geometry, int bruteBlocks, bool quick, vplBvh** bvhOut)
{
    vplArena* arena = vplArena_Create(geometry->context);
    vplBvhBuilder b = {.geometry = geometry,
                       .scratch = vplArena_Create(geometry->context),
                       .leaf = 2,
                       .perBlock = VPL_BVH_WIDTH};
    vplBvh* bvh = vplArena_AllocZero(arena, 1, sizeof *bvh);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        bvh->arena = arena;
        bvh->quick = quick;
        result = build(&b, bruteBlocks, quick, bvh);
    }
    vplArena_Destroy(b.scratch);
    return vplArena_Deliver(arena, result, bvh, bvhOut);
}
