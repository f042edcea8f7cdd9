// SPDX-License-Identifier: MIT
// One light against sixteen points that a camera sees, by the formulas of shading/light_kernel.c. Those lie in a
// layer above; here one number per point is wanted, and it only steers a choice.
#include "base/isa.h"
#include "lights/placement.h"

#include <float.h>
#include <math.h>
#include <string.h>

vplReflectFcn VPL_KERNEL(vplReflectDocumented), VPL_KERNEL(vplReflectPhysical);

// Larger of a number and 0, which it is where nothing is seen.
static inline float positive(float x)
{
    return x > 0 ? x : 0;
}

void VPL_KERNEL(vplReflectDocumented)(const vplSeenBlock* block, const vplShadeLight* light,
                                      float inverseBound, float reflectedOut[VPL_LANES])
{
    (void)inverseBound;
    const vplShadeLight v = *light;
    const vplSurface* s = &block->surface;
    float out[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = v.px - s->px[l], y = v.py - s->py[l], z = v.pz - s->pz[l];
        const float square = x * x + y * y + z * z, d2 = square > FLT_MIN ? square : FLT_MIN;
        const float cosine = positive(s->nx[l] * x + s->ny[l] * y + s->nz[l] * z) / sqrtf(d2);
        out[l] = cosine * (v.r * block->rho[0][l] + v.g * block->rho[1][l] + v.b * block->rho[2][l]);
    }
    memcpy(reflectedOut, out, sizeof out);
}

void VPL_KERNEL(vplReflectPhysical)(const vplSeenBlock* block, const vplShadeLight* light, float inverseBound,
                                    float reflectedOut[VPL_LANES])
{
    const vplShadeLight v = *light;
    const vplSurface* s = &block->surface;
    float out[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = v.px - s->px[l], y = v.py - s->py[l], z = v.pz - s->pz[l];
        const float square = x * x + y * y + z * z, d2 = square > FLT_MIN ? square : FLT_MIN;
        const float here = positive(s->nx[l] * x + s->ny[l] * y + s->nz[l] * z);
        const float there = positive(-(v.nx * x + v.ny * y + v.nz * z));
        const float inverse = 1 / d2, bounded = inverse < inverseBound ? inverse : inverseBound;
        const float geometry = (here * inverse) * (there * bounded);
        out[l] = geometry * (v.r * block->rho[0][l] + v.g * block->rho[1][l] + v.b * block->rho[2][l]);
    }
    memcpy(reflectedOut, out, sizeof out);
}
