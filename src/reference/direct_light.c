// SPDX-License-Identifier: MIT
// Based on: Eric Veach, Robust Monte Carlo Methods for Light Transport Simulation, 1997, chapter 9 (multiple
// importance sampling, power heuristic). For diffuse surfaces the weights depend on ratios of densities
// alone, and no weighted term exceeds the radiance reflected from its light, so nothing overflows where a
// surface touches an area light.
#include "reference/direct_light.h"
#include "geometry/emission.h"
#include "geometry/triangle.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <float.h>

// Emitters that a tree offers to a vertex, of which one gets a ray. Variance times time of a hall with 1,000 points is 0.38, 0.22,
// 0.19, 0.22 of that with all emitters asked for 1, 2, 4, 8 offers, with 30 points 1.36, 0.89, 1.21, 2.01 (bench/path).
enum { TREE_OFFERS = 4 };

// ---- weights

static bool samplesLight(const vplPathScene* s, const vplConnection* c)
{
    return c->bsdfRatio == 0 || s->def.techniques & VPL_PATH_LIGHT_SAMPLING;
}

double vplConnection_Weights(const vplPathScene* s, const vplConnection* c)
{
    return (samplesLight(s, c) ? 1 : 0) +
           (s->def.techniques & VPL_PATH_BSDF_SAMPLING ? vplHeuristic(s, c->bsdfRatio) : 0);
}

static double sumOfTechniques(const vplPathScene* s, const vplConnection* c)
{
    return vplConnection_Weights(s, c) + vplHeuristic(s, c->particleRatio) * c->edges;
}

static double lightSamplingWeight(const vplPathScene* s, const vplConnection* c)
{
    return c->distance > 0 && samplesLight(s, c) ? 1 / sumOfTechniques(s, c) : 0;
}

static double bsdfSamplingWeight(const vplPathScene* s, const vplConnection* c)
{
    if (c->distance == 0) {
        return 1; // the surface touches the light: no other technique finds the path
    }
    return s->def.techniques & VPL_PATH_BSDF_SAMPLING ? vplHeuristic(s, c->bsdfRatio) / sumOfTechniques(s, c)
                                                      : 0;
}

// ---- connections

// Finds the unit vector from a to b in double, 0 where they coincide. Returns the distance.
static double directionTo(vplVec3 a, vplVec3 b, double direction[3])
{
    double x = (double)b.x - a.x, y = (double)b.y - a.y, z = (double)b.z - a.z;
    double distance = sqrt(x * x + y * y + z * z), scale = distance > 0 ? 1 / distance : 0;
    direction[0] = x * scale;
    direction[1] = y * scale;
    direction[2] = z * scale;
    return distance;
}

static double along(vplVec3 n, const double direction[3])
{
    return n.x * direction[0] + n.y * direction[1] + n.z * direction[2];
}

// The environment in one direction. A particle's start has the density of the direction, times the environment's share of
// all power over the area of the disc that particles cover; that share remains of the ratio.
static vplConnection connectToSky(const vplPathScene* s, const vplPathVertex* vertex, vplVec3 towards)
{
    const double to[3] = {towards.x, towards.y, towards.z};
    const double flat = along(vertex->normal, to), cosine = along(vertex->shading, to);
    double density;
    const vplRgb light = vplEnvironment_Light(s->geometry->environment, towards, &density);
    vplConnection found = {.distance = FLT_MAX, .cosineAtLight = 1, .edges = vertex->edges};
    if (!(density > 0 && flat > 0 && cosine > 0)) {
        return (vplConnection){.distance = 0};
    }
    found.bsdfRatio = cosine / VPL_PI / density;
    found.value = vplRadiance_Reflect(found.bsdfRatio, vertex->rho, vplRadiance_Of(light));
    found.particleRatio = s->skyShare * flat;
    found.bsdfRatio *= 1 - vertex->guided;
    return found;
}

// Finds the source of an emitter or a triangle among first .. end - 1, which are in the order of either; -1 where it has no
// power.
static int findSource(const vplEmission* e, int first, int end, const vplLightPoint* light)
{
    while (first < end) {
        const int middle = first + (end - first) / 2;
        const vplEmissionSource* s = &e->sources[middle];
        const int difference =
            light->triangle >= 0 ? s->triangle - light->triangle : s->emitter - light->emitter;
        if (difference == 0) {
            return middle;
        }
        first = difference < 0 ? middle + 1 : first;
        end = difference < 0 ? end : middle;
    }
    return -1;
}

