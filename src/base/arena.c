// SPDX-License-Identifier: MIT
#include "base/arena.h"

#include <string.h>

enum { ALIGNMENT = 64 };

// Precedes each allocation, padded so that what follows is aligned.
typedef union Node {
    union Node* older;
    char padding[ALIGNMENT];
} Node;

struct vplArena {
    vplContext* context;
    Node* newest;
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
        for (Node *node = arena->newest, *older; node != NULL; node = older) {
            older = node->older;
            vplFree(arena->context, node);
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
    // On overflow vplAlloc is asked for the impossible, and logs it.
    const bool fits =
        !__builtin_mul_overflow(count, size, &bytes) && !__builtin_add_overflow(bytes, sizeof(Node), &bytes);
    Node* node = vplAlloc(arena->context, fits ? bytes : SIZE_MAX, 1);
    if (node == NULL) {
        arena->failed = true;
        return NULL;
    }
    node->older = arena->newest;
    arena->newest = node;
    return node + 1;
}

void* vplArena_AllocZero(vplArena* arena, size_t count, size_t size)
{
    void* memory = vplArena_Alloc(arena, count, size);
    if (memory != NULL) {
        memset(memory, 0, count * size);
    }
    return memory;
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
