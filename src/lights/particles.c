// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights, "Particle Simulation", after Alexander
// Keller, Instant Radiosity, SIGGRAPH 1997. All N particles are shot, then the first floor(rho N) go on, then
// the first floor(rho^2 N), as the document's figure counts them (its prose skips floor(rho N)).
//
// Documented: light is attenuated by rho_d/pi at every hit and reflected like by a mirror. Physical: the flux
// 4 pi I is multiplied by rho_d and leaves in a cosine-distributed direction.
//
// Keller's own recipe counts the places where particles start as step 0: N lights on the emitters, of which the
// first floor(rho N) are shot. Departs: where particles start from a point or a direction, those lights are one, the
// emitter itself, and are marked so.
#include <vpl/lights.h>

#include "base/context.h"
#include "geometry/bvh.h"
#include "lights/counts.h"
#include "lights/starts.h"
#include "math/sampling.h"
#include "math/vec.h"

enum { PARTICLE_COOKIE = 0x56504c60 };

vplParticleDef vplDefaultParticleDef(void)
{
    vplParticleDef def = {0};
    def.particleCount = 10;
    def.reflectivity = 0.5;
    def.cookie = PARTICLE_COOKIE;
    return def;
}

typedef struct Simulation {
    const vplGeometry* geometry;
    vplParticleDef def;
    vplStarts starts;
    bool keller; // lights where particles start are step 0
    const int* stepCounts;
    const int* stepStart;  // first slot of each step
    const int* reach;      // per step: how many particles get there, to leave a light or to go on
    const double* weights; // per step
    int stepCount;
    vplVirtualLight* slots; // one per step and particle; step -1 where nothing was hit
    int* raysOf;            // per particle
    int* testsOf;           // per particle
    bool* escapedOf;        // per particle
} Simulation;

static vplVec3 reflect(vplVec3 d, vplVec3 n)
{
    float along = vplDot(d, n);
    vplVec3 r = vplNormalize(vplSub(d, vplScale(2 * along, n)));
    // Grazing rays may point into the surface after rounding; slide along it instead.
    float side = along > 0 ? -1.0f : 1.0f, out = side * vplDot(r, n);
    return out >= 0 ? r : vplNormalize(vplSub(r, vplScale(side * out, n)));
}

// The particle's next surface; `hit` is the one it leaves, its object -1 in free space.
static bool trace(Simulation* s, int particle, const vplRay* ray, vplHit* hit)
{
    if (s->def.geometry == VPL_PARTICLE_GEOMETRY_EXACT) {
        return vplClosestHit(s->geometry, ray, hit, &s->testsOf[particle]);
    }
    const vplHit from = *hit;
    s->testsOf[particle] += s->geometry->objectCount;
    return vplGeometry_ClosestBox(s->geometry, ray, from.object >= 0 ? &from : NULL, hit);
}

// The first surface of a particle that leaves an emitter with a map: where the texel's centre is, and the particle
// comes from there.
static bool lookUp(Simulation* s, const vplReflectiveMap* map, vplRay* ray, vplHit* hit)
{
    const int64_t texel = vplReflectiveMap_Find(map, ray);
    return texel >= 0 && vplReflectiveMap_GetHit(map, s->geometry, texel, hit, &ray->direction);
}

// The map that takes the place of a particle's first ray, or NULL.
static const vplReflectiveMap* mapOf(const Simulation* s, const vplStart* p)
{
    return s->def.maps != NULL && p->emitter >= 0 ? s->def.maps[p->emitter] : NULL;
}

// A bounding box has no colour of its own: it reflects as its object does in the mean.
static vplRgb reflectanceAt(const Simulation* s, const vplHit* hit)
{
    const vplGeometry* g = s->geometry;
    return s->def.geometry == VPL_PARTICLE_GEOMETRY_OBB
               ? g->objects[hit->object].reflectance
               : g->materials[g->triangleMaterials[hit->triangle]].diffuse;
}

// Interpolated normals receive cos(shading) where the surface met cos(geometric) of the light.
static float shadingFactor(const Simulation* s, const vplHit* hit, vplVec3 direction)
{
    if (s->def.geometry == VPL_PARTICLE_GEOMETRY_OBB || !s->geometry->objects[hit->object].smooth) {
        return 1;
    }
    float geometric = fabsf(vplDot(direction, hit->normal));
    float shading = vplDot(direction, vplGeometry_ShadingNormal(s->geometry, hit));
    shading *= vplDot(direction, hit->normal) < 0 ? -1.0f : 1.0f;
    return geometric > 0 && shading > 0 ? shading / geometric : 0;
}

static void leaveLight(Simulation* s, int particle, int step, const vplVirtualLight* light)
{
    if (particle >= s->stepCounts[step]) {
        return; // only later steps have a place for it
    }
    vplVirtualLight* slot = &s->slots[s->stepStart[step] + particle];
    *slot = *light;
    slot->weight = (float)s->weights[step];
    slot->step = step;
    slot->particle = particle;
}

