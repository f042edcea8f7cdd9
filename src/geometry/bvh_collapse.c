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

// A wide node before its boxes are filled in.
typedef struct WideNode {
    int32_t from[VPL_BVH_WIDTH]; // nodes of the binary tree that become its children
    int32_t child[VPL_BVH_WIDTH];
    int32_t count;
} WideNode;

// A walk over the binary tree: the first counts nodes and blocks, the second lists them.
typedef struct Collapse {
    const vplBvhBuilder* builder;
    vplBvh* bvh;
    WideNode* nodes;
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

// Adds a binary node and all below. Returns its number as a child. Parents come before their children.
static int32_t addChild(Collapse* c, int index, bool mustBeNode)
{
    const vplBinary* from = &c->builder->binary[index];
    const bool listing = c->blockItems != NULL;
    vplBvh* bvh = c->bvh;
    if (from->left < 0 || (from->isBlock && !mustBeNode)) {
        if (listing) {
            c->blockItems[bvh->blockCount] = (vplItemRange){from->first, from->count};
        }
        return ~bvh->blockCount++;
    }
    WideNode counted = {.count = 0}, *node = listing ? &c->nodes[bvh->nodeCount] : &counted;
    const int place = bvh->nodeCount++;
    node->count = 0;
    listChildren(c->builder, from->left, from->wideShare, node->from, &node->count);
    listChildren(c->builder, from->right, VPL_BVH_WIDTH - from->wideShare, node->from, &node->count);
    for (int i = 0; i < node->count; i++) {
        node->child[i] = addChild(c, node->from[i], false);
    }
    return place;
}

// Any-hit rays visit children in this order (bench/rays: 1.4x the random rays in Sponza, 0.9x its shadow
// rays).
static void sortChildren(const vplBvhBuilder* b, WideNode* node)
{
    float worth[VPL_BVH_WIDTH];
    for (int i = 0; i < node->count; i++) { // by insertion
        const int32_t from = node->from[i], child = node->child[i];
        const float value = b->binary[from].hitsPerCost;
        int at = i;
        for (; at > 0 && worth[at - 1] < value; at--) {
            worth[at] = worth[at - 1];
            node->from[at] = node->from[at - 1];
            node->child[at] = node->child[at - 1];
        }
        worth[at] = value;
        node->from[at] = from;
        node->child[at] = child;
    }
}

static void fillNode(const Collapse* c, int index)
{
    WideNode* from = &c->nodes[index];
    sortChildren(c->builder, from);
    vplBvhNode* node = &c->bvh->nodes[index];
    for (int i = 0; i < VPL_BVH_WIDTH; i++) {
        const bool used = i < from->count;
        vplBvhNode_SetBox(node, i, used ? c->builder->binary[from->from[i]].box : vplBox_Empty());
        node->child[i] = used ? from->child[i] : 0;
    }
    node->count = from->count;
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

// Tasks fill all nodes, VPL_TRIANGLE_CHUNK in each, and then the blocks.
static void fillChunk(void* data, int task, int worker)
{
    (void)worker;
    const Collapse* c = data;
    const int nodeTasks = vplCountChunks(c->bvh->nodeCount, VPL_TRIANGLE_CHUNK);
    const bool nodes = task < nodeTasks;
    const int first = (nodes ? task : task - nodeTasks) * VPL_TRIANGLE_CHUNK;
    const int end = vplEndOfChunk(nodes ? c->bvh->nodeCount : c->bvh->blockCount, first, VPL_TRIANGLE_CHUNK);
    for (int i = first; i < end; i++) {
        if (nodes) {
            fillNode(c, i);
        } else {
            fillBlock(c, i);
        }
    }
}

static vplResult allocate(Collapse* c)
{
    vplBvh* bvh = c->bvh;
    const size_t nodes = (size_t)bvh->nodeCount, blocks = (size_t)bvh->blockCount;
    bvh->nodes = nodes > 0 ? vplArena_Alloc(bvh->arena, nodes, sizeof *bvh->nodes) : NULL;
    bvh->blocks = vplArena_Alloc(bvh->arena, blocks, sizeof *bvh->blocks);
    bvh->marks = vplArena_Alloc(bvh->arena, blocks, sizeof *bvh->marks);
    c->nodes = nodes > 0 ? vplArena_Alloc(c->builder->scratch, nodes, sizeof *c->nodes) : NULL;
    c->blockItems = vplArena_Alloc(c->builder->scratch, blocks, sizeof *c->blockItems);
    TRY(vplArena_Check(bvh->arena));
    return vplArena_Check(c->builder->scratch);
}

static void fillAll(Collapse* c)
{
    const int tasks = vplCountChunks(c->bvh->nodeCount, VPL_TRIANGLE_CHUNK) +
                      vplCountChunks(c->bvh->blockCount, VPL_TRIANGLE_CHUNK);
    vplParallelFor(c->builder->geometry->context, tasks, fillChunk, c);
    bool any = false;
    for (int i = 0; i < c->bvh->blockCount; i++) {
        any = any || c->bvh->marks[i].extreme != 0 || c->bvh->marks[i].byFormula != 0;
    }
    c->bvh->marks = any ? c->bvh->marks : NULL;
}

vplResult vplCollapse(const vplBvhBuilder* builder, int root, vplBvh* bvh)
{
    Collapse c = {.builder = builder, .bvh = bvh};
    addChild(&c, root, true);
    TRY(allocate(&c));
    bvh->nodeCount = bvh->blockCount = 0;
    addChild(&c, root, true);
    fillAll(&c);
    bvh->cost = vplBvh_Cost(bvh);
    return VPL_SUCCESS;
}

vplResult vplMakeBlocks(const vplBvhBuilder* builder, int itemCount, vplBvh* bvh)
{
    Collapse c = {.builder = builder, .bvh = bvh};
    bvh->blockCount = (itemCount + VPL_BVH_WIDTH - 1) / VPL_BVH_WIDTH;
    TRY(allocate(&c));
    for (int i = 0; i < bvh->blockCount; i++) {
        const int first = i * VPL_BVH_WIDTH, rest = itemCount - first;
        c.blockItems[i] = (vplItemRange){first, rest < VPL_BVH_WIDTH ? rest : VPL_BVH_WIDTH};
    }
    fillAll(&c);
    return VPL_SUCCESS;
}
