// SPDX-License-Identifier: MIT
// Builds the hierarchy. What is done side by side is cut by the number of triangles alone, and each task writes its
// own slots, so the tree does not depend on the number of workers.
#include "geometry/bvh.h"
#include "base/context.h"
#include "base/isa.h"
#include "geometry/bvh_build.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>

void vplBuilder_Run(const vplBuilder* builder, int count, vplTaskFcn* task, void* data)
{
    if (!builder->alone) {
        vplParallelFor(builder->geometry->context, count, task, data);
        return;
    }
    for (int i = 0; i < count; i++) {
        task(data, i, 0);
    }
}

// ---- the binary tree

// A subtree of `count` items has fewer than 2 count nodes; those of the items from `first` on have their place in
// the array at 2 first, after the nodes above all tasks.
typedef struct Task {
    vplBuildRange range, other; // other: the right half, while it is cut
    int parent, depth;
    bool isRight;
    vplBuildCosts costs;
} Task;

typedef struct Plan {
    const vplBuilder* builder;
    Task tasks[VPL_BUILD_TASKS];
    int taskCount, topCount;
    int cuts[VPL_BUILD_TASKS]; // tasks of a wave
} Plan;

static int placeOf(const vplBuildRange* range)
{
    return VPL_BUILD_TASKS + 2 * range->first;
}

static void setNode(const vplBuilder* b, int index, const vplBuildRange* range)
{
    b->binary[index] =
        (vplBinary){.box = range->box, .first = range->first, .count = range->count, .left = -1, .right = -1};
}

static float surfaceOf(const vplBuilder* b, const vplBinary* node)
{
    if (node->left >= 0) {
        return b->binary[node->left].surface + b->binary[node->right].surface;
    }
    float surface = 0;
    for (int i = node->first; i < node->first + node->count; i++) {
        surface += b->items[i].high[3] * b->unit * b->unit;
    }
    return surface;
}

// Builds the subtree of a range from place *next on.
static int buildRange(const vplBuilder* b, vplBuildRange range, int depth, int* next, vplBuildCosts* costs)
{
    const int index = (*next)++;
    vplBinary* node = &b->binary[index];
    setNode(b, index, &range);
    if (range.count <= VPL_BINARY_LEAF) {
        node->surface = surfaceOf(b, node);
        vplFindCosts(b, node, NULL, NULL, costs);
        return index;
    }
    vplBuildRange right;
    vplBuildCosts leftCosts, rightCosts;
    vplCutRange(b, &range, &right, depth);
    node->left = buildRange(b, range, depth + 1, next, &leftCosts);
    node->right = buildRange(b, right, depth + 1, next, &rightCosts);
    node->surface = surfaceOf(b, node);
    vplFindCosts(b, node, &leftCosts, &rightCosts, costs);
    return index;
}

static void buildTask(void* data, int index, int worker)
{
    (void)worker;
    Plan* plan = data;
    Task* task = &plan->tasks[index];
    int next = placeOf(&task->range);
    buildRange(plan->builder, task->range, task->depth, &next, &task->costs);
}

static void cutTask(void* data, int index, int worker)
{
    (void)worker;
    Plan* plan = data;
    Task* task = &plan->tasks[plan->cuts[index]];
    vplCutRange(plan->builder, &task->range, &task->other, task->depth);
}

// Makes a node of a task that was cut, a task of its left half and another one of its right half.
static void divideTask(Plan* plan, int index, const vplBuildRange* whole)
{
    const vplBuilder* b = plan->builder;
    Task* left = &plan->tasks[index];
    Task* right = &plan->tasks[plan->taskCount++];
    const int node = plan->topCount++;
    setNode(b, node, whole);
    if (left->parent >= 0) {
        *(left->isRight ? &b->binary[left->parent].right : &b->binary[left->parent].left) = node;
    }
    left->parent = node;
    left->depth++;
    left->isRight = false;
    *right = *left;
    right->range = left->other;
    right->isRight = true;
}

// Cuts all that are large, in waves. The nodes above the tasks come first in the array, parents first.
static void planTasks(Plan* plan, const vplBuildRange* all)
{
    const int share = all->count / (VPL_BUILD_TASKS / 2);
    const int large = share > VPL_TASK_LEAST ? share : VPL_TASK_LEAST;
    plan->tasks[0] = (Task){.range = *all, .parent = -1};
    plan->taskCount = 1;
    for (int count = 1; count > 0;) {
        vplBuildRange whole[VPL_BUILD_TASKS];
        count = 0;
        for (int i = 0; i < plan->taskCount && plan->taskCount + count < VPL_BUILD_TASKS; i++) {
            if (plan->tasks[i].range.count > large) {
                whole[count] = plan->tasks[i].range;
                plan->cuts[count++] = i;
            }
        }
        vplBuilder_Run(plan->builder, count, cutTask, plan);
        for (int i = 0; i < count; i++) {
            divideTask(plan, plan->cuts[i], &whole[i]);
        }
    }
}

