// SPDX-License-Identifier: MIT
// Results, messages, memory and threads: what every other header needs.
//
// In all headers a pointer must not be NULL unless its function or field says that it may be; progress, user and data always
// may. Functions with a vplResult check their own arguments: NULL is VPL_INVALID_ARGUMENT, and the message names it. Others
// return 0, false, NULL or a struct of zeros for it, except those that loops call, whose comments say that pointers must not
// be NULL. tests/nulls calls every function with every wrong argument. Numbers in texts and files have decimal points
// in every locale. Functions with a vplResult, and tasks, compute in the default floating-point environment (rounding to nearest,
// denormals kept, no traps) and restore the program's; other functions compute in the program's.
#ifndef VPL_BASE_H
#define VPL_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// Every header's declarations have C linkage and are what the shared library exports.
#if defined(__GNUC__)
#define VPL_EXPORT_BEGIN _Pragma("GCC visibility push(default)")
#define VPL_EXPORT_END   _Pragma("GCC visibility pop")
#else
#define VPL_EXPORT_BEGIN
#define VPL_EXPORT_END
#endif
#ifdef __cplusplus
#define VPL_HEADER_BEGIN                                                                                     \
    extern "C" {                                                                                             \
    VPL_EXPORT_BEGIN
#define VPL_HEADER_END                                                                                       \
    VPL_EXPORT_END                                                                                           \
    }
#else
#define VPL_HEADER_BEGIN VPL_EXPORT_BEGIN
#define VPL_HEADER_END   VPL_EXPORT_END
#endif

VPL_HEADER_BEGIN

#define VPL_VERSION_MAJOR  0
#define VPL_VERSION_MINOR  12
#define VPL_VERSION_PATCH  0
#define VPL_VERSION_STRING "0.12.0"

// Largest width or height of an image, in pixels.
#define VPL_MAX_IMAGE_SIZE 16384
// Largest vplOutputOptions.pixelSize: the side of the squares of pixels that are rendered as one pixel.
#define VPL_MAX_PIXEL_SIZE 64
// Most virtual lights one render may hold.
#define VPL_MAX_LIGHTS (1 << 24)
// Most triangles one scene may hold.
#define VPL_MAX_TRIANGLES 2147483647
// Most worker threads one context may use.
#define VPL_MAX_WORKERS 1024

// The result of a call. On failure, all output parameters are untouched, and one sentence that names the cause
// goes to the context's log and to vplContext_GetLastMessage.
typedef enum vplResult {
    VPL_SUCCESS = 0,
    VPL_CANCELLED,        // the progress callback returned false
    VPL_OUT_OF_MEMORY,    // the allocator returned NULL
    VPL_INVALID_ARGUMENT, // a value is out of its documented range
    VPL_LIMIT,            // a value is valid but exceeds a limit (lights, steps, triangles, bytes)
    VPL_FILE_ERROR,       // a file could not be opened, read, written or renamed
    VPL_PARSE_ERROR       // a file was read, but its contents are invalid
} vplResult;

// The name of a result, such as "out of memory". Never NULL.
const char* vplResult_GetName(vplResult result);

typedef enum vplLogLevel { VPL_LOG_ERROR = 0, VPL_LOG_WARNING, VPL_LOG_INFO } vplLogLevel;

// Receives one message, a sentence without a line break. The text is valid during the call only.
typedef void vplLogFcn(void* user, vplLogLevel level, const char* message);

// A log for vplContextDef.log: writes errors and warnings to stderr, one line each. If `user` is not NULL it also
// writes notes (VPL_LOG_INFO).
void vplLogToStderr(void* user, vplLogLevel level, const char* message);

// An allocator with the contract of Lua's. If newSize is 0, frees `memory` and returns NULL; if `memory` is
// NULL, allocates; otherwise resizes. oldSize is the size that `memory` has. Blocks are aligned like
// malloc's. Returns NULL when out of memory; the old block then stays valid.
typedef void* vplAllocFcn(void* user, void* memory, size_t oldSize, size_t newSize);

// Runs one task. `worker` is in [0, workerCount) and no two tasks run under one worker at the same time.
typedef void vplTaskFcn(void* data, int task, int worker);

