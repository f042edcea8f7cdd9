// SPDX-License-Identifier: MIT
// The context from the inside: memory, messages and tasks.
#ifndef VPL_BASE_CONTEXT_H
#define VPL_BASE_CONTEXT_H

#include <vpl/base.h>

struct vplContext {
    vplContextDef def;
    vplIsa isa;
    int workerCount;
    // Bytes held now, and the most held at once. Not atomic: parallel sections do not allocate.
    size_t bytes, peakBytes;
    uint64_t stamps;          // see vplNextStamp
    struct vplSpeeds* speeds; // see vplContext_SetSpeeds; NULL: as usual
};

// Returns a different number each time. Identifies an object, or one state of it.
uint64_t vplNextStamp(vplContext* context);

// ---- messages

#if defined(__GNUC__)
#define VPL_PRINTF(text, first) __attribute__((format(printf, text, first)))
#else
#define VPL_PRINTF(text, first)
#endif

void vplLog(const vplContext* context, vplLogLevel level, const char* format, ...) VPL_PRINTF(3, 4);

// Logs an error message and returns `result`, so that a check is one statement.
vplResult vplFail(const vplContext* context, vplResult result, const char* format, ...) VPL_PRINTF(3, 4);

// ---- memory: 64-byte aligned, counted, overflow-checked

// Memory for `count` elements of `size` bytes: uninitialised, or zeros. Logs and returns NULL when out of
// memory. A count of 0 gives a valid pointer.
void* vplAlloc(vplContext* context, size_t count, size_t size);
void* vplAllocZero(vplContext* context, size_t count, size_t size);

// Makes *array hold at least `count` elements; grows by half, so that appending takes linear time. On failure
// *array is as it was.
vplResult vplReserve(vplContext* context, void* array, size_t* capacity, size_t count, size_t size);

// The new capacity of an array that must hold `count` elements and holds `capacity` now.
size_t vplGrownCapacity(size_t capacity, size_t count);

// NULL is allowed.
void vplFree(vplContext* context, void* memory);

// Bytes that the context holds for one allocation.
size_t vplAllocatedBytes(const void* memory);

// ---- tasks

// Runs task(data, i, worker) for i in [0, count), on the calling thread if there is one worker or one task.
void vplParallelFor(vplContext* context, int count, vplTaskFcn* task, void* data);

// The part of a longer job that a loop does: `progress` (may be NULL) is called with fractions that grow from
// `from` to `to`.
typedef struct vplProgressRange {
    vplProgressFcn* progress;
    void* user;
    double from, to;
} vplProgressRange;

// vplParallelFor that calls range.progress on the calling thread as tasks end. Returns VPL_CANCELLED if that
// returned false, else VPL_SUCCESS.
vplResult vplParallelForProgress(vplContext* context, int count, vplTaskFcn* task, void* data,
                                 vplProgressRange range);

#endif
