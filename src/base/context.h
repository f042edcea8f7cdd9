// SPDX-License-Identifier: MIT
// The context from the inside: memory, messages and tasks.
#ifndef VPL_BASE_CONTEXT_H
#define VPL_BASE_CONTEXT_H

#include <vpl/machine.h>

#include "base/floats.h"

#include <pthread.h>
#include <stdatomic.h>

// Who is asked whether the work under way goes on.
typedef struct vplWatch {
    vplProgressFcn* progress; // NULL: nobody
    void* user;
    double fraction;  // that was reported last
    pthread_t thread; // that alone may ask
} vplWatch;

enum { VPL_LAST_MESSAGE = 4096 };

struct vplContext {
    vplContextDef def;
    char* lastMessage; // VPL_LAST_MESSAGE bytes behind the context; NULL: none is kept
    vplIsa isa;
    int workerCount;
    // Bytes held now, and the most held at once. Not atomic: parallel sections do not allocate.
    size_t bytes, peakBytes;
    size_t memoryLimit; // of plans, bytes; 0: none
    vplWatch watch;
    atomic_bool cancelled;    // the loop of tasks under way
    uint64_t stamps;          // see vplNextStamp
    struct vplSpeeds* speeds; // see vplContext_SetSpeeds; NULL: as usual
    // Files in memory, which are read instead of those on disk: see vplContext_SetFiles.
    const vplMemoryFile* files;
    int fileCount;
    vplFileFcn* fileObserver; // see vplContext_SetFileObserver
    void* fileUser;
    vplTeam team;         // see vplContext_SetTeam; count 0: none
    vplResult teamResult; // the worst of its members so far
    void* teamRoom;       // for headers of messages
};

// Returns a different number each time. Identifies an object, or one state of it.
uint64_t vplNextStamp(vplContext* context);

// ---- messages

#if defined(__MINGW32__)
#define VPL_PRINTF_KIND gnu_printf // of __USE_MINGW_ANSI_STDIO, which knows %zu
#else
#define VPL_PRINTF_KIND printf
#endif
#if defined(__GNUC__)
#define VPL_PRINTF(text, first) __attribute__((format(VPL_PRINTF_KIND, text, first)))
#else
#define VPL_PRINTF(text, first)
#endif

void vplLog(const vplContext* context, vplLogLevel level, const char* format, ...) VPL_PRINTF(3, 4);

// Logs an error message and returns `result`, so that a check is one statement.
vplResult vplFail(const vplContext* context, vplResult result, const char* format, ...) VPL_PRINTF(3, 4);

// ---- arguments of public functions

// The context of an object; NULL for NULL.
#define CONTEXT_OF(object) ((object) != NULL ? (object)->context : NULL)

// Returns VPL_INVALID_ARGUMENT from the calling function, with a sentence that names it and the argument, if one of up to
// six pointers is NULL.
#define CHECK_POINTERS(context, ...)                                                                         \
    do {                                                                                                     \
        const void* const required[] = {__VA_ARGS__};                                                        \
        if (!vplCheckPointers((context), __func__, #__VA_ARGS__, required,                                   \
                              sizeof required / sizeof required[0])) {                                       \
            return VPL_INVALID_ARGUMENT;                                                                     \
        }                                                                                                    \
    } while (0)

// CHECK_POINTERS at the beginning of a public function, which then computes with PLAIN_FLOATS.
#define REQUIRE(context, ...)                                                                                \
    PLAIN_FLOATS;                                                                                            \
    CHECK_POINTERS(context, __VA_ARGS__)

// CHECK_POINTERS for an array, which may be NULL if it has no elements. Negative counts are left to others.
#define REQUIRE_ARRAY(context, array, count)                                                                 \
    do {                                                                                                     \
        if ((count) > 0) {                                                                                   \
            CHECK_POINTERS(context, array);                                                                  \
        }                                                                                                    \
    } while (0)

// False, after an error message, if a pointer is NULL. `names` are those of the pointers, with commas between them.
bool vplCheckPointers(const vplContext* context, const char* function, const char* names,
                      const void* const* pointers, size_t count);

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

// The number of chunks of `size` that `count` elements make, and the end of the chunk that begins at `first`. Neither overflows.
static inline int vplCountChunks(int count, int size)
{
    return count / size + (count % size > 0);
}

static inline int vplEndOfChunk(int count, int first, int size)
{
    return count - first < size ? count : first + size;
}

// The part of a longer job that a loop does: `progress` (may be NULL) is called with fractions that grow from
// `from` to `to`.
typedef struct vplProgressRange {
    vplProgressFcn* progress;
    void* user;
    double from, to;
} vplProgressRange;

// vplParallelFor that calls range.progress on the calling thread as tasks end; without one it asks the watch.
// Returns VPL_CANCELLED if that returned false, else VPL_SUCCESS.
vplResult vplParallelForProgress(vplContext* context, int count, vplTaskFcn* task, void* data,
                                 vplProgressRange range);

// ---- cancellation
//
// A renderer sets the watch of the context for each of its stages. Stages need no progress of their own to be
// cancelled: whatever takes longer than about 50 ms asks in one of these ways.

// Makes the calling thread ask `progress` (NULL: nobody). Returns the watch before, which the caller puts back.
vplWatch vplSetWatch(vplContext* context, vplProgressFcn* progress, void* user, double fraction);

// Returns VPL_CANCELLED if the watch says so. Only for the calling thread, between loops of tasks.
vplResult vplAsk(vplContext* context);

// vplParallelFor that asks as tasks end.
vplResult vplParallelForAsking(vplContext* context, int count, vplTaskFcn* task, void* data);

// Asks from within a long task of vplParallelForProgress or vplParallelForAsking, on any thread. If it returns
// false the task shall end at once; its result is not used.
bool vplTask_GoesOn(vplContext* context);

// Fills memory with zeros and asks on the way, because a fresh gigabyte takes seconds.
vplResult vplClear(vplContext* context, void* memory, size_t bytes);

#endif
