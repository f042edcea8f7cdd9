// SPDX-License-Identifier: MIT
// Lights of SSVP: samples of reflective shadow maps whose light stays in the scene, and samples of what
// clusters see.
#include "base/rng.h"
#include "lights/light_set.h"
#include "math/vec.h"
#include "render/stages/make.h"
#include "render/stages/ssvp.h"

#include <math.h>
#include <string.h>

enum { SHIFT_STREAM = 0x80000004u };

uint64_t vplSsvpShift(const vplRun* run)
{
    const vplRenderOptions* o = &run->plan->options;
    double frame = o->sequence.coherence == VPL_COHERENCE_OFF ? o->sequence.frame : 0;
    uint64_t bits = 0;
    frame = frame == 0 ? 0 : frame; // and not -0
    memcpy(&bits, &frame, sizeof bits);
    if (o->seed == 0 && run->pass == 0 && bits == 0) {
        return 0;
    }
    const vplRandom4 r = vplRandomAt(o->seed, SHIFT_STREAM, bits ^ (uint64_t)run->pass * 0x9e3779b97f4a7c15u);
    return ((uint64_t)r.v[0] << 32 | r.v[1]) | 1;
}

// ---- the use of lights: the share of their light that stays in the scene

// Rays per light. Weights are multiples of a sixteenth.
enum { USE_RAYS = 16 };

vplResult vplMeasureLightUse(const vplRun* run, const vplLightSet* set, float** useOut)
{
    *useOut = vplArena_Alloc(run->scratch, (size_t)set->lightCount, sizeof **useOut);
    TRY(vplArena_Check(run->scratch));
    TRY(vplMeasureUse(run->results[VPL_STAGE_GEOMETRY], set, USE_RAYS, *useOut));
    run->stats->rays += USE_RAYS * (int64_t)set->lightCount;
    return VPL_SUCCESS;
}

// The use of a light that moves a little changes by a ray or two of sixteen. If weights followed at once, the
// picture would flicker. So they follow by a tenth of the change per frame.
static const float FOLLOW = 0.1f;

// The samples of the last frame or pass, if they had the same pattern; else NULL.
static const vplBounceLights* lastOf(const vplRun* run, uint64_t shift)
{
    const vplBounceLights* last = run->before;
    const bool follows = run->plan->options.sequence.coherence == VPL_COHERENCE_ON;
    return follows && last != NULL && last->shift == shift ? last : NULL;
}

// Moves the use of each sample from its last value towards the measured one, and keeps it for the next frame.
static vplResult followUse(const vplRun* run, const vplLightSet* set, int count, float* use,
                           vplBounceLights* b)
{
    const vplBounceLights* last = lastOf(run, b->shift);
    const bool follows = last != NULL && last->use != NULL && last->sampleCount == count;
    b->sampleCount = count;
    b->use = vplArena_Alloc(run->arena, (size_t)count, sizeof *b->use);
    TRY(vplArena_Check(run->arena));
    for (int i = 0; i < count; i++) {
        b->use[i] = follows ? last->use[i] : -1;
    }
    for (int i = 0; i < set->lightCount; i++) {
        float* known = &b->use[set->lights[i].particle];
        use[i] = *known >= 0 ? *known + FOLLOW * (use[i] - *known) : use[i];
        *known = use[i];
    }
    return VPL_SUCCESS;
}

// ---- the first bounce

// Gives area lights and the environment the share of the first-bounce lights that they have of the power.
static vplResult countAreaLightSamples(const vplRun* run, int count, int* countOut)
{
    vplEmission* emission;
    TRY(vplEmission_Create(run->results[VPL_STAGE_GEOMETRY], run->plan->emitters, run->plan->emitterCount,
                           &emission));
    double area = 0;
    for (int i = emission->firstTriangle; i < emission->sourceCount; i++) {
        area += vplRgbMean(emission->sources[i].power);
    }
    area += emission->environment >= 0 ? vplRgbMean(emission->sources[emission->environment].power) : 0;
    const double all = vplEmission_Power(emission);
    *countOut = all > 0 ? (int)rint(count * (area / all)) : 0;
    vplEmission_Destroy(emission);
    return VPL_SUCCESS;
}

