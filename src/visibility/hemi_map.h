// SPDX-License-Identifier: MIT
// Shadow maps of half spaces from the inside.
#ifndef VPL_VISIBILITY_HEMI_MAP_H
#define VPL_VISIBILITY_HEMI_MAP_H

#include <vpl/visibility.h>

#include "geometry/bvh.h"
#include "math/vec.h"

#include <math.h>

// Blocks of 4 x 4 texels along a side.
static inline int32_t vplHemiMap_Blocks(int32_t size)
{
    return (size + VPL_BLOCK_SIDE - 1) / VPL_BLOCK_SIDE;
}

// Where a texel is.
static inline int32_t vplHemiMap_Place(int32_t blocks, int32_t column, int32_t row)
{
    return ((row >> 2) * blocks + (column >> 2)) * VPL_LANES + (row & 3) * VPL_BLOCK_SIDE + (column & 3);
}

// Bit i: some of child i lies above a plane.
static inline uint32_t vplChildrenAbove(const vplBvhNode* node, vplVec3 o, vplVec3 n)
{
    uint32_t above = 0;
    for (int i = 0; i < node->count; i++) {
        const float x = (node->planes[n.x > 0 ? 3 : 0][i] - o.x) * n.x;
        const float y = (node->planes[n.y > 0 ? 4 : 1][i] - o.y) * n.y;
        const float z = (node->planes[n.z > 0 ? 5 : 2][i] - o.z) * n.z;
        above |= (uint32_t)(x + y + z > 0) << i;
    }
    return above;
}

// How many triangles a light's map draws: those in blocks of the tree that reach above its plane.
int64_t vplHemiMap_TrianglesAbove(const vplGeometry* geometry, const vplHemiMapPlace* place);

// What is nearer to the light than a fragment and its plane by less than this share of the distance, one and a half
// footprints, does not shadow it: walls that meet in a corner. Pairs dark in the map only + in the ray only, in %, for
// 0, 1/2, 1, 3/2, 2 footprints (bench/crossover, 128 texels): room 0.51 + 0.20, 0.38 + 0.20, 0.30 + 0.20, 0.26 + 0.20,
// 0.23 + 0.20; Sibenik 5.72 + 3.82, 3.73 + 4.06, 2.96 + 4.38, 2.31 + 4.87, 1.90 + 5.50; Sponza 5.37 + 4.29,
// 3.43 + 4.82, 2.39 + 5.30, 1.91 + 5.82, 1.62 + 6.40.
static inline float vplHemiMap_Tolerance(int size)
{
    return 1.5f * 1.41421356f / (float)size + 0x1p-16f; // and rounding
}

// 2.5 f + b, metres: how near something may be to a point at distance r for map and ray to disagree, where texels look
// past the point by at most f and cosT is its plane's cosine to the light.
static inline float vplShadowBand(float r, float f, float cosT)
{
    const float sinT = sqrtf(1 - cosT * cosT);
    const float cosA = r / sqrtf(r * r + f * f), sinA = f / r * cosA;
    const float turned = sinT * cosA <= cosT * sinA ? 1 : cosT * cosA + sinT * sinA;
    return 2.5f * f + r * (1 - cosT / turned) + r * 0x1p-16f;
}

// The band of vplHemiMap_FactorBlock, and f.
static inline float vplHemiMap_Band(const vplHemiMap* map, vplVec3 point, vplVec3 normal, float* footprintOut)
{
    const vplVec3 way = vplSub(point, map->position);
    const float x = fabsf(vplDot(way, map->right)), y = fabsf(vplDot(way, map->up));
    const float r = fmaxf(vplLength(way), 1e-30f),
                f = 1.41421356f * (x + y + fabsf(vplDot(way, map->forward))) / (float)map->size;
    *footprintOut = f;
    return vplShadowBand(r, f, fminf(fabsf(vplDot(way, normal)) / r, 1));
}

static inline float vplLargestOf(vplVec3 p)
{
    return fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z)));
}

// 64 units in the last place of a coordinate: further than surfaces are from where they should be.
static inline float vplLightLift(float largest)
{
    return largest * 0x1p-18f;
}

// A ray from a point to a virtual light, which lies on a surface and maybe in a corner, and neither must shadow it: it
// aims above the surface and ends before the light, by the rounding of the larger end. The light's own coordinates do
// not do: in a Cornell box whose floor is at 0, lights near the origin were hidden from the ceiling by the floor that
// they lie on (0.46 % of all pairs), and those on an edge of a room by the other wall.
static inline vplVec3 vplWayToLight(vplVec3 light, vplVec3 n, vplVec3 from)
{
    const float lift = vplLightLift(fmaxf(vplLargestOf(light), vplLargestOf(from)));
    const vplVec3 way = vplSub(vplAdd(light, vplScale(lift, n)), from);
    const float length = fmaxf(vplLargestOf(way), 2 * lift);
    return length > 0 ? vplScale(1 - lift / length, way) : way;
}

#endif
