// SPDX-License-Identifier: MIT
// Hash tables of things that are numbered 0, 1, 2 ... in the order they were met, and names numbered so.
#ifndef VPL_SCENE_OBJ_INDEX_H
#define VPL_SCENE_OBJ_INDEX_H

#include "base/context.h"

#define VPL_NO_ENTRY 0xFFFFFFFFu

typedef struct vplHashEntry {
    uint32_t hash, next;
} vplHashEntry;

// Knows the hashes of entries, not the entries themselves. Start with {context}.
typedef struct vplHashIndex {
    vplContext* context;
    vplHashEntry* entries;
    uint32_t* heads; // chains by the hash's low bits
    size_t capacity, headCount;
    uint32_t count;
} vplHashIndex;

// The first entry with this hash, or VPL_NO_ENTRY; then the next. The caller compares the things themselves.
uint32_t vplHashIndex_First(const vplHashIndex* index, uint32_t hash);
uint32_t vplHashIndex_Next(const vplHashIndex* index, uint32_t entry);

// Makes room for `count` entries in all.
vplResult vplHashIndex_Reserve(vplHashIndex* index, size_t count);

// Adds entry number index->count.
vplResult vplHashIndex_Add(vplHashIndex* index, uint32_t hash);
void vplHashIndex_Close(vplHashIndex* index);

// A hash of a few words.
uint32_t vplHashKey(const uint32_t* words, int count);

// Different names, in the order they were added. Start with {{context}}.
typedef struct vplNames {
    vplHashIndex index;
    char** names;
    size_t capacity;
} vplNames;

// The number of a name, or -1.
int vplNames_Find(const vplNames* names, const char* start, size_t length);

// Adds a name that is not there yet; its number is in *out.
vplResult vplNames_Add(vplNames* names, const char* start, size_t length, int* out);
void vplNames_Close(vplNames* names);

#endif