// Follows one particle to its last step.
static void followParticle(Simulation* s, int particle)
{
    const bool documented = s->def.lighting == VPL_LIGHTING_DOCUMENTED, asDeclared = documented && !s->keller;
    const bool mirror =
        s->def.bounce == VPL_BOUNCE_REFLECT || (s->def.bounce == VPL_BOUNCE_AUTO && asDeclared);
    vplStart p;
    const bool started = vplStarts_Get(&s->starts, particle, &p);
    int step = 0;
    if (started && s->keller) {
        leaveLight(s, particle, step++,
                   &(vplVirtualLight){p.ray.origin, p.normal, p.light, .object = p.from.object});
    }
    for (; started && step < s->stepCount && particle < s->reach[step]; step++) {
        const vplReflectiveMap* map = step == s->keller ? mapOf(s, &p) : NULL;
        s->raysOf[particle] += map == NULL;
        if (map ? !lookUp(s, map, &p.ray, &p.from) : !trace(s, particle, &p.ray, &p.from)) {
            s->escapedOf[particle] = true;
            break;
        }
        const vplHit* hit = &p.from;
        const vplVec3 facing =
            vplDot(p.ray.direction, hit->normal) > 0 ? vplNegate(hit->normal) : hit->normal;
        const vplRgb rho = reflectanceAt(s, hit);
        p.light = vplRgbMul(p.light, documented ? vplRgbScale((float)(1 / VPL_PI), rho) : rho);
        if (!asDeclared) {
            p.light = vplRgbScale(shadingFactor(s, hit, p.ray.direction), p.light);
        }
        leaveLight(s, particle, step,
                   &(vplVirtualLight){hit->position, asDeclared ? hit->normal : facing, p.light,
                                      .object = hit->object});
        float u, v;
        vplSampleSource_Direction(&s->starts.samples, particle, step + !s->keller, &u, &v);
        vplVec3 onward = mirror ? reflect(p.ray.direction, hit->normal) : vplSampleCosineAround(facing, u, v);
        p.ray = vplGeometry_Leave(s->geometry, hit, onward);
    }
    for (; step < s->stepCount && particle < s->reach[step]; step++) {
        if (particle < s->stepCounts[step]) {
            s->slots[s->stepStart[step] + particle].step = -1;
        }
    }
}

enum { CHUNK = 128 }; // particles per task

static void followChunk(void* data, int index, int worker)
{
    (void)worker;
    Simulation* s = data;
    for (int i = index * CHUNK; i < (index + 1) * CHUNK && i < s->def.particleCount; i++) {
        followParticle(s, i);
    }
}

// Closes the gaps that escaped particles left and sums the statistics, in particle order.
static void collect(const Simulation* s, vplLightSet* set, int* lightsInStep)
{
    vplVirtualLight* lights = s->slots;
    int total = s->stepCount ? s->stepStart[s->stepCount - 1] + s->stepCounts[s->stepCount - 1] : 0;
    for (int i = 0; i < total; i++) {
        if (lights[i].step >= 0) {
            lightsInStep[lights[i].step]++;
            lights[set->lightCount++] = lights[i];
        }
    }
    for (int i = 0; i < s->def.particleCount; i++) {
        set->rays += s->raysOf[i];
        set->rayObjectTests += s->testsOf[i];
        set->escaped += s->escapedOf[i];
    }
}

// Franchi and Ferrante's formulas are about point lights.
static bool needsPoints(const vplParticleDef* def)
{
    return def->lighting == VPL_LIGHTING_DOCUMENTED && def->start == VPL_START_FIRST_HIT;
}

static vplResult checkDef(const vplContext* context, const vplEmitterDef* emitters, int emitterCount,
                          const vplParticleDef* def)
{
    if (def->firstParticle < 0 || def->firstParticle > (INT64_C(1) << 40)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplParticleDef.firstParticle is %lld, must be in [0, 2^40]",
                       (long long)def->firstParticle);
    }
    if (def->cookie != PARTICLE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplParticleDef was not made by vplDefaultParticleDef");
    }
    const bool pointsOnly = needsPoints(def);
    for (int i = 0; pointsOnly && i < emitterCount; i++) {
        if (emitters[i].type != VPL_EMITTER_POINT) {
            return vplFail(
                context, VPL_INVALID_ARGUMENT,
                "light %d is not a point light, and documented lighting knows no others; use physical", i);
        }
    }
    if (pointsOnly && emitterCount < 1) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "the scene has no emitter to shoot particles from: documented lighting needs a point light");
    }
    if (def->maps != NULL && def->geometry != VPL_PARTICLE_GEOMETRY_EXACT) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "reflective shadow maps show triangles, not bounding boxes: use exact particle geometry");
    }
    for (int i = 0; def->directions != NULL && i < def->particleCount; i++) {
        if (!vplIsFiniteVec(def->directions[i])) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "vplParticleDef.directions[%d] is not finite", i);
        }
    }
    return VPL_SUCCESS;
}

