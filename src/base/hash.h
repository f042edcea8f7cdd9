// SPDX-License-Identifier: MIT
// 64-bit hashes of words, the same for either byte order. They identify pictures and are not cryptographic.
#ifndef VPL_BASE_HASH_H
#define VPL_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

enum { VPL_HASH_LANES = 8 };

// Hash of `count` 32-bit words. `state` is 0, or the hash of what came before.
uint64_t vplHashWords(uint64_t state, const uint32_t* words, size_t count);

// Hash of the bit patterns of floats.
uint64_t vplHashFloats(uint64_t state, const float* values, size_t count);

#endif
