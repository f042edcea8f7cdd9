// SPDX-License-Identifier: MIT
// Sixteen table entries at once. gcc 12 makes sixteen scalar loads and compares of the plain loop.
#ifndef VPL_VISIBILITY_GATHER_H
#define VPL_VISIBILITY_GATHER_H

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

#endif
