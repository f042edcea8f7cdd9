// SPDX-License-Identifier: MIT
// Based on: Henri Ylitie, Tero Karras and Samuli Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed
// Wide BVHs, HPG 2017, section 4.1: which nodes of the binary tree become the children of wide ones, and where
// blocks begin, is found by dynamic programming over the expected cost.
#include "base/context.h"
#include "geometry/bvh_build.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>

// Work of a visit, relative: a block is read from further away and takes more arithmetic.
static const float NODE_COST = 1, BLOCK_COST = 1.2f;

// ---- costs

// Shares of the left half for every number of children.
static void shareChildren(vplBinary* node, const vplBuildCosts* left, const vplBuildCosts* right,
                          vplBuildCosts* costs)
{
    for (int j = 2; j <= VPL_BVH_WIDTH; j++) {
        costs->cost[j - 1] = left->cost[0] + right->cost[j - 2];
        node->take[j - 1] = 1;
        for (int k = 2; k < j; k++) {
            const float cost = left->cost[k - 1] + right->cost[j - k - 1];
            if (cost < costs->cost[j - 1]) {
                costs->cost[j - 1] = cost;
                node->take[j - 1] = (int8_t)k;
            }
        }
    }
}

void vplFindCosts(const vplBuilder* b, vplBinary* node, const vplBuildCosts* left, const vplBuildCosts* right,
                  vplBuildCosts* costs)
{
    const float area = vplHalfSurface(b, &node->box);
    const float block = node->count <= VPL_BVH_WIDTH ? BLOCK_COST * area : INFINITY;
    if (left == NULL) {
        for (int j = 0; j < VPL_BVH_WIDTH; j++) {
            costs->cost[j] = block;
            node->take[j] = 0;
        }
        node->isBlock = true;
    } else {
        shareChildren(node, left, right, costs);
        const float inner = NODE_COST * area + costs->cost[VPL_BVH_WIDTH - 1];
        node->wide = node->take[VPL_BVH_WIDTH - 1];
        node->isBlock = block <= inner;
        costs->cost[0] = node->isBlock ? block : inner;
        node->take[0] = 0;
        for (int j = 2; j <= VPL_BVH_WIDTH; j++) {
            if (costs->cost[j - 2] <= costs->cost[j - 1]) {
                costs->cost[j - 1] = costs->cost[j - 2];
                node->take[j - 1] = 0;
            }
        }
    }
    // Of rays that enter a box with triangles of area s about s / (s + area) meet one, for cost / area of work.
    const float s = node->surface, meets = s + area > 0 ? s / (s + area) : 1;
    node->promise = costs->cost[0] > 0 ? meets * (area / costs->cost[0]) : meets;
}

// ---- nodes and blocks

// What is made while the tree is walked; with nodes NULL it is only counted.
typedef struct Widening {
    const vplBuilder* builder;
    vplBvh* bvh;
    struct Part {
        int first, count; // items of a block
    } * parts;
} Widening;

// Lists the at most `count` children that the subtree becomes.
static void listChildren(const vplBuilder* b, int index, int count, int children[VPL_BVH_WIDTH],
                         int* childCount)
{
    const vplBinary* node = &b->binary[index];
    while (count > 1 && node->take[count - 1] == 0) {
        count--;
    }
    if (count == 1) {
        children[(*childCount)++] = index;
        return;
    }
    listChildren(b, node->left, node->take[count - 1], children, childCount);
    listChildren(b, node->right, count - node->take[count - 1], children, childCount);
}

// Any-hit rays go through children in their order: those first that promise most. Against the order of the splits
// random ones are 1.4x as fast in Sponza, shadow rays 1.3x in Sibenik and 0.9x in Sponza.
static void sortChildren(const vplBuilder* b, int children[VPL_BVH_WIDTH], int count)
{
    for (int i = 1; i < count; i++) {
        for (int k = i; k > 0 && b->binary[children[k - 1]].promise < b->binary[children[k]].promise; k--) {
            const int swap = children[k];
            children[k] = children[k - 1];
            children[k - 1] = swap;
        }
    }
}

static void setChild(vplBvhNode* node, int i, const vplBinary* child)
{
    for (int axis = 0; axis < 3; axis++) {
        node->planes[axis][i] = child ? child->box.low[axis] : INFINITY;
        node->planes[axis + 3][i] = child ? child->box.high[axis] : -INFINITY;
    }
    node->child[i] = 0;
}

