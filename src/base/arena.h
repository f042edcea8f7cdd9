// SPDX-License-Identifier: MIT
// The idioms of the whole library for errors (TRY) and for ownership of memory (vplArena).
//
// Errors: a function that can fail returns vplResult, and TRY passes a failure on to the caller.
// Memory: an object has one arena, and so has a call that needs scratch memory. Several allocations are
// followed by one check, and vplArena_Destroy frees them all.
//
//     vplResult vplThing_Create(vplContext* context, int count, vplThing** thingOut)
//     {
//         vplArena* arena = vplArena_Create(context);
//         vplThing* t = vplArena_AllocZero(arena, 1, sizeof *t);
//         float* weights = vplArena_Alloc(arena, (size_t)count, sizeof *weights);
//         vplResult result = vplArena_Check(arena); // covers the arena and both allocations
//         if (result == VPL_SUCCESS) {
//             *t = (vplThing){.arena = arena, .weights = weights, .count = count};
//             result = fill(t);
//         }
//         return vplArena_Deliver(arena, result, t, thingOut); // on failure frees everything
//     }
//
//     void vplThing_Destroy(vplThing* t) { vplArena_Destroy(t != NULL ? t->arena : NULL); }
#ifndef VPL_BASE_ARENA_H
#define VPL_BASE_ARENA_H

#include "base/context.h"

// Returns from the calling function with the result of `expression` unless that is VPL_SUCCESS.
#define TRY(expression)                                                                                      \
    do {                                                                                                     \
        const vplResult tryResult = (expression);                                                            \
        if (tryResult != VPL_SUCCESS) {                                                                      \
            return tryResult;                                                                                \
        }                                                                                                    \
    } while (0)

// A list of blocks that are freed together. Parallel sections must not use it: they do not allocate.
typedef struct vplArena vplArena;

// NULL when out of memory: the functions below accept that, and vplArena_Check reports it.
vplArena* vplArena_Create(vplContext* context);

// Frees the arena and everything in it. NULL is allowed.
void vplArena_Destroy(vplArena* arena);

// Memory for `count` elements of `size` bytes, aligned to 64 bytes: uninitialised, or zeros. NULL when out of
// memory.
void* vplArena_Alloc(vplArena* arena, size_t count, size_t size);
void* vplArena_AllocZero(vplArena* arena, size_t count, size_t size);

// A copy of `count` elements, or of a string; NULL when out of memory.
void* vplArena_Copy(vplArena* arena, const void* elements, size_t count, size_t size);
char* vplArena_CopyString(vplArena* arena, const char* text);

// Makes *array, a block of this arena or NULL, hold at least `count` elements; grows by half, so that
// appending takes linear time. On failure *array is as it was.
vplResult vplArena_Reserve(vplArena* arena, void* array, size_t* capacity, size_t count, size_t size);

// Frees one block of this arena early. NULL is allowed.
void vplArena_Free(vplArena* arena, void* memory);

// Moves the blocks of `source` to `arena` and destroys `source`. Cannot fail.
void vplArena_Absorb(vplArena* arena, vplArena* source);

// Bytes that the context holds for the arena. It is not NULL.
size_t vplArena_GetBytes(const vplArena* arena);

// VPL_OUT_OF_MEMORY if the arena is NULL or any of its allocations failed so far.
vplResult vplArena_Check(const vplArena* arena);

// Ends the creation of an object: on success stores it in *objectOut (a pointer to a pointer), else destroys
// the arena. Returns `result`.
vplResult vplArena_Deliver(vplArena* arena, vplResult result, void* object, void* objectOut);

#endif
