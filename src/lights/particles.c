// SPDX-License-Identifier: MIT
// Particle simulation.
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights, "Particle Simulation", after
// Alexander Keller, Instant Radiosity, SIGGRAPH 1997. All N particles are shot, then the first floor(rho N)
// go on, then the first floor(rho^2 N), as in the document's figure (its prose skips floor(rho N)).
//
// Documented: light is multiplied by rho_d/pi at every hit and reflected as by a mirror. Physical: the flux 4
// pi I is multiplied by rho_d and leaves in a cosine-distributed direction.
//
// Keller counts the places where particles start as step 0: N lights on the emitters, of which the first
// floor(rho N) are shot. Departs: where particles start from a point or a direction, these lights are marked
// as the emitter itself.
#include "lights/particles.h"

#include "base/arena.h"
#include "geometry/bvh.h"
#include "geometry/paint.h"
#include "lights/light_set.h"
#include "math/sampling.h"
#include "math/vec.h"

typedef struct Simulation {
    const vplGeometry* geometry;
    vplParticleDef def;
    vplStarts starts;
    bool keller; // lights where particles start are step 0
    // Per step: its first slot, the number of particles that reach it to leave a light or to go on, their
    // weight.
    int *stepCounts, *stepStart, *reach;
    double* weights;
    int stepCount;
    vplVirtualLight* slots; // one per step and particle; step -1 where nothing was hit
    // Per particle.
    int *raysOf, *testsOf;
    bool* escapedOf;
} Simulation;

vplVec3 vplMirror(vplVec3 d, vplVec3 n)
{
    const float along = vplDot(d, n);
    vplVec3 r = vplNormalize(vplSub(d, vplScale(2 * along, n)));
    // A grazing ray may point into the surface after rounding, by up to 1e-7: it slides along it, and what it
    // is lifted by is more than the rounding of this.
    const float lift = 0x1p-22f, side = along > 0 ? -1.0f : 1.0f, out = side * vplDot(r, n);
    return out >= lift ? r : vplNormalize(vplAdd(r, vplScale(side * (lift - out), n)));
}

// Finds the particle's next surface. `hit` is the one it leaves, of object -1 in free space.
static bool trace(Simulation* s, int particle, const vplRay* ray, vplHit* hit)
{
    if (s->def.geometry == VPL_PARTICLE_GEOMETRY_EXACT) {
        return vplClosestHit(s->geometry, ray, INFINITY, &s->testsOf[particle], hit);
    }
    const vplHit from = *hit;
    s->testsOf[particle] += s->geometry->objectCount;
    return vplGeometry_ClosestBox(s->geometry, ray, from.object >= 0 ? &from : NULL, hit);
}

// Looks up the first surface of a particle in its emitter's map. The ray becomes that of the texel's centre.
static bool lookUp(Simulation* s, const vplReflectiveMap* map, vplRay* ray, vplHit* hit)
{
    const int64_t texel = vplReflectiveMap_Find(map, ray);
    return texel >= 0 && vplReflectiveMap_GetHit(map, s->geometry, texel, hit, &ray->direction);
}

// The map that replaces a particle's first ray, or NULL.
static const vplReflectiveMap* mapOf(const Simulation* s, const vplStart* p)
{
    return s->def.maps != NULL && p->emitter >= 0 ? s->def.maps[p->emitter] : NULL;
}

// A bounding box reflects as its object does in the mean.
static vplRgb reflectanceAt(const Simulation* s, const vplHit* hit)
{
    const vplGeometry* g = s->geometry;
    const vplFootprint f = vplUpright(g, hit->triangle, vplShareOfArea(g, s->def.particleCount));
    return s->def.geometry == VPL_PARTICLE_GEOMETRY_OBB
               ? g->objects[hit->object].reflectance
               : vplGeometry_Reflectance(g, hit->triangle, hit->position, &f);
}

// Smooth surfaces receive by their shading normal: cos(shading) / cos(geometric) of what hit the triangle.
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
        return; // passes: a later step has more particles
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
        const vplVirtualLight first = vplStart_Light(&s->starts, &p);
        leaveLight(s, particle, step++, &first);
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
        vplVec3 onward =
            mirror ? vplMirror(p.ray.direction, hit->normal) : vplSampleCosineAround(facing, u, v);
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

