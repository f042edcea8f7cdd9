// SPDX-License-Identifier: MIT
// Paraboloid maps from the inside. They are drawn in blocks, in the order of hemi_map.h, and kept in rows, so that the
// two texels beside a point are loaded at once.
#ifndef VPL_VISIBILITY_PARABOLOID_MAP_H
#define VPL_VISIBILITY_PARABOLOID_MAP_H

#include "visibility/hemi_map.h"

// Texels of a hemisphere while it is drawn.
static inline size_t vplParaboloidMap_Drawn(int size)
{
    const size_t blocks = (size_t)vplHemiMap_Blocks(size);
    return blocks * blocks * VPL_LANES;
}

// Texels from one row to the next. Rows and columns at the sides are there twice, so that there are always two.
static inline int32_t vplParaboloidMap_Stride(int size)
{
    return size + 2;
}

// Texels of one hemisphere.
static inline size_t vplParaboloidMap_Texels(int size)
{
    return (size_t)vplParaboloidMap_Stride(size) * (size_t)vplParaboloidMap_Stride(size);
}

// Where a texel of a hemisphere is.
static inline size_t vplParaboloidMap_Place(int size, int column, int row)
{
    return (size_t)(row + 1) * (size_t)vplParaboloidMap_Stride(size) + (size_t)(column + 1);
}

// Where there is a back, texels hold something as far as this outside of the disk: what lies there beyond the rim, so
// that the four texels around a point near the rim all know. Less than a texel's diagonal, 2 sqrt(2) / size.
static inline float vplParaboloidMap_Rim(int size, int hemispheres)
{
    return hemispheres == 2 ? 1 + 3 / (float)size : 1;
}

// What is nearer to the place than a fragment and its plane by less than this share of the distance does not shadow
// it: one footprint of a texel on the axis, where its centre is 2 sqrt(2) / size from its corner. Points dark in the map
// only + in the ray only, in %, and the mean difference, for 1/2, 1, 3/2, 2 footprints (bench/paraboloid --agree, 256
// texels): room 0.18 + 0.09 0.44, 0.15 + 0.09 0.39, 0.14 + 0.09 0.38, 0.13 + 0.09 0.37; Sibenik 2.11 + 2.93 7.26,
// 1.73 + 3.38 6.97, 1.46 + 3.87 6.97, 1.24 + 4.65 7.30; Sponza 2.09 + 3.26 6.76, 1.47 + 3.54 6.21, 1.06 + 4.41 6.35,
// 0.81 + 4.96 6.44.
static inline float vplParaboloidMap_Tolerance(int size)
{
    return 2 * 1.41421356f / (float)size;
}

// The band of vplParaboloidMap_FactorBlock, 2.5 f + b, metres, and f: a texel's diagonal, because the four centres around
// a point are no further from it.
static inline float vplParaboloidMap_Band(const vplParaboloidMap* map, vplVec3 point, vplVec3 normal,
                                          float* footprintOut)
{
    const vplVec3 way = vplSub(point, map->position);
    const float r = fmaxf(vplLength(way), 1e-30f);
    const float f = 1.41421356f * 2 * (r + fabsf(vplDot(way, map->forward))) / (float)map->size;
    *footprintOut = f;
    return vplShadowBand(r, f, fminf(fabsf(vplDot(way, normal)) / r, 1));
}

#endif