// The probability with which light sampling chooses the emitter or triangle at the vertex, from a tree.
static double probabilityOf(const vplPathScene* s, const vplPathVertex* vertex, const vplLightPoint* light)
{
    const vplEmission* e = s->emission;
    const bool onTriangle = light->triangle >= 0;
    const vplEmitterTree* tree = onTriangle ? s->trees->triangles : s->trees->emitters;
    if (tree == NULL || (!onTriangle && (light->emitter < 0 ||
                                         e->emitters[light->emitter].type == VPL_EMITTER_DIRECTIONAL))) {
        return 1;
    }
    const int source = onTriangle ? findSource(e, e->firstTriangle, e->sourceCount, light)
                                  : findSource(e, 0, e->firstTriangle, light);
    return source < 0 ? 0
                      : vplEmitterTree_Probability(tree, vertex->hit.position, vertex->shading, source) *
                            (onTriangle ? 1 : TREE_OFFERS);
}

// The density, per square metre, with which a path from a guided vertex finds a point on a triangle that emits.
static __attribute__((noinline)) double guidedDensity(const vplPathScene* s, const vplPathVertex* vertex,
                                                      const vplLightPoint* light, double reflection)
{
    const vplHit hit = {.triangle = light->triangle, .position = light->position, .normal = light->normal};
    const vplVec3 direction = vplSub(light->position, vertex->hit.position);
    return vplPathVertex_Density(s, vertex, s->def.guide->find(s->def.guide->data, &hit, direction),
                                 reflection);
}

// Sources are chosen by power and particles leave emitters by intensity, so the density of a particle from an
// emitter is its intensity over the power of all sources. A particle's start on a triangle has the density of
// a chosen point, times the triangles' share of all power; that share and the lobe of the cosine remain of
// the ratio. Trees choose an emitter or a triangle with this probability, which is 1 without them: then all
// emitters are asked, and triangles are chosen by power.
static inline __attribute__((always_inline)) vplConnection
connect(const vplPathScene* s, const vplPathVertex* vertex, const vplLightPoint* light, double probability)
{
    if (light->emitter < 0 && light->triangle < 0) {
        return connectToSky(s, vertex, vplNegate(light->normal));
    }
    const vplEmitterDef* e = light->emitter >= 0 ? &s->emission->emitters[light->emitter] : NULL;
    const bool fromInfinity = e != NULL && e->type == VPL_EMITTER_DIRECTIONAL;
    vplConnection none = {.distance = 0}, found = {.cosineAtLight = 1, .edges = vertex->edges};
    double to[3] = {0, 0, 0}, falloff = 1;
    if (fromInfinity) {
        found.distance = FLT_MAX;
        to[0] = -(double)e->direction.x;
        to[1] = -(double)e->direction.y;
        to[2] = -(double)e->direction.z;
    } else {
        found.distance = directionTo(vertex->hit.position, light->position, to);
        falloff = 1 / (found.distance * found.distance);
    }
    found.cosineAtLight = e ? 1 : -along(light->normal, to);
    const double flat = along(vertex->normal, to), cosine = along(vertex->shading, to);
    if (!(found.distance > 0 && found.cosineAtLight > 0 && flat > 0 && cosine > 0 && probability > 0)) {
        return none;
    }
    if (e != NULL) {
        vplRgb i = vplEmitter_Intensity(e, vplVec((float)-to[0], (float)-to[1], (float)-to[2]));
        found.value =
            vplRadiance_Reflect(cosine * falloff / VPL_PI / probability, vertex->rho, vplRadiance_Of(i));
        found.particleRatio = vplRgbMean(i) / s->power * flat * falloff / probability;
    } else {
        const vplGeometry* g = s->geometry;
        vplRgb radiance = g->materials[g->triangleMaterials[light->triangle]].emission;
        // The density of the point, per square metre, and the share of all particles that start on triangles.
        double density = VPL_PI * vplRgbMean(radiance) / s->trianglePower,
               share = s->trianglePower / s->power;
        if (s->trees->triangles != NULL) {
            share = VPL_PI * vplRgbMean(radiance) / s->power;
            density = probability / vplGeometry_TriangleArea(g, light->triangle);
            share /= density;
        }
        found.bsdfRatio = cosine / VPL_PI * found.cosineAtLight * falloff / density;
        found.value = vplRadiance_Reflect(found.bsdfRatio, vertex->rho, vplRadiance_Of(radiance));
        found.particleRatio = share * found.cosineAtLight / VPL_PI * flat * falloff;
        if (vertex->guided > 0) {
            const double reflection = cosine / VPL_PI * found.cosineAtLight * falloff;
            found.bsdfRatio = guidedDensity(s, vertex, light, reflection) / density;
        }
    }
    return found;
}

