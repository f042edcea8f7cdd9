// SPDX-License-Identifier: MIT
// Lights of the next bounce by rays from the lights of the last one.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997 (particles that go on).
// Departs: the particles of each bounce share its flux equally again, and start at lights by systematic
// sampling. The samples of a cluster's map all start at one light: where a door is ajar, what that light sees
// decides for all others, and a hall had 0.5 to 12 times its light (hall of tests/bench/planner/scenes.sh).
#include "base/arena.h"
#include "base/rng.h"
#include "geometry/bvh.h"
#include "geometry/emission.h"
#include "geometry/paint.h"
#include "lights/light_set.h"
#include "math/sampling.h"

enum {
    NEXT_BOUNCE_COOKIE = 0x56504c6e,
    NEXT_STREAM = 0x80000020u,
    CHUNK = 32, // rays per task
    MAX_STEPS = 64,
};

vplNextBounceDef vplDefaultNextBounceDef(void)
{
    return (vplNextBounceDef){256, 0, 1, NEXT_BOUNCE_COOKIE};
}

typedef struct Shooting {
    const vplGeometry* geometry;
    const vplLightSet* from;
    const vplNextBounceDef* def;
    double* ends;           // per light: sum of flux up to it, W
    float shift[3];         // of the choice and of the directions
    vplVirtualLight* slots; // per ray; weight 0: none
} Shooting;

static double fluxOf(const vplLightSet* set, int i)
{
    const vplVirtualLight* v = &set->lights[i];
    return v->object >= 0 ? (double)v->weight / set->particleCount * vplRgbMean(v->light) : 0;
}

// The first light whose sum is more than `at`.
static int findLight(const Shooting* s, double at)
{
    int low = 0, high = s->from->lightCount - 1;
    while (low < high) {
        const int middle = (low + high) / 2;
        if (s->ends[middle] > at) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

static float wrap(float x)
{
    return x < 1 ? x : x - 1;
}

static void shoot(const Shooting* s, int ray)
{
    const vplLightSet* from = s->from;
    const double total = s->ends[from->lightCount - 1];
    const int i = findLight(s, ((double)ray + (double)s->shift[0]) / s->def->count * total);
    const vplVirtualLight* v = &from->lights[i];
    const vplVec3 lifted = vplScale(vplLightLift(vplLargestOf(v->position)), v->normal);
    const vplRay way = {vplAdd(v->position, lifted),
                        vplSampleCosineAround(v->normal, wrap(vplVanDerCorput((uint32_t)ray) + s->shift[1]),
                                              wrap(vplHalton((uint64_t)ray, 1) + s->shift[2])),
                        {0, 0}};
    vplHit hit;
    s->slots[ray].weight = 0;
    if (!(fluxOf(from, i) > 0) || !vplGeometry_ClosestHit(s->geometry, &way, &hit)) {
        return;
    }
    // Its flux divided by the probability that a ray starts there.
    const double carried = (double)v->weight / from->particleCount * (total / fluxOf(from, i));
    const vplFootprint footprint =
        vplUpright(s->geometry, hit.triangle, vplShareOfArea(s->geometry, s->def->count));
    const vplRgb albedo = vplGeometry_Reflectance(s->geometry, hit.triangle, hit.position, &footprint);
    const vplRgb light = vplScaleRadiometric(carried, vplRgbMul(v->light, albedo));
    if (light.r > 0 || light.g > 0 || light.b > 0) {
        s->slots[ray] = (vplVirtualLight){
            .position = hit.position,
            .normal = vplDot(way.direction, hit.normal) > 0 ? vplNegate(hit.normal) : hit.normal,
            .light = light,
            .weight = 1,
            .step = s->def->step,
            .particle = ray,
            .object = hit.object};
    }
}

static void shootChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Shooting* s = data;
    for (int i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < s->def->count; i++) {
        shoot(s, i);
    }
}

static vplResult shootAll(Shooting* s, vplArena* scratch, const vplLightArrays* arrays, vplLightSet* set)
{
    double sum = 0;
    s->ends = vplArena_Alloc(scratch, (size_t)s->from->lightCount, sizeof *s->ends);
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < s->from->lightCount; i++) {
        sum += fluxOf(s->from, i);
        s->ends[i] = sum;
    }
    if (sum > 0) {
        TRY(vplParallelForAsking(set->context, (s->def->count + CHUNK - 1) / CHUNK, shootChunk, s));
        for (int i = 0; i < s->def->count; i++) {
            if (s->slots[i].weight > 0) {
                s->slots[set->lightCount++] = s->slots[i];
            }
        }
        set->rays = s->def->count;
        set->escaped = s->def->count - set->lightCount;
    }
    arrays->stepCounts[s->def->step] = s->def->count;
    arrays->lightsInStep[s->def->step] = set->lightCount;
    return VPL_SUCCESS;
}

static vplResult check(const vplGeometry* geometry, const vplNextBounceDef* def)
{
    vplContext* context = geometry->context;
    if (def->cookie != NEXT_BOUNCE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplNextBounceDef was not made by vplDefaultNextBounceDef");
    }
    if (def->count < 0 || def->count > VPL_MAX_LIGHTS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplNextBounceDef.count is %d, must be in [0, %d]",
                       def->count, VPL_MAX_LIGHTS);
    }
    if (def->step < 1 || def->step >= MAX_STEPS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplNextBounceDef.step is %d, must be in [1, %d]",
                       def->step, MAX_STEPS - 1);
    }
    return VPL_SUCCESS;
}

vplResult vplShootNextBounce(const vplGeometry* geometry, const vplLightSet* lights,
                             const vplNextBounceDef* def, vplLightSet** setOut)
{
    REQUIRE(CONTEXT_OF(geometry) ?: CONTEXT_OF(lights), geometry, lights, def, setOut);
    Shooting s = {.geometry = geometry, .from = lights, .def = def, .shift = {0.5f, 0, 0}};
    vplLightArrays arrays;
    vplLightSet* set;
    TRY(check(geometry, def));
    TRY(vplLightSet_Make(geometry->context, def->count, def->step + 1, &arrays, &set));
    const vplRandom4 r = vplRandomAt(def->shift, NEXT_STREAM, (uint64_t)def->step);
    for (int k = 0; k < 3 && (def->shift != 0 || def->step > 1); k++) {
        s.shift[k] = vplUnitFloat(r.v[k]);
    }
    s.slots = arrays.lights;
    set->particleCount = def->count;
    vplArena* scratch = vplArena_Create(geometry->context);
    const vplResult result = lights->lightCount > 0 ? shootAll(&s, scratch, &arrays, set) : VPL_SUCCESS;
    vplArena_Destroy(scratch);
    return vplArena_Deliver(set->arena, result, set, setOut);
}
