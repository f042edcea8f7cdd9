// SPDX-License-Identifier: MIT
// Based on: Ingo Wald, On Fast Construction of SAH-Based Bounding Volume Hierarchies, RT 2007: ranges of
// triangles are split where the surface area heuristic, sampled at bins of centroids, is least.
// And: Henri Ylitie, Tero Karras and Samuli Laine, Efficient Incoherent Ray Traversal on GPUs Through Compressed
// Wide BVHs, HPG 2017, section 4.1: which nodes of the binary tree become the children of wide ones, and where
// blocks begin, is found by dynamic programming over the expected cost.
#include "geometry/bvh.h"
#include "base/context.h"
#include "base/isa.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>
#include <string.h>

enum { BINS = 16, LEAF = VPL_BVH_WIDTH, BINARY_LEAF = 2, HALVING_DEPTH = VPL_BVH_DEPTH - 32 };

// Work of a visit, relative: a block is read from further away and takes more arithmetic.
static const double NODE_COST = 1, BLOCK_COST = 1.2;

typedef struct Box {
    float low[3], high[3];
} Box;

static const Box NOTHING = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};

// A triangle while the tree is built.
typedef struct Item {
    Box box;
    int id;
} Item;

typedef struct Range {
    Box box;
    int first, count;
} Range;

// A node of the binary tree, with the ways in which it can become part of a wide one.
typedef struct Binary {
    Range range;
    int left, right; // -1: none
    double cost[VPL_BVH_WIDTH];
    int8_t take[VPL_BVH_WIDTH], wide;
    bool isBlock;
    double surface;
} Binary;

typedef struct Builder {
    vplContext* context;
    Binary* binary;
    int binaryCount;
    size_t binaryCapacity;
    const vplGeometry* geometry;
    Item* items;
    vplBvh* bvh;
    size_t nodeCapacity, blockCapacity;
} Builder;

static void grow(Box* box, const Box* by)
{
    for (int axis = 0; axis < 3; axis++) {
        box->low[axis] = by->low[axis] < box->low[axis] ? by->low[axis] : box->low[axis];
        box->high[axis] = by->high[axis] > box->high[axis] ? by->high[axis] : box->high[axis];
    }
}

// Half the surface. In double: sides of 1e15 would overflow.
static double areaOf(const Box* box)
{
    double x = (double)box->high[0] - box->low[0], y = (double)box->high[1] - box->low[1],
           z = (double)box->high[2] - box->low[2];
    return x >= 0 ? x * y + y * z + z * x : 0;
}

// Twice the centre.
static double centreOf(const Item* item, int axis)
{
    return (double)item->box.low[axis] + item->box.high[axis];
}

typedef struct Split {
    double cost;
    int axis, bin; // bins up to this one go left
    double from, scale;
} Split;

static int binOf(const Split* split, const Item* item)
{
    int bin = (int)((centreOf(item, split->axis) - split->from) * split->scale);
    return bin < BINS ? bin : BINS - 1;
}

// The cheapest of the 15 planes between bins along one axis.
static Split splitAlong(const Builder* b, const Range* range, int axis, double from, double to)
{
    Split best = {INFINITY, axis, 0, from, BINS / (to - from)};
    Box boxes[BINS];
    int counts[BINS] = {0};
    double rightCost[BINS];
    for (int i = 0; i < BINS; i++) {
        boxes[i] = NOTHING;
    }
    for (int i = range->first; i < range->first + range->count; i++) {
        int bin = binOf(&best, &b->items[i]);
        counts[bin]++;
        grow(&boxes[bin], &b->items[i].box);
    }
    Box right = NOTHING, left = NOTHING;
    for (int i = BINS - 1, count = 0; i > 0; i--) {
        grow(&right, &boxes[i]);
        count += counts[i];
        rightCost[i] = count ? areaOf(&right) * count : INFINITY;
    }
    for (int i = 0, count = 0; i < BINS - 1; i++) {
        grow(&left, &boxes[i]);
        count += counts[i];
        double cost = count ? areaOf(&left) * count + rightCost[i + 1] : INFINITY;
        if (cost < best.cost) {
            best.cost = cost;
            best.bin = i;
        }
    }
    return best;
}

