// SPDX-License-Identifier: MIT
// A hash index of elements that are numbered 0, 1, 2 ... in the order of their addition, and a set of names
// on top of it.
#ifndef VPL_SCENE_HASH_INDEX_H
#define VPL_SCENE_HASH_INDEX_H

#include "base/arena.h"

#define VPL_NO_ENTRY 0xFFFFFFFFu

typedef struct vplHashEntry {
    uint32_t hash, next;
} vplHashEntry;

// Stores the hashes of elements, not the elements. Initialise with {.arena = arena}, which owns its memory.
typedef struct vplHashIndex {
    vplArena* arena;
    vplHashEntry* entries;
    uint32_t* heads; // chains, by the hash's low bits
    size_t capacity, headCount;
    uint32_t count;
} vplHashIndex;

// The first element with this hash, and the one after `entry`; VPL_NO_ENTRY if there is none. The caller
// compares the elements themselves.
uint32_t vplHashIndex_First(const vplHashIndex* index, uint32_t hash);
uint32_t vplHashIndex_Next(const vplHashIndex* index, uint32_t entry);

// Makes room for `count` elements in all.
vplResult vplHashIndex_Reserve(vplHashIndex* index, size_t count);

// Adds element number index->count.
vplResult vplHashIndex_Add(vplHashIndex* index, uint32_t hash);

// Frees the memory early. Otherwise its arena does.
void vplHashIndex_Close(vplHashIndex* index);

// The hash of a few words.
uint32_t vplHashKey(const uint32_t* words, int count);

// Different names, in the order of their addition. Initialise with {.index = {.arena = arena}}.
typedef struct vplNames {
    vplHashIndex index;
    char** names;
    size_t capacity;
} vplNames;

// The number of a name, or -1.
int vplNames_Find(const vplNames* names, const char* start, size_t length);

// Adds a name that is not in the set; *out is its number.
vplResult vplNames_Add(vplNames* names, const char* start, size_t length, int* out);

#endif
