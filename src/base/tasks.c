// SPDX-License-Identifier: MIT
// Tasks run in any order on any worker, and no result may depend on either: each task writes to its own
// slots, and sums over tasks are taken afterwards, in task order.
#include "base/context.h"

#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

typedef struct Tasks {
    vplTaskFcn* task;
    void* data;
} Tasks;

// Runs a task in the default floating-point environment: each thread has an environment of its own.
static void plainTask(void* data, int index, int worker)
{
    PLAIN_FLOATS;
    const Tasks* t = data;
    t->task(t->data, index, worker);
}

void vplParallelFor(vplContext* context, int count, vplTaskFcn* task, void* data)
{
    Tasks tasks = {task, data};
    int workers = context->workerCount < count ? context->workerCount : count;
#ifndef _OPENMP
    workers = context->def.parallelFor != NULL ? workers : 1;
#endif
    if (workers <= 1) {
        for (int i = 0; i < count; i++) {
            task(data, i, 0);
        }
        return;
    }
    if (context->def.parallelFor != NULL) {
        context->def.parallelFor(context->def.parallelForUser, count, workers, plainTask, &tasks);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 1) num_threads(workers)
    for (int i = 0; i < count; i++) {
        plainTask(&tasks, i, omp_get_thread_num());
    }
#endif
}

// ---- asking

vplWatch vplSetWatch(vplContext* context, vplProgressFcn* progress, void* user, double fraction)
{
    const vplWatch before = context->watch;
    context->watch = (vplWatch){progress, user, fraction, pthread_self()};
    return before;
}

void vplContext_SetProgress(vplContext* context, vplProgressFcn* progress, void* user)
{
    if (context == NULL) {
        return;
    }
    vplSetWatch(context, progress, user, 0);
}

vplResult vplAsk(vplContext* context)
{
    const vplWatch* w = &context->watch;
    return w->progress == NULL || w->progress(w->user, w->fraction) ? VPL_SUCCESS : VPL_CANCELLED;
}

bool vplTask_GoesOn(vplContext* context)
{
    const vplWatch* w = &context->watch;
    const bool cancelled = atomic_load_explicit(&context->cancelled, memory_order_relaxed);
    if (cancelled || w->progress == NULL || !pthread_equal(w->thread, pthread_self())) {
        return !cancelled;
    }
    const bool goesOn = vplAsk(context) == VPL_SUCCESS;
    if (!goesOn) {
        atomic_store_explicit(&context->cancelled, true, memory_order_relaxed);
    }
    return goesOn;
}

typedef struct Watched {
    vplContext* context;
    vplTaskFcn* task;
    void* data;
    vplProgressRange range;
    int count;
    atomic_int done;
} Watched;

static void watchedTask(void* data, int index, int worker)
{
    Watched* w = data;
    if (atomic_load_explicit(&w->context->cancelled, memory_order_relaxed)) {
        return;
    }
    w->task(w->data, index, worker);
    const int done = 1 + atomic_fetch_add_explicit(&w->done, 1, memory_order_relaxed);
    if (pthread_equal(w->context->watch.thread, pthread_self())) {
        w->context->watch.fraction = w->range.from + (w->range.to - w->range.from) * done / w->count;
        vplTask_GoesOn(w->context);
    }
}

vplResult vplParallelForProgress(vplContext* context, int count, vplTaskFcn* task, void* data,
                                 vplProgressRange range)
{
    if (range.progress == NULL) {
        const vplWatch* w = &context->watch;
        range = (vplProgressRange){w->progress, w->user, w->fraction, w->fraction};
    }
    vplWatch outer = vplSetWatch(context, range.progress, range.user, range.from);
    Watched watched = {context, task, data, range, count, 0};
    // A host may run all tasks on threads of its own.
    const bool hosted = context->def.parallelFor != NULL && context->workerCount > 1;
    bool cancelled = hosted && vplAsk(context) != VPL_SUCCESS;
    if (!cancelled) {
        vplParallelFor(context, count, range.progress != NULL ? watchedTask : task,
                       range.progress != NULL ? &watched : data);
        context->watch.fraction = hosted ? range.to : context->watch.fraction;
        cancelled = atomic_exchange(&context->cancelled, false) || (hosted && vplAsk(context) != VPL_SUCCESS);
    }
    outer.fraction = outer.progress == range.progress && outer.user == range.user ? range.to : outer.fraction;
    context->watch = outer;
    return cancelled ? VPL_CANCELLED : VPL_SUCCESS;
}

vplResult vplParallelForAsking(vplContext* context, int count, vplTaskFcn* task, void* data)
{
    return vplParallelForProgress(context, count, task, data, (vplProgressRange){.progress = NULL});
}

vplResult vplClear(vplContext* context, void* memory, size_t bytes)
{
    enum { PIECE = 2 << 20 }; // 0.5 ms; 5 to 15 where a virtual machine's host finds the memory first
    for (size_t at = 0; at < bytes; at += PIECE) {
        memset((char*)memory + at, 0, bytes - at < PIECE ? bytes - at : PIECE);
        if (vplAsk(context) != VPL_SUCCESS) {
            return VPL_CANCELLED;
        }
    }
    return VPL_SUCCESS;
}
