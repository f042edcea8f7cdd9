// SPDX-License-Identifier: MIT
// What compensation needs beside a render's own things.
#include "shading/compensation.h"

#include <math.h>

vplResult vplOpenNearLight(vplShading* shading)
{
    const vplShadeDef* outer = shading->def;
    const vplCompensationDef* def = outer->compensation;
    vplContext* context = shading->geometry->context;
    if (def == NULL || outer->lighting != VPL_LIGHTING_PHYSICAL || !(outer->minDistance > 0)) {
        return VPL_SUCCESS;
    }
    vplNearLight* near = vplAllocZero(context, 1, sizeof *near);
    if (near == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    shading->nearLight = near;
    near->def = def;
    near->kernel = vplGetPointKernel(context->isa);
    near->sobol = vplSobol_Make();
    near->distance = outer->minDistance;
    near->lampDistance = fminf(def->emitterLightDistance, outer->minDistance);
    near->areaLightInverseBound = vplInverseSquare(near->lampDistance);
    near->hitsDef = (vplShadeDef){.lighting = VPL_LIGHTING_PHYSICAL,
                                  .emitters = def->emitters,
                                  .shadows = def->shadows,
                                  .emitterCount = def->emitterCount,
                                  .areaLights = def->areaLights,
                                  .areaLightCount = def->areaLightCount,
                                  .areaLightMinDistance = def->areaLightMinDistance};
    near->hits = vplShading_Make(shading->geometry, shading->view, &near->hitsDef);
    return vplMakeEmitterRays(&near->hits);
}

void vplCloseNearLight(vplShading* shading)
{
    if (shading->nearLight != NULL) {
        vplContext* context = shading->geometry->context;
        vplFree(context, shading->nearLight->hits.emitters);
        vplFree(context, shading->nearLight);
    }
}
