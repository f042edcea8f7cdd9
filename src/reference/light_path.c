// SPDX-License-Identifier: MIT
// Based on: Eric P. Lafortune and Yves D. Willems, Bi-directional Path Tracing, Compugraphics 1993; Eric Veach, Robust Monte Carlo
// Methods for Light Transport Simulation, 1997, chapter 10 (bidirectional path tracing) and section 5.3 (shading normals). Connections to light
// paths find bright places that paths from the camera hardly find: the ceiling above a point light, or all that is lit through a gap.
// Between diffuse surfaces a reflection along an edge has the same density in both directions. So, of the techniques that find the same path, the
// one that connects the ends of an edge has a density that is proportional to one over the density of the reflection along this edge.
#include "reference/light_path.h"
#include "base/context.h"
#include "geometry/emission.h"
#include "math/sampling.h"
#include "math/vec.h"

// First indices of the sets of random numbers that light paths draw; paths from the camera use lower ones.
enum { VERTEX_SETS = 1 << 30, CHOICE_SETS = VERTEX_SETS + VPL_MOST_LIGHT_VERTICES };

static vplPathVertex makeVertex(const vplPathScene* s, const vplHit* hit, vplVec3 direction)
{
    vplPathVertex v = vplPathVertex_Make(s, hit, direction, VPL_BOUNCE_SPREAD * hit->t);
    if (s->def.guide != NULL) {
        vplPathVertex_Locate(s, &v, direction);
    }
    return v;
}

// The first vertex. Returns false if the light path ends before it, or reflects nothing.
static bool makeFirst(vplPathState* path, double choice, const float u[4], vplLightPath* p)
{
    const vplPathScene* s = path->scene;
    vplParticle start;
    vplHit hit;
    if (!vplEmission_SampleParticle(s->emission, choice, u, &start)) {
        return false;
    }
    path->rays++;
    if (!vplGeometry_ClosestHit(s->geometry, &start.ray, &hit)) {
        return false;
    }
    const vplEmissionSource* source = &s->emission->sources[start.source];
    const vplLightPoint light = {source->emitter, source->triangle, start.position, start.normal};
    vplLightVertex* first = &p->vertices[0];
    first->at = makeVertex(s, &hit, start.ray.direction);
    first->carried = (vplRgb){1, 1, 1};
    first->ratio = 1;
    first->edges = 0;
    p->light = vplConnectToLight(s, &first->at, &light);
    p->weights = vplConnection_Weights(s, &p->light);
    return p->light.distance > 0;
}

// The next vertex. Russian roulette ends paths whose vertices reflect little light.
static bool makeNext(vplPathState* path, const vplLightVertex* from, uint32_t set, vplRgb* reflected,
                     vplLightVertex* to)
{
    const vplPathScene* s = path->scene;
    float u[4];
    vplHit hit;
    vplPath_Draw(path, set, u);
    const float chance = vplPathScene_Survival(s, *reflected);
    if (u[2] >= chance) {
        return false;
    }
    const vplVec3 direction = vplSampleCosineAround(from->at.normal, u[0], u[1]);
    const vplRay ray = vplGeometry_Leave(s->geometry, &from->at.hit, direction);
    path->rays++;
    if (!vplGeometry_ClosestHit(s->geometry, &ray, &hit)) {
        return false;
    }
    to->at = makeVertex(s, &hit, direction);
    const double left = vplDot(direction, from->at.normal), flat = -vplDot(direction, to->at.normal),
                 cosine = -vplDot(direction, to->at.shading);
    const double reflection = vplDensityOfReflection(cosine, left, hit.t); // from here to the vertex before
    const bool guided = to->at.guided > 0;
    const double density =
        guided ? vplPathVertex_Density(s, &to->at, from->at.place, reflection) : reflection;
    const vplRgb kept = vplRgbScale(1 / chance, to->at.rho);
    *reflected = vplRgbMul(*reflected, kept);
    to->carried = vplRgbMul(from->carried, kept);
    to->ratio = from->ratio * flat / cosine;
    if (guided) {
        to->carried = vplRgbScale((float)(reflection / density), to->carried);
        to->ratio *= reflection / density;
    }
    to->edges = from->edges + vplHeuristic(s, from->ratio / density);
    return density > 0 && flat > 0; // else no path from the camera goes along there
}

void vplLightPath_Follow(vplPathState* path, double choice, const float u[4], vplLightPath* p)
{
    const vplPathScene* s = path->scene;
    p->count = makeFirst(path, choice, u, p) ? 1 : 0;
    vplRgb reflected = p->count > 0 ? p->vertices[0].at.rho : (vplRgb){0, 0, 0};
    while (p->count > 0 && p->count < s->lightVertices &&
           makeNext(path, &p->vertices[p->count - 1], (uint32_t)(VERTEX_SETS + p->count), &reflected,
                    &p->vertices[p->count])) {
        p->count++;
    }
}

// A connection to a vertex of the light path.
typedef struct Offer {
    vplRadiance light;       // that it adds if nothing is in between
    double power;            // the sum of its red, green and blue
    double distance, cosine; // cosine: at the light path's vertex
    int vertex;              // -1: none
} Offer;

