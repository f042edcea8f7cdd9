// SPDX-License-Identifier: MIT
// Sixteen virtual lights for one point, where points are too few and far between to fill vectors.
#include "base/isa.h"
#include "lights/light_term.h"
#include "shading/compensation.h"

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
        const vplLightTerm t = vplLightTermOf(x, y, z, point[3], point[4], point[5], lanes.at[3][l],
                                              lanes.at[4][l], lanes.at[5][l]);
        const float left = vplSmallerOf(t.inverse, bounds[l]) - taken;
        geometry[l] = (t.here * t.inverse) * (t.there * vplLargerOf(left, 0));
    }
}
