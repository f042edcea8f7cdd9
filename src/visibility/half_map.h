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

// Where a virtual light is seen from: on its surface, which must not shadow it, so 64 units in the last place of its
// largest coordinate above.
static inline vplVec3 vplLightEye(vplVec3 p, vplVec3 n)
{
    const float largest = fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z))) * 0x1p-18f;
    return vplVec(p.x + largest * n.x, p.y + largest * n.y, p.z + largest * n.z);
}

#endif
