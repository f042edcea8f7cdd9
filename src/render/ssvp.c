// SPDX-License-Identifier: MIT
// Based on: Vitor Aranha, Marcio Macedo and Antonio Apolinario, Screen-Space Virtual Point Light Propagation for
// Real-Time Global Illumination: reflective maps of what the lights see, samples of them as first-bounce lights, k-means
// clusters of these, a paraboloid map per cluster, samples of those as second-bounce lights; then the camera's view is
// shaded by all of them, interleaved. Departs where the document says nothing or slips (EXTREMES.md, SSVP):
// second-bounce lights are weighted, and have clusters and maps of their own to see by; a cluster that may shine behind
// its plane has a second hemisphere; light of surfaces that emit, which no reflective map begins from, comes by particles.
#include "render/ssvp.h"

#include "base/rng.h"
#include "lights/light_set.h"
#include "math/vec.h"
#include "render/history.h"

#include <math.h>
#include <string.h>

enum { SHIFT_STREAM = 0x80000004u, USE_RAYS = 16 };

// ---- what it depends on

// 0, the points as published, for seed 0, the first pass and frames that keep their patterns.
static uint64_t shiftOf(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    double frame = o->coherence == VPL_COHERENCE_OFF ? o->frame : 0;
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

static vplSsvpKey keyOf(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    vplSsvpKey key;
    memset(&key, 0, sizeof key); // the gaps, too
    key.clusters = o->clusters;
    key.firstBounce = o->firstBounce;
    key.oversampling = o->oversampling;
    key.secondBounce = o->secondBounce;
    key.paraboloidSize = o->paraboloidSize;
    key.rsmSize = o->rsmSize;
    key.maxBounces = o->maxBounces;
    key.hemispheres = o->hemispheres;
    key.clusterMetric = (int)o->clusterMetric;
    key.clusterPlace = (int)o->clusterPlace;
    key.secondWeight = (int)o->secondWeight;
    key.lightShadows = (int)vplJob_GetLightShadows(job);
    key.w1 = o->w1;
    key.w2 = o->w2;
    key.shift = shiftOf(job);
    return key;
}

static bool isSame(vplVec3 a, vplVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

static bool isSameEmitter(const vplEmitterDef* a, const vplEmitterDef* b)
{
    return a->type == b->type && isSame(a->position, b->position) && isSame(a->direction, b->direction) &&
           a->intensity.r == b->intensity.r && a->intensity.g == b->intensity.g &&
           a->intensity.b == b->intensity.b && a->innerAngle == b->innerAngle &&
           a->outerAngle == b->outerAngle;
}

static bool isStill(const vplJob* job, const vplSsvpState* last)
{
    bool still = last->emitterCount == job->emitterCount;
    for (int i = 0; still && i < job->emitterCount; i++) {
        still = isSameEmitter(&job->emitters[i], &last->emitters[i]);
    }
    return still;
}

// ---- reflective maps

static bool hasPower(const vplEmitterDef* e)
{
    return e->intensity.r > 0 || e->intensity.g > 0 || e->intensity.b > 0;
}

static vplResult drawReflectiveMaps(vplJob* job, vplSsvpState* state)
{
    const vplRenderOptions* o = &job->options;
    const bool wanted =
        vplJob_GetLightShadows(job) != VPL_LIGHT_SHADOWS_RAY || vplNeedsLights(o) || o->show == VPL_SHOW_RSM;
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < job->emitterCount && wanted && result == VPL_SUCCESS; i++) {
        if (!hasPower(&job->emitters[i])) {
            continue;
        }
        vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
        def.emitter = job->emitters[i];
        def.size = o->rsmSize;
        result = vplReflectiveMap_Create(job->geometry, &def, vplJob_GetProgress(job), job, &state->maps[i]);
        if (result == VPL_SUCCESS) {
            vplJob_AddRaster(job, &state->maps[i]->stats);
        }
    }
    return result;
}

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
    state->rsmSize = job->options.rsmSize;
    for (size_t i = 0; i < count; i++) {
        state->emitters[i] = job->emitters[i];
    }
    *stateOut = state;
    return VPL_SUCCESS;
}

