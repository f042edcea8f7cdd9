// SPDX-License-Identifier: MIT
// Counter-based random numbers: a pure function of (seed, stream, index), so any thread can draw any of them.
// Based on: Salmon, Moraes, Dror and Shaw, Parallel Random Numbers: As Easy as 1, 2, 3, SC 2011 (Philox 4x32,
// ten rounds, the published constants).
#ifndef VPL_BASE_RNG_H
#define VPL_BASE_RNG_H

#include <stdint.h>

typedef struct vplRandom4 {
    uint32_t v[4];
} vplRandom4;

static inline vplRandom4 vplPhilox(const uint32_t counter[4], uint32_t key0, uint32_t key1)
{
    uint32_t c0 = counter[0], c1 = counter[1], c2 = counter[2], c3 = counter[3];
    for (int round = 0; round < 10; round++) {
        uint64_t p0 = (uint64_t)0xD2511F53u * c0;
        uint64_t p1 = (uint64_t)0xCD9E8D57u * c2;
        c0 = (uint32_t)(p1 >> 32) ^ c1 ^ key0;
        c1 = (uint32_t)p1;
        c2 = (uint32_t)(p0 >> 32) ^ c3 ^ key1;
        c3 = (uint32_t)p0;
        key0 += 0x9E3779B9u;
        key1 += 0xBB67AE85u;
    }
    return (vplRandom4){{c0, c1, c2, c3}};
}

// Random words number `index` of stream `stream` for `seed`.
static inline vplRandom4 vplRandomAt(uint64_t seed, uint32_t stream, uint64_t index)
{
    const uint32_t counter[4] = {(uint32_t)index, (uint32_t)(index >> 32), stream, 0};
    return vplPhilox(counter, (uint32_t)seed, (uint32_t)(seed >> 32));
}

// Uniform in [0, 1): 24 bits fit a float exactly, so the largest is 1 - 2^-24.
static inline float vplUnitFloat(uint32_t word)
{
    return (float)(word >> 8) * 0x1p-24f;
}

#endif
