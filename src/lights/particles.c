// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights, "Particle Simulation", after Alexander
// Keller, Instant Radiosity, SIGGRAPH 1997. All N particles are shot, then the first floor(rho N) go on, then
// the first floor(rho^2 N), as the document's figure counts them (its prose skips floor(rho N)).
//
// Documented: light is attenuated by rho_d/pi at every hit and reflected like by a mirror. Physical: the flux
// 4 pi I is multiplied by rho_d and leaves in a cosine-distributed direction.
#include <vpl/lights.h>

#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "lights/samples.h"
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
    const vplEmitterDef* emitters;
    int emitterCount;
    double totalPower;           // sum of the emitters' mean intensities
    const vplEmission* emission; // physical lighting only
    vplParticleDef def;
    vplSampleSource samples;
    const int* stepCounts;
    const int* stepStart; // first slot of each step
    int stepCount;
    vplVirtualLight* slots; // one per step and particle; step -1 where nothing was hit
    int* raysOf;            // per particle
    int* testsOf;           // per particle
    bool* escapedOf;        // per particle
} Simulation;

static double powerOf(const vplEmitterDef* e)
{
    return vplRgbMean(e->intensity);
}

// The emitter of particle i, and one over the probability that it was chosen.
static const vplEmitterDef* chooseEmitter(const Simulation* s, int particle, float* inverseProbability)
{
    *inverseProbability = 1;
    if (s->emitterCount == 1 || s->totalPower == 0) {
        return &s->emitters[0];
    }
    double place = (double)vplSampleSource_Emitter(&s->samples, particle) * s->totalPower;
    int chosen = -1;
    for (int i = 0; i < s->emitterCount; i++) {
        double power = powerOf(&s->emitters[i]);
        if (power > 0) {
            chosen = i;
            if (place < power) {
                break;
            }
        }
        place -= power;
    }
    *inverseProbability = (float)(s->totalPower / powerOf(&s->emitters[chosen]));
    return &s->emitters[chosen];
}

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

// The surface that a particle comes from.
static vplHit sourceOf(const Simulation* s, const vplParticle* p)
{
    const vplGeometry* g = s->geometry;
    const int triangle = s->emission->sources[p->source].triangle;
    vplHit hit = {.object = -1, .face = VPL_FACE_NONE, .triangle = triangle};
    if (triangle >= 0) {
        hit.object = g->owners[triangle];
        hit.face = vplGeometry_FaceOf(g, triangle);
    }
    return hit;
}

// Where a particle begins and what it carries; `from` is what it leaves. False where nothing emits.
static bool start(const Simulation* s, int particle, vplRay* ray, vplRgb* light, vplHit* from)
{
    float u[4];
    vplSampleSource_Direction(&s->samples, particle, 0, &u[2], &u[3]);
    if (s->emission != NULL) {
        vplParticle p;
        vplSampleSource_Place(&s->samples, particle, &u[0], &u[1]);
        if (!vplEmission_SampleParticle(s->emission, vplSampleSource_Emitter(&s->samples, particle), u, &p)) {
            return false;
        }
        *ray = p.ray;
        *light = p.flux;
        *from = sourceOf(s, &p);
    } else {
        float inverseProbability;
        const vplEmitterDef* emitter = chooseEmitter(s, particle, &inverseProbability);
        *light = vplRgbScale(inverseProbability, emitter->intensity);
        *ray = (vplRay){emitter->position, vplSampleSphere(u[2], u[3]), {0, 0}};
    }
    if (s->def.directions != NULL) {
        ray->direction = s->def.directions[particle];
    }
    return true;
}

