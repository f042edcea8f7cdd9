// SPDX-License-Identifier: MIT
// The virtual lights that a picture adds up, ready for shading.
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>

// Counts the lights of step 0 that lie on surfaces. They are Keller's, and stand for emission.
static int countEmitterLights(const vplLightSet* set)
{
    int count = 0;
    for (int i = 0; set->stepCount > 0 && i < set->lightsInStep[0]; i++) {
        count += set->lights[i].object >= 0;
    }
    return count;
}

// A light stands for its share of all surfaces; nearer than the radius of that share it is no point. Half the
// distance leaves 5 to 35 % more rmse, and twice as much takes a few per cent of the light away (room,
// room-area, cornell-area; 32 to 2048 particles). Where rays find the light that is taken away, the clamp
// need not fall with the number of lights, and then the square of the error falls like 1/N.
float vplClampDistance(const vplRun* run, double lights)
{
    const vplPlan* plan = run->plan;
    if (plan->clampArea <= 0) {
        return plan->options.lights.minDistance;
    }
    const double before = (double)vplParticlesBefore(plan, run->pass),
                 now = vplParticlesOfPass(plan, run->pass);
    lights *= now > 0 ? (before + now) / now : run->pass + 1;
    const double share = lights > 0 ? sqrt(plan->clampArea / lights / VPL_PI) : 0;
    return (float)(lights > 0 && plan->compensates ? fmax(share, (double)plan->nearDistance) : share);
}

// Chooses the lights of the set that are shown: all, one, or all but those on the emitters. With
// compensation, lights on the emitters stay, because they light the hits of short rays.
static vplResult choose(const vplRun* run, vplVirtualLights* v, vplLightSet* shown)
{
    const vplRenderOptions* o = &run->plan->options;
    const vplLightSet* set = v->set;
    const bool keller = o->method == VPL_METHOD_KELLER, one = o->output.show == VPL_SHOW_LIGHT;
    v->emitterLightCount = keller && !one ? countEmitterLights(set) : 0;
    *shown = *set;
    if (one) {
        if (o->output.showIndex >= set->lightCount) {
            return vplFail(run->context, VPL_INVALID_ARGUMENT,
                           "virtual light %d does not exist, there are %d (from 0)", o->output.showIndex,
                           set->lightCount);
        }
        shown->lights += o->output.showIndex;
        shown->lightCount = 1;
    }
    if (o->output.show == VPL_SHOW_INDIRECT && keller && set->stepCount > 0) {
        if (run->plan->compensates) {
            v->first = v->emitterLightCount;
            return VPL_SUCCESS;
        }
        v->emitterLightCount = 0;
        shown->lights += set->lightsInStep[0];
        shown->lightCount -= set->lightsInStep[0];
    }
    return VPL_SUCCESS;
}

// Sorts lights by cluster and keeps the order within each. `first` is the set's index of the first light.
static vplResult sortByCluster(const vplRun* run, const vplClusteredLights* clustered, int first,
                               vplVirtualLights* v)
{
    const size_t count = (size_t)v->count;
    int* starts = vplArena_AllocZero(run->scratch, (size_t)clustered->shadowCount + 1, sizeof *starts);
    vplShadeLight* sorted = vplArena_Alloc(run->arena, count, sizeof *sorted);
    v->clusters = vplArena_Alloc(run->arena, count, sizeof *v->clusters);
    TRY(vplArena_Check(run->scratch));
    TRY(vplArena_Check(run->arena));
    const int* of = clustered->clusterOf + first;
    for (size_t i = 0; i < count; i++) {
        starts[of[i] + 1]++;
    }
    for (int i = 0; i < clustered->shadowCount; i++) {
        starts[i + 1] += starts[i];
    }
    for (size_t i = 0; i < count; i++) {
        const int at = starts[of[i]]++;
        sorted[at] = v->lights[i];
        v->clusters[at] = of[i];
    }
    v->lights = sorted;
    return VPL_SUCCESS;
}

vplResult vplMakeVirtualLights(const vplRun* run, void** resultOut)
{
    const vplClusteredLights* clustered = run->results[VPL_STAGE_CLUSTERED_LIGHTS];
    vplVirtualLights* v = vplArena_AllocZero(run->arena, 1, sizeof *v);
    vplLightSet shown;
    TRY(vplArena_Check(run->arena));
    *resultOut = v;
    v->set = clustered != NULL ? clustered->set : run->results[VPL_STAGE_PARTICLES];
    TRY(choose(run, v, &shown));
    v->lights = vplArena_Alloc(run->arena, (size_t)shown.lightCount, sizeof *v->lights);
    TRY(vplArena_Check(run->arena));
    v->count = vplPrepareLights(&shown, run->plan->shading, v->lights);
    v->minDistance = vplClampDistance(run, v->set->lightCount);
    const bool clusters = clustered != NULL && clustered->clusterOf != NULL;
    return clusters ? sortByCluster(run, clustered, (int)(shown.lights - v->set->lights), v) : VPL_SUCCESS;
}

void vplReportVirtualLights(const vplRun* run)
{
    const vplVirtualLights* v = run->results[VPL_STAGE_VIRTUAL_LIGHTS];
    run->stats->minDistance = v->minDistance;
    run->stats->lightShadows = run->plan->options.lights.shadows;
    run->stats->shadowMapEstimateMs = run->plan->shadowMapEstimateMs;
    run->stats->shadowRayEstimateMs = run->plan->shadowRayEstimateMs;
}
