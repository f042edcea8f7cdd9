// SPDX-License-Identifier: MIT
#include "base/arena.h"
#include "base/isa.h"
#include "base/numbers.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#ifdef __linux__
#include <sys/mman.h>
#endif
#include <string.h>

#ifdef _OPENMP
#include <omp.h>
#endif

enum { CONTEXT_COOKIE = 0x56504c31 };

static const size_t CONTEXT_BYTES = sizeof(vplContext) + VPL_LAST_MESSAGE;

const char* vplGetVersion(void)
{
    return VPL_VERSION_STRING;
}

const char* vplResult_GetName(vplResult result)
{
    static const char* const names[] = {
        [VPL_SUCCESS] = "success",
        [VPL_CANCELLED] = "cancelled",
        [VPL_OUT_OF_MEMORY] = "out of memory",
        [VPL_INVALID_ARGUMENT] = "invalid argument",
        [VPL_LIMIT] = "limit exceeded",
        [VPL_FILE_ERROR] = "file error",
        [VPL_PARSE_ERROR] = "parse error",
    };
    return (int)result >= 0 && (int)result <= VPL_PARSE_ERROR ? names[result] : "unknown result";
}

vplContextDef vplDefaultContextDef(void)
{
    return (vplContextDef){.cookie = CONTEXT_COOKIE};
}

static void* defaultAlloc(void* user, void* memory, size_t oldSize, size_t newSize)
{
    (void)user;
    (void)oldSize;
    if (newSize == 0) {
        free(memory);
        return NULL;
    }
#ifdef MADV_HUGEPAGE
    // Huge pages save page faults: `vpl render examples/scenes/room.json --size 1920x1080` takes 21 % less
    // processor time with them.
    const size_t huge = 2u << 20;
    if (memory == NULL && newSize >= huge && posix_memalign(&memory, huge, newSize) == 0) {
        (void)madvise(memory, newSize, MADV_HUGEPAGE); // may fail: 4 KB pages do as well
        return memory;
    }
#endif
    return realloc(memory, newSize);
}

static int defaultWorkerCount(void)
{
#ifdef _OPENMP
    int count = omp_get_num_procs();
    return count < 1 ? 1 : count > VPL_MAX_WORKERS ? VPL_MAX_WORKERS : count;
#else
    return 1;
#endif
}

static vplResult checkAbi(const vplContext* draft, int major, int minor)
{
    return major == VPL_VERSION_MAJOR && minor == VPL_VERSION_MINOR
               ? VPL_SUCCESS
               : vplFail(draft, VPL_INVALID_ARGUMENT,
                         "vplContext_Create: the program was built with headers of libvpl %d.%d, the library "
                         "is %s",
                         major, minor, VPL_VERSION_STRING);
}

// The public name, for programs that link without the header's macro.
vplResult(vplContext_Create)(const vplContextDef* def, vplContext** contextOut)
{
    return vplContext_CreateForAbi(VPL_VERSION_MAJOR, VPL_VERSION_MINOR, def, contextOut);
}

vplResult vplContext_CreateForAbi(int major, int minor, const vplContextDef* def, vplContext** contextOut)
{
    vplContext draft = {.def = def ? *def : vplDefaultContextDef()};
    if (draft.def.cookie != CONTEXT_COOKIE) {
        return VPL_INVALID_ARGUMENT; // not initialised: its log callback cannot be trusted either
    }
    TRY(checkAbi(&draft, major, minor));
    if (contextOut == NULL) {
        return vplFail(&draft, VPL_INVALID_ARGUMENT, "vplContext_Create: contextOut is NULL");
    }
    if (draft.def.alloc == NULL) {
        draft.def.alloc = defaultAlloc;
    }
    if (draft.def.workerCount < 0 || draft.def.workerCount > VPL_MAX_WORKERS) {
        return vplFail(&draft, VPL_INVALID_ARGUMENT, "vplContextDef.workerCount is %d, must be in [0, %d]",
                       draft.def.workerCount, VPL_MAX_WORKERS);
    }
    draft.workerCount = draft.def.workerCount ? draft.def.workerCount : defaultWorkerCount();
    draft.isa = draft.def.isa == VPL_ISA_AUTO ? vplBestIsa() : draft.def.isa;
    if (!vplHasIsa(draft.isa)) {
        return vplFail(&draft, VPL_INVALID_ARGUMENT,
                       "vplContextDef.isa is %s, which this machine or build lacks",
                       vplIsa_GetName(draft.isa));
    }
    vplContext* context = draft.def.alloc(draft.def.allocUser, NULL, 0, CONTEXT_BYTES);
    if (context == NULL) {
        return vplFail(&draft, VPL_OUT_OF_MEMORY, "out of memory: %zu bytes for a context", CONTEXT_BYTES);
    }
    *context = draft;
    context->lastMessage = (char*)(context + 1);
    context->lastMessage[0] = 0;
    *contextOut = context;
    return VPL_SUCCESS;
}