// Follows one particle to its last step.
static void followParticle(Simulation* s, int particle)
{
    bool documented = s->def.lighting == VPL_LIGHTING_DOCUMENTED;
    bool mirror = s->def.bounce == VPL_BOUNCE_REFLECT || (s->def.bounce == VPL_BOUNCE_AUTO && documented);
    float u, v;
    vplRgb light;
    vplRay ray;
    vplHit hit = {.object = -1};
    const bool started = start(s, particle, &ray, &light, &hit);
    int step = 0;
    for (; started && step < s->stepCount && particle < s->stepCounts[step]; step++) {
        s->raysOf[particle]++;
        if (!trace(s, particle, &ray, &hit)) {
            s->escapedOf[particle] = true;
            break;
        }
        const vplVec3 facing = vplDot(ray.direction, hit.normal) > 0 ? vplNegate(hit.normal) : hit.normal;
        const vplRgb rho = reflectanceAt(s, &hit);
        light = vplRgbMul(light, documented ? vplRgbScale((float)(1 / VPL_PI), rho) : rho);
        if (!documented) {
            light = vplRgbScale(shadingFactor(s, &hit, ray.direction), light);
        }
        s->slots[s->stepStart[step] + particle] = (vplVirtualLight){
            hit.position, documented ? hit.normal : facing,
            light,        (float)((double)s->def.particleCount / s->stepCounts[step]),
            step,         particle,
            hit.object,
        };
        vplSampleSource_Direction(&s->samples, particle, step + 1, &u, &v);
        vplVec3 onward = mirror ? reflect(ray.direction, hit.normal) : vplSampleCosineAround(facing, u, v);
        ray = vplGeometry_Leave(s->geometry, &hit, onward);
    }
    for (; step < s->stepCount && particle < s->stepCounts[step]; step++) {
        s->slots[s->stepStart[step] + particle].step = -1;
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

static vplResult checkDef(const vplContext* context, const vplEmitterDef* emitters, int emitterCount,
                          const vplParticleDef* def)
{
    if (def->cookie != PARTICLE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplParticleDef was not made by vplDefaultParticleDef");
    }
    for (int i = 0; def->lighting == VPL_LIGHTING_DOCUMENTED && i < emitterCount; i++) {
        if (emitters[i].type != VPL_EMITTER_POINT) {
            return vplFail(
                context, VPL_INVALID_ARGUMENT,
                "light %d is not a point light, and documented lighting knows no others; use physical", i);
        }
    }
    if (def->lighting == VPL_LIGHTING_DOCUMENTED && emitterCount < 1) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "the scene has no emitter to shoot particles from: documented lighting needs a point light");
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
    int* starts = vplAlloc(context, steps, sizeof(int));
    *lightsInStep = vplAllocZero(context, steps, sizeof(int));
    s->slots = vplAlloc(context, (size_t)total, sizeof *s->slots);
    s->raysOf = vplAllocZero(context, particles, sizeof *s->raysOf);
    s->testsOf = vplAllocZero(context, particles, sizeof *s->testsOf);
    s->escapedOf = vplAllocZero(context, particles, sizeof *s->escapedOf);
    set->stepCounts = s->stepCounts = counts;
    s->stepStart = starts;
    set->lightsInStep = *lightsInStep;
    set->lights = s->slots;
    if (!counts || !starts || !*lightsInStep || !s->slots || !s->raysOf || !s->testsOf || !s->escapedOf) {
        return VPL_OUT_OF_MEMORY;
    }
    vplResult result = vplCountParticles(context, s->def.particleCount, s->def.reflectivity, counts,
                                         set->stepCount, &set->stepCount, &total);
    for (int i = 0, at = 0; i < set->stepCount; at += counts[i], i++) {
        starts[i] = at;
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
        result = vplCountParticles(context, def->particleCount, def->reflectivity, NULL, 0, &steps, &total);
    }
    vplLightSet* set = result == VPL_SUCCESS ? vplAllocZero(context, 1, sizeof *set) : NULL;
    if (set == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    set->context = context;
    set->stepCount = steps;
    set->particleCount = def->particleCount;
    Simulation s = {.geometry = geometry, .emitters = emitters, .emitterCount = emitterCount, .def = *def};
    s.samples = vplSampleSource_Make(def->sampler, def->seed, def->particleCount);
    for (int i = 0; i < emitterCount; i++) {
        s.totalPower += powerOf(&emitters[i]);
    }
    vplEmission* emission = NULL;
    if (def->lighting == VPL_LIGHTING_PHYSICAL) {
        result = vplEmission_Create(geometry, emitters, emitterCount, &emission);
        s.emission = emission;
    }
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
