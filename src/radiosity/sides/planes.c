// SPDX-License-Identifier: MIT
#include "radiosity/sides/planes.h"

size_t vplPaddedSides(int count)
{
    return ((size_t)count + VPL_SIDE_LANES - 1) / VPL_SIDE_LANES * VPL_SIDE_LANES;
}

vplPlanes vplPlanes_Alloc(vplArena* arena, int count)
{
    const size_t stride = vplPaddedSides(count);
    float* values = vplArena_AllocZero(arena, 3 * stride, sizeof *values);
    return values != NULL ? (vplPlanes){{values, values + stride, values + 2 * stride}} : (vplPlanes){{NULL}};
}

void vplPlanes_Read(vplPlanes* planes, const vplRgb* values, int count)
{
    for (int i = 0; i < count; i++) {
        planes->c[0][i] = values[i].r;
        planes->c[1][i] = values[i].g;
        planes->c[2][i] = values[i].b;
    }
}

void vplPlanes_Write(const vplPlanes* planes, int count, vplRgb* valuesOut)
{
    for (int i = 0; i < count; i++) {
        valuesOut[i] = (vplRgb){planes->c[0][i], planes->c[1][i], planes->c[2][i]};
    }
}