static vplResult shootFromAreaLights(const vplRun* run, int count, uint64_t shift, vplLightSet** setOut)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = count;
    def.reflectivity = 0; // the first hits are all there is
    def.sampler = VPL_SAMPLER_HALTON;
    def.seed = shift;
    return vplSimulateParticles(run->results[VPL_STAGE_GEOMETRY], NULL, 0, &def, setOut);
}

// Samples the reflective maps as the document does.
static vplResult sampleAll(const vplRun* run, int count, uint64_t shift, vplLightSet** setOut)
{
    const vplReflectiveMaps* maps = run->results[VPL_STAGE_REFLECTIVE_MAPS];
    vplRsmSampleDef def = vplDefaultRsmSampleDef();
    def.count = count;
    def.shift = shift;
    return vplSampleReflectiveMaps(run->results[VPL_STAGE_GEOMETRY],
                                   (const vplReflectiveMap* const*)maps->maps, maps->count, &def, setOut);
}

// Finds how many times more samples than lights to take: a power of two. The factor of the last frame stays
// as long as it leaves 0.4 to 1.25 times the wanted lights, because a change of the factor moves all samples.
static int oversample(const vplBounceLights* last, int most, int count, double kept)
{
    const int before = last != NULL && count > 0 ? last->sampleCount / count : 0;
    int factor = 1;
    if (before > 0 && before * count == last->sampleCount && before <= most &&
        2 * before * kept >= count * 0.8 && before * kept <= 1.25 * count) {
        return before;
    }
    while (kept > 0 && 2 * factor <= most && 2 * factor * kept <= count &&
           (int64_t)2 * factor * count <= VPL_MAX_LIGHTS) {
        factor *= 2;
    }
    return factor;
}

// Takes `count` samples and measures the use of each. The set is the caller's also on failure.
static vplResult sampleAndMeasure(const vplRun* run, int count, vplBounceLights* b, vplLightSet** setOut,
                                  float** useOut)
{
    vplLightSet_Destroy(*setOut);
    *setOut = NULL;
    TRY(sampleAll(run, count, b->shift, setOut));
    TRY(vplMeasureLightUse(run, *setOut, useOut));
    return followUse(run, *setOut, count, *useOut, b);
}

static vplResult keepUseful(const vplRun* run, int count, vplBounceLights* b, vplLightSet** all,
                            vplLightSet** setOut)
{
    float* use;
    TRY(sampleAndMeasure(run, count, b, all, &use));
    const int factor = oversample(lastOf(run, b->shift), run->plan->options.ssvp.oversampling, count,
                                  vplCountUseful(*all, use));
    if (factor > 1) {
        TRY(sampleAndMeasure(run, factor * count, b, all, &use));
    }
    return vplKeepUseful(*all, use, b->shift, setOut);
}

static vplResult sampleMaps(const vplRun* run, int count, vplBounceLights* b, vplLightSet** setOut)
{
    if (run->plan->options.ssvp.oversampling <= 1) {
        return sampleAll(run, count, b->shift, setOut);
    }
    vplLightSet* all = NULL;
    const vplResult result = keepUseful(run, count, b, &all, setOut);
    vplLightSet_Destroy(all);
    return result;
}

