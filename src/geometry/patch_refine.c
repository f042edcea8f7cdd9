// SPDX-License-Identifier: MIT
// Bisects the patches of the highest refinement priority, or with the longest edges.
#include "geometry/bvh.h"
#include "geometry/patch_tree.h"
#include "geometry/triangle.h"
#include "math/scalar.h"

#include <string.h>

// A heap of patches or nodes: the largest priority first, among equal ones the lowest index.
typedef struct Heap {
    const float* priorities;
    int* items;
    int count;
} Heap;

static bool comesBefore(const Heap* heap, int a, int b)
{
    return heap->priorities[a] > heap->priorities[b] || (heap->priorities[a] == heap->priorities[b] && a < b);
}

static void siftDown(Heap* heap, int at)
{
    const int item = heap->items[at];
    for (int child = 2 * at + 1; child < heap->count; child = 2 * at + 1) {
        child += child + 1 < heap->count && comesBefore(heap, heap->items[child + 1], heap->items[child]);
        if (!comesBefore(heap, heap->items[child], item)) {
            break;
        }
        heap->items[at] = heap->items[child];
        at = child;
    }
    heap->items[at] = item;
}

static int takeFirst(Heap* heap)
{
    const int item = heap->items[0];
    heap->items[0] = heap->items[--heap->count];
    siftDown(heap, 0);
    return item;
}

static void add(Heap* heap, int item)
{
    int at = heap->count++;
    for (; at > 0 && comesBefore(heap, item, heap->items[(at - 1) / 2]); at = (at - 1) / 2) {
        heap->items[at] = heap->items[(at - 1) / 2];
    }
    heap->items[at] = item;
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

// Returns how many patches have a priority above 0; groups are left as they are.
static int countWorthwhile(const vplPatches* patches, const float* priorities)
{
    int count = 0;
    for (int i = 0; i < patches->patchCount - patches->groupCount; i++) {
        count += priorities[i] > 0;
    }
    return count;
}

static vplResult bisectFirst(const vplPatches* patches, const float* priorities, int more, vplPatchTree* tree)
{
    Heap heap = {.priorities = priorities};
    heap.items = vplArena_Alloc(tree->scratch, (size_t)patches->patchCount, sizeof *heap.items);
    TRY(vplArena_Check(tree->scratch));
    for (int i = 0; i < patches->patchCount - patches->groupCount; i++) {
        if (priorities[i] > 0) {
            add(&heap, i);
        }
    }
    while (more > 0 && heap.count > 0) {
        more -= vplPatchTree_Bisect(tree, patches->patches[takeFirst(&heap)], 0);
    }
    return VPL_SUCCESS;
}

vplResult vplPatches_Refine(const vplPatches* patches, const float* priorities, int count,
                            vplPatches** patchesOut)
{
    REQUIRE(CONTEXT_OF(patches), patches, priorities, patchesOut);
    TRY(check(patches, priorities, count));
    vplPatchTree tree = {.geometry = patches->geometry};
    const int most = countWorthwhile(patches, priorities),
              more = vplMaxi(0, vplMini(most, count - patches->patchCount));
    vplResult result = copyTree(patches, more, &tree);
    if (result == VPL_SUCCESS) {
        result = bisectFirst(patches, priorities, more, &tree);
    }
    return vplPatchTree_Finish(&tree, result, patchesOut);
}

// ---- the longest edge first

// The length of a node's longest edge without its last six bits: edges that differ less are meant to be equal.
static float roundedEdge(const vplPatchTree* tree, int node)
{
    const vplTriangleCorners at = vplCornersOf(tree->positions, tree->nodes[node].corners);
    float length = (float)sqrt(vplPatch_SquaredEdge(&at));
    uint32_t bits;
    memcpy(&bits, &length, sizeof bits);
    bits &= ~(uint32_t)63;
    memcpy(&length, &bits, sizeof bits);
    return length;
}

static int roundsOf(const vplPatchTree* tree, int node)
{
    int rounds = 0;
    for (; node >= tree->rootCount; node = tree->nodes[node].parent) {
        rounds++;
    }
    return rounds;
}

vplResult vplPatchTree_BisectLongest(vplPatchTree* tree, const uint8_t* isKept, int more, int rounds)
{
    const size_t nodes = (size_t)tree->nodeCount + 2 * (size_t)more;
    float* lengths = vplArena_Alloc(tree->scratch, nodes, sizeof *lengths);
    Heap heap = {.priorities = lengths};
    heap.items = vplArena_Alloc(tree->scratch, nodes, sizeof *heap.items);
    TRY(vplArena_Check(tree->scratch));
    for (int i = 0; i < tree->nodeCount && rounds > 0; i++) {
        if (tree->nodes[i].children < 0 && vplCanBeHit(tree->geometry, tree->nodes[i].triangle) &&
            !(isKept != NULL && isKept[i])) {
            lengths[i] = roundedEdge(tree, i);
            add(&heap, i);
        }
    }
    while (more > 0 && heap.count > 0) {
        const int node = takeFirst(&heap), half = tree->nodeCount;
        if (!vplPatchTree_Bisect(tree, node, 0)) {
            continue;
        }
        more--;
        const bool last = roundsOf(tree, half) >= rounds;
        for (int i = half; i < half + 2 && !last; i++) {
            lengths[i] = roundedEdge(tree, i);
            add(&heap, i);
        }
    }
    return VPL_SUCCESS;
}

vplResult vplPatches_BisectLongest(const vplPatches* patches, const uint8_t* isKept, int count, int rounds,
                                   vplPatches** patchesOut)
{
    vplPatchTree tree = {.geometry = patches->geometry};
    const int more = vplMaxi(0, count - patches->patchCount);
    vplResult result = copyTree(patches, more, &tree);
    tree.rootCount = tree.nodeCount;
    if (result == VPL_SUCCESS) {
        result = vplPatchTree_BisectLongest(&tree, isKept, more, rounds);
    }
    return vplPatchTree_Finish(&tree, result, patchesOut);
}
