// SPDX-License-Identifier: MIT
// The sixteen cells of a triangle: cell 4 a + b is part b of part a, where parts 0, 1 and 2 of a triangle are those at
// its corners and part 3 is the middle one.
#ifndef VPL_RADIOSITY_CELLS_H
#define VPL_RADIOSITY_CELLS_H

#include <vpl/radiosity.h>

#include "math/vec.h"

// Weights within the part -> weights within the whole.
static inline void vplCell_Outward(int part, float w[3])
{
    for (int k = 0; k < 3; k++) {
        w[k] = part == 3 ? 0.5f * (1 - w[k]) : 0.5f * (w[k] + (k == part ? 1.0f : 0.0f));
    }
}

// A point of a cell, uniform over it for u, v uniform in [0, 1), by the map of Heitz, A Low-Distortion Map Between
// Triangle and Square, 2019.
static inline vplVec3 vplCell_Point(const vplVec3 corners[3], int cell, float u, float v)
{
    float w[3];
    w[1] = v > u ? 0.5f * u : u - 0.5f * v;
    w[2] = v > u ? v - 0.5f * u : 0.5f * v;
    w[0] = 1 - w[1] - w[2];
    vplCell_Outward(cell & 3, w);
    vplCell_Outward(cell >> 2, w);
    return vplAdd(vplScale(w[0], corners[0]), vplAdd(vplScale(w[1], corners[1]), vplScale(w[2], corners[2])));
}

// The part that a point lies in by its weights, which become those within the part.
static inline int vplCell_Inward(double w[3])
{
    const int part = w[0] >= 0.5 ? 0 : w[1] >= 0.5 ? 1 : w[2] >= 0.5 ? 2 : 3;
    for (int k = 0; k < 3; k++) {
        w[k] = part == 3 ? 1 - 2 * w[k] : 2 * w[k] - (k == part);
    }
    return part;
}

// The cell that a point of a triangle lies in, or nearly.
int vplCell_Find(const vplVec3 corners[3], vplVec3 point);

// The corners of a patch, counter-clockwise seen from one of its sides.
void vplSide_GetCorners(const vplPatches* patches, int patch, bool back, vplVec3 cornersOut[3]);

#endif