void vplContext_Destroy(vplContext* context)
{
    if (context != NULL) {
        vplFree(context, context->speeds);
        vplFree(context, context->teamRoom);
        context->def.alloc(context->def.allocUser, context, CONTEXT_BYTES, 0);
    }
}

const char* vplContext_GetLastMessage(const vplContext* context)
{
    return context != NULL ? context->lastMessage : "";
}

size_t vplContext_GetBytes(const vplContext* context)
{
    if (context == NULL) {
        return 0;
    }
    return context->bytes;
}

void vplContext_SetMemoryLimit(vplContext* context, size_t bytes)
{
    if (context == NULL) {
        return;
    }
    context->memoryLimit = bytes;
}

size_t vplContext_GetPeakBytes(const vplContext* context)
{
    if (context == NULL) {
        return 0;
    }
    return context->peakBytes;
}

void vplContext_ResetPeakBytes(vplContext* context)
{
    if (context == NULL) {
        return;
    }
    context->peakBytes = context->bytes;
}

vplIsa vplContext_GetIsa(const vplContext* context)
{
    if (context == NULL) {
        return 0;
    }
    return context->isa;
}

int vplContext_GetWorkerCount(const vplContext* context)
{
    if (context == NULL) {
        return 0;
    }
    return context->workerCount;
}

// Replaces control characters and broken UTF-8 by '?': messages quote files, and terminals obey control
// characters.
static void makePrintable(char* text)
{
    unsigned char* p = (unsigned char*)text;
    while (*p != 0) {
        int length = *p < 0x80 ? 1 : *p >= 0xF0 ? 4 : *p >= 0xE0 ? 3 : *p >= 0xC2 ? 2 : 0;
        bool control = *p < 0x20 || *p == 0x7F || (*p == 0xC2 && p[1] < 0xA0);
        int good = control ? 0 : 1;
        while (good > 0 && good < length && (p[good] & 0xC0) == 0x80) {
            good++;
        }
        if (length == 0 || good < length) { // also a sequence that the buffer's end cut off
            *p++ = '?';
        } else {
            p += length;
        }
    }
}

void vplLogToStderr(void* user, vplLogLevel level, const char* message)
{
    if (message != NULL && (level < VPL_LOG_INFO || user != NULL)) {
        const char* name = level == VPL_LOG_WARNING ? "warning" : level == VPL_LOG_INFO ? "note" : "error";
        fprintf(stderr, "libvpl: %s: %s\n", name, message);
    }
}

// Keeps a message; the middle of one that is too long is left out, because the reason stands at the end.
static void keep(char* kept, const char* message)
{
    const size_t length = strlen(message), half = VPL_LAST_MESSAGE / 2;
    if (length < VPL_LAST_MESSAGE) {
        memcpy(kept, message, length + 1);
    } else {
        memcpy(kept, message, half - 4);
        memcpy(kept + half - 4, " ...", 4);
        memcpy(kept + half, message + length + 1 - half, half);
        makePrintable(kept); // a character may have lost a part
    }
}

static void logArguments(const vplContext* context, vplLogLevel level, const char* format, va_list arguments)
{
    char* kept = context != NULL && level == VPL_LOG_ERROR ? context->lastMessage : NULL;
    if (context == NULL || (context->def.log == NULL && kept == NULL)) {
        return;
    }
    char start[1024];
    va_list again;
    va_copy(again, arguments);
    const int length = vplFormatList(start, sizeof start, format, arguments);
    const size_t size = length < 0 ? 0 : (size_t)length + 1;
    // The reason stands behind names, which may be long. Without memory the message is cut off.
    char* all = size > sizeof start ? context->def.alloc(context->def.allocUser, NULL, 0, size) : NULL;
    if (all != NULL) {
        vplFormatList(all, size, format, again);
    }
    va_end(again);
    char* message = all != NULL ? all : start;
    makePrintable(message);
    if (kept != NULL) {
        keep(kept, message);
    }
    if (context->def.log != NULL) {
        context->def.log(context->def.logUser, level, message);
    }
    if (all != NULL) {
        context->def.alloc(context->def.allocUser, all, size, 0);
    }
}

void vplLog(const vplContext* context, vplLogLevel level, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    logArguments(context, level, format, arguments);
    va_end(arguments);
}

vplResult vplFail(const vplContext* context, vplResult result, const char* format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    logArguments(context, VPL_LOG_ERROR, format, arguments);
    va_end(arguments);
    return result;
}

bool vplCheckPointers(const vplContext* context, const char* function, const char* names,
                      const void* const* pointers, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const size_t length = strcspn(names, ",");
        if (pointers[i] == NULL) {
            vplFail(context, VPL_INVALID_ARGUMENT, "%s: %.*s is NULL", function, (int)length, names);
            return false;
        }
        names += length + strspn(names + length, ", ");
    }
    return true;
}
