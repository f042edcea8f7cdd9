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
    const int more = vplMaxi(0, vplMini(patches->patchCount, count - patches->patchCount));
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

// A tree whose longest leaves are bisected first. Lengths and areas are those of nodes, rounded.
typedef struct Longest {
    vplPatchTree* tree;
    float *lengths, *areas;
    Heap heap; // of leaves that may be bisected
    int rounds;
} Longest;

static void addNode(Longest* l, int node)
{
    const vplTriangleCorners at = vplCornersOf(l->tree->positions, l->tree->nodes[node].corners);
    l->lengths[node] = rounded(sqrt(vplPatch_SquaredEdge(&at)));
    l->areas[node] = rounded(vplTriangle_Area(&at));
    add(&l->heap, node);
}

// Bisects the first leaf. False where it has no middle.
static bool bisectNext(Longest* l)
{
    const int node = takeFirst(&l->heap), half = l->tree->nodeCount;
    if (!vplPatchTree_Bisect(l->tree, node, 0)) {
        return false;
    }
    const bool last = roundsOf(l->tree, half) >= l->rounds;
    for (int i = half; i < half + 2 && !last; i++) {
        addNode(l, i);
    }
    return true;
}

static int countEqual(const Longest* l, float length, float area)
{
    int count = 0;
    for (int i = 0; i < l->heap.count; i++) {
        const int node = l->heap.items[i];
        count += l->lengths[node] == length && l->areas[node] == area;
    }
    return count;
}

vplResult vplPatchTree_BisectLongest(vplPatchTree* tree, const uint8_t* isKept, int more, int rounds)
{
    const int spare = vplSparePatches(more);
    const size_t nodes = (size_t)tree->nodeCount + 2 * ((size_t)more + (size_t)spare);
    Longest l = {.tree = tree, .rounds = rounds};
    l.heap.priorities = l.lengths = vplArena_Alloc(tree->scratch, nodes, sizeof *l.lengths);
    l.heap.areas = l.areas = vplArena_Alloc(tree->scratch, nodes, sizeof *l.areas);
    l.heap.items = vplArena_Alloc(tree->scratch, nodes, sizeof *l.heap.items);
    TRY(vplArena_Check(tree->scratch));
    for (int i = 0; i < tree->nodeCount && rounds > 0; i++) {
        if (tree->nodes[i].children < 0 && vplCanBeHit(tree->geometry, tree->nodes[i].triangle) &&
            !(isKept != NULL && isKept[i])) {
            addNode(&l, i);
        }
    }
    float length = 0, area = 0; // of the last leaf that was bisected
    while (more > 0 && l.heap.count > 0) {
        length = l.lengths[l.heap.items[0]];
        area = l.areas[l.heap.items[0]];
        more -= bisectNext(&l);
    }
    const int equal = countEqual(&l, length, area);
    for (int i = 0; i < equal && equal <= spare; i++) {
        bisectNext(&l);
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
