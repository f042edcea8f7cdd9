// SPDX-License-Identifier: MIT
// 64-bit hashes of words, the same for either byte order. They identify pictures and are not cryptographic.
#ifndef VPL_BASE_HASH_H
#define VPL_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>
#include <string.h>

enum { VPL_HASH_LANES = 8 };

// Every bit of the result depends on every bit of x (the last steps of SplitMix64: Steele, Lea and Flood, Fast Splittable
// Pseudorandom Number Generators, OOPSLA 2014).
static inline uint64_t vplMixBits(uint64_t x)
{
    x ^= x >> 30;
    x *= 0xBF58476D1CE4E5B9u;
    x ^= x >> 27;
    x *= 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

// Hash of `count` 32-bit words. `state` is 0, or the hash of what came before.
uint64_t vplHashWords(uint64_t state, const uint32_t* words, size_t count);

// Hash of the bit patterns of floats.
uint64_t vplHashFloats(uint64_t state, const float* values, size_t count);

// Hash of the bit patterns of three coordinates, for random numbers of points. It mixes twice, where vplHashFloats mixes twenty times.
static inline uint64_t vplHashPosition(uint64_t seed, float x, float y, float z)
{
    const float at[3] = {x, y, z};
    uint32_t words[3];
    memcpy(words, at, sizeof words);
    const uint64_t first = vplMixBits(seed ^ ((uint64_t)words[0] << 32 | words[1]));
    return vplMixBits(first + 0x9E3779B97F4A7C15u + words[2]);
}

#endif
