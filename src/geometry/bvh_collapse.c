// SPDX-License-Identifier: MIT
// Based on: Henri Ylitie, Tero Karras and Samuli Laine, Efficient Incoherent Ray Traversal on GPUs Through
// Compressed Wide BVHs, HPG 2017, section 4.1: dynamic programming over the expected cost decides which nodes
// of the binary tree become children of wide ones, and which become blocks.
#include "geometry/bvh_build.h"
#include "geometry/triangle.h"

// Cost of a visit, relative: blocks are further away in memory and take more arithmetic.
static const float NODE_COST = 1, BLOCK_COST = 1.2f;

// ---- costs

// Divides every number of children between the halves.
static void shareChildren(vplBinary* node, const vplBuildCosts* left, const vplBuildCosts* right,
                          vplBuildCosts* costs)
{
    for (int j = 2; j <= VPL_BVH_WIDTH; j++) {
        costs->cost[j - 1] = left->cost[0] + right->cost[j - 2];
        node->leftShare[j - 1] = 1;
        for (int k = 2; k < j; k++) {
            const float cost = left->cost[k - 1] + right->cost[j - k - 1];
            if (cost < costs->cost[j - 1]) {
                costs->cost[j - 1] = cost;
                node->leftShare[j - 1] = (int8_t)k;
            }
        }
    }
}

static void finishLeaf(const vplBvhBuilder* b, vplBinary* node, float block, vplBuildCosts* costs)
{
    for (int i = node->first; i < node->first + node->count; i++) {
        node->surface += b->items[i].high[3] * b->scale * b->scale;
    }
    for (int j = 0; j < VPL_BVH_WIDTH; j++) {
        costs->cost[j] = block;
    }
    node->isBlock = true;
}

static void finishInner(const vplBvhBuilder* b, vplBinary* node, float inner, float block,
                        vplBuildCosts* costs)
{
    node->surface = b->binary[node->left].surface + b->binary[node->right].surface;
    node->wideShare = node->leftShare[VPL_BVH_WIDTH - 1];
    inner += costs->cost[VPL_BVH_WIDTH - 1];
    node->isBlock = block <= inner;
    costs->cost[0] = node->isBlock ? block : inner;
    for (int j = 2; j <= VPL_BVH_WIDTH; j++) {
        if (costs->cost[j - 2] <= costs->cost[j - 1]) {
            costs->cost[j - 1] = costs->cost[j - 2];
            node->leftShare[j - 1] = 0;
        }
    }
}

void vplFinishNode(const vplBvhBuilder* b, vplBinary* node, const vplBuildCosts* left,
                   const vplBuildCosts* right, vplBuildCosts* costs)
{
    const float area = vplHalfSurface(b, &node->box);
    const float block = node->count <= b->perBlock ? BLOCK_COST * area : INFINITY;
    if (node->left < 0) {
        finishLeaf(b, node, block, costs);
    } else {
        shareChildren(node, left, right, costs);
        finishInner(b, node, NODE_COST * area, block, costs);
    }
    // A ray that enters a box with triangles of area s meets one with a probability of about s / (s + area),
    // for cost / area of work.
    const float s = node->surface, meets = s + area > 0 ? s / (s + area) : 1;
    node->hitsPerCost = costs->cost[0] > 0 ? meets * (area / costs->cost[0]) : meets;
}

// ---- nodes and blocks

// A walk over the binary tree: the first counts nodes and blocks, the second fills them.
typedef struct Collapse {
    const vplBvhBuilder* builder;
    vplBvh* bvh;
    vplItemRange* blockItems; // NULL during the first walk
} Collapse;

// Lists the at most `count` children that the subtree becomes.
static void listChildren(const vplBvhBuilder* b, int index, int count, int children[VPL_BVH_WIDTH],
                         int* childCount)
{
    const vplBinary* node = &b->binary[index];
    while (count > 1 && node->leftShare[count - 1] == 0) {
        count--;
    }
    if (count == 1) {
        children[(*childCount)++] = index;
        return;
    }
    listChildren(b, node->left, node->leftShare[count - 1], children, childCount);
    listChildren(b, node->right, count - node->leftShare[count - 1], children, childCount);
}

// Any-hit rays visit children in this order (bench/rays: 1.4x the random rays in Sponza, 0.9x its shadow
// rays).
static void sortChildren(const vplBvhBuilder* b, int children[VPL_BVH_WIDTH], int count)
{
    for (int i = 1; i < count; i++) {
        for (int k = i; k > 0 && b->binary[children[k - 1]].hitsPerCost < b->binary[children[k]].hitsPerCost;
             k--) {
            const int swap = children[k];
            children[k] = children[k - 1];
            children[k - 1] = swap;
        }
    }
}

static void setChild(vplBvhNode* node, int i, const vplBinary* child)
{
    vplBvhNode_SetBox(node, i, child ? child->box : vplBox_Empty());
    node->child[i] = 0;
}

