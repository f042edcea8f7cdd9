// SPDX-License-Identifier: MIT
#include "scene/hash_index.h"

#include <string.h>

// The first entry with this hash in the chain from `entry` on.
static uint32_t follow(const vplHashIndex* index, uint32_t entry, uint32_t hash)
{
    while (entry != VPL_NO_ENTRY && index->entries[entry].hash != hash) {
        entry = index->entries[entry].next;
    }
    return entry;
}

uint32_t vplHashIndex_First(const vplHashIndex* index, uint32_t hash)
{
    return index->headCount == 0 ? VPL_NO_ENTRY
                                 : follow(index, index->heads[hash & (index->headCount - 1)], hash);
}

uint32_t vplHashIndex_Next(const vplHashIndex* index, uint32_t entry)
{
    return follow(index, index->entries[entry].next, index->entries[entry].hash);
}

static void link(vplHashIndex* index, uint32_t entry)
{
    uint32_t* head = &index->heads[index->entries[entry].hash & (index->headCount - 1)];
    index->entries[entry].next = *head;
    *head = entry;
}

vplResult vplHashIndex_Reserve(vplHashIndex* index, size_t count)
{
    TRY(vplArena_Reserve(index->arena, &index->entries, &index->capacity, count, sizeof *index->entries));
    if (count <= index->headCount) {
        return VPL_SUCCESS;
    }
    size_t headCount = 16;
    while (headCount < count) {
        headCount *= 2;
    }
    uint32_t* heads = vplArena_Alloc(index->arena, headCount, sizeof *heads);
    if (heads == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memset(heads, 0xFF, headCount * sizeof *heads); // VPL_NO_ENTRY
    vplArena_Free(index->arena, index->heads);
    index->heads = heads;
    index->headCount = headCount;
    for (uint32_t i = 0; i < index->count; i++) {
        link(index, i);
    }
    return VPL_SUCCESS;
}

vplResult vplHashIndex_Add(vplHashIndex* index, uint32_t hash)
{
    TRY(vplHashIndex_Reserve(index, (size_t)index->count + 1));
    index->entries[index->count].hash = hash;
    link(index, index->count++);
    return VPL_SUCCESS;
}

void vplHashIndex_Close(vplHashIndex* index)
{
    vplArena_Free(index->arena, index->entries);
    vplArena_Free(index->arena, index->heads);
    *index = (vplHashIndex){.arena = index->arena};
}

uint32_t vplHashKey(const uint32_t* words, int count)
{
    uint64_t hash = 0x9E3779B97F4A7C15u;
    for (int i = 0; i < count; i++) {
        hash = (hash ^ words[i]) * 0xD6E8FEB86659FD93u;
        hash ^= hash >> 32;
    }
    return (uint32_t)hash;
}

static uint32_t hashName(const char* start, size_t length)
{
    uint32_t hash = 0;
    for (size_t i = 0; i < length; i++) {
        uint32_t pair[2] = {hash, (unsigned char)start[i]};
        hash = vplHashKey(pair, 2);
    }
    return hash;
}

int vplNames_Find(const vplNames* names, const char* start, size_t length)
{
    uint32_t i = vplHashIndex_First(&names->index, hashName(start, length));
    while (i != VPL_NO_ENTRY) {
        if (strlen(names->names[i]) == length && memcmp(names->names[i], start, length) == 0) {
            return (int)i;
        }
        i = vplHashIndex_Next(&names->index, i);
    }
    return -1;
}

vplResult vplNames_Add(vplNames* names, const char* start, size_t length, int* out)
{
    vplArena* arena = names->index.arena;
    const uint32_t count = names->index.count;
    TRY(vplArena_Reserve(arena, &names->names, &names->capacity, (size_t)count + 1, sizeof *names->names));
    char* copy = vplArena_Alloc(arena, length + 1, 1);
    if (copy == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    memcpy(copy, start, length);
    copy[length] = 0;
    names->names[count] = copy;
    *out = (int)count;
    return vplHashIndex_Add(&names->index, hashName(start, length));
}