vplResult vplSsvp_Begin(vplJob* job, vplSsvpState** stateOut)
{
    vplHistory* history = job->options.history;
    if (job->options.lighting == VPL_LIGHTING_DOCUMENTED) {
        return vplFail(job->context, VPL_INVALID_ARGUMENT,
                       "the SSVP document prints no lighting formulas of its own; use physical lighting");
    }
    if (history != NULL && history->ssvp != NULL && isStill(job, history->ssvp) &&
        history->ssvp->rsmSize == job->options.rsmSize) {
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
    result = drawReflectiveMaps(job, state);
    vplJob_EndStage(job, "reflective map");
    if (result != VPL_SUCCESS) {
        vplSsvp_Destroy(state);
        return result;
    }
    *stateOut = state;
    return VPL_SUCCESS;
}

// ---- bounces

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
    *countOut = all > 0 ? (int)rint(job->options.firstBounce * (lamps / all)) : 0;
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

// ---- the stages, each one bounce

// One making of lights.
typedef struct Making {
    vplJob* job;
    const vplSsvpState* state;
    vplSsvpLights* lights;
    const vplSsvpLights* last; // of the frame before; NULL: there is none
    bool sees;                 // lights see by clusters
    bool twice;                // there is a second bounce
} Making;

// As the document takes them.
static vplResult sampleAll(const Making* m, int count, vplLightSet** setOut)
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

// What each sample was taken to be of use in the last frame, and is now.
static vplResult followUse(const Making* m, const vplLightSet* set, int count, float* use)
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
static vplResult sampleAndMeasure(const Making* m, int count, vplLightSet** setOut, float** useOut)
{
    vplLightSet* set;
    vplResult result = sampleAll(m, count, &set);
    if (result != VPL_SUCCESS) {
        return result;
    }
    float* use = vplAlloc(m->job->context, (size_t)set->lightCount, sizeof *use);
    result = use ? vplMeasureUse(m->job->geometry, set, USE_RAYS, use) : VPL_OUT_OF_MEMORY;
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
static int oversample(const Making* m, int count, double kept)
{
    const vplRenderOptions* o = &m->job->options;
    const int before = m->last != NULL && count > 0 ? m->last->sampleCount / count : 0;
    int factor = 1;
    if (before > 0 && before * count == m->last->sampleCount && before <= o->oversampling &&
        2 * before * kept >= count * 0.8 && before * kept <= 1.25 * count) {
        return before;
    }
    while (kept > 0 && 2 * factor <= o->oversampling && 2 * factor * kept <= count &&
           (int64_t)2 * factor * count <= VPL_MAX_LIGHTS) {
        factor *= 2;
    }
    return factor;
}

static vplResult sampleMaps(const Making* m, int count, vplLightSet** setOut)
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

static vplResult sampleFirstBounce(Making* m)
{
    int lampLights = 0;
    vplLightSet *seen = NULL, *shot = NULL;
    const vplRenderOptions* o = &m->job->options;
    vplResult result = countLampLights(m->job, &lampLights);
    if (result == VPL_SUCCESS) {
        const int count = o->firstBounce - lampLights;
        result = o->oversampling > 1 ? sampleMaps(m, count, &seen) : sampleAll(m, count, &seen);
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

static vplResult sampleSecondBounce(Making* m)
{
    const vplSsvpBounce* first = &m->lights->bounce[0];
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    def.count = m->twice ? m->job->options.secondBounce : 0;
    def.weight = m->job->options.secondWeight;
    def.shift = m->lights->key.shift;
    return def.count > 0 ? vplSampleParaboloidMaps(m->job->geometry, first->clusters, first->maps, &def,
                                                   &m->lights->bounce[1].lights)
                         : VPL_SUCCESS;
}

// Clusters are for lights whose light stays in the scene: of Sponza's eight, one had all of the courtyard's floor and the
// others the roof. FLIP of 4, 8, 16, 32 clusters against path tracing, mean of three seeds: 0.254, 0.248, 0.204, 0.185
// where all lights count alike; by their use 0.245, 0.192, 0.154, 0.175, by its square 0.278, 0.203, 0.176, 0.179. In
// closed rooms all are of the same use.
static vplResult weigh(const Making* m, const vplLightSet* set, float** weightsOut)
{
    float* weights = vplAlloc(m->job->context, (size_t)set->lightCount, sizeof *weights);
    const vplResult result =
        weights ? vplMeasureUse(m->job->geometry, set, USE_RAYS, weights) : VPL_OUT_OF_MEMORY;
    if (result != VPL_SUCCESS) {
        vplFree(m->job->context, weights);
        return result;
    }
    *weightsOut = weights;
    return VPL_SUCCESS;
}

static vplResult cluster(const Making* m, int k)
{
    const vplRenderOptions* o = &m->job->options;
    vplSsvpBounce* bounce = &m->lights->bounce[k];
    if (bounce->lights == NULL) {
        return VPL_SUCCESS;
    }
    vplClusterDef def = vplDefaultClusterDef();
    def.count = o->clusters;
    def.metric = o->clusterMetric;
    def.w1 = o->w1;
    def.w2 = o->w2;
    def.last = m->last != NULL ? m->last->bounce[k].clusters : NULL;
    float* weights = NULL;
    vplResult result = o->oversampling > 1 ? weigh(m, bounce->lights, &weights) : VPL_SUCCESS;
    if (result == VPL_SUCCESS) {
        def.weights = weights;
        result = vplFindClusters(bounce->lights, &def, &bounce->clusters);
    }
    vplFree(m->job->context, weights);
    return result;
}

// The light that a cluster looks from: that of the last frame as long as it is one of its lights, so that what is seen
// does not jump; else the nearest to the mean. -1: none.
static int findLooker(const Making* m, int k, int cluster)
{
    const vplSsvpBounce* bounce = &m->lights->bounce[k];
    const vplSsvpBounce* last = m->last != NULL ? &m->last->bounce[k] : NULL;
    const vplLightClusters* clusters = bounce->clusters;
    if (m->job->options.clusterPlace == VPL_CLUSTER_PLACE_MEAN) {
        return -1;
    }
    for (int i = 0;
         last != NULL && last->lookers != NULL && cluster < last->clusters->count && i < clusters->lightCount;
         i++) {
        if (clusters->of[i] == cluster && bounce->lights->lights[i].particle == last->lookers[cluster]) {
            return i;
        }
    }
    return clusters->clusters[cluster].nearest;
}

// Always lifted, also from mid-air: a mean that lies on a wall but for rounding would see the wall as half of space.
static vplParaboloidPlace placeOf(const Making* m, int k, int i)
{
    vplSsvpBounce* bounce = &m->lights->bounce[k];
    const vplLightCluster* c = &bounce->clusters->clusters[i];
    const int looker = findLooker(m, k, i);
    const vplVirtualLight* light = looker >= 0 ? &bounce->lights->lights[looker] : NULL;
    bounce->lookers[i] = light != NULL ? light->particle : -1;
    return (vplParaboloidPlace){.position = light != NULL ? light->position : c->position,
                                .normal = c->normal,
                                .hemispheres = m->sees && !c->flat ? m->job->options.hemispheres : 1,
                                .onSurface = true};
}

// With triangles where surfaces are asked for, not only distances.
static vplResult drawMaps(const Making* m, bool triangles, int k)
{
    vplJob* job = m->job;
    vplSsvpBounce* bounce = &m->lights->bounce[k];
    const int count = bounce->clusters->count;
    vplParaboloidPlace* places = vplAlloc(job->context, (size_t)count, sizeof *places);
    bounce->lookers = vplAlloc(job->context, (size_t)count, sizeof *bounce->lookers);
    vplResult result = places && bounce->lookers ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        places[i] = placeOf(m, k, i);
    }
    if (result == VPL_SUCCESS) {
        result = vplParaboloidMaps_Create(job->context, job->options.paraboloidSize, count, triangles,
                                          &bounce->maps);
    }
    if (result == VPL_SUCCESS) {
        result =
            vplParaboloidMaps_Draw(bounce->maps, job->geometry, places, count, vplJob_GetProgress(job), job);
    }
    vplFree(job->context, places);
    return result;
}

static vplResult clusterFirst(Making* m)
{
    return cluster(m, 0);
}

static vplResult drawFirst(Making* m)
{
    const bool shown = m->job->options.show == VPL_SHOW_PARABOLOID;
    return m->sees || m->twice || shown ? drawMaps(m, m->twice || shown, 0) : VPL_SUCCESS;
}

static vplResult clusterSecond(Making* m)
{
    return m->sees ? cluster(m, 1) : VPL_SUCCESS;
}

static vplResult drawSecond(Making* m)
{
    return m->sees && m->lights->bounce[1].lights != NULL ? drawMaps(m, false, 1) : VPL_SUCCESS;
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

static vplResult join(Making* m)
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
    vplResult (*run)(Making*);
} STAGES[] = {{0.06, "first bounce", sampleFirstBounce},
              {0.07, "clusters", clusterFirst},
              {0.12, "paraboloid", drawFirst},
              {0.13, "second bounce", sampleSecondBounce},
              {0.14, "second clusters", clusterSecond},
              {0.19, "second paraboloid", drawSecond},
              {0.2, "list", join}};

static vplResult cook(Making* m)
{
    vplResult result = VPL_SUCCESS;
    for (size_t i = 0; i < sizeof STAGES / sizeof *STAGES && result == VPL_SUCCESS; i++) {
        vplJob_BeginStage(m->job, STAGES[i].to);
        result = STAGES[i].run(m);
        vplJob_EndStage(m->job, STAGES[i].name);
    }
    return result;
}

static void destroyLights(vplSsvpLights* lights)
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

vplResult vplSsvp_MakeLights(vplJob* job, vplSsvpState* state)
{
    const vplSsvpKey key = keyOf(job);
    const vplHistory* history = job->options.history;
    if (state->lights != NULL && memcmp(&state->lights->key, &key, sizeof key) == 0) {
        return VPL_SUCCESS;
    }
    vplSsvpLights* lights = vplAllocZero(job->context, 1, sizeof *lights);
    if (lights == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    lights->context = job->context;
    memcpy(&lights->key, &key, sizeof key);
    Making m = {.job = job, .state = state, .lights = lights};
    if (job->options.coherence == VPL_COHERENCE_ON) {
        m.last = state->lights == NULL && history != NULL && history->ssvp != NULL ? history->ssvp->lights
                                                                                   : state->lights;
    }
    m.sees = key.lightShadows == VPL_LIGHT_SHADOWS_CLUSTER;
    m.twice = key.maxBounces != 1 && key.secondBounce > 0;
    vplResult result = cook(&m);
    if (result != VPL_SUCCESS) {
        destroyLights(lights);
        return result;
    }
    destroyLights(state->lights);
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

void vplSsvp_Destroy(vplSsvpState* state)
{
    if (state != NULL) {
        destroyLights(state->lights);
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
    vplHistory* history = job->options.history;
    if (history == NULL || state == NULL) {
        vplSsvp_Destroy(state);
        return;
    }
    vplSsvp_Destroy(history->ssvp);
    history->ssvp = state;
    history->destroySsvp = vplSsvp_Destroy;
}
