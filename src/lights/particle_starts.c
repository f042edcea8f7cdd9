// SPDX-License-Identifier: MIT
// The definition of a simulation, and where its particles start. Emitters share them by power. Documented:
// point lights, with their intensity, in uniform directions. Otherwise everything that emits, by
// vplEmission_SampleParticle.
#include "lights/particles.h"

#include "geometry/emission.h"
#include "lights/sky_lights.h"
#include "base/context.h"
#include "geometry/triangle.h"
#include "math/sampling.h"
#include "math/vec.h"

// ---- the definition

enum { PARTICLE_COOKIE = 0x56504c60 };

vplParticleDef vplDefaultParticleDef(void)
{
    vplParticleDef def = {0};
    def.particleCount = 10;
    def.reflectivity = 0.5;
    def.cookie = PARTICLE_COOKIE;
    return def;
}

// Franchi and Ferrante's formulas know point lights only.
bool vplParticleDef_NeedsPoints(const vplParticleDef* def)
{
    return def->lighting == VPL_LIGHTING_DOCUMENTED && def->start == VPL_START_FIRST_HIT;
}

vplResult vplParticleDef_Check(const vplContext* context, const vplEmitterDef* emitters, int emitterCount,
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
    const bool pointsOnly = vplParticleDef_NeedsPoints(def);
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

// ---- starts

static double powerOf(const vplEmitterDef* e)
{
    return vplRgbMean(e->intensity);
}

vplStarts vplStarts_Make(const vplGeometry* geometry, const vplEmission* emission,
                         const vplEmitterDef* emitters, int emitterCount, const vplParticleDef* def)
{
    vplStarts s = {geometry, def, emitters, emitterCount, 0, emission, {0}};
    s.samples = vplSampleSource_Make(def);
    for (int i = 0; i < emitterCount; i++) {
        s.totalPower += powerOf(&emitters[i]);
    }
    return s;
}

// The emitter of particle i, and one over the probability that it was chosen.
static const vplEmitterDef* chooseEmitter(const vplStarts* s, int particle, float* inverseProbability)
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

// The surface that a particle leaves.
static vplHit sourceOf(const vplStarts* s, const vplParticle* p)
{
    const vplGeometry* g = s->geometry;
    const int triangle = s->emission->sources[p->source].triangle;
    vplHit hit = {.object = -1, .face = VPL_FACE_NONE, .triangle = triangle, .position = p->position};
    if (triangle >= 0) {
        hit.object = g->owners[triangle];
        hit.face = vplGeometry_FaceOf(g, triangle);
    }
    return hit;
}

// The light that Keller's particle leaves where it starts. Light of the environment is far away; its flux is as much
// larger as its distance squared, so that surfaces receive what parallel light brings them.
vplVirtualLight vplStart_Light(const vplStarts* s, const vplStart* p)
{
    if (s->emission != NULL && p->onSky) {
        return (vplVirtualLight){vplSkyLight_Position(s->emission, vplNegate(p->normal)), p->normal,
                                 vplScaleRadiometric((double)VPL_SKY_DISTANCE * VPL_SKY_DISTANCE, p->light),
                                 .object = VPL_SKY_OBJECT};
    }
    return (vplVirtualLight){p->from.position, p->normal, p->light, .object = p->from.object};
}

bool vplStarts_Get(const vplStarts* s, int particle, vplStart* out)
{
    float u[4];
    vplSampleSource_Direction(&s->samples, particle, 0, &u[2], &u[3]);
    if (s->emission != NULL) {
        vplParticle p;
        vplSampleSource_Place(&s->samples, particle, &u[0], &u[1]);
        if (!vplEmission_SampleParticle(s->emission, vplSampleSource_Emitter(&s->samples, particle), u, &p)) {
            return false;
        }
        *out = (vplStart){p.ray,
                          p.normal,
                          p.flux,
                          sourceOf(s, &p),
                          s->emission->sources[p.source].emitter,
                          p.source == s->emission->environment};
    } else {
        float inverseProbability;
        const vplEmitterDef* emitter = chooseEmitter(s, particle, &inverseProbability);
        const vplVec3 direction = vplSampleSphere(u[2], u[3]);
        *out =
            (vplStart){{emitter->position, direction, {0, 0}},
                       direction,
                       vplRgbScale(inverseProbability, emitter->intensity),
                       {.object = -1, .face = VPL_FACE_NONE, .triangle = -1, .position = emitter->position},
                       (int)(emitter - s->emitters),
                       false};
    }
    if (s->def->directions != NULL) {
        out->ray.direction = s->def->directions[particle];
    }
    return true;
}