static Split findSplit(const Builder* b, const Range* range)
{
    Split best = {INFINITY, 0, 0, 0, 0};
    for (int axis = 0; axis < 3; axis++) {
        double from = INFINITY, to = -INFINITY;
        for (int i = range->first; i < range->first + range->count; i++) {
            double centre = centreOf(&b->items[i], axis);
            from = centre < from ? centre : from;
            to = centre > to ? centre : to;
        }
        if (to > from) {
            Split split = splitAlong(b, range, axis, from, to);
            best = split.cost < best.cost ? split : best;
        }
    }
    return best;
}

static Range makeRange(const Builder* b, int first, int count)
{
    Range range = {NOTHING, first, count};
    for (int i = first; i < first + count; i++) {
        grow(&range.box, &b->items[i].box);
    }
    return range;
}

// Cuts a range in two; in halves where no plane separates centres, or where the tree gets too deep.
static void cut(const Builder* b, Range* range, Range* otherOut, int depth)
{
    Split split = findSplit(b, range);
    int first = range->first, end = first + range->count, middle = first + range->count / 2;
    if (split.cost < INFINITY && depth < HALVING_DEPTH) {
        middle = first;
        for (int last = end; middle < last;) {
            Item* item = &b->items[middle];
            if (binOf(&split, item) <= split.bin) {
                middle++;
            } else {
                Item swap = b->items[--last];
                b->items[last] = *item;
                *item = swap;
            }
        }
    }
    *otherOut = makeRange(b, middle, end - middle);
    *range = makeRange(b, first, middle - first);
}

// By corner and axis, in world space.
static void getCorners(const vplGeometry* g, int triangle, float p[3][3])
{
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    for (int i = 0; i < 9; i++) {
        p[i / 3][i % 3] = vplComponent(t.corner[i / 3], i % 3);
    }
}

static vplResult addBlock(Builder* b, const Range* range, int32_t* childOut)
{
    vplBvh* bvh = b->bvh;
    vplResult result = vplReserve(b->context, &bvh->blocks, &b->blockCapacity, (size_t)bvh->blockCount + 1,
                                  sizeof *bvh->blocks);
    if (result != VPL_SUCCESS) {
        return result;
    }
    int ids[VPL_BVH_WIDTH];
    for (int i = 0; i < range->count; i++) { // ascending, by insertion
        int at = i;
        for (; at > 0 && ids[at - 1] > b->items[range->first + i].id; at--) {
            ids[at] = ids[at - 1];
        }
        ids[at] = b->items[range->first + i].id;
    }
    vplTriangleBlock* block = &bvh->blocks[bvh->blockCount];
    for (int lane = 0; lane < VPL_BVH_WIDTH; lane++) {
        bool used = lane < range->count;
        float p[3][3];
        getCorners(b->geometry, ids[used ? lane : 0], p);
        block->id[lane] = used ? ids[lane] : -1;
        for (int i = 0; i < 9; i++) {
            block->p[i / 3][i % 3][lane] = p[i / 3][i % 3];
        }
    }
    *childOut = ~bvh->blockCount++;
    return VPL_SUCCESS;
}

// ---- the binary tree

// Appends the node of a range and those below it; *indexOut is its place. Children come after their parents.
static vplResult addBinary(Builder* b, const Range* range, int depth, int* indexOut)
{
    const int index = b->binaryCount;
    vplResult result =
        vplReserve(b->context, &b->binary, &b->binaryCapacity, (size_t)index + 1, sizeof *b->binary);
    if (result != VPL_SUCCESS) {
        return result;
    }
    b->binaryCount++;
    Binary node = {.range = *range, .left = -1, .right = -1};
    if (range->count > BINARY_LEAF) {
        Range left = *range, right;
        cut(b, &left, &right, depth);
        result = addBinary(b, &left, depth + 1, &node.left);
        if (result == VPL_SUCCESS) {
            result = addBinary(b, &right, depth + 1, &node.right);
        }
    }
    b->binary[index] = node; // the array may have moved
    *indexOut = index;
    return result;
}

