// SPDX-License-Identifier: MIT
#include "base/isa.h"
#include "shading/shading.h"

#include <math.h>

VPL_KERNEL_TABLE(DOCUMENTED, vplLightKernelFcn, vplLightsDocumented);
VPL_KERNEL_TABLE(PHYSICAL, vplLightKernelFcn, vplLightsPhysical);
VPL_KERNEL_TABLE(EMITTER, vplEmitterKernelFcn, vplEmitterCosine);

vplLightKernelFcn* vplGetLightKernel(vplIsa isa, vplLighting lighting)
{
    return lighting == VPL_LIGHTING_DOCUMENTED ? DOCUMENTED[isa] : PHYSICAL[isa];
}

vplEmitterKernelFcn* vplGetEmitterKernel(vplIsa isa)
{
    return EMITTER[isa];
}

void vplAccumulateLights(const vplContext* context, vplLighting lighting, float minDistance,
                         const vplSurface* surface, const vplShadeLight* lights, int count,
                         float irradiance[3][VPL_LANES])
{
    float inverseBound = minDistance > 0 ? 1 / (minDistance * minDistance) : INFINITY;
    vplGetLightKernel(context->isa, lighting)(surface, lights, count, inverseBound, irradiance);
}

void vplPrepareLights(const vplLightSet* set, vplLighting lighting, vplShadeLight* out)
{
    // A virtual light of flux P emits P/pi cos; the 1/pi is taken into the colour once.
    const float scale = lighting == VPL_LIGHTING_PHYSICAL ? (float)(1 / VPL_PI) : 1;
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        const float factor = scale * (v->weight / (float)set->particleCount);
        out[i] = (vplShadeLight){v->position.x,       v->position.y,       v->position.z,
                                 v->normal.x,         v->normal.y,         v->normal.z,
                                 factor * v->light.r, factor * v->light.g, factor * v->light.b};
    }
}
