// SPDX-License-Identifier: MIT
// Every block is preceded by its own size, so that callers free with one pointer while the allocator still
// gets the sizes that Lua's contract promises it.
#include "base/context.h"

#include <string.h>

// Wide enough for any vector load and for one cache line.
enum { ALIGNMENT = 64 };

typedef struct Header {
    void* raw;    // what the allocator returned
    size_t total; // what it was asked for
} Header;

static Header* headerOf(void* memory)
{
    return (Header*)memory - 1;
}

uint64_t vplNextStamp(vplContext* context)
{
    return ++context->stamps;
}

// ---- kept blocks

static void dropKept(vplContext* context, int index)
{
    const vplFreedBlock block = context->kept[index];
    context->kept[index] = context->kept[--context->keptCount];
    context->keptBytes -= block.total;
    context->bytes -= block.total;
    context->def.alloc(context->def.allocUser, block.raw, block.total, 0);
}

static void dropOldestKept(vplContext* context)
{
    int oldest = 0;
    for (int i = 1; i < context->keptCount; i++) {
        oldest = context->kept[i].age < context->kept[oldest].age ? i : oldest;
    }
    dropKept(context, oldest);
}

static void dropAllKept(vplContext* context)
{
    while (context->keptCount > 0) {
        dropKept(context, context->keptCount - 1);
    }
}

void vplStartKeeping(vplContext* context)
{
    if (context->keepers++ == 0) {
        context->usedPeak = context->bytes;
    }
}

void vplStopKeeping(vplContext* context)
{
    if (--context->keepers == 0) {
        dropAllKept(context);
    }
}

void vplAgeKept(vplContext* context)
{
    context->keptRound++;
    for (int i = context->keptCount; i-- > 0;) {
        if (context->keptRound - context->kept[i].age > 2) {
            dropKept(context, i);
        }
    }
}

// False where the block is small, or nobody wants it kept: then the allocator gets it.
static bool keep(vplContext* context, Header header)
{
    if (context->keepers == 0 || header.total < VPL_KEPT_BYTES) {
        return false;
    }
    if (context->keptCount == VPL_MAX_FREED) {
        dropOldestKept(context);
    }
    context->keptBytes += header.total;
    context->kept[context->keptCount++] = (vplFreedBlock){header.raw, header.total, context->keptRound};
    return true;
}

// The smallest kept block that has room, but not more than a quarter too much of it.
static bool reuse(vplContext* context, size_t wanted, Header* headerOut)
{
    int best = -1;
    for (int i = 0; i < context->keptCount && wanted >= VPL_KEPT_BYTES; i++) {
        const size_t total = context->kept[i].total;
        const bool fits = total >= wanted && total <= wanted + wanted / 4;
        best = fits && (best < 0 || total < context->kept[best].total) ? i : best;
    }
    if (best < 0) {
        return false;
    }
    *headerOut = (Header){context->kept[best].raw, context->kept[best].total};
    context->kept[best] = context->kept[--context->keptCount];
    context->keptBytes -= headerOut->total;
    return true;
}

static void noteUse(vplContext* context)
{
    const size_t used = context->bytes - context->keptBytes;
    context->usedPeak = used > context->usedPeak ? used : context->usedPeak;
    context->peakBytes = context->bytes > context->peakBytes ? context->bytes : context->peakBytes;
}

// Whether so many bytes more would be too many while blocks are kept.
static bool isTooMuch(const vplContext* context, size_t total)
{
    const size_t used = context->bytes - context->keptBytes + total;
    const size_t most = used > context->usedPeak ? used : context->usedPeak;
    return context->bytes + total > most + most / 2;
}

static Header request(vplContext* context, size_t total)
{
    Header header;
    if (reuse(context, total, &header)) {
        noteUse(context);
        return header;
    }
    while (context->keptCount > 0 && isTooMuch(context, total)) {
        dropOldestKept(context);
    }
    header = (Header){context->def.alloc(context->def.allocUser, NULL, 0, total), total};
    if (header.raw == NULL && context->keptCount > 0) { // what is kept may be what is missing
        dropAllKept(context);
        header.raw = context->def.alloc(context->def.allocUser, NULL, 0, total);
    }
    if (header.raw != NULL) {
        context->bytes += total;
        noteUse(context);
    }
    return header;
}

// ---- blocks

void* vplAlloc(vplContext* context, size_t count, size_t size)
{
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2) {
        vplFail(context, VPL_OUT_OF_MEMORY,
                "out of memory: %zu elements of %zu bytes exceed the address space", count, size);
        return NULL;
    }
    const Header header = request(context, bytes + ALIGNMENT + sizeof(Header));
    if (header.raw == NULL) {
        vplFail(context, VPL_OUT_OF_MEMORY, "out of memory: %zu bytes wanted, %zu held", bytes,
                context->bytes);
        return NULL;
    }
    uintptr_t start = ((uintptr_t)header.raw + sizeof(Header) + ALIGNMENT - 1) & ~(uintptr_t)(ALIGNMENT - 1);
    void* memory = (void*)start;
    *headerOf(memory) = header;
    return memory;
}

void* vplAllocZero(vplContext* context, size_t count, size_t size)
{
    void* memory = vplAlloc(context, count, size);
    if (memory != NULL) {
        memset(memory, 0, count * size);
    }
    return memory;
}

void vplFree(vplContext* context, void* memory)
{
    if (memory != NULL) {
        const Header header = *headerOf(memory);
        if (!keep(context, header)) {
            context->bytes -= header.total;
            context->def.alloc(context->def.allocUser, header.raw, header.total, 0);
        }
    }
}

vplResult vplReserve(vplContext* context, void* array, size_t* capacity, size_t count, size_t size)
{
    if (count <= *capacity) {
        return VPL_SUCCESS;
    }
    size_t wanted = *capacity + *capacity / 2;
    wanted = wanted < count ? count : wanted;
    wanted = wanted < 8 ? 8 : wanted;
    void* grown = vplAlloc(context, wanted, size);
    if (grown == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    void* old;
    memcpy(&old, array, sizeof old); // `array` is the address of a pointer of any type
    if (old != NULL) {
        memcpy(grown, old, *capacity * size);
        vplFree(context, old);
    }
    memcpy(array, &grown, sizeof grown);
    *capacity = wanted;
    return VPL_SUCCESS;
}

char* vplCopyString(vplContext* context, const char* text)
{
    size_t length = strlen(text) + 1;
    char* copy = vplAlloc(context, length, 1);
    if (copy != NULL) {
        memcpy(copy, text, length);
    }
    return copy;
}