// Takes `count` samples from reflective maps, and from area lights by their share of the power.
static vplResult sampleFirst(const vplRun* run, int count, vplBounceLights* b, vplLightSet** setOut)
{
    int fromArea = 0;
    vplLightSet *seen = NULL, *shot = NULL;
    TRY(countAreaLightSamples(run, count, &fromArea));
    TRY(vplSsvpChooses(run->plan) ? sampleAll(run, count - fromArea, b->shift, &seen)
                                  : sampleMaps(run, count - fromArea, b, &seen));
    if (fromArea == 0) {
        *setOut = seen;
        return VPL_SUCCESS;
    }
    vplResult result = shootFromAreaLights(run, fromArea, b->shift, &shot);
    if (result == VPL_SUCCESS) {
        result = vplLightSet_Join(seen, shot, setOut);
    }
    vplLightSet_Destroy(seen);
    vplLightSet_Destroy(shot);
    return result;
}

// ---- choice

// Describes what the camera sees. Lights of different bounces are chosen independently.
vplPlacementDef vplSsvpView(const vplRun* run)
{
    const vplPlan* plan = run->plan;
    vplPlacementDef def = vplDefaultPlacementDef();
    def.camera = plan->camera;
    def.width = plan->view.width;
    def.height = plan->view.height;
    def.minDistance = vplClampDistance(run, (double)plan->virtualLights);
    def.seed = plan->options.seed;
    def.index = run->pass;
    return def;
}

// Beyond these, more candidates take time and find nothing.
enum { MAX_CANDIDATES = 16384 };

int vplSsvpCountCandidates(const vplPlan* plan, int count)
{
    const int most = count > MAX_CANDIDATES ? count : MAX_CANDIDATES, times = plan->options.ssvp.oversampling;
    return !vplSsvpChooses(plan) ? count : count > most / times ? most : count * times;
}

// Keeps about `count` of all lights of a bounce; all where there are no more candidates.
static vplResult chooseLights(const vplRun* run, int count, vplBounceLights* b)
{
    if (b->all->particleCount <= count) {
        b->lights = b->all;
        b->all = NULL;
        return VPL_SUCCESS;
    }
    const vplGeometry* g = run->results[VPL_STAGE_GEOMETRY];
    vplPlacementDef def = vplSsvpView(run);
    int64_t rays;
    float* contributions = vplArena_Alloc(run->scratch, (size_t)b->all->lightCount, sizeof *contributions);
    TRY(vplArena_Check(run->scratch));
    TRY(vplMeasureLights(g, b->all, &def, contributions, &rays));
    run->stats->rays += rays;
    return vplChooseLights(b->all, contributions, count, &def, &b->lights);
}

static vplResult beginBounce(const vplRun* run, vplBounceLights** resultOut)
{
    vplBounceLights* b = vplArena_AllocZero(run->arena, 1, sizeof *b);
    TRY(vplArena_Check(run->arena));
    b->shift = vplSsvpShift(run);
    *resultOut = b;
    return VPL_SUCCESS;
}

vplResult vplMakeFirstBounce(const vplRun* run, void** resultOut)
{
    const int count = run->plan->options.ssvp.firstBounce;
    TRY(beginBounce(run, (vplBounceLights**)resultOut));
    vplBounceLights* b = *resultOut;
    if (!vplSsvpChooses(run->plan)) {
        return sampleFirst(run, count, b, &b->lights);
    }
    TRY(sampleFirst(run, vplSsvpCountCandidates(run->plan, count), b, &b->all));
    return chooseLights(run, count, b);
}

// ---- the second, and those after it

// Bounces after the second have fewer lights, so that each carries about as much.
int vplSsvpCountLights(const vplPlan* plan, int step)
{
    double count = plan->options.ssvp.secondBounce;
    for (int k = 1; k < step; k++) {
        count *= plan->reflectance;
    }
    return (int)ceil(count);
}

static vplResult sampleClusters(const vplRun* run, const vplBounceParts* from, int step, vplBounceLights* b)
{
    vplSecondBounceDef def = vplDefaultSecondBounceDef();
    def.count = vplSsvpCountLights(run->plan, step);
    def.weight = run->plan->options.ssvp.secondWeight;
    def.shift = b->shift;
    def.step = step;
    return vplSampleParaboloidMaps(run->results[VPL_STAGE_GEOMETRY], from->clusters->clusters,
                                   from->maps->maps, &def, &b->lights);
}

