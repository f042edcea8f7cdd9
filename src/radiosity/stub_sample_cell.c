// SPDX-License-Identifier: MIT
// Stands in until the patches branch is merged, which brings the real one.
#include "math/vec.h"

#include <vpl/radiosity.h>

static void outward(int part, float w[3])
{
    for (int k = 0; k < 3; k++) {
        w[k] = part == 3 ? 0.5f * (1 - w[k]) : 0.5f * (w[k] + (k == part ? 1.0f : 0.0f));
    }
}

vplVec3 vplPatchSide_SampleCell(const vplPatchSide* side, int cell, float u, float v)
{
    float w[3];
    w[1] = v > u ? 0.5f * u : u - 0.5f * v;
    w[2] = v > u ? v - 0.5f * u : 0.5f * v;
    w[0] = 1 - w[1] - w[2];
    outward(cell & 3, w);
    outward(cell >> 2, w);
    return vplAdd(vplScale(w[0], side->corners[0]),
                  vplAdd(vplScale(w[1], side->corners[1]), vplScale(w[2], side->corners[2])));
}