static vplResult allocate(Simulation* s, vplLightSet* set, int64_t total, int** lightsInStep)
{
    vplContext* context = set->context;
    size_t particles = (size_t)s->def.particleCount, steps = (size_t)set->stepCount;
    int* counts = vplAlloc(context, steps, sizeof(int));
    int* starts = vplAlloc(context, 2 * steps, sizeof(int));
    double* weights = vplAlloc(context, steps, sizeof *weights);
    *lightsInStep = vplAllocZero(context, steps, sizeof(int));
    s->slots = vplAlloc(context, (size_t)total, sizeof *s->slots);
    s->raysOf = vplAllocZero(context, particles, sizeof *s->raysOf);
    s->testsOf = vplAllocZero(context, particles, sizeof *s->testsOf);
    s->escapedOf = vplAllocZero(context, particles, sizeof *s->escapedOf);
    set->stepCounts = s->stepCounts = counts;
    s->stepStart = starts;
    s->weights = weights;
    set->lightsInStep = *lightsInStep;
    set->lights = s->slots;
    if (!counts || !starts || !weights || !*lightsInStep || !s->slots || !s->raysOf || !s->testsOf ||
        !s->escapedOf) {
        return VPL_OUT_OF_MEMORY;
    }
    vplResult result = vplCountPass(context, s->def.pass ? s->def.firstParticle : 0, s->def.particleCount,
                                    s->def.reflectivity, counts, set->stepCount, &set->stepCount, &total);
    double weight = 1;
    for (int i = 0, at = 0; i < set->stepCount; at += counts[i], i++) {
        starts[i] = at;
        weights[i] = s->def.pass ? weight : (double)s->def.particleCount / counts[i];
        weight /= s->def.reflectivity;
    }
    s->reach = starts + set->stepCount;
    for (int i = set->stepCount - 1, most = 0; i >= 0; i--) {
        most = counts[i] > most ? counts[i] : most;
        starts[set->stepCount + i] = most;
    }
    return result;
}

vplResult vplSimulateParticles(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                               const vplParticleDef* def, vplLightSet** setOut)
{
    vplContext* context = geometry->context;
    int steps;
    int64_t total;
    vplResult result = checkDef(context, emitters, emitterCount, def);
    if (result == VPL_SUCCESS) {
        result = vplCountPass(context, def->pass ? def->firstParticle : 0, def->particleCount,
                              def->reflectivity, NULL, 0, &steps, &total);
    }
    vplLightSet* set = result == VPL_SUCCESS ? vplAllocZero(context, 1, sizeof *set) : NULL;
    if (set == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    set->context = context;
    set->stepCount = steps;
    set->particleCount = def->particleCount;
    Simulation s = {.geometry = geometry, .def = *def, .keller = def->start == VPL_START_EMITTER};
    vplEmission* emission = NULL;
    if (!needsPoints(def)) {
        result = vplEmission_Create(geometry, emitters, emitterCount, &emission);
    }
    s.starts = vplStarts_Make(geometry, emission, emitters, emitterCount, &s.def);
    if (result == VPL_SUCCESS && emission != NULL && emission->sourceCount == 0 && emitterCount == 0) {
        result = vplFail(context, VPL_INVALID_ARGUMENT,
                         "the scene has no emitter: no light, and no surface that emits");
    }
    int* lightsInStep = NULL;
    if (result == VPL_SUCCESS && def->geometry == VPL_PARTICLE_GEOMETRY_EXACT) {
        result = vplGeometry_PrepareRays(geometry);
    }
    if (result == VPL_SUCCESS) {
        result = allocate(&s, set, total, &lightsInStep);
    }
    if (result == VPL_SUCCESS) {
        s.stepCount = set->stepCount;
        result = vplParallelForProgress(context, (def->particleCount + CHUNK - 1) / CHUNK, followChunk, &s,
                                        def->progress, def->progressUser, 0, 1);
    }
    if (result == VPL_SUCCESS) {
        collect(&s, set, lightsInStep);
    }
    vplEmission_Destroy(emission);
    vplFree(context, (int*)s.stepStart);
    vplFree(context, (double*)s.weights);
    vplFree(context, s.raysOf);
    vplFree(context, s.testsOf);
    vplFree(context, s.escapedOf);
    if (result != VPL_SUCCESS) {
        vplLightSet_Destroy(set);
        return result;
    }
    *setOut = set;
    return VPL_SUCCESS;
}

void vplLightSet_Destroy(vplLightSet* set)
{
    if (set != NULL) {
        vplFree(set->context, (void*)set->lights);
        vplFree(set->context, (void*)set->stepCounts);
        vplFree(set->context, (void*)set->lightsInStep);
        vplFree(set->context, set);
    }
}
