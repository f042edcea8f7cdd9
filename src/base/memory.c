// SPDX-License-Identifier: MIT
// Each block is preceded by its size: callers free it by its pointer alone, and the allocator still gets the
// size that its contract (vplAllocFcn) promises.
#include "base/context.h"

#include <string.h>

#ifndef __has_feature // clang's
#define __has_feature(x) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || __has_feature(address_sanitizer)
#include <sanitizer/asan_interface.h>
#else
#define ASAN_POISON_MEMORY_REGION(start, size)   ((void)(start), (void)(size))
#define ASAN_UNPOISON_MEMORY_REGION(start, size) ((void)(start), (void)(size))
#endif

// One cache line, and the widest vector.
enum { ALIGNMENT = 64 };

typedef struct Header {
    void* raw;    // from the allocator
    size_t total; // bytes asked from it
} Header;

static Header* headerOf(void* memory)
{
    return (Header*)memory - 1;
}

uint64_t vplNextStamp(vplContext* context)
{
    return ++context->stamps;
}

void* vplAlloc(vplContext* context, size_t count, size_t size)
{
    size_t bytes;
    if (__builtin_mul_overflow(count, size, &bytes) || bytes > SIZE_MAX / 2) {
        vplFail(context, VPL_OUT_OF_MEMORY,
                "out of memory: %zu elements of %zu bytes exceed the address space", count, size);
        return NULL;
    }
    const size_t total = bytes + ALIGNMENT + sizeof(Header);
    const Header header = {context->def.alloc(context->def.allocUser, NULL, 0, total), total};
    if (header.raw == NULL) {
        vplFail(context, VPL_OUT_OF_MEMORY, "out of memory: %zu bytes wanted, %zu held", bytes,
                context->bytes);
        return NULL;
    }
    context->bytes += total;
    context->peakBytes = context->bytes > context->peakBytes ? context->bytes : context->peakBytes;
    uintptr_t start = ((uintptr_t)header.raw + sizeof(Header) + ALIGNMENT - 1) & ~(uintptr_t)(ALIGNMENT - 1);
    void* memory = (void*)start;
    *headerOf(memory) = header;
    // Up to 64 spare bytes follow the block. The address sanitizer reports accesses to them.
    ASAN_POISON_MEMORY_REGION((char*)memory + bytes, (uintptr_t)header.raw + total - start - bytes);
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

size_t vplAllocatedBytes(const void* memory)
{
    return ((const Header*)memory - 1)->total;
}

void vplFree(vplContext* context, void* memory)
{
    if (memory != NULL) {
        const Header header = *headerOf(memory);
        context->bytes -= header.total;
        ASAN_UNPOISON_MEMORY_REGION(header.raw, header.total);
        context->def.alloc(context->def.allocUser, header.raw, header.total, 0);
    }
}

size_t vplGrownCapacity(size_t capacity, size_t count)
{
    const size_t grown = capacity + capacity / 2 > count ? capacity + capacity / 2 : count;
    return grown < 8 ? 8 : grown;
}

vplResult vplReserve(vplContext* context, void* array, size_t* capacity, size_t count, size_t size)
{
    if (count <= *capacity) {
        return VPL_SUCCESS;
    }
    const size_t wanted = vplGrownCapacity(*capacity, count);
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
