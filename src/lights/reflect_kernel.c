// SPDX-License-Identifier: MIT
// One light and sixteen points that a camera sees: one number per point, which steers the choice of lights.
#include "lights/kernels.h"
#include "lights/light_term.h"
#include "lights/placement.h"

static inline __attribute__((always_inline)) void reflect(const vplViewBlock* block,
                                                          const vplShadeLight* light, float inverseClamp,
                                                          bool physical, float reflectedOut[VPL_LANES])
{
    const vplShadeLight v = *light;
    const vplVec3 m = {v.nx, v.ny, v.nz};
    const vplSurface* s = &block->surface;
    float out[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const vplVec3 way = {v.px - s->px[l], v.py - s->py[l], v.pz - s->pz[l]};
        const vplVec3 n = {s->nx[l], s->ny[l], s->nz[l]};
        const float factor = vplLightFactor(physical, way, n, m, inverseClamp);
        out[l] = factor * (v.r * block->rho[0][l] + v.g * block->rho[1][l] + v.b * block->rho[2][l]);
    }
    memcpy(reflectedOut, out, sizeof out);
}

void VPL_KERNEL(vplReflectDocumented)(const vplViewBlock* block, const vplShadeLight* light,
                                      float inverseClamp, float reflectedOut[VPL_LANES])
{
    reflect(block, light, inverseClamp, false, reflectedOut);
}

void VPL_KERNEL(vplReflectPhysical)(const vplViewBlock* block, const vplShadeLight* light, float inverseClamp,
                                    float reflectedOut[VPL_LANES])
{
    reflect(block, light, inverseClamp, true, reflectedOut);
}
