// SPDX-License-Identifier: MIT
// Hemi-octahedral shadow maps from the inside.
#ifndef VPL_VISIBILITY_HEMI_MAP_H
#define VPL_VISIBILITY_HEMI_MAP_H

#include <vpl/visibility.h>

#include "geometry/bvh.h"
#include "math/vec.h"

#include <math.h>

// Blocks of 4 x 4 texels along a side.
static inline int32_t vplHemiMap_Blocks(int32_t size)
{
    return size / VPL_BLOCK_SIDE + (size % VPL_BLOCK_SIDE > 0);
}

// Texels of all blocks.
static inline size_t vplHemiMap_Texels(int32_t size)
{
    const size_t blocks = (size_t)vplHemiMap_Blocks(size);
    return blocks * blocks * VPL_LANES;
}

// The index of a texel.
static inline int32_t vplHemiMap_Place(int32_t blocks, int32_t column, int32_t row)
{
    return ((row >> 2) * blocks + (column >> 2)) * VPL_LANES + (row & 3) * VPL_BLOCK_SIDE + (column & 3);
}

// Bit i: part of child i lies above the plane through o with normal n.
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

// The number of triangles that the map of a place draws: those in blocks of the tree that reach above its
// plane.
int64_t vplHemiMap_TrianglesAbove(const vplGeometry* geometry, const vplHemiMapPlace* place);

// Blockers that are nearer to the light than a fragment and its plane by less than this fraction of the
// distance, one and a half footprints, do not shadow it: walls that meet in a corner. More footprints lose
// shadows, fewer find false ones (bench/crossover).
static inline float vplHemiMap_Tolerance(int size)
{
    return 1.5f * 1.41421356f / (float)size + 0x1p-16f; // and rounding
}

// 64 units in the last place of a coordinate: more than the rounding of surfaces.
static inline float vplLightLift(float largest)
{
    return largest * 0x1p-18f;
}

// The ray from a point to a virtual light, which lies on a surface and maybe in a corner: neither must shadow
// it. The ray aims slightly above the surface and ends before the light, by the rounding of the larger end.
// The rounding of the light's own coordinates is not enough: in a Cornell box whose floor is at 0, the floor
// would hide lights near the origin from the ceiling (0.46 % of all pairs).
static inline vplVec3 vplWayToLight(vplVec3 light, vplVec3 n, vplVec3 from)
{
    const float lift = vplLightLift(fmaxf(vplLargestOf(light), vplLargestOf(from)));
    const vplVec3 way = vplSub(vplAdd(light, vplScale(lift, n)), from);
    const float length = fmaxf(vplLargestOf(way), 2 * lift);
    return length > 0 ? vplScale(1 - lift / length, way) : way;
}

#endif