// Runs task(data, i, worker) for every i in [0, taskCount), in any order, on up to workerCount threads, and
// returns when all tasks have ended. For hosts with a job system of their own.
typedef void vplParallelForFcn(void* user, int taskCount, int workerCount, vplTaskFcn* task, void* data);

// Called between steps of work, always on the thread that made the call. `fraction` is in [0, 1]. Return
// false to cancel: the call then returns VPL_CANCELLED soon.
typedef bool vplProgressFcn(void* user, double fraction);

// Instruction sets that hot loops are compiled for. All give the same bits.
typedef enum vplIsa {
    VPL_ISA_AUTO = 0, // the widest that the machine has
    VPL_ISA_SCALAR,   // no vector instructions
    VPL_ISA_SSE2,     // the baseline of x86-64; elsewhere the machine's own baseline
    VPL_ISA_AVX2,
    VPL_ISA_AVX512,
    VPL_ISA_COUNT
} vplIsa;

typedef struct vplContextDef {
    vplAllocFcn* alloc;             // NULL (default): malloc, realloc and free
    void* allocUser;                // passed to alloc
    vplLogFcn* log;                 // NULL (default): silence; vplLogToStderr, or a function of the caller's
    void* logUser;                  // passed to log
    int workerCount;                // threads, [0, VPL_MAX_WORKERS]; 0 (default): one per processor
    vplIsa isa;                     // default VPL_ISA_AUTO; an error if the machine lacks it
    vplParallelForFcn* parallelFor; // NULL (default): OpenMP, or a plain loop in a build without it
    void* parallelForUser;          // passed to parallelFor
    uint32_t cookie;                // set by vplDefaultContextDef; detects defs that were not initialised
} vplContextDef;

// A def with every field at its default.
vplContextDef vplDefaultContextDef(void);

// Owns memory, messages and threads. Other objects are created from a context and must be destroyed before
// it. Only one thread at a time may use a context; contexts are independent of each other. A thread that calls the library,
// or runs tasks for parallelFor, needs a stack of 256 KiB.
typedef struct vplContext vplContext;

// Creates a context. `def` NULL means all defaults. VPL_INVALID_ARGUMENT for a def out of range,
// VPL_OUT_OF_MEMORY.
//
// The ABI of the library is its major and minor version: within one, sizes and fields of structs and what functions take
// stay as they are, and so does the soname. vplContextDef keeps its layout in all versions.
vplResult vplContext_Create(const vplContextDef* def, vplContext** contextOut);

// What vplContext_Create calls, with the version of the headers that the program was built with. Any other major or minor
// version than the library's is VPL_INVALID_ARGUMENT, because structs may differ. For other languages. def NULL means all
// defaults.
vplResult vplContext_CreateForAbi(int major, int minor, const vplContextDef* def, vplContext** contextOut);
#define vplContext_Create(def, contextOut)                                                                   \
    vplContext_CreateForAbi(VPL_VERSION_MAJOR, VPL_VERSION_MINOR, def, contextOut)

// Destroys a context. NULL is allowed.
void vplContext_Destroy(vplContext* context);

// The sentence of the last call that failed, "" before one does; NULL as context is allowed and gives "". The context owns
// the text, which stays until a call fails again. Texts of more than 4,000 bytes lack their middle.
const char* vplContext_GetLastMessage(const vplContext* context);

// Sets the function by which calls without a progress argument, such as those that read scenes and pictures, can be
// cancelled. They call it with a fraction of 0, also while a pipe that they read is silent, and return VPL_CANCELLED when
// it returns false. NULL (default): nothing is called. Renders call vplRenderOptions.progress instead. `progress` is called
// on the thread that made the call.
void vplContext_SetProgress(vplContext* context, vplProgressFcn* progress, void* user);

// A file in memory. `path` is the name by which it is looked for.
typedef struct vplMemoryFile {
    const char* path;
    const void* bytes; // read only; need not end in 0
    size_t size;
} vplMemoryFile;

// The version of the library, VPL_VERSION_STRING of its headers.
const char* vplGetVersion(void);

VPL_HEADER_END

#endif
