// SPDX-License-Identifier: MIT
// The light kernels: virtual lights become irradiance here only. Compiled once per instruction set; all give
// the same bits, because + - * / and sqrtf round correctly everywhere.
// Based on: Franchi and Ferrante, Virtual Point Lights (documented); Alexander Keller, Instant Radiosity,
// SIGGRAPH 1997 (physical). Departs: the geometry term is clamped, r^2 -> max(r^2, minDistance^2).
#include "base/isa.h"
#include "lights/light_term.h"
#include "shading/shading.h"

#include <string.h>

void VPL_KERNEL(vplAddLightsDocumented)(const vplSurface* restrict surface,
                                        const vplShadeLight* restrict lights, int count, float inverseClamp,
                                        float irradiance[restrict 3][VPL_LANES])
{
    (void)inverseClamp;
    float r[VPL_LANES], g[VPL_LANES], b[VPL_LANES];
    memcpy(r, irradiance[0], sizeof r);
    memcpy(g, irradiance[1], sizeof g);
    memcpy(b, irradiance[2], sizeof b);
    for (int i = 0; i < count; i++) {
        const vplShadeLight light = lights[i];
        for (int l = 0; l < VPL_LANES; l++) {
            float x = light.px - surface->px[l], y = light.py - surface->py[l], z = light.pz - surface->pz[l];
            float cosine = vplDocumentedCosine(x, y, z, surface->nx[l], surface->ny[l], surface->nz[l]);
            r[l] += light.r * cosine;
            g[l] += light.g * cosine;
            b[l] += light.b * cosine;
        }
    }
    memcpy(irradiance[0], r, sizeof r);
    memcpy(irradiance[1], g, sizeof g);
    memcpy(irradiance[2], b, sizeof b);
}

void VPL_KERNEL(vplAddLightsPhysical)(const vplSurface* restrict surface,
                                      const vplShadeLight* restrict lights, int count, float inverseClamp,
                                      float irradiance[restrict 3][VPL_LANES])
{
    float r[VPL_LANES], g[VPL_LANES], b[VPL_LANES];
    memcpy(r, irradiance[0], sizeof r);
    memcpy(g, irradiance[1], sizeof g);
    memcpy(b, irradiance[2], sizeof b);
    for (int i = 0; i < count; i++) {
        const vplShadeLight light = lights[i];
        for (int l = 0; l < VPL_LANES; l++) {
            float x = light.px - surface->px[l], y = light.py - surface->py[l], z = light.pz - surface->pz[l];
            float geometry = vplClampedGeometry(vplLightTermOf(x, y, z, surface->nx[l], surface->ny[l],
                                                               surface->nz[l], light.nx, light.ny, light.nz),
                                                inverseClamp);
            r[l] += light.r * geometry;
            g[l] += light.g * geometry;
            b[l] += light.b * geometry;
        }
    }
    memcpy(irradiance[0], r, sizeof r);
    memcpy(irradiance[1], g, sizeof g);
    memcpy(irradiance[2], b, sizeof b);
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
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = lanes.at[0][l] - point[0], y = lanes.at[1][l] - point[1],
                    z = lanes.at[2][l] - point[2];
        const vplLightTerm t = vplLightTermOf(x, y, z, point[3], point[4], point[5], lanes.at[3][l],
                                              lanes.at[4][l], lanes.at[5][l]);
        const float left = vplSmallerOf(t.inverse, clamps[l]) - subtracted;
        geometry[l] = (t.here * t.inverse) * (t.there * vplLargerOf(left, 0));
    }
}
