// SPDX-License-Identifier: MIT
#include "geometry/ray_tree.h"
#include "base/context.h"

#include <math.h>
#include <stdatomic.h>

typedef enum State { ABSENT, GROWING, READY, FAILED } State;

typedef struct vplRayTree {
    atomic_int state;
    vplBvh* bvh; // where READY
} vplRayTree;

vplResult vplRayTree_Create(vplContext* context, vplRayTree** treeOut)
{
    vplRayTree* tree = vplAlloc(context, 1, sizeof *tree);
    if (tree == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    tree->bvh = NULL;
    atomic_init(&tree->state, ABSENT);
    *treeOut = tree;
    return VPL_SUCCESS;
}

void vplRayTree_Destroy(vplContext* context, vplRayTree* tree)
{
    if (tree != NULL) {
        vplBvh_Destroy(context, tree->bvh);
        vplFree(context, tree);
    }
}

// Builds the tree unless it is there; of several threads that come here one builds and the others wait.
static State grow(const vplGeometry* g, bool alone)
{
    vplRayTree* tree = g->rayTree;
    int state = atomic_load_explicit(&tree->state, memory_order_acquire);
    if (state == READY) {
        return READY;
    }
    do {
        state = ABSENT;
        if (atomic_compare_exchange_strong(&tree->state, &state, GROWING)) {
            vplBvh* bvh = NULL;
            state = vplBvh_Create(g, VPL_BRUTE_BLOCKS, alone, &bvh) == VPL_SUCCESS ? READY : FAILED;
            tree->bvh = bvh;
            atomic_store_explicit(&tree->state, state, memory_order_release);
        }
    } while (state == GROWING);
    return (State)state;
}

vplResult vplGeometry_PrepareRays(const vplGeometry* geometry)
{
    int failed = FAILED; // there may be more memory by now
    atomic_compare_exchange_strong(&geometry->rayTree->state, &failed, ABSENT);
    return grow(geometry, false) == READY ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// Alone: a ray may be cast from inside a task, where no others can be started.
const vplBvh* vplGeometry_GetBvh(const vplGeometry* geometry)
{
    return grow(geometry, true) == READY ? geometry->rayTree->bvh : NULL;
}

// ---- without a tree

// The block of triangles first .. first + 7, in a hierarchy of its own.
static void makeBlock(const vplGeometry* g, int first, vplTriangleBlock* block, vplBvh* bvh)
{
    int32_t ids[VPL_BVH_WIDTH];
    int count = 0;
    for (int i = first; i < first + VPL_BVH_WIDTH && i < g->triangleCount; i++) {
        if (vplCanBeHit(g, i)) {
            ids[count++] = i;
        }
    }
    if (count > 0) {
        vplTriangleBlock_Fill(block, g, ids, count);
    }
    *bvh = (vplBvh){.blocks = block, .blockCount = count > 0};
}

void vplClosestOfTriangles(const vplGeometry* geometry, const vplRay* ray, vplRawHit* hitOut)
{
    vplTraceClosestFcn* closest = vplGetTraceClosest(vplContext_GetIsa(geometry->context));
    *hitOut = (vplRawHit){.t = INFINITY, .triangle = -1};
    for (int i = 0; i < geometry->triangleCount; i += VPL_BVH_WIDTH) {
        vplTriangleBlock block;
        vplBvh bvh;
        vplRawHit hit;
        makeBlock(geometry, i, &block, &bvh);
        closest(&bvh, ray, hitOut->t, &hit);
        *hitOut = hit.triangle >= 0 ? hit : *hitOut; // ascending: of equal distances the first stays
    }
}

bool vplAnyOfTriangles(const vplGeometry* geometry, const vplRay* ray, float tMax)
{
    vplTraceAnyFcn* any = vplGetTraceAny(vplContext_GetIsa(geometry->context));
    bool found = false;
    for (int i = 0; i < geometry->triangleCount && !found; i += VPL_BVH_WIDTH) {
        vplTriangleBlock block;
        vplBvh bvh;
        makeBlock(geometry, i, &block, &bvh);
        found = any(&bvh, ray, tMax);
    }
    return found;
}
