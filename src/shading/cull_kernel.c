// SPDX-License-Identifier: MIT
// Culls lights that contribute exactly 0 to all points within some bounds: those behind all surfaces, and for
// physical lighting those whose own plane has all points on it or behind it.
//
// The light kernel computes (a x + b y) + c z from x = light - point. Rounding is monotone, so the same
// operations on the ends of the intervals bound every rounded result from above. Where that bound is not
// positive, the kernel's cosine is 0 in every lane, and adding 0 changes no bit.
#include "base/isa.h"
#include "shading/shading.h"

static inline float most4(float a, float b, float c, float d)
{
    const float ab = a > b ? a : b, cd = c > d ? c : d;
    return ab > cd ? ab : cd;
}

// Largest product of two numbers from two intervals.
static inline float mostProduct(float low, float high, float a, float b)
{
    return most4(low * a, low * b, high * a, high * b);
}

static inline void cull(const vplBounds* bounds, float* const columns[6], int first, int count, bool oneSided,
                        int32_t facing[VPL_LIGHT_GROUP])
{
    const vplBounds b = *bounds;
    const float *px = columns[0] + first, *py = columns[1] + first, *pz = columns[2] + first;
    const float *nx = columns[3] + first, *ny = columns[4] + first, *nz = columns[5] + first;
    // Columns are padded to whole groups.
    for (int i = 0; i < ((count + VPL_LANES - 1) & ~(VPL_LANES - 1)); i++) {
        const float x0 = px[i] - b.high[0], x1 = px[i] - b.low[0];
        const float y0 = py[i] - b.high[1], y1 = py[i] - b.low[1];
        const float z0 = pz[i] - b.high[2], z1 = pz[i] - b.low[2];
        const float here = mostProduct(x0, x1, b.low[3], b.high[3]) +
                           mostProduct(y0, y1, b.low[4], b.high[4]) +
                           mostProduct(z0, z1, b.low[5], b.high[5]);
        // -(n . (x, y, z)) is largest where n . (-x, -y, -z) is, and a change of signs rounds alike.
        const float there = mostProduct(-x1, -x0, nx[i], nx[i]) + mostProduct(-y1, -y0, ny[i], ny[i]) +
                            mostProduct(-z1, -z0, nz[i], nz[i]);
        facing[i] = (here > 0) & (!oneSided | (there > 0));
    }
}

void VPL_KERNEL(vplCullDocumented)(const vplBounds* bounds, float* const columns[6], int first, int count,
                                   int32_t facing[VPL_LIGHT_GROUP])
{
    cull(bounds, columns, first, count, false, facing);
}

void VPL_KERNEL(vplCullPhysical)(const vplBounds* bounds, float* const columns[6], int first, int count,
                                 int32_t facing[VPL_LIGHT_GROUP])
{
    cull(bounds, columns, first, count, true, facing);
}
