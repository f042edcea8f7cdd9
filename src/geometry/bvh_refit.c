// SPDX-License-Identifier: MIT
// Refits the ray tree after objects were moved.
// Based on: Ingo Wald, Solomon Boulos and Peter Shirley, Ray Tracing Deformable Scenes Using Dynamic Bounding Volume
// Hierarchies, TOG 2007: triangles stay where they are in the tree, and boxes grow around them, from the leaves up.
#include "geometry/bvh_build.h"
#include "geometry/cut_outs.h"
#include "geometry/object_build.h"

#include <stdatomic.h>

// The tree is built anew if rays would cost more than this many times what they cost when it was built.
#define MOST_COST 1.2

enum { CHUNK = 512 }; // nodes per task

// ---- cost

static double surfaceOf(const vplBvhNode* node, int child)
{
    double side[3];
    for (int axis = 0; axis < 3; axis++) {
        side[axis] = (double)node->planes[axis + 3][child] - (double)node->planes[axis][child];
    }
    return 2 * (side[0] * side[1] + side[1] * side[2] + side[2] * side[0]);
}

double vplBvh_Cost(const vplBvh* bvh)
{
    double cost = 0;
    for (int i = 0; i < bvh->nodeCount; i++) {
        for (int k = 0; k < bvh->nodes[i].count; k++) {
            cost += surfaceOf(&bvh->nodes[i], k);
        }
    }
    return cost;
}

// ---- blocks

typedef struct Refit {
    const vplGeometry* geometry;
    const uint8_t* changes; // of objects
    vplBvh* bvh;
    atomic_bool marked; // a block got a mark, and the tree has none
} Refit;

static int countOf(const vplTriangleBlock* block)
{
    int count = 0;
    while (count < VPL_BVH_WIDTH && block->id[count] >= 0) {
        count++;
    }
    return count;
}

static bool hasMoved(const Refit* r, const vplTriangleBlock* block, int count)
{
    bool moved = false;
    for (int i = 0; i < count && !moved; i++) {
        moved = (r->changes[r->geometry->owners[block->id[i]]] & VPL_OBJECT_MOVED) != 0;
    }
    return moved;
}

// Fills a block again, if anything in it was moved.
static bool refill(Refit* r, int index)
{
    vplTriangleBlock* block = &r->bvh->blocks[index];
    const int count = countOf(block);
    if (!hasMoved(r, block, count)) {
        return false;
    }
    int32_t ids[VPL_BVH_WIDTH];
    for (int i = 0; i < count; i++) {
        ids[i] = block->id[i];
    }
    const vplBlockMarks marks = vplTriangleBlock_Fill(block, r->geometry, ids, count);
    if (r->bvh->marks != NULL) {
        r->bvh->marks[index] = marks;
    } else if (marks.byFormula != 0 || marks.extreme != 0) {
        atomic_store(&r->marked, true);
    }
    return true;
}

static vplBox boundBlock(const vplGeometry* g, const vplTriangleBlock* block)
{
    vplBox box = vplBox_Empty();
    for (int i = 0; i < countOf(block); i++) {
        box = vplBox_Join(box, vplBoundItem(g, block->id[i]));
    }
    return box;
}

static void refitBlocks(void* data, int task, int worker)
{
    (void)worker;
    Refit* r = data;
    for (int i = task * CHUNK; i < r->bvh->nodeCount && i < (task + 1) * CHUNK; i++) {
        vplBvhNode* node = &r->bvh->nodes[i];
        for (int k = 0; k < node->count; k++) {
            const int block = ~node->child[k];
            if (block >= 0 && refill(r, block)) {
                vplBvhNode_SetBox(node, k, boundBlock(r->geometry, &r->bvh->blocks[block]));
            }
        }
    }
}

// ---- nodes

static vplBox boxOf(const vplBvhNode* node)
{
    vplBox box = vplBox_Empty();
    for (int k = 0; k < node->count; k++) {
        vplBox child = vplBox_Empty();
        for (int axis = 0; axis < 3; axis++) {
            child.low[axis] = node->planes[axis][k];
            child.high[axis] = node->planes[axis + 3][k];
        }
        box = vplBox_Join(box, child);
    }
    return box;
}

// Parents come before their children.
static void refitNodes(vplBvh* bvh)
{
    for (int i = bvh->nodeCount; i-- > 0;) {
        vplBvhNode* node = &bvh->nodes[i];
        for (int k = 0; k < node->count; k++) {
            if (node->child[k] >= 0) {
                vplBvhNode_SetBox(node, k, boxOf(&bvh->nodes[node->child[k]]));
            }
        }
    }
}

// True if the blocks hold the triangles that can be hit.
static bool holdsAll(const vplBvh* bvh, const vplGeometry* g)
{
    int held = 0, solid = 0;
    for (int i = 0; i < bvh->blockCount; i++) {
        for (int k = 0; k < countOf(&bvh->blocks[i]); k++) {
            held += vplIsSolid(g, bvh->blocks[i].id[k]) ? 1 : 0;
        }
    }
    for (int i = 0; i < g->triangleCount; i++) {
        solid += vplIsSolid(g, i) ? 1 : 0;
    }
    return held == solid;
}

bool vplBvh_Refit(vplBvh* bvh, const vplGeometry* g, const uint8_t* changes)
{
    Refit r = {.geometry = g, .changes = changes, .bvh = bvh};
    if (!holdsAll(bvh, g)) {
        return false;
    }
    if (bvh->nodes == NULL) {
        for (int i = 0; i < bvh->blockCount; i++) {
            refill(&r, i);
        }
        return !atomic_load(&r.marked);
    }
    vplParallelFor(g->context, (bvh->nodeCount + CHUNK - 1) / CHUNK, refitBlocks, &r);
    refitNodes(bvh);
    return !atomic_load(&r.marked) && vplBvh_Cost(bvh) <= MOST_COST * bvh->cost;
}