// ---- the wide tree

// cost[j - 1] is the least expected work for a binary subtree that becomes at most j children of some wide node;
// take[j - 1] is how many of them the left half gets, 0: as with j - 1.
static void findCosts(const Builder* b, Binary* node)
{
    node->surface = 0;
    if (node->left < 0) {
        for (int i = 0; i < node->range.count; i++) {
            node->surface += vplGeometry_TriangleArea(b->geometry, b->items[node->range.first + i].id);
        }
    } else {
        node->surface = b->binary[node->left].surface + b->binary[node->right].surface;
    }
    const double area = areaOf(&node->range.box);
    const double leaf = node->range.count <= LEAF ? BLOCK_COST * area : INFINITY;
    if (node->left < 0) {
        for (int j = 0; j < VPL_BVH_WIDTH; j++) {
            node->cost[j] = leaf;
            node->take[j] = 0;
        }
        return;
    }
    const Binary *l = &b->binary[node->left], *r = &b->binary[node->right];
    for (int j = 2; j <= VPL_BVH_WIDTH; j++) {
        node->cost[j - 1] = INFINITY;
        for (int k = 1; k < j; k++) {
            const double cost = l->cost[k - 1] + r->cost[j - k - 1];
            if (cost < node->cost[j - 1]) {
                node->cost[j - 1] = cost;
                node->take[j - 1] = (int8_t)k;
            }
        }
    }
    node->wide = node->take[VPL_BVH_WIDTH - 1]; // how its own eight are shared, should it be a wide node
    const double inner = NODE_COST * area + node->cost[VPL_BVH_WIDTH - 1];
    node->isBlock = leaf <= inner;
    node->cost[0] = leaf < inner ? leaf : inner;
    node->take[0] = 0;
    for (int j = 2; j <= VPL_BVH_WIDTH; j++) {
        if (node->cost[j - 2] <= node->cost[j - 1]) {
            node->cost[j - 1] = node->cost[j - 2];
            node->take[j - 1] = 0;
        }
    }
}

// Lists the at most `count` children that the subtree becomes.
static void listChildren(const Builder* b, int index, int count, int children[VPL_BVH_WIDTH], int* childCount)
{
    const Binary* node = &b->binary[index];
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

static double orderOf(const Binary* n)
{
    double area = areaOf(&n->range.box);
    double p = n->surface / (n->surface + area + 1e-30);
    return p * area / n->cost[0];
}
#define ORDER(c) orderOf(&b->binary[c])
static vplResult addNode(Builder* b, int index, int32_t* childOut)
{
    const Binary* from = &b->binary[index];
    if (from->left < 0 || from->isBlock) {
        return addBlock(b, &from->range, childOut);
    }
    vplBvh* bvh = b->bvh;
    vplResult result =
        vplReserve(b->context, &bvh->nodes, &b->nodeCapacity, (size_t)bvh->nodeCount + 1, sizeof *bvh->nodes);
    if (result != VPL_SUCCESS) {
        return result;
    }
    int children[VPL_BVH_WIDTH], count = 0;
    listChildren(b, from->left, from->wide, children, &count);
    listChildren(b, from->right, VPL_BVH_WIDTH - from->wide, children, &count);
    for (int i = 1; i < count; i++) {
        for (int k = i; k > 0 && ORDER(children[k - 1]) < ORDER(children[k]); k--) {
            int swap = children[k];
            children[k] = children[k - 1];
            children[k - 1] = swap;
        }
    }
    const int place = bvh->nodeCount++;
    vplBvhNode node = {.count = count};
    for (int i = 0; i < VPL_BVH_WIDTH; i++) {
        const Box* box = i < count ? &b->binary[children[i]].range.box : &NOTHING;
        for (int axis = 0; axis < 3; axis++) {
            node.planes[axis][i] = box->low[axis];
            node.planes[axis + 3][i] = box->high[axis];
        }
        node.child[i] = 0;
    }
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        result = addNode(b, children[i], &node.child[i]);
    }
    bvh->nodes[place] = node; // the array may have moved
    *childOut = place;
    return result;
}

