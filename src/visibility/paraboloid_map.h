// SPDX-License-Identifier: MIT
// Paraboloid maps from the inside. They are drawn in the blocks of hemi_map.h and then stored in rows, so
// that the two texels beside a point are loaded at once.
#ifndef VPL_VISIBILITY_PARABOLOID_MAP_H
#define VPL_VISIBILITY_PARABOLOID_MAP_H

#include "visibility/hemi_map.h"

// Texels from one row to the next. Rows and columns at the sides are stored twice, so that a point always has
// two.
static inline int32_t vplParaboloidMap_Stride(int size)
{
    return size + 2;
}

// Texels of one hemisphere.
static inline size_t vplParaboloidMap_Texels(int size)
{
    return (size_t)vplParaboloidMap_Stride(size) * (size_t)vplParaboloidMap_Stride(size);
}

// The index of a texel in its hemisphere.
static inline size_t vplParaboloidMap_Place(int size, int column, int row)
{
    return (size_t)(row + 1) * (size_t)vplParaboloidMap_Stride(size) + (size_t)(column + 1);
}

// Texels up to this distance from the middle hold surfaces. With a back hemisphere that is beyond the rim of
// the disk by more than a texel's diagonal, 2 sqrt(2) / size, so that all four texels around a point near the
// rim are valid.
static inline float vplParaboloidMap_Rim(int size, int hemispheres)
{
    return hemispheres == 2 ? 1 + 3 / (float)size : 1;
}

// Blockers that are nearer to the place than a fragment and its plane by less than this fraction of the
// distance do not shadow it: one footprint of a texel on the axis, whose centre is 2 sqrt(2) / size from its
// corner. More footprints lose shadows, fewer find false ones (bench/paraboloid --agree).
static inline float vplParaboloidMap_Tolerance(int size)
{
    return 2 * 1.41421356f / (float)size;
}

#endif
