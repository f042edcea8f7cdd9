// SPDX-License-Identifier: MIT
// What SSVP keeps: reflective maps and lights, from frame to frame where nothing that they depend on has changed.
#include "base/rng.h"
#include "render/history.h"
#include "render/ssvp.h"

#include <string.h>

enum { SHIFT_STREAM = 0x80000004u };

// ---- what it depends on

// 0, the points as published, for seed 0, the first pass and frames that keep their patterns.
static uint64_t shiftOf(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    double frame = o->sequence.coherence == VPL_COHERENCE_OFF ? o->sequence.frame : 0;
    uint64_t bits = 0;
    frame = frame == 0 ? 0 : frame; // and not -0
    memcpy(&bits, &frame, sizeof bits);
    if (o->seed == 0 && job->stepsDone == 0 && bits == 0) {
        return 0;
    }
    const vplRandom4 r =
        vplRandomAt(o->seed, SHIFT_STREAM, bits ^ (uint64_t)job->stepsDone * 0x9e3779b97f4a7c15u);
    return ((uint64_t)r.v[0] << 32 | r.v[1]) | 1;
}

vplSsvpKey vplSsvp_FindKey(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    vplSsvpKey key;
    memset(&key, 0, sizeof key); // the gaps, too
    key.clusters = o->ssvp.clusters;
    key.firstBounce = o->ssvp.firstBounce;
    key.oversampling = o->ssvp.oversampling;
    key.secondBounce = o->ssvp.secondBounce;
    key.paraboloidSize = o->ssvp.paraboloidSize;
    key.rsmSize = o->shadow.rsmSize;
    key.maxBounces = o->maxBounces;
    key.hemispheres = o->ssvp.hemispheres;
    key.clusterMetric = (int)o->ssvp.metric;
    key.clusterPlace = (int)o->ssvp.place;
    key.secondWeight = (int)o->ssvp.secondWeight;
    key.lightShadows = (int)vplJob_GetLightShadows(job);
    key.shown = o->output.show == VPL_SHOW_PARABOLOID || o->output.show == VPL_SHOW_CLUSTERS;
    key.w1 = o->ssvp.w1;
    key.w2 = o->ssvp.w2;
    key.shift = shiftOf(job);
    return key;
}

// Direct light takes its shadows from them, lights are samples of them.
static bool needsMaps(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    return o->lights.shadows != VPL_LIGHT_SHADOWS_RAY || vplNeedsLights(o) || o->output.show == VPL_SHOW_RSM;
}

// Whether the last frame's maps do: nothing that they depend on has changed, and they are there where they are needed.
static bool isStill(const vplJob* job, const vplSsvpState* last)
{
    bool still = last->emitterCount == job->emitterCount && last->rsmSize == job->options.shadow.rsmSize &&
                 (last->drawn || !needsMaps(job));
    for (int i = 0; still && i < job->emitterCount; i++) {
        still = vplIsSameEmitter(&job->emitters[i], &last->emitters[i]);
    }
    return still;
}

// ---- reflective maps

static vplResult makeState(vplJob* job, vplSsvpState** stateOut)
{
    vplSsvpState* state = vplAllocZero(job->context, 1, sizeof *state);
    if (state == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const size_t count = (size_t)job->emitterCount;
    state->context = job->context;
    state->emitters = vplAlloc(job->context, count, sizeof *state->emitters);
    state->maps = vplAllocZero(job->context, count, sizeof *state->maps);
    if (state->emitters == NULL || state->maps == NULL) {
        vplSsvp_Destroy(state);
        return VPL_OUT_OF_MEMORY;
    }
    state->emitterCount = job->emitterCount;
    state->rsmSize = job->options.shadow.rsmSize;
    for (size_t i = 0; i < count; i++) {
        state->emitters[i] = job->emitters[i];
    }
    *stateOut = state;
    return VPL_SUCCESS;
}

vplResult vplSsvp_Begin(vplJob* job, vplSsvpState** stateOut)
{
    vplHistory* history = job->options.sequence.history;
    if (job->options.lighting == VPL_LIGHTING_DOCUMENTED) {
        return vplFail(job->context, VPL_INVALID_ARGUMENT,
                       "the SSVP document prints no lighting formulas of its own; use physical lighting");
    }
    if (history != NULL && history->ssvp != NULL && isStill(job, history->ssvp)) {
        *stateOut = history->ssvp;
        history->ssvp = NULL;
        return VPL_SUCCESS;
    }
    vplSsvpState* state;
    vplResult result = makeState(job, &state);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplJob_BeginStage(job, 0.05);
    if (needsMaps(job)) {
        result = vplJob_DrawReflectiveMaps(job, job->emitters, job->emitterCount, state->maps);
        state->drawn = true;
    }
    vplJob_EndStage(job, "reflective map");
    if (result != VPL_SUCCESS) {
        vplSsvp_Destroy(state);
        return result;
    }
    *stateOut = state;
    return VPL_SUCCESS;
}

// ---- the end

void vplSsvpLights_Destroy(vplSsvpLights* lights)
{
    if (lights == NULL) {
        return;
    }
    for (int i = 0; i < 2; i++) {
        vplLightSet_Destroy(lights->bounce[i].lights);
        vplLightClusters_Destroy(lights->bounce[i].clusters);
        vplParaboloidMaps_Destroy(lights->bounce[i].maps);
        vplFree(lights->context, lights->bounce[i].lookers);
    }
    vplLightSet_Destroy(lights->set);
    vplFree(lights->context, lights->use);
    vplFree(lights->context, lights->clusterOf);
    vplFree(lights->context, lights->shadows);
    vplFree(lights->context, lights);
}

void vplSsvp_Destroy(vplSsvpState* state)
{
    if (state != NULL) {
        vplSsvpLights_Destroy(state->lights);
        for (int i = 0; state->maps != NULL && i < state->emitterCount; i++) {
            vplReflectiveMap_Destroy(state->maps[i]);
        }
        vplFree(state->context, state->maps);
        vplFree(state->context, state->emitters);
        vplFree(state->context, state);
    }
}

void vplSsvp_End(vplJob* job, vplSsvpState* state)
{
    vplHistory* history = job->options.sequence.history;
    if (history == NULL || state == NULL) {
        vplSsvp_Destroy(state);
        return;
    }
    vplSsvp_Destroy(history->ssvp);
    history->ssvp = state;
    history->destroySsvp = vplSsvp_Destroy;
}
