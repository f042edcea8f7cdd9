// SPDX-License-Identifier: MIT
// Paraboloid maps from the inside. Texels lie in the order of half_map.h.
#ifndef VPL_VISIBILITY_PARABOLOID_MAP_H
#define VPL_VISIBILITY_PARABOLOID_MAP_H

#include "visibility/half_map.h"

// Texels of one hemisphere.
static inline size_t vplParaboloidMap_Texels(int size)
{
    const size_t blocks = (size_t)vplHalfMap_Blocks(size);
    return blocks * blocks * VPL_LANES;
}

// Where there is a back, texels hold something as far as this outside of the disk: what lies there beyond the rim, so
// that the four texels around a point near the rim all know. Less than a texel's diagonal, 2 sqrt(2) / size.
static inline float vplParaboloidMap_Rim(int size, int hemispheres)
{
    return hemispheres == 2 ? 1 + 3 / (float)size : 1;
}

// Draws a hemisphere of a map, with a back or without; `triangles` may be NULL.
typedef void vplDrawParaboloidFcn(const vplBvh* bvh, const vplParaboloidMap* map, int hemisphere,
                                  float* texels, int32_t* triangles);

typedef void vplParaboloidFactorFcn(const vplParaboloidMap* map, const vplSurface* surface,
                                    float factor[restrict VPL_LANES]);

// What is nearer to the place than a fragment and its plane by less than this share of the distance does not shadow
// it, in footprints of a texel on the axis, whose centre is at most sqrt(2) 2 / size from its corner: see
// vplHalfMap_Tolerance.
static inline float vplParaboloidMap_Tolerance(int size)
{
    return 1.5f * 2 * 1.41421356f / (float)size;
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