static vplResult buildTree(Builder* b, int count)
{
    const Range all = makeRange(b, 0, count);
    int root;
    int32_t child;
    vplResult result = addBinary(b, &all, 0, &root);
    for (int i = b->binaryCount - 1; i >= 0 && result == VPL_SUCCESS; i--) {
        findCosts(b, &b->binary[i]);
    }
    if (result == VPL_SUCCESS) {
        b->binary[root].isBlock = false; // the root is a node
        result = addNode(b, root, &child);
    }
    vplFree(b->context, b->binary);
    return result;
}

// The triangles that can be hit.
static int collectItems(const vplGeometry* g, Item* items)
{
    int count = 0;
    for (int i = 0; i < g->triangleCount; i++) {
        vplVec3 n = g->normals[i];
        if (n.x != 0 || n.y != 0 || n.z != 0) {
            float p[3][3];
            getCorners(g, i, p);
            vplBoundTriangle(p, items[count].box.low, items[count].box.high);
            items[count++].id = i;
        }
    }
    return count;
}

static vplResult build(Builder* b, int count, int bruteBlocks)
{
    int32_t child;
    if (count == 0) {
        return VPL_SUCCESS;
    }
    if ((count + VPL_BVH_WIDTH - 1) / VPL_BVH_WIDTH > bruteBlocks) {
        return buildTree(b, count);
    }
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < count && result == VPL_SUCCESS; i += VPL_BVH_WIDTH) {
        Range range = {NOTHING, i, count - i < VPL_BVH_WIDTH ? count - i : VPL_BVH_WIDTH};
        result = addBlock(b, &range, &child);
    }
    return result;
}

vplResult vplBvh_Create(const vplGeometry* geometry, int bruteBlocks, vplBvh** bvhOut)
{
    vplContext* context = geometry->context;
    Builder b = {.context = context, .geometry = geometry};
    b.bvh = vplAllocZero(context, 1, sizeof *b.bvh);
    b.items = b.bvh ? vplAlloc(context, (size_t)geometry->triangleCount, sizeof *b.items) : NULL;
    vplResult result = VPL_OUT_OF_MEMORY;
    if (b.items != NULL) {
        result = build(&b, collectItems(geometry, b.items), bruteBlocks);
    }
    vplFree(context, b.items);
    if (result != VPL_SUCCESS) {
        vplBvh_Destroy(context, b.bvh);
        return result;
    }
    *bvhOut = b.bvh;
    return VPL_SUCCESS;
}

void vplBvh_Destroy(vplContext* context, vplBvh* bvh)
{
    if (bvh != NULL) {
        vplFree(context, bvh->nodes);
        vplFree(context, bvh->blocks);
        vplFree(context, bvh);
    }
}

VPL_KERNEL_TABLE(CLOSEST, vplTraceClosestFcn, vplTraceClosest);
VPL_KERNEL_TABLE(PACKET, vplTraceAnyPacketFcn, vplTraceAnyPacket);
VPL_KERNEL_TABLE(ANY, vplTraceAnyFcn, vplTraceAny);

// 512 bits are for lanes by the dozen: collecting eight flags from a mask register takes longer than from a vector,
// and boxes and triangles are tested one after another. AVX2 on the same processor (Zen 4; bench/rays --isa) traces
// 1.05x of the rays of AVX-512, in packets 1.1x; in the room, packets 0.85x.
static vplIsa isaOfRays(vplIsa isa)
{
    return isa == VPL_ISA_AVX512 ? VPL_ISA_AVX2 : isa;
}

vplTraceClosestFcn* vplGetTraceClosest(vplIsa isa)
{
    return CLOSEST[isaOfRays(isa)];
}

vplTraceAnyFcn* vplGetTraceAny(vplIsa isa)
{
    return ANY[isaOfRays(isa)];
}

vplTraceAnyPacketFcn* vplGetTraceAnyPacket(vplIsa isa)
{
    return PACKET[isaOfRays(isa)];
}
