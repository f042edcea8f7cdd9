// SPDX-License-Identifier: MIT
#include "base/arena.h"

#include <string.h>

enum { ALIGNMENT = 64 };

// Precedes each allocation; as long as the alignment, so that the memory behind it is aligned.
typedef struct Block {
    _Alignas(ALIGNMENT) struct Block* older;
    struct Block* newer;
} Block;

struct vplArena {
    vplContext* context;
    Block* newest;
    bool failed;
};

vplArena* vplArena_Create(vplContext* context)
{
    vplArena* arena = vplAlloc(context, 1, sizeof *arena);
    if (arena != NULL) {
        *arena = (vplArena){context, NULL, false};
    }
    return arena;
}

void vplArena_Destroy(vplArena* arena)
{
    if (arena != NULL) {
        for (Block *block = arena->newest, *older; block != NULL; block = older) {
            older = block->older;
            vplFree(arena->context, block);
        }
        vplFree(arena->context, arena);
    }
}

void* vplArena_Alloc(vplArena* arena, size_t count, size_t size)
{
    if (arena == NULL) {
        return NULL;
    }
    size_t bytes;
    const bool fits =
        !__builtin_mul_overflow(count, size, &bytes) && !__builtin_add_overflow(bytes, sizeof(Block), &bytes);
    Block* block = vplAlloc(arena->context, fits ? bytes : SIZE_MAX, 1); // SIZE_MAX fails and is logged
    if (block == NULL) {
        arena->failed = true;
        return NULL;
    }
    *block = (Block){.older = arena->newest};
    if (arena->newest != NULL) {
        arena->newest->newer = block;
    }
    arena->newest = block;
    return block + 1;
}

void* vplArena_AllocZero(vplArena* arena, size_t count, size_t size)
{
    void* memory = vplArena_Alloc(arena, count, size);
    return memory != NULL ? memset(memory, 0, count * size) : NULL;
}

void* vplArena_Copy(vplArena* arena, const void* elements, size_t count, size_t size)
{
    void* copy = vplArena_Alloc(arena, count, size);
    return copy != NULL && count > 0 ? memcpy(copy, elements, count * size) : copy;
}

char* vplArena_CopyString(vplArena* arena, const char* text)
{
    return vplArena_Copy(arena, text, strlen(text) + 1, 1);
}

vplResult vplArena_Reserve(vplArena* arena, void* array, size_t* capacity, size_t count, size_t size)
{
    if (count <= *capacity) {
        return VPL_SUCCESS;
    }
    const size_t wanted = vplGrownCapacity(*capacity, count);
    void *old, *grown = vplArena_Alloc(arena, wanted, size);
    if (grown == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(&old, array, sizeof old); // `array` is the address of a pointer of any type
    if (old != NULL) {
        memcpy(grown, old, *capacity * size);
        vplArena_Free(arena, old);
    }
    memcpy(array, &grown, sizeof grown);
    *capacity = wanted;
    return VPL_SUCCESS;
}

void vplArena_Free(vplArena* arena, void* memory)
{
    if (memory != NULL) {
        Block* block = (Block*)memory - 1;
        *(block->newer != NULL ? &block->newer->older : &arena->newest) = block->older;
        if (block->older != NULL) {
            block->older->newer = block->newer;
        }
        vplFree(arena->context, block);
    }
}

void vplArena_Absorb(vplArena* arena, vplArena* source)
{
    Block* oldest = source->newest;
    if (oldest != NULL) {
        while (oldest->older != NULL) {
            oldest = oldest->older;
        }
        oldest->older = arena->newest;
        if (arena->newest != NULL) {
            arena->newest->newer = oldest;
        }
        arena->newest = source->newest;
    }
    vplFree(source->context, source);
}

size_t vplArena_GetBytes(const vplArena* arena)
{
    size_t bytes = vplAllocatedBytes(arena);
    for (const Block* block = arena->newest; block != NULL; block = block->older) {
        bytes += vplAllocatedBytes(block);
    }
    return bytes;
}

vplResult vplArena_Check(const vplArena* arena)
{
    return arena != NULL && !arena->failed ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

vplResult vplArena_Deliver(vplArena* arena, vplResult result, void* object, void* objectOut)
{
    if (result == VPL_SUCCESS) {
        memcpy(objectOut, &object, sizeof object);
    } else {
        vplArena_Destroy(arena);
    }
    return result;
}