// Closes the gaps of escaped particles and sums the statistics, in particle order.
static void collect(const Simulation* s, int* lightsInStep, vplLightSet* set)
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

static vplParticlePass passOf(const vplParticleDef* def)
{
    return (vplParticlePass){def->pass ? def->firstParticle : 0, def->particleCount, def->reflectivity};
}

static vplResult prepare(Simulation* s, vplContext* context, vplArena* scratch)
{
    const size_t particles = (size_t)s->def.particleCount, steps = (size_t)s->stepCount;
    s->stepCounts = vplArena_Alloc(scratch, steps, sizeof *s->stepCounts);
    s->stepStart = vplArena_Alloc(scratch, steps, sizeof *s->stepStart);
    s->reach = vplArena_Alloc(scratch, steps, sizeof *s->reach);
    s->weights = vplArena_Alloc(scratch, steps, sizeof *s->weights);
    s->raysOf = vplArena_AllocZero(scratch, particles, sizeof *s->raysOf);
    s->testsOf = vplArena_AllocZero(scratch, particles, sizeof *s->testsOf);
    s->escapedOf = vplArena_AllocZero(scratch, particles, sizeof *s->escapedOf);
    TRY(vplArena_Check(scratch));
    const vplParticlePass pass = passOf(&s->def);
    vplStepTotals totals;
    TRY(vplCountParticles(context, &pass, s->stepCounts, s->stepCount, &totals));
    double weight = 1;
    for (int i = 0, at = 0; i < s->stepCount; at += s->stepCounts[i], i++) {
        s->stepStart[i] = at;
        s->weights[i] = s->def.pass ? weight : (double)s->def.particleCount / s->stepCounts[i];
        weight /= s->def.reflectivity;
    }
    for (int i = s->stepCount - 1, most = 0; i >= 0; i--) {
        most = s->stepCounts[i] > most ? s->stepCounts[i] : most;
        s->reach[i] = most;
    }
    return VPL_SUCCESS;
}

static vplResult simulate(Simulation* s, int lightCount, vplArena* scratch, vplLightSet** setOut)
{
    vplContext* context = s->geometry->context;
    vplLightArrays arrays;
    vplLightSet* set;
    TRY(prepare(s, context, scratch));
    TRY(vplLightSet_Make(context, lightCount, s->stepCount, &arrays, &set));
    s->slots = arrays.lights;
    set->particleCount = s->def.particleCount;
    for (int i = 0; i < s->stepCount; i++) {
        arrays.stepCounts[i] = s->stepCounts[i];
    }
    const vplResult result =
        vplParallelForProgress(context, (s->def.particleCount + CHUNK - 1) / CHUNK, followChunk, s,
                               (vplProgressRange){s->def.progress, s->def.progressUser, 0, 1});
    if (result == VPL_SUCCESS) {
        collect(s, arrays.lightsInStep, set);
    }
    return vplArena_Deliver(set->arena, result, set, setOut);
}

vplResult vplSimulateParticles(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                               const vplParticleDef* def, vplLightSet** setOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, def, setOut);
    REQUIRE_ARRAY(CONTEXT_OF(geometry), emitters, emitterCount);
    vplContext* context = geometry->context;
    const vplParticlePass pass = passOf(def);
    vplStepTotals totals;
    vplEmission* emission = NULL;
    TRY(vplParticleDef_Check(context, emitters, emitterCount, def));
    TRY(vplCountParticles(context, &pass, NULL, 0, &totals));
    if (!vplParticleDef_NeedsPoints(def)) {
        TRY(vplEmission_Create(geometry, emitters, emitterCount, &emission));
    }
    vplResult result = VPL_SUCCESS;
    if (emission != NULL && emission->sourceCount == 0 && emitterCount == 0) {
        result = vplFail(context, VPL_INVALID_ARGUMENT,
                         "the scene has no emitter: no light, and no surface that emits");
    }
    if (result == VPL_SUCCESS) {
        vplArena* scratch = vplArena_Create(context);
        Simulation s = {.geometry = geometry,
                        .def = *def,
                        .keller = def->start == VPL_START_EMITTER,
                        .stepCount = totals.stepCount};
        s.starts = vplStarts_Make(geometry, emission, emitters, emitterCount, &s.def);
        result = simulate(&s, (int)totals.lightCount, scratch, setOut);
        vplArena_Destroy(scratch);
    }
    vplEmission_Destroy(emission);
    return result;
}
