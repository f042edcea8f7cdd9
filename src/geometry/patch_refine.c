// SPDX-License-Identifier: MIT
// Bisects the patches of the highest refinement priority.
#include "geometry/patch_tree.h"
#include "math/scalar.h"

#include <string.h>

// A heap of patches: the largest priority first, among equal ones the patch with the lowest index.
typedef struct Heap {
    const float* priorities;
    int* patches;
    int count;
} Heap;

static bool comesBefore(const Heap* heap, int a, int b)
{
    return heap->priorities[a] > heap->priorities[b] || (heap->priorities[a] == heap->priorities[b] && a < b);
}

static void siftDown(Heap* heap, int at)
{
    const int patch = heap->patches[at];
    for (int child = 2 * at + 1; child < heap->count; child = 2 * at + 1) {
        child += child + 1 < heap->count && comesBefore(heap, heap->patches[child + 1], heap->patches[child]);
        if (!comesBefore(heap, heap->patches[child], patch)) {
            break;
        }
        heap->patches[at] = heap->patches[child];
        at = child;
    }
    heap->patches[at] = patch;
}

static int takeFirst(Heap* heap)
{
    const int patch = heap->patches[0];
    heap->patches[0] = heap->patches[--heap->count];
    siftDown(heap, 0);
    return patch;
}

static void fillHeap(Heap* heap, int patchCount)
{
    for (int i = 0; i < patchCount; i++) {
        if (heap->priorities[i] > 0) {
            heap->patches[heap->count++] = i;
        }
    }
    for (int i = heap->count / 2; i-- > 0;) {
        siftDown(heap, i);
    }
}

static vplResult check(const vplPatches* patches, const float* priorities, int count)
{
    if (count < 1 || count > VPL_MAX_PATCHES) {
        return vplFail(patches->context, VPL_INVALID_ARGUMENT, "count is %d, must be in [1, %d]", count,
                       VPL_MAX_PATCHES);
    }
    for (int i = 0; i < patches->patchCount; i++) {
        if (isnan(priorities[i])) {
            return vplFail(patches->context, VPL_INVALID_ARGUMENT, "priorities[%d] is not a number", i);
        }
    }
    return VPL_SUCCESS;
}

static vplResult copyTree(const vplPatches* patches, int more, vplPatchTree* tree)
{
    const size_t positions = (size_t)patches->positionCount, nodes = (size_t)patches->nodeCount;
    TRY(vplPatchTree_Reserve(tree, positions + (size_t)more, nodes + 2 * (size_t)more));
    for (size_t i = 0; i < positions; i++) {
        vplPatchTree_Intern(tree, patches->positions[i]);
    }
    memcpy(tree->nodes, patches->nodes, nodes * sizeof *tree->nodes);
    tree->nodeCount = patches->nodeCount;
    tree->cutPatches = patches->cutPatches;
    tree->unresolvedCuts = patches->unresolvedCuts;
    for (size_t i = 0; i < nodes; i++) {
        tree->nodes[i].patch = -1;
    }
    const vplPatchGroups groups = {patches->groupCount, patches->firstMember, patches->members,
                                   patches->areaUpTo};
    TRY(vplPatchTree_CopyGroups(tree, &groups));
    return vplPatchTree_CopyCuts(tree, patches->cuts, patches->firstCut);
}

static void bisectFirst(const vplPatches* patches, int count, Heap* heap, vplPatchTree* tree)
{
    for (int i = patches->patchCount; i < count && heap->count > 0;) {
        i += vplPatchTree_Bisect(tree, patches->patches[takeFirst(heap)], 0);
    }
}

vplResult vplPatches_Refine(const vplPatches* patches, const float* priorities, int count,
                            vplPatches** patchesOut)
{
    REQUIRE(CONTEXT_OF(patches), patches, priorities, patchesOut);
    TRY(check(patches, priorities, count));
    Heap heap = {.priorities = priorities};
    heap.patches = vplAlloc(patches->context, (size_t)patches->patchCount, sizeof *heap.patches);
    if (heap.patches == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    fillHeap(&heap, patches->patchCount - patches->groupCount);
    vplPatchTree tree = {.geometry = patches->geometry};
    const int more = vplMaxi(0, vplMini(heap.count, count - patches->patchCount));
    const vplResult result = copyTree(patches, more, &tree);
    if (result == VPL_SUCCESS) {
        bisectFirst(patches, count, &heap, &tree);
    }
    vplFree(patches->context, heap.patches);
    return vplPatchTree_Finish(&tree, result, patchesOut);
}
