// SPDX-License-Identifier: MIT
// Eight interleaved multiply-xor lanes, which compilers vectorise, folded by the finaliser of
// Steele, Lea and Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014.
#include "base/hash.h"

uint64_t vplHashWords(uint64_t state, const uint32_t* words, size_t count)
{
    uint64_t lanes[VPL_HASH_LANES];
    for (int j = 0; j < VPL_HASH_LANES; j++) {
        lanes[j] = vplMixBits(state + (uint64_t)(j + 1) * 0x9E3779B97F4A7C15u);
    }
    size_t i = 0;
    for (; i + VPL_HASH_LANES <= count; i += VPL_HASH_LANES) {
        for (int j = 0; j < VPL_HASH_LANES; j++) {
            lanes[j] = (lanes[j] ^ words[i + (size_t)j]) * 0xD6E8FEB86659FD93u;
            lanes[j] ^= lanes[j] >> 32;
        }
    }
    for (int j = 0; i < count; i++, j++) {
        lanes[j] = vplMixBits(lanes[j] ^ words[i]);
    }
    uint64_t hash = vplMixBits(state ^ count);
    for (int j = 0; j < VPL_HASH_LANES; j++) {
        hash = vplMixBits(hash ^ lanes[j]);
    }
    return hash;
}

uint64_t vplHashFloats(uint64_t state, const float* values, size_t count)
{
    // Copies 4 KB at a time: memcpy reinterprets the floats without a second copy of a whole image.
    uint32_t words[1024];
    for (size_t i = 0; i < count; i += 1024) {
        size_t n = count - i < 1024 ? count - i : 1024;
        memcpy(words, values + i, n * sizeof(float));
        state = vplHashWords(state, words, n);
    }
    return state;
}
