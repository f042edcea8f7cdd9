// SPDX-License-Identifier: MIT
#include "base/isa.h"
#include "lights/prepare.h"
#include "shading/compensation.h"

#include <math.h>

VPL_KERNEL_TABLE(DOCUMENTED, vplLightKernelFcn, vplLightsDocumented);
VPL_KERNEL_TABLE(PHYSICAL, vplLightKernelFcn, vplLightsPhysical);
VPL_KERNEL_TABLE(POINT, vplPointKernelFcn, vplLightsOfPoint);
VPL_KERNEL_TABLE(EMITTERS, vplAddEmittersFcn, vplAddEmitters);
VPL_KERNEL_TABLE(CULL_DOCUMENTED, vplCullFcn, vplCullDocumented);
VPL_KERNEL_TABLE(CULL_PHYSICAL, vplCullFcn, vplCullPhysical);
VPL_KERNEL_TABLE(BOUND_DOCUMENTED, vplClusterBoundFcn, vplClusterBoundDocumented);
VPL_KERNEL_TABLE(BOUND_PHYSICAL, vplClusterBoundFcn, vplClusterBoundPhysical);
VPL_KERNEL_TABLE(SURFACE, vplFragmentFcn, vplShadeSurface);
VPL_KERNEL_TABLE(GBUFFER, vplFragmentFcn, vplWriteGbuffer);
VPL_KERNEL_TABLE(DIRECT, vplFragmentFcn, vplShadeDirect);
VPL_KERNEL_TABLE(LIGHTS, vplPassesFcn, vplShadeLights);
VPL_KERNEL_TABLE(LIGHT_TILE, vplTileFcn, vplLightTile);
VPL_KERNEL_TABLE(INTERLEAVED_TILE, vplTileFcn, vplInterleaveTile);
VPL_KERNEL_TABLE(CUT_TILE, vplTileFcn, vplCutTile);
VPL_KERNEL_TABLE(GATHER_TILE, vplTaskFcn, vplGatherTile);
VPL_KERNEL_TABLE(SHOW_TILE, vplTileFcn, vplShowTile);
VPL_KERNEL_TABLE(FOLD_TILE, vplTileFcn, vplFoldTile);
VPL_KERNEL_TABLE(RESOLVE_TILE, vplTileFcn, vplResolveTile);

vplShadingKernels vplGetShadingKernels(vplIsa isa)
{
    return (vplShadingKernels){.surface = SURFACE[isa],
                               .gbuffer = GBUFFER[isa],
                               .direct = DIRECT[isa],
                               .lights = LIGHTS[isa],
                               .light = LIGHT_TILE[isa],
                               .interleaved = INTERLEAVED_TILE[isa],
                               .cut = CUT_TILE[isa],
                               .gather = GATHER_TILE[isa],
                               .show = SHOW_TILE[isa],
                               .fold = FOLD_TILE[isa],
                               .resolve = RESOLVE_TILE[isa]};
}

vplCullFcn* vplGetCull(vplIsa isa, vplLighting lighting)
{
    return lighting == VPL_LIGHTING_DOCUMENTED ? CULL_DOCUMENTED[isa] : CULL_PHYSICAL[isa];
}

vplLightKernelFcn* vplGetLightKernel(vplIsa isa, vplLighting lighting)
{
    return lighting == VPL_LIGHTING_DOCUMENTED ? DOCUMENTED[isa] : PHYSICAL[isa];
}

vplClusterBoundFcn* vplGetClusterBound(vplIsa isa, vplLighting lighting)
{
    return lighting == VPL_LIGHTING_DOCUMENTED ? BOUND_DOCUMENTED[isa] : BOUND_PHYSICAL[isa];
}

vplPointKernelFcn* vplGetPointKernel(vplIsa isa)
{
    return POINT[isa];
}

vplAddEmittersFcn* vplGetAddEmitters(vplIsa isa)
{
    return EMITTERS[isa];
}

void vplAccumulateLights(const vplContext* context, vplLighting lighting, float minDistance,
                         const vplSurface* surface, const vplShadeLight* lights, int count,
                         float irradiance[3][VPL_LANES])
{
    float inverseBound = minDistance > 0 ? 1 / (minDistance * minDistance) : INFINITY;
    vplGetLightKernel(context->isa, lighting)(surface, lights, count, inverseBound, irradiance);
}

int vplPrepareLights(const vplLightSet* set, vplLighting lighting, vplShadeLight* out)
{
    int count = 0;
    for (int i = 0; i < set->lightCount; i++) {
        if (set->lights[i].object >= 0) {
            out[count++] = vplPrepareLight(&set->lights[i], set->particleCount, lighting);
        }
    }
    return count;
}
