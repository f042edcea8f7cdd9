// SPDX-License-Identifier: MIT
// Shadow maps of half spaces from the inside.
#ifndef VPL_VISIBILITY_HALF_MAP_H
#define VPL_VISIBILITY_HALF_MAP_H

#include <vpl/visibility.h>

#include "geometry/bvh.h"
#include "math/vec.h"

#include <math.h>

// Texels behind a map's last, so that 16 can always be loaded.
enum { VPL_HALF_MAP_PAD = VPL_LANES };

// Rounding of stored and compared values, relative.
#define VPL_HALF_MAP_SLACK 0x1p-16f

// Draws all triangles of a tree into a map that was cleared.
typedef void vplDrawHalfMapFcn(const vplBvh* bvh, const vplHalfMap* map, float* texels);

typedef void vplHalfMapFactorFcn(const vplHalfMap* map, const vplSurface* surface,
                                 float factor[restrict VPL_LANES]);

// The answers of a map and of rays are equal but in a band. A texel's centre looks past a fragment at distance r
// (w = |x| + |y| + z in the map's frame) by at most the footprint f = sqrt(2) w / size, and along the fragment's
// plane, at the angle T to the light, it is nearer by at most the bias of VPL_BIAS_EXACT, r (1 - cos T / cos(T - a))
// with tan a = f / r. So where all that blocks a ray to the fragment is further from it than band = f + bias, and
// blocks or frees all rays within the footprint f around that end alike, the map says what the ray says. Returns
// the band, metres.
static inline float vplHalfMap_Band(const vplHalfMap* map, vplVec3 point, vplVec3 normal, float* footprintOut)
{
    const vplVec3 way = vplSub(point, map->position);
    const float x = fabsf(vplDot(way, map->right)), y = fabsf(vplDot(way, map->up));
    const float r = fmaxf(vplLength(way), 1e-30f), f = 1.41421356f * (x + y + fabsf(vplDot(way, map->forward))) / (float)map->size;
    const float cosT = fminf(fabsf(vplDot(way, normal)) / r, 1), sinT = sqrtf(1 - cosT * cosT);
    const float cosA = r / sqrtf(r * r + f * f), sinA = f / r * cosA;
    const float turned = sinT * cosA <= cosT * sinA ? 1 : cosT * cosA + sinT * sinA;
    *footprintOut = f;
    return f + r * (1 - cosT / turned) + r * 0x1p-16f;
}

// Where a virtual light is seen from: on its surface, which must not shadow it, so 64 units in the last place of its
// largest coordinate above.
static inline vplVec3 vplLightEye(vplVec3 p, vplVec3 n)
{
    const float largest = fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z))) * 0x1p-18f;
    return vplVec(p.x + largest * n.x, p.y + largest * n.y, p.z + largest * n.z);
}

#endif
