// SPDX-License-Identifier: MIT
// Sixteen virtual lights for one point, where points are too few and far between to fill vectors.
#include "base/isa.h"
#include "shading/compensation.h"

#include <float.h>
#include <string.h>

vplPointKernelFcn VPL_KERNEL(vplLightsOfPoint);

void VPL_KERNEL(vplLightsOfPoint)(const vplLightLanes* restrict lights, const float point[restrict 6],
                                  const float inverseBound[restrict VPL_LANES], float taken,
                                  float geometry[restrict VPL_LANES])
{
    vplLightLanes lanes;
    float bounds[VPL_LANES];
    memcpy(&lanes, lights, sizeof lanes);
    memcpy(bounds, inverseBound, sizeof bounds);
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = lanes.at[0][l] - point[0], y = lanes.at[1][l] - point[1],
                    z = lanes.at[2][l] - point[2];
        const float square = x * x + y * y + z * z;
        float here = point[3] * x + point[4] * y + point[5] * z;
        float there = -(lanes.at[3][l] * x + lanes.at[4][l] * y + lanes.at[5][l] * z);
        here = here > 0 ? here : 0;
        there = there > 0 ? there : 0;
        const float inverse = 1 / (square > FLT_MIN ? square : FLT_MIN);
        const float bounded = inverse < bounds[l] ? inverse : bounds[l];
        const float left = bounded - taken;
        geometry[l] = (here * inverse) * (there * (left > 0 ? left : 0));
    }
}
