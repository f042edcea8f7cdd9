// SPDX-License-Identifier: MIT
// One light and sixteen points that a camera sees: one number per point, which steers the choice of lights.
#include "lights/kernels.h"
#include "lights/light_term.h"
#include "lights/placement.h"

void VPL_KERNEL(vplReflectDocumented)(const vplViewBlock* block, const vplShadeLight* light,
                                      float inverseClamp, float reflectedOut[VPL_LANES])
{
    (void)inverseClamp;
    const vplShadeLight v = *light;
    const vplSurface* s = &block->surface;
    float out[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = v.px - s->px[l], y = v.py - s->py[l], z = v.pz - s->pz[l];
        const float cosine = vplDocumentedCosine(x, y, z, s->nx[l], s->ny[l], s->nz[l]);
        out[l] = cosine * (v.r * block->rho[0][l] + v.g * block->rho[1][l] + v.b * block->rho[2][l]);
    }
    memcpy(reflectedOut, out, sizeof out);
}

void VPL_KERNEL(vplReflectPhysical)(const vplViewBlock* block, const vplShadeLight* light, float inverseClamp,
                                    float reflectedOut[VPL_LANES])
{
    const vplShadeLight v = *light;
    const vplSurface* s = &block->surface;
    float out[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = v.px - s->px[l], y = v.py - s->py[l], z = v.pz - s->pz[l];
        const vplLightTerm t = vplLightTermOf(x, y, z, s->nx[l], s->ny[l], s->nz[l], v.nx, v.ny, v.nz);
        const float geometry = vplClampedGeometry(t, inverseClamp);
        out[l] = geometry * (v.r * block->rho[0][l] + v.g * block->rho[1][l] + v.b * block->rho[2][l]);
    }
    memcpy(reflectedOut, out, sizeof out);
}
