// SPDX-License-Identifier: MIT
// Bisects the patches of the highest refinement priority, or with the longest edges.
#include "geometry/bvh.h"
#include "geometry/patch_tree.h"
#include "geometry/triangle.h"
#include "math/scalar.h"

#include <string.h>

// A heap of patches or nodes: the largest priority first, among equal ones the largest area, then the lowest index.
typedef struct Heap {
    const float* priorities;
    const float* areas; // NULL: all equal
    int* items;
    int count;
} Heap;

static bool comesBefore(const Heap* heap, int a, int b)
{
    if (heap->priorities[a] != heap->priorities[b]) {
        return heap->priorities[a] > heap->priorities[b];
    }
    if (heap->areas != NULL && heap->areas[a] != heap->areas[b]) {
        return heap->areas[a] > heap->areas[b];
    }
    return a < b;
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

// A number rounded to 12 bits: lengths and areas that differ less are meant to be equal, and which of them is larger must not
// depend on where the scene is.
static float rounded(double number)
{
    const float value = (float)number;
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    bits = (bits + 0x800) & ~(uint32_t)0xfff;
    float result;
    memcpy(&result, &bits, sizeof result);
    return result;
}

static int roundsOf(const vplPatchTree* tree, int node)
{
    int rounds = 0;
    for (; node >= tree->rootCount; node = tree->nodes[node].parent) {
        rounds++;
    }
    return rounds;
}

static void addNode(const vplPatchTree* tree, int node, float* lengths, float* areas, Heap* heap)
{
    const vplTriangleCorners at = vplCornersOf(tree->positions, tree->nodes[node].corners);
    lengths[node] = rounded(sqrt(vplPatch_SquaredEdge(&at)));
    areas[node] = rounded(vplTriangle_Area(&at));
    add(heap, node);
}

static bool bisect(vplPatchTree* tree, int node, int rounds, float* lengths, float* areas, Heap* heap)
{
    const int half = tree->nodeCount;
    if (!vplPatchTree_Bisect(tree, node, 0)) {
        return false;
    }
    const bool last = roundsOf(tree, half) >= rounds;
    for (int i = half; i < half + 2 && !last; i++) {
        addNode(tree, i, lengths, areas, heap);
    }
    return true;
}

// Returns how many nodes are as long and as large as the first.
static int countEqual(const Heap* heap)
{
    int count = 0;
    for (int i = 0; i < heap->count; i++) {
        const int first = heap->items[0], other = heap->items[i];
        count +=
            heap->priorities[other] == heap->priorities[first] && heap->areas[other] == heap->areas[first];
    }
    return count;
}

vplResult vplPatchTree_BisectLongest(vplPatchTree* tree, const uint8_t* isKept, int more, int rounds)
{
    const size_t nodes = (size_t)tree->nodeCount + 2 * ((size_t)more + (size_t)vplSparePatches(more));
    float* lengths = vplArena_Alloc(tree->scratch, nodes, sizeof *lengths);
    float* areas = vplArena_Alloc(tree->scratch, nodes, sizeof *areas);
    Heap heap = {.priorities = lengths, .areas = areas};
    heap.items = vplArena_Alloc(tree->scratch, nodes, sizeof *heap.items);
    TRY(vplArena_Check(tree->scratch));
    for (int i = 0; i < tree->nodeCount && rounds > 0; i++) {
        if (tree->nodes[i].children < 0 && vplCanBeHit(tree->geometry, tree->nodes[i].triangle) &&
            !(isKept != NULL && isKept[i])) {
            addNode(tree, i, lengths, areas, &heap);
        }
    }
    const int spare = vplSparePatches(more);
    int equal = 0;
    while (more > 0 && heap.count > 0) {
        const float length = lengths[heap.items[0]], area = areas[heap.items[0]];
        more -= bisect(tree, takeFirst(&heap), rounds, lengths, areas, &heap);
        const bool divides =
            more == 0 && heap.count > 0 && lengths[heap.items[0]] == length && areas[heap.items[0]] == area;
        equal = divides ? countEqual(&heap) : 0;
    }
    for (int i = 0; i < equal && equal <= spare; i++) {
        bisect(tree, takeFirst(&heap), rounds, lengths, areas, &heap);
    }
    return VPL_SUCCESS;
}

vplResult vplPatches_BisectLongest(const vplPatches* patches, const uint8_t* isKept, int count, int rounds,
                                   vplPatches** patchesOut)
{
    vplPatchTree tree = {.geometry = patches->geometry};
    const int more = vplMaxi(0, count - patches->patchCount);
    vplResult result = copyTree(patches, more + vplSparePatches(more), &tree);
    tree.rootCount = tree.nodeCount;
    if (result == VPL_SUCCESS) {
        result = vplPatchTree_BisectLongest(&tree, isKept, more, rounds);
    }
    return vplPatchTree_Finish(&tree, result, patchesOut);
}
