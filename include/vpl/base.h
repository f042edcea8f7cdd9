// SPDX-License-Identifier: MIT
// Results, messages, memory and threads: what every other header needs.
#ifndef VPL_BASE_H
#define VPL_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VPL_VERSION_MAJOR  0
#define VPL_VERSION_MINOR  1
#define VPL_VERSION_PATCH  0
#define VPL_VERSION_STRING "0.1.0"

// Largest width or height of an image, in pixels.
#define VPL_MAX_IMAGE_SIZE 16384
// Most virtual lights one render may hold.
#define VPL_MAX_LIGHTS (1 << 24)
// Most triangles one scene may hold.
#define VPL_MAX_TRIANGLES 2147483647
// Most worker threads one context may use.
#define VPL_MAX_WORKERS 1024

// What became of a call. Unless it is VPL_SUCCESS, every output parameter is untouched and one sentence that
// names the cause was given to the context's log first.
typedef enum vplResult {
    VPL_SUCCESS = 0,
    VPL_CANCELLED,        // the progress callback returned false
    VPL_OUT_OF_MEMORY,    // the allocator returned NULL
    VPL_INVALID_ARGUMENT, // a value is out of its documented range
    VPL_LIMIT,            // valid, but beyond a stated limit (lights, steps, triangles, bytes)
    VPL_FILE_ERROR,       // could not be opened, read, written or renamed
    VPL_PARSE_ERROR       // read, but its contents are not what they must be
} vplResult;

// The name of a result, such as "out of memory". Never NULL.
const char* vplResult_GetName(vplResult result);

typedef enum vplLogLevel { VPL_LOG_ERROR = 0, VPL_LOG_WARNING, VPL_LOG_INFO } vplLogLevel;

// Receives one message: a sentence without a line break, valid during the call only.
typedef void vplLogFcn(void* user, vplLogLevel level, const char* message);

// Lua's allocator contract. newSize 0 frees `memory` and returns NULL; `memory` NULL allocates; otherwise
// resizes. oldSize is the size `memory` was given. Alignment as malloc's. NULL means out of memory, and then
// the old block stays valid.
typedef void* vplAllocFcn(void* user, void* memory, size_t oldSize, size_t newSize);

// Runs one task. `worker` is in [0, workerCount) and no two tasks run under one worker at the same time.
typedef void vplTaskFcn(void* data, int task, int worker);

// Runs task(data, i, worker) for every i in [0, taskCount), in any order, on up to workerCount threads, and
// returns when all have ended. For hosts that have a job system of their own.
typedef void vplParallelForFcn(void* user, int taskCount, int workerCount, vplTaskFcn* task, void* data);

// Asked between steps of work, always on the thread that made the call. `fraction` is in [0, 1].
// Return false to cancel: the call then returns VPL_CANCELLED soon.
typedef bool vplProgressFcn(void* user, double fraction);

// Instruction sets that the hot loops are compiled for. All give the same bits.
typedef enum vplIsa {
    VPL_ISA_AUTO = 0, // the widest that this machine has
    VPL_ISA_SCALAR,   // plain C without vector instructions
    VPL_ISA_SSE2,     // the baseline of x86-64; on other machines, their own baseline
    VPL_ISA_AVX2,
    VPL_ISA_AVX512,
    VPL_ISA_COUNT
} vplIsa;

// "auto", "scalar", "sse2", "avx2" or "avx512".
const char* vplIsa_GetName(vplIsa isa);

typedef struct vplContextDef {
    vplAllocFcn* alloc;             // NULL (default): malloc, realloc and free
    void* allocUser;                // passed to alloc
    vplLogFcn* log;                 // NULL (default): silence
    void* logUser;                  // passed to log
    int workerCount;                // threads, [0, VPL_MAX_WORKERS]; 0 (default): one per processor
    vplIsa isa;                     // default VPL_ISA_AUTO; one this machine lacks is an error
    vplParallelForFcn* parallelFor; // NULL (default): OpenMP, or a plain loop where built without it
    void* parallelForUser;          // passed to parallelFor
    uint32_t cookie;                // set by vplDefaultContextDef; catches a def that was never filled in
} vplContextDef;

// A def with every field at its default.
vplContextDef vplDefaultContextDef(void);

// Owns memory, messages and threads. Everything else is made from a context and must be destroyed before it.
// One context may be used by one thread at a time; several contexts are independent.
typedef struct vplContext vplContext;

// Makes a context. `def` NULL means all defaults.
vplResult vplContext_Create(const vplContextDef* def, vplContext** contextOut);

// Destroys a context. NULL is allowed.
void vplContext_Destroy(vplContext* context);

// Bytes held now, and the most that were held at once since creation or the last reset.
size_t vplContext_GetBytes(const vplContext* context);
size_t vplContext_GetPeakBytes(const vplContext* context);
void vplContext_ResetPeakBytes(vplContext* context);

// The instruction set chosen (never AUTO) and the number of workers (never 0).
vplIsa vplContext_GetIsa(const vplContext* context);
int vplContext_GetWorkerCount(const vplContext* context);

// Writes a whole file: to a temporary name beside the target, checked, then renamed, so that the target is
// either its old self or complete. What is not a regular file (a device, a pipe) is written directly.
vplResult vplWriteFile(vplContext* context, const char* path, const void* bytes, size_t size);

// "0.1.0"
const char* vplGetVersion(void);

#ifdef __cplusplus
}
#endif

#endif
