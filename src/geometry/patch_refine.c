// SPDX-License-Identifier: MIT
// More patches where they are wanted.
#include "base/context.h"
#include "geometry/patch_tree.h"
#include "math/scalar.h"

#include <string.h>

// Patches as a heap: the largest priority first, among equal ones the first patch.
typedef struct Heap {
    const float* priorities;
    int* patches;
    int count;
} Heap;

static bool comesBefore(const Heap* heap, int a, int b)
{
    return heap->priorities[a] > heap->priorities[b] || (heap->priorities[a] == heap->priorities[b] && a < b);
}

static void sink(Heap* heap, int at)
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
    sink(heap, 0);
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
        sink(heap, i);
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
    vplResult result = vplPatchTree_Reserve(tree, positions + (size_t)more, nodes + 2 * (size_t)more);
    if (result != VPL_SUCCESS) {
        return result;
    }
    for (size_t i = 0; i < positions; i++) {
        vplPatchTree_Intern(tree, patches->positions[i]);
    }
    memcpy(tree->nodes, patches->nodes, nodes * sizeof *tree->nodes);
    tree->nodeCount = patches->nodeCount;
    for (size_t i = 0; i < nodes; i++) {
        tree->nodes[i].patch = -1;
    }
    return VPL_SUCCESS;
}

vplResult vplPatches_Refine(const vplPatches* patches, const float* priorities, int count,
                            vplPatches** patchesOut)
{
    vplContext* context = patches->context;
    vplResult result = check(patches, priorities, count);
    Heap heap = {.priorities = priorities};
    if (result == VPL_SUCCESS) {
        heap.patches = vplAlloc(context, (size_t)patches->patchCount, sizeof *heap.patches);
        result = heap.patches ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    vplPatchTree tree = {.geometry = patches->geometry};
    if (result == VPL_SUCCESS) {
        fillHeap(&heap, patches->patchCount);
        result = copyTree(patches, vplMaxi(0, vplMini(heap.count, count - patches->patchCount)), &tree);
    }
    if (result == VPL_SUCCESS) {
        for (int i = patches->patchCount; i < count && heap.count > 0;) {
            i += vplPatchTree_Bisect(&tree, patches->patches[takeFirst(&heap)], 0);
        }
        result = vplPatchTree_Finish(&tree, patchesOut);
    }
    vplFree(context, heap.patches);
    return result;
}
