// SPDX-License-Identifier: MIT
// Gathers 16 texels of a map. gcc 12 turns the plain loop into 16 scalar loads and compares.
#ifndef VPL_VISIBILITY_MAP_GATHER_H
#define VPL_VISIBILITY_MAP_GATHER_H

#include <vpl/raster.h>

#include <string.h>

// out[l] = table[index[l]]
static inline void vplGather(const float* restrict table, const int32_t index[restrict VPL_LANES],
                             float out[restrict VPL_LANES])
{
    typedef float Lanes __attribute__((vector_size(sizeof(float) * VPL_LANES)));
    const float* restrict t = table;
    uint32_t i[VPL_LANES]; // unsigned: no sign to extend sixteen times
    memcpy(i, index, sizeof i);
    const Lanes lanes = {t[i[0]], t[i[1]], t[i[2]],  t[i[3]],  t[i[4]],  t[i[5]],  t[i[6]],  t[i[7]],
                         t[i[8]], t[i[9]], t[i[10]], t[i[11]], t[i[12]], t[i[13]], t[i[14]], t[i[15]]};
    memcpy(out, &lanes, sizeof lanes);
}

// first[l] = table[index[l]], second[l] = table[index[l] + 1]: half as many loads as two calls of vplGather.
static inline void vplGatherPairs(const float* restrict table, const int32_t index[restrict VPL_LANES],
                                  float first[restrict VPL_LANES], float second[restrict VPL_LANES])
{
    typedef uint64_t Eight __attribute__((vector_size(sizeof(uint64_t) * VPL_LANES / 2)));
    typedef float Lanes __attribute__((vector_size(sizeof(float) * VPL_LANES)));
    uint32_t i[VPL_LANES];
    uint64_t p[VPL_LANES];
    memcpy(i, index, sizeof i);
    for (int l = 0; l < VPL_LANES; l++) {
        memcpy(&p[l], table + i[l], sizeof p[l]);
    }
    const Eight low = {p[0], p[1], p[2], p[3], p[4], p[5], p[6], p[7]};
    const Eight high = {p[8], p[9], p[10], p[11], p[12], p[13], p[14], p[15]};
    const Lanes a = (Lanes)low, b = (Lanes)high;
    const Lanes even =
        __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    const Lanes odd =
        __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
    memcpy(first, &even, sizeof even);
    memcpy(second, &odd, sizeof odd);
}

#endif
