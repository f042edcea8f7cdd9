// SPDX-License-Identifier: MIT
// Whether, and with how many rays, a picture gets back what the bound of near virtual lights takes away.
#include "render/ingredients.h"
#include <stdlib.h>

bool vplCompensates(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    const bool keller = o->method == VPL_METHOD_KELLER;
    const bool usual =
        keller && o->lighting == VPL_LIGHTING_PHYSICAL && o->lightShadows != VPL_LIGHT_SHADOWS_NONE;
    const bool wanted = o->compensation == VPL_COMPENSATION_RAYS ||
                        (o->compensation == VPL_COMPENSATION_USUAL && usual);
    const bool shown = o->show == VPL_SHOW_PICTURE || o->show == VPL_SHOW_INDIRECT ||
                       o->show == VPL_SHOW_OVERLAY || (o->show == VPL_SHOW_DIRECT && keller);
    return wanted && shown && o->minDistance != 0 && o->method != VPL_METHOD_DIRECT &&
           vplJob_GetShading(job) == VPL_LIGHTING_PHYSICAL;
}

vplCompensationDef vplMakeCompensation(const vplJob* job, const vplIngredients* in)
{
    const vplRenderOptions* o = &job->options;
    const bool keller = o->method == VPL_METHOD_KELLER;
    vplCompensationDef def = {.rayCount = getenv("VPL_N") ? atoi(getenv("VPL_N")) : 4,
                              .hitLights = getenv("VPL_M") ? atoi(getenv("VPL_M")) : 64,
                              .seed = o->seed,
                              .emitters = in->emitters,
                              .shadows = in->emitterMaps.shadows,
                              .emitterCount = in->emitterMaps.shadows ? in->emitterCount : 0,
                              .lamps = in->lamps,
                              .lampCount = in->lampCount,
                              .lampMinDistance = in->lampMinDistance,
                              .lights = in->lights,
                              .lightShadows = in->lightMaps.shadows,
                              .lightCount = in->lightCount,
                              .reflection = 1,
                              .lampsAreLights = keller};
    if (o->lighting == VPL_LIGHTING_DOCUMENTED) {
        def.reflection = (float)(1 / VPL_PI);
    }
    def.seesEmission = keller && o->show != VPL_SHOW_INDIRECT;
    def.seesReflection = !(keller && o->show == VPL_SHOW_DIRECT);
    return def;
}

// Some thousand points tell the share to a per cent of it or so; fewer where they would take more than about a
// hundredth of the time that the picture takes.
static int pointsToAsk(const vplJob* job, const vplIngredients* in)
{
    (void)in;
    (void)job;
    return 1024;
}

vplResult vplEstimateLoss(vplJob* job, const vplIngredients* in, const vplShadeDef* shown)
{
    vplShadeDef def = *shown;
    vplCompensationDef compensation = vplMakeCompensation(job, in);
    vplClampLoss loss = {0, 0};
    compensation.rayCount = 4;
    compensation.hitLights = 16;
    compensation.firstRay = (uint32_t)job->stepsDone * 1024;
    def.compensation = &compensation;
    const vplResult result =
        vplEstimateClampLoss(job->geometry, &job->view, &def, pointsToAsk(job, in), &loss);
    job->loss.lost += loss.lost;
    job->loss.all += loss.all;
    job->stats.clampLoss = job->loss.all > 0 ? job->loss.lost / job->loss.all : 0;
    return result;
}