static float largestCoordinate(vplVec3 p)
{
    return fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z)));
}

// The shadow ray must not hit that surface, which rounding puts before or behind the point: it stops short by the rounding
// of coordinates, enlarged at grazing angles.
bool vplPathVertex_Sees(vplPathState* path, const vplPathVertex* v, vplVec3 point, double distance,
                        double cosine)
{
    const vplGeometry* g = path->scene->geometry;
    double extent = fmaxf(largestCoordinate(point), largestCoordinate(v->hit.position));
    double shorter = 0x1p-20 + 0x1p-19 * extent / (distance * cosine);
    vplRay ray = vplGeometry_Leave(g, &v->hit, vplSub(point, v->hit.position));
    path->rays++;
    return !vplGeometry_IsOccluded(g, &ray, (float)(1 - (shorter < 0.5 ? shorter : 0.5)));
}

// Tests whether nothing is in a direction from the vertex.
static bool isOpen(vplPathState* path, const vplPathVertex* v, vplVec3 towards)
{
    const vplRay ray = vplGeometry_Leave(path->scene->geometry, &v->hit, towards);
    path->rays++;
    return !vplGeometry_IsOccluded(path->scene->geometry, &ray, FLT_MAX);
}

static bool isEmitterVisible(vplPathState* path, const vplPathVertex* v, const vplEmitterDef* e,
                             const vplConnection* c)
{
    if (e->type != VPL_EMITTER_DIRECTIONAL) {
        return vplPathVertex_Sees(path, v, e->position, c->distance, 1);
    }
    return isOpen(path, v, vplNegate(e->direction));
}

// ---- light sampling

// A random number of 48 bits from two of 24: choosing from a tree of many sources uses up more than 24.
static double refine(float u, float more)
{
    return (double)u + 0x1p-24 * (double)more;
}

static void addTriangle(vplPathState* path, const vplPathVertex* v, double choice, float across,
                        vplRadiance* sum)
{
    const vplPathScene* s = path->scene;
    vplChosenSource chosen = {.probability = 1};
    if (s->trees->triangles != NULL) {
        chosen = vplEmitterTree_Choose(s->trees->triangles, v->hit.position, v->shading, choice);
    } else {
        chosen.source = vplEmission_Choose(s->emission, s->emission->firstTriangle, choice, &chosen.rest);
    }
    if (chosen.source < 0) {
        return;
    }
    int triangle = s->emission->sources[chosen.source].triangle;
    vplHit point =
        vplGeometry_SampleTriangle(s->geometry, triangle, (float)chosen.rest * 0x1.fffffep-1f, across);
    vplLightPoint light = {-1, triangle, point.position, point.normal};
    const vplConnection c = connect(s, v, &light, chosen.probability);
    const double weight = lightSamplingWeight(s, &c);
    if (weight > 0 && vplPathVertex_Sees(path, v, point.position, c.distance, c.cosineAtLight)) {
        vplRadiance_Add(sum, vplRadiance_Scale(weight, c.value));
    }
}

static inline __attribute__((always_inline)) vplConnection
connectToEmitter(const vplPathScene* s, const vplPathVertex* v, int emitter, double probability)
{
    vplLightPoint light = {emitter, -1, s->emission->emitters[emitter].position, {0, 0, 0}};
    vplConnection c = connect(s, v, &light, probability);
    c.value = vplRadiance_Scale(lightSamplingWeight(s, &c), c.value);
    return c;
}

// Emitters that were offered, of which one is chosen with a probability proportional to its unoccluded light.
typedef struct Offers {
    vplReservoir reservoir;
    vplConnection chosen;
    double power; // of the chosen one
    int emitter;  // the chosen one; -1: none
} Offers;

// Always inlined, so that the reservoir stays in registers: saves 1.2 % of the instructions in scenes with few emitters.
static inline __attribute__((always_inline)) void offer(const vplPathScene* s, const vplPathVertex* v,
                                                        int emitter, double probability, Offers* o)
{
    const vplConnection c = connectToEmitter(s, v, emitter, probability);
    double power = c.value.r + c.value.g + c.value.b;
    if (power <= 0) {
        return;
    }
    if (vplReservoir_Takes(&o->reservoir, power)) {
        o->chosen = c;
        o->power = power;
        o->emitter = emitter;
    }
}

