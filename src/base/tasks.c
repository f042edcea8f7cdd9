// SPDX-License-Identifier: MIT
// Tasks run in any order on any worker, and no result may depend on either: each task writes to its own
// slots, and sums over tasks are taken afterwards, in task order.
#include "base/context.h"

#include <stdatomic.h>

#ifdef _OPENMP
#include <omp.h>
#endif

void vplParallelFor(vplContext* context, int count, vplTaskFcn* task, void* data)
{
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
        context->def.parallelFor(context->def.parallelForUser, count, workers, task, data);
        return;
    }
#ifdef _OPENMP
#pragma omp parallel for schedule(dynamic, 1) num_threads(workers)
    for (int i = 0; i < count; i++) {
        task(data, i, omp_get_thread_num());
    }
#endif
}

typedef struct Watched {
    vplTaskFcn* task;
    void* data;
    vplProgressRange range;
    int count;
    atomic_int done;
    atomic_bool cancelled;
} Watched;

// Worker 0 is the calling thread, so it alone calls `progress`.
static void watchedTask(void* data, int index, int worker)
{
    Watched* w = data;
    if (atomic_load_explicit(&w->cancelled, memory_order_relaxed)) {
        return;
    }
    w->task(w->data, index, worker);
    int done = 1 + atomic_fetch_add_explicit(&w->done, 1, memory_order_relaxed);
    const vplProgressRange* r = &w->range;
    if (worker == 0 && !r->progress(r->user, r->from + (r->to - r->from) * done / w->count)) {
        atomic_store_explicit(&w->cancelled, true, memory_order_relaxed);
    }
}

vplResult vplParallelForProgress(vplContext* context, int count, vplTaskFcn* task, void* data,
                                 vplProgressRange range)
{
    // A host's scheduler may run worker 0 on any thread: `progress` is called before and after only.
    bool hosted = context->def.parallelFor != NULL && context->workerCount > 1;
    if (range.progress == NULL || hosted) {
        if (range.progress != NULL && !range.progress(range.user, range.from)) {
            return VPL_CANCELLED;
        }
        vplParallelFor(context, count, task, data);
        return range.progress != NULL && !range.progress(range.user, range.to) ? VPL_CANCELLED : VPL_SUCCESS;
    }
    Watched watched = {task, data, range, count, 0, false};
    vplParallelFor(context, count, watchedTask, &watched);
    return atomic_load(&watched.cancelled) ? VPL_CANCELLED : VPL_SUCCESS;
}
