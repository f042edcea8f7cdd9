// SPDX-License-Identifier: MIT
// Based on: Vitor Aranha, Marcio Macedo and Antonio Apolinario, Screen-Space Virtual Point Light Propagation for
// Real-Time Global Illumination: reflective maps of what the lights see, samples of them as first-bounce lights, k-means
// clusters of these, a paraboloid map per cluster, samples of those as second-bounce lights; then the camera's view is
// shaded by all of them, interleaved. Departs where the document says nothing or slips (EXTREMES.md, SSVP):
// second-bounce lights are weighted, and have clusters and maps of their own to see by; a cluster that may shine behind
// its plane has a second hemisphere; light of surfaces that emit, which no reflective map begins from, comes by particles.
#include "render/ssvp.h"

#include "lights/light_set.h"
#include "render/history.h"

#include <string.h>

// ---- stages that are not always wanted

static vplResult clusterFirst(vplSsvpMaking* m)
{
    return m->sees || m->twice || m->lights->key.shown ? vplSsvp_Cluster(m, 0) : VPL_SUCCESS;
}

static vplResult drawFirst(vplSsvpMaking* m)
{
    const bool shown = m->lights->key.shown;
    return m->sees || m->twice || shown ? vplSsvp_DrawMaps(m, m->twice || shown, 0) : VPL_SUCCESS;
}

static vplResult clusterSecond(vplSsvpMaking* m)
{
    return m->sees ? vplSsvp_Cluster(m, 1) : VPL_SUCCESS;
}

static vplResult drawSecond(vplSsvpMaking* m)
{
    return m->sees && m->lights->bounce[1].lights != NULL ? vplSsvp_DrawMaps(m, false, 1) : VPL_SUCCESS;
}

// ---- both bounces as one list

static void listShadows(const vplSsvpBounce* bounce, int* clusterOf, vplSsvpLights* lights)
{
    for (int i = 0; i < bounce->lights->lightCount; i++) {
        clusterOf[i] = lights->shadowCount + bounce->clusters->of[i];
    }
    for (int i = 0; i < bounce->maps->count; i++) {
        lights->shadows[lights->shadowCount++] = bounce->maps->maps[i];
    }
}

static vplResult join(vplSsvpMaking* m)
{
    vplSsvpLights* l = m->lights;
    const vplLightSet none = {.context = l->context, .particleCount = 1};
    const vplLightSet* second = l->bounce[1].lights ? l->bounce[1].lights : &none;
    vplResult result = vplLightSet_Join(l->bounce[0].lights, second, &l->set);
    size_t shadows = 0;
    for (int i = 0; i < 2; i++) {
        shadows += m->sees && l->bounce[i].maps ? (size_t)l->bounce[i].maps->count : 0;
    }
    if (result == VPL_SUCCESS && m->sees) {
        l->clusterOf = vplAlloc(l->context, (size_t)l->set->lightCount, sizeof(int));
        l->shadows = vplAlloc(l->context, shadows, sizeof *l->shadows);
        result = l->clusterOf && l->shadows ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    }
    for (int i = 0, at = 0; i < 2 && result == VPL_SUCCESS && m->sees; i++) {
        if (l->bounce[i].maps != NULL) {
            listShadows(&l->bounce[i], l->clusterOf + at, l);
            at += l->bounce[i].lights->lightCount;
        }
    }
    return result;
}

// ---- the recipe

static const struct {
    double to; // share of the progress
    const char* name;
    vplResult (*run)(vplSsvpMaking*);
} STAGES[] = {{0.06, "first bounce", vplSsvp_SampleFirstBounce},
              {0.07, "clusters", clusterFirst},
              {0.12, "paraboloid", drawFirst},
              {0.13, "second bounce", vplSsvp_SampleSecondBounce},
              {0.14, "second clusters", clusterSecond},
              {0.19, "second paraboloid", drawSecond},
              {0.2, "list", join}};

static vplResult cook(vplSsvpMaking* m)
{
    vplResult result = VPL_SUCCESS;
    for (size_t i = 0; i < sizeof STAGES / sizeof *STAGES && result == VPL_SUCCESS; i++) {
        vplJob_BeginStage(m->job, STAGES[i].to);
        result = STAGES[i].run(m);
        vplJob_EndStage(m->job, STAGES[i].name);
    }
    return result;
}

vplResult vplSsvp_MakeLights(vplJob* job, vplSsvpState* state)
{
    const vplSsvpKey key = vplSsvp_FindKey(job);
    const vplHistory* history = job->options.sequence.history;
    if (state->lights != NULL && memcmp(&state->lights->key, &key, sizeof key) == 0) {
        return VPL_SUCCESS;
    }
    vplSsvpLights* lights = vplAllocZero(job->context, 1, sizeof *lights);
    if (lights == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    lights->context = job->context;
    memcpy(&lights->key, &key, sizeof key);
    vplSsvpMaking m = {.job = job, .state = state, .lights = lights};
    const vplSsvpLights* last = state->lights == NULL && history != NULL && history->ssvp != NULL
                                    ? history->ssvp->lights
                                    : state->lights;
    // Passes have other samples, which have nothing to do with those of the same number before.
    if (job->options.sequence.coherence == VPL_COHERENCE_ON && last != NULL && last->key.shift == key.shift) {
        m.last = last;
    }
    m.sees = key.lightShadows == VPL_LIGHT_SHADOWS_CLUSTER;
    m.twice = key.maxBounces != 1 && key.secondBounce > 0;
    vplResult result = cook(&m);
    if (result != VPL_SUCCESS) {
        vplSsvpLights_Destroy(lights);
        return result;
    }
    vplSsvpLights_Destroy(state->lights);
    state->lights = lights;
    return VPL_SUCCESS;
}

vplResult vplSsvp_TakeLights(vplJob* job, vplLightSet** setOut)
{
    vplSsvpState* state;
    vplResult result = vplSsvp_Begin(job, &state);
    if (result != VPL_SUCCESS) {
        return result;
    }
    result = vplSsvp_MakeLights(job, state);
    if (result == VPL_SUCCESS) {
        *setOut = state->lights->set;
        state->lights->set = NULL;
    }
    vplSsvp_Destroy(state);
    return result;
}