static inline __attribute__((always_inline)) Offer offerOf(const vplPathState* path, const vplPathVertex* v,
                                                           const vplLightPath* p, int i, bool guided)
{
    const vplPathScene* s = path->scene;
    const vplLightVertex* l = &p->vertices[i];
    const vplVec3 between = vplSub(l->at.hit.position, v->hit.position);
    Offer o = {.distance = (double)vplLength(between), .vertex = i};
    const double scale = o.distance > 0 ? 1 / o.distance : 0;
    const double cosine = scale * vplDot(between, v->shading), flat = scale * vplDot(between, v->normal);
    o.cosine = -scale * vplDot(between, l->at.normal);
    if (!(cosine > 0 && flat > 0 && o.cosine > 0)) {
        return o;
    }
    const double reflection = vplDensityOfReflection(cosine, o.cosine, o.distance);
    const double density = guided ? vplPathVertex_Density(s, v, l->at.place, reflection) : reflection;
    const double share = guided ? reflection / density : 1;
    const double edges =
        l->edges + vplHeuristic(s, l->ratio / density) +
        vplHeuristic(s, l->ratio * flat / cosine * share) * path->edges[s->lightVertices - 1 - i];
    const double mine = p->light.particleRatio * l->ratio / density;
    const double weight = share * (s->def.balanceHeuristic ? 1 : mine) /
                          (p->weights + vplHeuristic(s, p->light.particleRatio) * edges);
    o.light = vplRadiance_Reflect(weight, vplRgbMul(v->rho, l->carried), p->light.value);
    o.power = o.light.r + o.light.g + o.light.b;
    return o;
}

static inline __attribute__((always_inline)) vplRadiance connectTo(vplPathState* path, const vplPathVertex* v,
                                                                   const vplLightPath* p, int bounce,
                                                                   vplRgb throughput, bool guided)
{
    const vplPathScene* s = path->scene;
    const vplRadiance none = {0, 0, 0};
    float u[4] = {0};
    if (p->count > 1) {
        vplPath_Draw(path, (uint32_t)(CHOICE_SETS + bounce), u);
    }
    Offer chosen = {.vertex = -1};
    vplReservoir reservoir = {.choice = (double)u[0]};
    for (int i = 0; i < p->count && bounce + 1 + i <= s->def.mostBounces; i++) {
        const Offer o = offerOf(path, v, p, i, guided);
        if (o.power > 0 && vplReservoir_Takes(&reservoir, o.power)) {
            chosen = o;
        }
    }
    const int i = chosen.vertex;
    if (i < 0 || bounce + 1 + i < s->def.firstBounce || bounce + 1 + i > s->def.lastBounce ||
        !vplPathVertex_Sees(path, v, p->vertices[i].at.hit.position, chosen.distance, chosen.cosine)) {
        return none;
    }
    const vplRadiance light = vplRadiance_Scale(reservoir.total / chosen.power, chosen.light);
    if (i > 0) {
        path->further += (light.r * throughput.r + light.g * throughput.g + light.b * throughput.b) / 3;
    }
    return light;
}

// The connection is compiled twice, so that the guide costs other paths no time.
vplRadiance vplConnectToLightPath(vplPathState* path, const vplPathVertex* v, const vplLightPath* p,
                                  int bounce, vplRgb throughput)
{
    return v->guided > 0 ? connectTo(path, v, p, bounce, throughput, true)
                         : connectTo(path, v, p, bounce, throughput, false);
}

// ---- how much light is found at later vertices of light paths

// Light that is reflected more often hardly counts, and takes long where surfaces absorb hardly any.
enum { PILOT_BOUNCES = 32 };

enum { PILOT_CHUNKS = 32, PILOT_SEED = 0x70696c6f74 };

typedef struct Pilot {
    vplPathScene scene;
    double all[PILOT_CHUNKS], further[PILOT_CHUNKS]; // light that paths found
} Pilot;

static void followPilots(void* data, int chunk, int worker)
{
    (void)worker;
    Pilot* p = data;
    const uint64_t pixels = (uint64_t)p->scene.def.width * (uint64_t)p->scene.def.height;
    enum { EACH = VPL_PILOT_PATHS / PILOT_CHUNKS };
    for (uint64_t i = (uint64_t)chunk * EACH; i < ((uint64_t)chunk + 1) * EACH; i++) {
        float u[4];
        vplSobol_Sample(&p->scene.sobol, PILOT_SEED, 0, 0, (uint32_t)i, u);
        const uint64_t pixel =
            (uint64_t)(((double)i + (double)u[0]) / VPL_PILOT_PATHS * (double)pixels) % pixels;
        vplPathState path = {.scene = &p->scene, .stream = 2 * i};
        vplRadiance light = {0, 0, 0};
        vplPath_Follow(&path, (int)(pixel % (uint64_t)p->scene.def.width),
                       (int)(pixel / (uint64_t)p->scene.def.width), &light);
        p->all[chunk] += (light.r + light.g + light.b) / 3;
        p->further[chunk] += path.further;
    }
}

vplResult vplMeasureFurther(const vplGeometry* geometry, const vplPathDef* def, double* shareOut)
{
    Pilot pilot = {.all = {0}};
    vplPathDef reflected = *def;
    reflected.seed = PILOT_SEED;
    reflected.emission = false;
    reflected.lightVertices = VPL_MOST_LIGHT_VERTICES;
    reflected.firstBounce = 1;
    reflected.lastBounce = def->mostBounces < PILOT_BOUNCES ? def->mostBounces : PILOT_BOUNCES;
    reflected.mostBounces = reflected.lastBounce;
    TRY(vplPathScene_Init(&pilot.scene, geometry, &reflected));
    const vplResult result = vplParallelForAsking(geometry->context, PILOT_CHUNKS, followPilots, &pilot);
    double all = 0, further = 0;
    for (int i = 0; i < PILOT_CHUNKS; i++) {
        all += pilot.all[i];
        further += pilot.further[i];
    }
    vplPathScene_Free(&pilot.scene);
    *shareOut = all > 0 ? further / all : 0;
    return result;
}
