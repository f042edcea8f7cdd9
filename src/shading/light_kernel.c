// SPDX-License-Identifier: MIT
// The light kernels: virtual lights become irradiance here only. Compiled once per instruction set; all give
// the same bits, because + - * / and sqrtf round correctly everywhere.
// Based on: Franchi and Ferrante, Virtual Point Lights (documented); Alexander Keller, Instant Radiosity,
// SIGGRAPH 1997 (physical). Departs: the geometry term is clamped, r^2 -> max(r^2, minDistance^2).
#include "base/isa.h"
#include "lights/light_term.h"
#include "shading/shading.h"

#include <string.h>

static inline __attribute__((always_inline)) void addLights(const vplSurface* restrict surface,
                                                            const vplShadeLight* restrict lights, int count,
                                                            float inverseClamp, bool physical,
                                                            float irradiance[restrict 3][VPL_LANES])
{
    float r[VPL_LANES], g[VPL_LANES], b[VPL_LANES];
    memcpy(r, irradiance[0], sizeof r);
    memcpy(g, irradiance[1], sizeof g);
    memcpy(b, irradiance[2], sizeof b);
    for (int i = 0; i < count; i++) {
        const vplShadeLight light = lights[i];
        const vplVec3 m = {light.nx, light.ny, light.nz};
        for (int l = 0; l < VPL_LANES; l++) {
            const vplVec3 way = {light.px - surface->px[l], light.py - surface->py[l],
                                 light.pz - surface->pz[l]};
            const vplVec3 n = {surface->nx[l], surface->ny[l], surface->nz[l]};
            const float factor = vplLightFactor(physical, way, n, m, inverseClamp);
            r[l] += light.r * factor;
            g[l] += light.g * factor;
            b[l] += light.b * factor;
        }
    }
    memcpy(irradiance[0], r, sizeof r);
    memcpy(irradiance[1], g, sizeof g);
    memcpy(irradiance[2], b, sizeof b);
}

void VPL_KERNEL(vplAddLightsDocumented)(const vplSurface* restrict surface,
                                        const vplShadeLight* restrict lights, int count, float inverseClamp,
                                        float irradiance[restrict 3][VPL_LANES])
{
    addLights(surface, lights, count, inverseClamp, false, irradiance);
}

void VPL_KERNEL(vplAddLightsPhysical)(const vplSurface* restrict surface,
                                      const vplShadeLight* restrict lights, int count, float inverseClamp,
                                      float irradiance[restrict 3][VPL_LANES])
{
    addLights(surface, lights, count, inverseClamp, true, irradiance);
}

// Sixteen lights for one point: points that rays hit are too few to fill vectors.
void VPL_KERNEL(vplLightsOfPoint)(const vplLightLanes* restrict lights, const float point[restrict 6],
                                  const float inverseClamp[restrict VPL_LANES], float subtracted,
                                  float geometry[restrict VPL_LANES])
{
    vplLightLanes lanes;
    float clamps[VPL_LANES];
    memcpy(&lanes, lights, sizeof lanes);
    memcpy(clamps, inverseClamp, sizeof clamps);
    const vplVec3 n = {point[3], point[4], point[5]};
    for (int l = 0; l < VPL_LANES; l++) {
        const vplVec3 way = {lanes.at[0][l] - point[0], lanes.at[1][l] - point[1], lanes.at[2][l] - point[2]};
        const vplVec3 m = {lanes.at[3][l], lanes.at[4][l], lanes.at[5][l]};
        const vplLightTerm t = vplLightTermOf(way, n, m);
        const float left = vplSmallerOf(t.inverse, clamps[l]) - subtracted;
        geometry[l] = (t.here * t.inverse) * (t.there * vplLargerOf(left, 0));
    }
}
