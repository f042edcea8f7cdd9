// SPDX-License-Identifier: MIT
// Axis-aligned boxes in vector registers, by the vector types that gcc and clang share. Written as loops over
// floats the hierarchy builds 1.9x slower (bench "geometry and tree": gcc 12 splits most of them into
// scalars).
#ifndef VPL_GEOMETRY_BOX_H
#define VPL_GEOMETRY_BOX_H

#include <math.h>
#include <stdbool.h>
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

// Lane by lane: a where the mask is -1, b where it is 0.
static inline vplFour vplFour_Choose(vplFourInts mask, vplFour a, vplFour b)
{
    return (vplFour)((mask & (vplFourInts)a) | (~mask & (vplFourInts)b));
}

// x, y, z; the fourth lane is free for other use.
typedef struct vplBox {
    vplFour low, high;
} vplBox;

static inline vplBox vplBox_Empty(void)
{
    return (vplBox){vplFour_Of(INFINITY), vplFour_Of(-INFINITY)};
}

static inline vplBox vplBox_Join(vplBox a, vplBox b)
{
    return (vplBox){vplFour_Min(a.low, b.low), vplFour_Max(a.high, b.high)};
}

static inline bool vplBox_Overlaps(vplBox a, vplBox b)
{
    bool overlaps = true;
    for (int k = 0; k < 3; k++) {
        overlaps = overlaps && a.low[k] <= b.high[k] && b.low[k] <= a.high[k];
    }
    return overlaps;
}

// Triangle bounds, padded by the largest rounding error of the triangle test: two units in the last place of
// the coordinates and of the differences between them.
static inline vplBox vplBoundTriangle(const vplFour corner[3])
{
    const vplFour low = vplFour_Min(corner[0], vplFour_Min(corner[1], corner[2]));
    const vplFour high = vplFour_Max(corner[0], vplFour_Max(corner[1], corner[2]));
    const vplFour size = high - low, magnitude = vplFour_Max(-low, high);
    float extent = size[0] > size[1] ? size[0] : size[1];
    float largest = magnitude[0] > magnitude[1] ? magnitude[0] : magnitude[1];
    extent = extent > size[2] ? extent : size[2];
    largest = largest > magnitude[2] ? largest : magnitude[2];
    const float pad = extent * 0x1p-20f + largest * 0x1p-22f;
    return (vplBox){low - pad, high + pad};
}

#endif
