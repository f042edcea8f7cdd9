// SPDX-License-Identifier: MIT
// The context from the inside: memory, messages and tasks for all layers above.
#ifndef VPL_BASE_CONTEXT_H
#define VPL_BASE_CONTEXT_H

#include <vpl/base.h>

struct vplContext {
    vplContextDef def;
    vplIsa isa;
    int workerCount;
    // Bytes held now, and most at once. Allocation happens outside parallel sections, so plain counters do.
    size_t bytes, peakBytes;
    uint64_t stamps; // handed out so far, see vplNextStamp
};

// Another number each time, to tell one thing, or one state of it, from another.
uint64_t vplNextStamp(vplContext* context);

// ---- messages

#if defined(__GNUC__)
#define VPL_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define VPL_PRINTF(text, first)
#endif

void vplLog(const vplContext* context, vplLogLevel level, const char* format, ...) VPL_PRINTF(3, 4);

// Logs the sentence as an error and returns `result`, so that a check is one line.
vplResult vplFail(const vplContext* context, vplResult result, const char* format, ...) VPL_PRINTF(3, 4);

// ---- memory: 64-byte aligned, counted, overflow-checked

// Room for count elements of `size` bytes, uninitialised. Logs and returns NULL when out of memory. A count
// of 0 gives a valid pointer.
void* vplAlloc(vplContext* context, size_t count, size_t size);

// As vplAlloc, filled with zeros.
void* vplAllocZero(vplContext* context, size_t count, size_t size);

// Makes *array hold at least `count` elements, growing by half so that appending stays linear. On failure
// the array is as it was and the result is VPL_OUT_OF_MEMORY.
vplResult vplReserve(vplContext* context, void* array, size_t* capacity, size_t count, size_t size);

// NULL is allowed.
void vplFree(vplContext* context, void* memory);

// A copy of a string in context memory; NULL when out of memory.
char* vplCopyString(vplContext* context, const char* text);

// ---- tasks

// Runs task(data, i, worker) for i in [0, count). Falls back to the calling thread for one worker or task.
void vplParallelFor(vplContext* context, int count, vplTaskFcn* task, void* data);

// The same, asking `progress` (may be NULL) on the calling thread as tasks end; fractions run from `from` to
// `to`. Returns VPL_CANCELLED when it said stop, else VPL_SUCCESS.
vplResult vplParallelForProgress(vplContext* context, int count, vplTaskFcn* task, void* data,
                                 vplProgressFcn* progress, void* user, double from, double to);

#endif
