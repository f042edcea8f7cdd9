// SPDX-License-Identifier: MIT
// Words and numbers of a state file, little-endian.
#ifndef VPL_RENDER_STATE_STREAM_H
#define VPL_RENDER_STATE_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// A file in memory that is written or read, front to back, by the same functions.
typedef struct vplStream {
    uint8_t* bytes;
    size_t at;
    bool writes, finite; // finite: every number that was read is
} vplStream;

// These functions write the values, or replace them by the values that they read, and move `at` behind them.
void vplStream_Word(vplStream* s, uint32_t* word);
void vplStream_Long(vplStream* s, uint64_t* value);
void vplStream_Doubles(vplStream* s, double* values, size_t count);
void vplStream_Floats(vplStream* s, float* values, size_t count);

// True if no value is farther from 0 than `most`.
bool vplStream_AreSmall(const float* values, size_t count, double most);

// Computes the checksum of the first `size` bytes, a multiple of 4. It is the last word of a file.
uint64_t vplState_Checksum(const uint8_t* bytes, size_t size);

#endif