// The next bounce begins from all lights, also from those that the camera sees no light of.
static const vplLightSet* sourceOf(const vplBounceParts* from)
{
    return from->lights->all != NULL ? from->lights->all : from->lights->lights;
}

static vplResult shoot(const vplRun* run, const vplLightSet* from, int step, uint64_t shift,
                       vplLightSet** setOut)
{
    vplNextBounceDef def = vplDefaultNextBounceDef();
    def.shift = shift;
    def.step = step;
    def.count = vplSsvpCountCandidates(run->plan, vplSsvpCountLights(run->plan, step));
    run->stats->rays += def.count;
    return vplShootNextBounce(run->results[VPL_STAGE_GEOMETRY], from, &def, setOut);
}

static vplResult shootNext(const vplRun* run, const vplBounceParts* from, int step, vplBounceLights* b)
{
    if (!vplSsvpChooses(run->plan)) {
        return shoot(run, sourceOf(from), step, b->shift, &b->lights);
    }
    TRY(shoot(run, sourceOf(from), step, b->shift, &b->all));
    return chooseLights(run, vplSsvpCountLights(run->plan, step), b);
}

// Adds the lights of one more bounce to the set.
static vplResult addBounce(vplLightSet** set, const vplLightSet* bounce)
{
    vplLightSet* joined;
    TRY(vplLightSet_Join(*set, bounce, &joined));
    vplLightSet_Destroy(*set);
    *set = joined;
    return VPL_SUCCESS;
}

static vplResult shootAll(const vplRun* run, const vplLightSet* from, uint64_t shift, int* countOut,
                          vplLightSet** setOut)
{
    const vplLightSet none = {.context = run->context, .particleCount = 0};
    vplLightSet* last = NULL;
    TRY(vplLightSet_Join(&none, &none, setOut));
    for (int step = 2; step < run->plan->options.maxBounces; step++) {
        vplLightSet* next = NULL;
        vplResult result = shoot(run, last != NULL ? last : from, step, shift, &next);
        vplLightSet_Destroy(last);
        last = next;
        result = result == VPL_SUCCESS ? addBounce(setOut, last) : result;
        if (result != VPL_SUCCESS) {
            vplLightSet_Destroy(last);
            return result;
        }
        *countOut += vplSsvpCountLights(run->plan, step);
    }
    vplLightSet_Destroy(last);
    return VPL_SUCCESS;
}

vplResult vplShootFurtherBounces(const vplRun* run, const vplBounceParts* from, vplBounceLights** resultOut)
{
    int count = 0;
    TRY(beginBounce(run, resultOut));
    vplBounceLights* b = *resultOut;
    const bool chooses = vplSsvpChooses(run->plan);
    TRY(shootAll(run, sourceOf(from), b->shift, &count, chooses ? &b->all : &b->lights));
    return chooses ? chooseLights(run, count, b) : VPL_SUCCESS;
}

vplResult vplMakeNextBounce(const vplRun* run, const vplBounceParts* from, int step,
                            vplBounceLights** resultOut)
{
    TRY(beginBounce(run, resultOut));
    return vplSsvpSamplesMaps(run->plan) ? sampleClusters(run, from, step, *resultOut)
                                         : shootNext(run, from, step, *resultOut);
}

vplResult vplMakeSecondBounce(const vplRun* run, void** resultOut)
{
    const vplBounceParts first = vplSsvpBounce(run, 0);
    return vplMakeNextBounce(run, &first, 1, (vplBounceLights**)resultOut);
}

void vplDestroyBounce(void* result)
{
    vplBounceLights* b = result;
    vplLightSet_Destroy(b->lights);
    vplLightSet_Destroy(b->all);
}