// Hangs the tasks' subtrees below the top and finds its costs, children first.
static void joinTasks(const Plan* plan)
{
    const vplBuilder* b = plan->builder;
    vplBuildCosts top[VPL_BUILD_TASKS];
    const vplBuildCosts* halves[VPL_BUILD_TASKS][2];
    for (int i = 0; i < plan->taskCount; i++) {
        const Task* task = &plan->tasks[i];
        if (task->parent >= 0) {
            vplBinary* parent = &b->binary[task->parent];
            *(task->isRight ? &parent->right : &parent->left) = placeOf(&task->range);
            halves[task->parent][task->isRight] = &task->costs;
        }
    }
    for (int i = plan->topCount - 1; i >= 0; i--) {
        vplBinary* node = &b->binary[i];
        for (int half = 0; half < 2; half++) {
            const int child = half ? node->right : node->left;
            if (child < plan->topCount) {
                halves[i][half] = &top[child];
            }
        }
        node->surface = surfaceOf(b, node);
        vplFindCosts(b, node, halves[i][0], halves[i][1], &top[i]);
    }
}

static vplResult buildTree(vplBuilder* b, const vplBuildRange* all, vplBvh* bvh)
{
    vplContext* context = b->geometry->context;
    b->binary = vplAlloc(context, VPL_BUILD_TASKS + 2 * (size_t)all->count, sizeof *b->binary);
    Plan* plan = b->binary ? vplAllocZero(context, 1, sizeof *plan) : NULL;
    vplResult result = VPL_OUT_OF_MEMORY;
    if (plan != NULL) {
        plan->builder = b;
        planTasks(plan, all);
        vplBuilder_Run(b, plan->taskCount, buildTask, plan);
        joinTasks(plan);
        result = vplWiden(b, plan->topCount > 0 ? 0 : placeOf(all), bvh);
    }
    vplFree(context, plan);
    vplFree(context, b->binary);
    return result;
}

static vplResult build(vplBuilder* b, int bruteBlocks, vplBvh* bvh)
{
    vplBuildRange all;
    vplResult result = vplCollectItems(b, &all);
    if (result != VPL_SUCCESS || all.count == 0) {
        return result;
    }
    if ((all.count + VPL_BVH_WIDTH - 1) / VPL_BVH_WIDTH <= bruteBlocks) {
        return vplMakeBlocks(b, all.count, bvh);
    }
    float half = 0x1p-100f; // of the longest side; 1e38 and its double would be beyond all floats
    for (int axis = 0; axis < 3; axis++) {
        half = fmaxf(half, 0.5f * all.box.high[axis] - 0.5f * all.box.low[axis]);
    }
    b->unit = 0.5f / fminf(half, 0x1p127f);
    return buildTree(b, &all, bvh);
}

vplResult vplBvh_Create(const vplGeometry* geometry, int bruteBlocks, bool alone, vplBvh** bvhOut)
{
    vplContext* context = geometry->context;
    const size_t count = (size_t)geometry->triangleCount;
    vplBuilder b = {.geometry = geometry, .alone = alone};
    vplBvh* bvh = vplAllocZero(context, 1, sizeof *bvh);
    b.items = bvh ? vplAlloc(context, count, sizeof *b.items) : NULL;
    b.ids = b.items ? vplAlloc(context, count, sizeof *b.ids) : NULL;
    vplResult result = b.ids ? build(&b, bruteBlocks, bvh) : VPL_OUT_OF_MEMORY;
    vplFree(context, b.items);
    vplFree(context, b.ids);
    if (result != VPL_SUCCESS) {
        vplBvh_Destroy(context, bvh);
        return result;
    }
    *bvhOut = bvh;
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

// ---- kernels

// 512 bits are for lanes by the dozen: collecting eight flags from a mask register takes longer than from a vector,
// and boxes and triangles are tested one after another. AVX2 on the same processor (Zen 4) traces 1.05x of the rays
// of AVX-512, in packets 1.1x in Sponza and Sibenik, 0.85x in the room.
VPL_NARROW_KERNEL_TABLE(CLOSEST, vplTraceClosestFcn, vplTraceClosest);
VPL_NARROW_KERNEL_TABLE(ANY, vplTraceAnyFcn, vplTraceAny);
VPL_NARROW_KERNEL_TABLE(PACKET, vplTraceAnyPacketFcn, vplTraceAnyPacket);

vplTraceClosestFcn* vplGetTraceClosest(vplIsa isa)
{
    return CLOSEST[isa];
}

vplTraceAnyFcn* vplGetTraceAny(vplIsa isa)
{
    return ANY[isa];
}

vplTraceAnyPacketFcn* vplGetTraceAnyPacket(vplIsa isa)
{
    return PACKET[isa];
}