// The number of the child that a binary node becomes, with all below. Parents come before their children.
static int32_t addChild(Widening* w, int index, bool mustBeNode)
{
    const vplBinary* from = &w->builder->binary[index];
    vplBvh* bvh = w->bvh;
    if (from->left < 0 || (from->isBlock && !mustBeNode)) {
        if (w->parts != NULL) {
            w->parts[bvh->blockCount] = (struct Part){from->first, from->count};
        }
        return ~bvh->blockCount++;
    }
    int children[VPL_BVH_WIDTH], count = 0;
    listChildren(w->builder, from->left, from->wide, children, &count);
    listChildren(w->builder, from->right, VPL_BVH_WIDTH - from->wide, children, &count);
    const int place = bvh->nodeCount++;
    vplBvhNode* node = bvh->nodes ? &bvh->nodes[place] : NULL;
    if (node != NULL) {
        sortChildren(w->builder, children, count);
    }
    for (int i = 0; node != NULL && i < VPL_BVH_WIDTH; i++) {
        setChild(node, i, i < count ? &w->builder->binary[children[i]] : NULL);
        node->count = count;
    }
    for (int i = 0; i < count; i++) {
        const int32_t child = addChild(w, children[i], false);
        if (node != NULL) {
            node->child[i] = child;
        }
    }
    return place;
}

void vplTriangleBlock_Fill(vplTriangleBlock* block, const vplGeometry* g, const int32_t* ids, int count)
{
    for (int lane = 0; lane < VPL_BVH_WIDTH; lane++) {
        const bool used = lane < count;
        const vplTriangleCorners t = vplGeometry_Corners(g, ids[used ? lane : 0]);
        block->id[lane] = used ? ids[lane] : -1;
        for (int corner = 0; corner < 3; corner++) {
            block->p[corner][0][lane] = t.corner[corner].x;
            block->p[corner][1][lane] = t.corner[corner].y;
            block->p[corner][2][lane] = t.corner[corner].z;
        }
    }
}

static void fillBlock(const Widening* w, int index)
{
    const struct Part* part = &w->parts[index];
    const int32_t* from = w->builder->ids + part->first;
    int32_t ids[VPL_BVH_WIDTH];
    for (int i = 0; i < part->count; i++) {
        int at = i;
        for (; at > 0 && ids[at - 1] > from[i]; at--) {
            ids[at] = ids[at - 1];
        }
        ids[at] = from[i];
    }
    vplTriangleBlock_Fill(&w->bvh->blocks[index], w->builder->geometry, ids, part->count);
}

static void fillBlocks(void* data, int task, int worker)
{
    (void)worker;
    const Widening* w = data;
    for (int i = task * VPL_BUILD_CHUNK; i < w->bvh->blockCount && i < (task + 1) * VPL_BUILD_CHUNK; i++) {
        fillBlock(w, i);
    }
}

// Allocates the blocks and the list of their parts.
static vplResult allocateBlocks(Widening* w, int count)
{
    vplContext* context = w->builder->geometry->context;
    w->bvh->blocks = vplAlloc(context, (size_t)count, sizeof *w->bvh->blocks);
    w->parts = w->bvh->blocks ? vplAlloc(context, (size_t)count, sizeof *w->parts) : NULL;
    return w->parts ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static void finishBlocks(Widening* w)
{
    vplBuilder_Run(w->builder, (w->bvh->blockCount + VPL_BUILD_CHUNK - 1) / VPL_BUILD_CHUNK, fillBlocks, w);
    vplFree(w->builder->geometry->context, w->parts);
}

vplResult vplWiden(const vplBuilder* builder, int root, vplBvh* bvh)
{
    Widening w = {builder, bvh, NULL};
    addChild(&w, root, true);
    const int blockCount = bvh->blockCount;
    bvh->nodes = vplAlloc(builder->geometry->context, (size_t)bvh->nodeCount, sizeof *bvh->nodes);
    if (bvh->nodes == NULL || allocateBlocks(&w, blockCount) != VPL_SUCCESS) {
        return VPL_OUT_OF_MEMORY;
    }
    bvh->nodeCount = bvh->blockCount = 0;
    addChild(&w, root, true);
    finishBlocks(&w);
    return VPL_SUCCESS;
}

vplResult vplMakeBlocks(const vplBuilder* builder, int itemCount, vplBvh* bvh)
{
    Widening w = {builder, bvh, NULL};
    const int count = (itemCount + VPL_BVH_WIDTH - 1) / VPL_BVH_WIDTH;
    if (allocateBlocks(&w, count) != VPL_SUCCESS) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < count; i++) {
        const int first = i * VPL_BVH_WIDTH, rest = itemCount - first;
        w.parts[i] = (struct Part){first, rest < VPL_BVH_WIDTH ? rest : VPL_BVH_WIDTH};
    }
    bvh->blockCount = count;
    finishBlocks(&w);
    return VPL_SUCCESS;
}