// Adds a binary node and all below. Returns its number as a child. Parents come before their children.
static int32_t addChild(Collapse* c, int index, bool mustBeNode)
{
    const vplBinary* from = &c->builder->binary[index];
    const bool filling = c->blockItems != NULL;
    vplBvh* bvh = c->bvh;
    if (from->left < 0 || (from->isBlock && !mustBeNode)) {
        if (filling) {
            c->blockItems[bvh->blockCount] = (vplItemRange){from->first, from->count};
        }
        return ~bvh->blockCount++;
    }
    int children[VPL_BVH_WIDTH], count = 0;
    listChildren(c->builder, from->left, from->wideShare, children, &count);
    listChildren(c->builder, from->right, VPL_BVH_WIDTH - from->wideShare, children, &count);
    const int place = bvh->nodeCount++;
    if (filling) {
        sortChildren(c->builder, children, count);
        bvh->nodes[place].count = count;
    }
    for (int i = 0; filling && i < VPL_BVH_WIDTH; i++) {
        setChild(&bvh->nodes[place], i, i < count ? &c->builder->binary[children[i]] : NULL);
    }
    for (int i = 0; i < count; i++) {
        const int32_t child = addChild(c, children[i], false);
        if (filling) {
            bvh->nodes[place].child[i] = child;
        }
    }
    return place;
}

static void fillBlock(const Collapse* c, int index)
{
    const vplBvhBuilder* b = c->builder;
    const vplItemRange* items = &c->blockItems[index];
    const int32_t* from = b->ids + items->first;
    if (b->clusters != NULL) {
        items = &b->clusters[*from];
        from = b->members + items->first;
    }
    int32_t ids[VPL_BVH_WIDTH];
    for (int i = 0; i < items->count; i++) { // sorted by insertion
        int at = i;
        for (; at > 0 && ids[at - 1] > from[i]; at--) {
            ids[at] = ids[at - 1];
        }
        ids[at] = from[i];
    }
    c->bvh->marks[index] =
        vplTriangleBlock_Fill(&c->bvh->blocks[index], c->builder->geometry, ids, items->count);
}

static void fillBlocks(void* data, int task, int worker)
{
    (void)worker;
    const Collapse* c = data;
    const int first = task * VPL_TRIANGLE_CHUNK,
              end = vplEndOfChunk(c->bvh->blockCount, first, VPL_TRIANGLE_CHUNK);
    for (int i = first; i < end; i++) {
        fillBlock(c, i);
    }
}

static vplResult allocate(Collapse* c)
{
    vplBvh* bvh = c->bvh;
    const size_t nodes = (size_t)bvh->nodeCount, blocks = (size_t)bvh->blockCount;
    bvh->nodes = nodes > 0 ? vplArena_Alloc(bvh->arena, nodes, sizeof *bvh->nodes) : NULL;
    bvh->blocks = vplArena_Alloc(bvh->arena, blocks, sizeof *bvh->blocks);
    bvh->marks = vplArena_Alloc(bvh->arena, blocks, sizeof *bvh->marks);
    c->blockItems = vplArena_Alloc(c->builder->scratch, blocks, sizeof *c->blockItems);
    TRY(vplArena_Check(bvh->arena));
    return vplArena_Check(c->builder->scratch);
}

static void fillAllBlocks(Collapse* c)
{
    vplParallelFor(c->builder->geometry->context, vplCountChunks(c->bvh->blockCount, VPL_TRIANGLE_CHUNK),
                   fillBlocks, c);
    bool any = false;
    for (int i = 0; i < c->bvh->blockCount; i++) {
        any = any || c->bvh->marks[i].extreme != 0 || c->bvh->marks[i].byFormula != 0;
    }
    c->bvh->marks = any ? c->bvh->marks : NULL;
}

vplResult vplCollapse(const vplBvhBuilder* builder, int root, vplBvh* bvh)
{
    Collapse c = {builder, bvh, NULL};
    addChild(&c, root, true);
    TRY(allocate(&c));
    bvh->nodeCount = bvh->blockCount = 0;
    addChild(&c, root, true);
    fillAllBlocks(&c);
    bvh->cost = vplBvh_Cost(bvh);
    return VPL_SUCCESS;
}

vplResult vplMakeBlocks(const vplBvhBuilder* builder, int itemCount, vplBvh* bvh)
{
    Collapse c = {builder, bvh, NULL};
    bvh->blockCount = (itemCount + VPL_BVH_WIDTH - 1) / VPL_BVH_WIDTH;
    TRY(allocate(&c));
    for (int i = 0; i < bvh->blockCount; i++) {
        const int first = i * VPL_BVH_WIDTH, rest = itemCount - first;
        c.blockItems[i] = (vplItemRange){first, rest < VPL_BVH_WIDTH ? rest : VPL_BVH_WIDTH};
    }
    fillAllBlocks(&c);
    return VPL_SUCCESS;
}