// Offers directional emitters, and points and spots that the tree chooses by numbers spread evenly from `choice` on.
static __attribute__((noinline)) void offerFromTree(const vplPathScene* s, const vplPathVertex* v,
                                                    double choice, Offers* o)
{
    for (int i = 0; i < s->trees->directionalCount; i++) {
        offer(s, v, s->trees->directional[i], 1, o);
    }
    for (int i = 0; i < TREE_OFFERS; i++) {
        const vplChosenSource c = vplEmitterTree_Choose(s->trees->emitters, v->hit.position, v->shading,
                                                        (i + choice) / TREE_OFFERS);
        if (c.source >= 0) {
            offer(s, v, s->emission->sources[c.source].emitter, TREE_OFFERS * c.probability, o);
        }
    }
}

// Adds one emitter. For equal variance it takes 0.83x to 0.97x the time of all emitters (3 to 8 point lights in the room).
static void addEmitter(vplPathState* path, const vplPathVertex* v, const float u[4], vplRadiance* sum)
{
    const vplPathScene* s = path->scene;
    Offers o = {
        .reservoir = {.choice = (double)u[s->trees->emitters != NULL ? 1 : 0]}, .power = 1, .emitter = -1};
    if (s->trees->emitters != NULL) {
        offerFromTree(s, v, refine(u[0], u[3]), &o);
    } else {
        for (int i = 0; i < s->emission->emitterCount; i++) {
            offer(s, v, i, 1, &o);
        }
    }
    if (o.emitter >= 0 && isEmitterVisible(path, v, &s->emission->emitters[o.emitter], &o.chosen)) {
        vplRadiance_Add(sum, vplRadiance_Scale(o.reservoir.total / o.power, o.chosen.value));
    }
}

static void addSky(vplPathState* path, const vplPathVertex* v, const float u[2], vplRadiance* sum)
{
    const vplVec3 towards =
        vplEnvironment_Sample(path->scene->geometry->environment, (double)u[0], (double)u[1]).direction;
    const vplConnection c = connectToSky(path->scene, v, towards);
    const double weight = lightSamplingWeight(path->scene, &c);
    if (weight > 0 && isOpen(path, v, towards)) {
        vplRadiance_Add(sum, vplRadiance_Scale(weight, c.value));
    }
}

vplRadiance vplSampleDirect(vplPathState* path, const vplPathVertex* vertex, const float u[2], uint32_t set)
{
    const int emitters = path->scene->emission->emitterCount;
    vplRadiance sum = {0, 0, 0};
    float more[4] = {0};
    const bool sky = path->scene->geometry->environment != NULL;
    if (emitters > 1 || sky || path->scene->trees->triangles != NULL) {
        vplPath_Draw(path, set, more);
    }
    if (emitters > 0) {
        addEmitter(path, vertex, more, &sum);
    }
    if (path->scene->trianglePower > 0) {
        addTriangle(path, vertex,
                    path->scene->trees->triangles != NULL ? refine(u[0], more[2]) : (double)u[0], u[1], &sum);
    }
    if (sky) {
        addSky(path, vertex, more + 2, &sum);
    }
    return sum;
}

// ---- BSDF sampling

vplRadiance vplHitEmission(const vplPathScene* s, const vplPathVertex* vertex, const vplHit* hit,
                           vplVec3 direction)
{
    vplRgb emission = vplPathScene_EmissionAt(s, hit, direction);
    if (emission.r + emission.g + emission.b <= 0) {
        return (vplRadiance){0, 0, 0};
    }
    vplLightPoint light = {-1, hit->triangle, hit->position, hit->normal};
    const vplConnection c = connect(s, vertex, &light, probabilityOf(s, vertex, &light));
    return vplRadiance_Scale(bsdfSamplingWeight(s, &c), vplRadiance_Of(emission));
}

vplRadiance vplMissEmission(const vplPathScene* s, const vplPathVertex* vertex, vplVec3 direction)
{
    if (s->geometry->environment == NULL) {
        return (vplRadiance){0, 0, 0};
    }
    const vplConnection c = connectToSky(s, vertex, direction);
    double density;
    const vplRgb light = vplEnvironment_Light(s->geometry->environment, direction, &density);
    return vplRadiance_Scale(c.distance > 0 ? bsdfSamplingWeight(s, &c) : 0, vplRadiance_Of(light));
}

// ---- light paths

vplConnection vplConnectToLight(const vplPathScene* s, const vplPathVertex* vertex,
                                const vplLightPoint* light)
{
    return connect(s, vertex, light, probabilityOf(s, vertex, light));
}
