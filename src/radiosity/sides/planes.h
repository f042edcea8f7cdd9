// SPDX-License-Identifier: MIT
// Values of sides, channel by channel.
#ifndef VPL_RADIOSITY_PLANES_H
#define VPL_RADIOSITY_PLANES_H

#include "base/arena.h"
#include "radiosity/radiosity_kernels.h"

// `count`, rounded up to a multiple of VPL_SIDE_LANES.
size_t vplPaddedSides(int count);

// All 0, in one allocation. NULL planes when out of memory; vplArena_Check reports it.
vplPlanes vplPlanes_Alloc(vplArena* arena, int count);

void vplPlanes_Read(vplPlanes* planes, const vplRgb* values, int count);
void vplPlanes_Write(const vplPlanes* planes, int count, vplRgb* valuesOut);

#endif
