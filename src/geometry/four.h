// SPDX-License-Identifier: MIT
// Four floats in one register, in the vector types that gcc and clang share, for building the hierarchy: written
// as loops over four floats, gcc 12 takes most of them apart, and the whole build takes 1.9x as long.
#ifndef VPL_GEOMETRY_FOUR_H
#define VPL_GEOMETRY_FOUR_H

#include <stdint.h>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

typedef float vplFour __attribute__((vector_size(16)));
typedef int32_t vplFourInts __attribute__((vector_size(16)));

static inline vplFour vplFour_Min(vplFour a, vplFour b)
{
#if defined(__SSE2__)
    return (vplFour)_mm_min_ps((__m128)a, (__m128)b);
#else
    for (int i = 0; i < 4; i++) {
        b[i] = a[i] < b[i] ? a[i] : b[i];
    }
    return b;
#endif
}

static inline vplFour vplFour_Max(vplFour a, vplFour b)
{
#if defined(__SSE2__)
    return (vplFour)_mm_max_ps((__m128)a, (__m128)b);
#else
    for (int i = 0; i < 4; i++) {
        b[i] = a[i] > b[i] ? a[i] : b[i];
    }
    return b;
#endif
}

static inline vplFour vplFour_Of(float x)
{
    return (vplFour){x, x, x, x};
}

#endif
