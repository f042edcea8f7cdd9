// SPDX-License-Identifier: MIT
// SSVP's lights: samples of reflective maps, those of use among them, and samples of what clusters see.
#include "render/ssvp.h"

#include "lights/light_set.h"
#include "math/vec.h"

#include <math.h>

// Of each light, to find of what use it is: weights change by sixteenths.
enum { USE_RAYS = 16 };

// ---- the first bounce

// How many of the first-bounce lights come from surfaces that emit: their share of the power.
static vplResult countLampLights(const vplJob* job, int* countOut)
{
    vplEmission* emission;
    vplResult result = vplEmission_Create(job->geometry, job->emitters, job->emitterCount, &emission);
    if (result != VPL_SUCCESS) {
        return result;
    }
    double lamps = 0;
    for (int i = emission->firstTriangle; i < emission->sourceCount; i++) {
        lamps += vplRgbMean(emission->sources[i].power);
    }
    const double all = vplEmission_Power(emission);
    *countOut = all > 0 ? (int)rint(job->options.ssvp.firstBounce * (lamps / all)) : 0;
    vplEmission_Destroy(emission);
    return VPL_SUCCESS;
}

static vplResult shootFromLamps(vplJob* job, int count, uint64_t shift, vplLightSet** setOut)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = count;
    def.reflectivity = 0; // the first hits are all there is
    def.sampler = VPL_SAMPLER_HALTON;
    def.seed = shift;
    return vplSimulateParticles(job->geometry, NULL, 0, &def, setOut);
}

// As the document takes them.
static vplResult sampleAll(const vplSsvpMaking* m, int count, vplLightSet** setOut)
{
    vplRsmSampleDef def = vplDefaultRsmSampleDef();
    def.count = count;
    def.shift = m->lights->key.shift;
    return vplSampleReflectiveMaps(m->job->geometry, (const vplReflectiveMap* const*)m->state->maps,
                                   m->state->emitterCount, &def, setOut);
}

// A light that moves a little is of another use by a ray or two of sixteen. If weights followed at once, the picture would
// flicker: they follow within some frames.
static const float FOLLOW = 0.1f;

vplResult vplSsvp_MeasureUse(vplSsvpMaking* m, const vplLightSet* set, float** useOut)
{
    float* use = vplAlloc(m->job->context, (size_t)set->lightCount, sizeof *use);
    const vplResult result = use ? vplMeasureUse(m->job->geometry, set, USE_RAYS, use) : VPL_OUT_OF_MEMORY;
    if (result != VPL_SUCCESS) {
        vplFree(m->job->context, use);
        return result;
    }
    m->job->stats.rays += USE_RAYS * (int64_t)set->lightCount;
    *useOut = use;
    return VPL_SUCCESS;
}

// What each sample was taken to be of use in the last frame, and is now.
static vplResult followUse(vplSsvpMaking* m, const vplLightSet* set, int count, float* use)
{
    vplSsvpLights* lights = m->lights;
    const bool follows = m->last != NULL && m->last->use != NULL && m->last->sampleCount == count;
    vplFree(lights->context, lights->use);
    lights->sampleCount = count;
    lights->use = vplAlloc(lights->context, (size_t)count, sizeof *lights->use);
    for (int i = 0; lights->use != NULL && i < count; i++) {
        lights->use[i] = follows ? m->last->use[i] : -1;
    }
    for (int i = 0; lights->use != NULL && i < set->lightCount; i++) {
        float* known = &lights->use[set->lights[i].particle];
        use[i] = *known >= 0 ? *known + FOLLOW * (use[i] - *known) : use[i];
        *known = use[i];
    }
    return lights->use ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// So many samples, and what each is worth.
static vplResult sampleAndMeasure(vplSsvpMaking* m, int count, vplLightSet** setOut, float** useOut)
{
    vplLightSet* set;
    vplResult result = sampleAll(m, count, &set);
    if (result != VPL_SUCCESS) {
        return result;
    }
    float* use = NULL;
    result = vplSsvp_MeasureUse(m, set, &use);
    if (result == VPL_SUCCESS) {
        result = followUse(m, set, count, use);
    }
    if (result != VPL_SUCCESS) {
        vplFree(m->job->context, use);
        vplLightSet_Destroy(set);
        return result;
    }
    *setOut = set;
    *useOut = use;
    return VPL_SUCCESS;
}

// How many times as many samples as lights are taken. A power of two, and that of the last frame as long as it leaves
// half to five quarters of the lights: samples must not all move with every move of the light.
static int oversample(const vplSsvpMaking* m, int count, double kept)
{
    const vplRenderOptions* o = &m->job->options;
    const int before = m->last != NULL && count > 0 ? m->last->sampleCount / count : 0;
    int factor = 1;
    if (before > 0 && before * count == m->last->sampleCount && before <= o->ssvp.oversampling &&
        2 * before * kept >= count * 0.8 && before * kept <= 1.25 * count) {
        return before;
    }
    while (kept > 0 && 2 * factor <= o->ssvp.oversampling && 2 * factor * kept <= count &&
           (int64_t)2 * factor * count <= VPL_MAX_LIGHTS) {
        factor *= 2;
    }
    return factor;
}

static vplResult sampleMaps(vplSsvpMaking* m, int count, vplLightSet** setOut)
{
    vplContext* context = m->job->context;
    vplLightSet* set = NULL;
    float* use = NULL;
    vplResult result = sampleAndMeasure(m, count, &set, &use);
    const int factor = result == VPL_SUCCESS ? oversample(m, count, vplCountUseful(set, use)) : 1;
    if (factor > 1) {
        vplFree(context, use);
        vplLightSet_Destroy(set);
        use = NULL;
        set = NULL;
        result = sampleAndMeasure(m, factor * count, &set, &use);
    }
    if (result == VPL_SUCCESS) {
        result = vplKeepUseful(set, use, m->lights->key.shift, setOut);
    }
    vplFree(context, use);
    vplLightSet_Destroy(set);
    return result;
}

vplResult vplSsvp_SampleFirstBounce(vplSsvpMaking* m)
{
    int lampLights = 0;
    vplLightSet *seen = NULL, *shot = NULL;
    const vplRenderOptions* o = &m->job->options;
    vplResult result = countLampLights(m->job, &lampLights);
    if (result == VPL_SUCCESS) {
        const int count = o->ssvp.firstBounce - lampLights;
        result = o->ssvp.oversampling > 1 ? sampleMaps(m, count, &seen) : sampleAll(m, count, &seen);
    }
    if (result == VPL_SUCCESS && lampLights == 0) {
        m->lights->bounce[0].lights = seen;
        return VPL_SUCCESS;
    }
    if (result == VPL_SUCCESS) {
        result = shootFromLamps(m->job, lampLights, m->lights->key.shift, &shot);
    }
    if (result == VPL_SUCCESS) {
        result = vplLightSet_Join(seen, shot, &m->lights->bounce[0].lights);
    }
    vplLightSet_Destroy(seen);
    vplLightSet_Destroy(shot);
    return result;
}

// ---- the second

vplResult vplSsvp_SampleSecondBounce(vplSsvpMaking* m)
{
    const vplSsvpBounce* first = &m->lights->bounce[0];
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    def.count = m->twice ? m->job->options.ssvp.secondBounce : 0;
    def.weight = m->job->options.ssvp.secondWeight;
    def.shift = m->lights->key.shift;
    return def.count > 0 ? vplSampleParaboloidMaps(m->job->geometry, first->clusters, first->maps, &def,
                                                   &m->lights->bounce[1].lights)
                         : VPL_SUCCESS;
}
