// SPDX-License-Identifier: MIT
// The clamped term cos cos / max(d^2, D^2) takes from a point x the share 1 - d^2/D^2 of the light of
// surfaces nearer than D. Cosine-distributed rays of length D find those surfaces: a hit y at distance d adds
// pi (1 - d^2/D^2) times the radiance that leaves y. That is y's emission, reflected light of emitters and
// clamped virtual lights, and the light that the clamp takes from y, which the next ray finds. The mean is
// unbiased for every D.
// Based on: Thomas Kollig and Alexander Keller, Illumination in the Presence of Weak Singularities, MCQMC
// 2004.
// Departs: rays end at D instead of being weighted by the geometry term at their hit, because the clamp
// depends on the distance alone; y is lit by a random choice of the virtual lights, because the mean over
// many hits needs no more.
#include "shading/compensation.h"
#include "geometry/bvh.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <math.h>
#include <string.h>

// Emitters that light a pixel, for each that lights a hit, of which a pixel has many.
enum { PER_HIT = 16 };

// Only a D far larger than a scene of white walls, where roulette ends no walk, comes near this.
enum { MAX_BOUNCES = 1024 };

// Sixteen walks, one per point of a block.
typedef struct Walk {
    vplLitPoint at[VPL_LANES];
    float weight[3][VPL_LANES];    // of the radiance that leaves `at`
    float clampedShare[VPL_LANES]; // 1 - d^2/D^2 of the last ray,
    float emittedShare[VPL_LANES]; // and the same with the clamp distance of lights that stand for emission
    uint32_t active;               // bit per lane
} Walk;

static float shareTaken(float distance, float t)
{
    const float nearer = t / distance;
    return nearer < 1 ? 1 - nearer * nearer : 0;
}

// Moves each walk to its next surface if that is nearer than D; other walks end.
static void castShortRays(const vplShading* s, Walk* w, int64_t* rays)
{
    const vplGeometry* g = s->geometry;
    const vplCompensator* compensator = s->compensation;
    vplRayPacket packet;
    packet.active = 0;
    for (uint32_t left = w->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplLitPoint* p = &w->at[l];
        float u[VPL_SOBOL_DIMENSIONS];
        vplSobol_Sample(&compensator->sobol, compensator->def->seed, p->pixel, p->bounce, p->ray, u);
        const vplVec3 direction = vplSampleCosineAround(p->shading, u[0], u[1]);
        if (vplDot(direction, p->plane) > 0) {
            const vplRay ray = vplGeometry_Leave(g, &p->hit, direction);
            vplRayPacket_Set(&packet, l, &ray);
        }
    }
    *rays += __builtin_popcount(packet.active);
    w->active = 0;
    for (uint32_t left = vplGeometry_AreOccluded(g, &packet, compensator->distance); left != 0;
         left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplRay ray = vplRayPacket_Get(&packet, l);
        vplLitPoint* p = &w->at[l];
        vplHit hit;
        if (!vplClosestHit(g, &ray, compensator->distance, NULL, &hit)) {
            continue;
        }
        p->hit = hit;
        vplLitPoint_Face(p, g, ray.direction);
        p->bounce++;
        w->clampedShare[l] = shareTaken(compensator->distance, hit.t);
        w->emittedShare[l] = shareTaken(compensator->areaLightDistance, hit.t);
        w->active |= w->clampedShare[l] > 0 ? 1u << l : 0;
    }
}

static void addEmission(const vplShading* s, const Walk* w, double sums[3][VPL_LANES])
{
    const vplGeometry* g = s->geometry;
    for (uint32_t left = w->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplHit* hit = &w->at[l].hit;
        const vplRgb e = g->materials[g->triangleMaterials[hit->triangle]].emission;
        if (vplDot(w->at[l].plane, hit->normal) > 0) { // the front
            sums[0][l] += (double)(w->weight[0][l] * w->emittedShare[l] * e.r);
            sums[1][l] += (double)(w->weight[1][l] * w->emittedShare[l] * e.g);
            sums[2][l] += (double)(w->weight[2][l] * w->emittedShare[l] * e.b);
        }
    }
}

// The walks' places as points to be lit.
static void toPoints(const Walk* w, vplSurface* surface, vplSurface* plane, vplPoints* points)
{
    memset(surface, 0, sizeof *surface);
    memset(plane, 0, sizeof *plane);
    points->surface = surface;
    points->plane = plane;
    for (int l = 0; l < VPL_LANES; l++) {
        points->triangle[l] = -1;
    }
    for (uint32_t left = w->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplLitPoint* p = &w->at[l];
        points->triangle[l] = p->hit.triangle;
        vplSurface_Put(surface, l, p->hit.position, p->shading);
        vplSurface_Put(plane, l, p->hit.position, p->plane);
    }
}

// Adds reflected light of emitters, area lights and virtual lights. Weights become those of the next hits.
static void addReflection(const vplShading* s, Walk* w, double sums[3][VPL_LANES], int64_t* rays)
{
    const vplCompensator* compensator = s->compensation;
    const vplCompensationDef* def = compensator->def;
    const vplLightDraw all = {def->lights, def->lightCount, def->hitLights, def->emitterLightCount, 0};
    vplSurface surface, plane;
    vplPoints points;
    float direct[3][VPL_LANES];
    toPoints(w, &surface, &plane, &points);
    vplDirectIrradiance(s, &compensator->direct, &points, direct, rays);
    for (uint32_t left = w->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplRgb rho = vplRgbScale(def->reflection, vplLitPoint_Reflectance(&w->at[l], s->geometry));
        const float factor[3] = {rho.r, rho.g, rho.b};
        float indirect[3];
        vplReceiveDrawnLights(s, &all, &w->at[l], indirect, rays);
        for (int c = 0; c < 3; c++) {
            w->weight[c][l] *= w->clampedShare[l] * factor[c];
            sums[c][l] += (double)(w->weight[c][l] * (direct[c][l] + indirect[c])) / VPL_PI;
        }
    }
}

// Russian roulette: a walk goes on with the probability that its last ray and reflection left of its light.
static void endByChance(const vplShading* s, Walk* w)
{
    const vplCompensator* compensator = s->compensation;
    for (uint32_t left = w->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplRgb rho = vplLitPoint_Reflectance(&w->at[l], s->geometry);
        const float most =
            fmaxf(rho.r, fmaxf(rho.g, rho.b)) * compensator->def->reflection * w->clampedShare[l];
        float u[VPL_SOBOL_DIMENSIONS];
        vplSobol_Sample(&compensator->sobol, compensator->def->seed, w->at[l].pixel, w->at[l].bounce,
                        w->at[l].ray, u);
        if (!(u[2] < most)) {
            w->active &= ~(1u << l);
            continue;
        }
        for (int c = 0; c < 3; c++) {
            w->weight[c][l] /= most < 1 ? most : 1;
        }
    }
}

static void walk(const vplShading* s, Walk* w, double sums[3][VPL_LANES], int64_t* rays)
{
    const vplCompensationDef* def = s->compensation->def;
    for (int bounce = 0; bounce < MAX_BOUNCES; bounce++) {
        castShortRays(s, w, rays);
        if (w->active == 0) {
            return;
        }
        if (def->emitterLightCount > 0 && (bounce > 0 || def->seesEmission)) {
            addEmission(s, w, sums);
        }
        if (!def->seesReflection) {
            return;
        }
        addReflection(s, w, sums, rays);
        endByChance(s, w);
    }
}

// Adds light that the clamp takes from lights that stand for emission, beyond their own clamp distance. Short
// rays would seldom hit the area light, and bring much light when they do (cornell-area, 512 lights, D = 1 m,
// 4 rays: relative MSE 0.066 instead of 0.011).
static void addAreaLights(const vplShading* s, Walk* start, float irradiance[3][VPL_LANES], int64_t* rays)
{
    const vplCompensationDef* def = s->compensation->def;
    const int drawn = def->hitLights > def->rayCount ? def->hitLights : def->rayCount;
    const vplLightDraw areaLights = {def->lights, def->emitterLightCount, drawn, def->emitterLightCount,
                                     s->lights.inverseClamp};
    for (uint32_t left = start->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        float part[3];
        start->at[l].ray = def->firstRay;
        vplReceiveDrawnLights(s, &areaLights, &start->at[l], part, rays);
        for (int c = 0; c < 3; c++) {
            irradiance[c][l] += part[c];
        }
    }
}

void vplAddCompensation(const vplShading* shading, const vplPoints* points, const uint32_t pixels[VPL_LANES],
                        float irradiance[3][VPL_LANES], int64_t* rays)
{
    const vplCompensationDef* def = shading->compensation->def;
    Walk start = {.active = 0};
    for (int l = 0; l < VPL_LANES; l++) {
        if (points->triangle[l] < 0) {
            continue;
        }
        const vplSurface *p = points->surface, *plane = points->plane;
        start.active |= 1u << l;
        start.at[l] = (vplLitPoint){.hit = vplHitOfPoint(shading->geometry, points->triangle[l],
                                                         vplVec(p->px[l], p->py[l], p->pz[l])),
                                    .shading = vplVec(p->nx[l], p->ny[l], p->nz[l]),
                                    .plane = vplVec(plane->nx[l], plane->ny[l], plane->nz[l]),
                                    .pixel = pixels[l]};
        for (int c = 0; c < 3; c++) {
            start.weight[c][l] = (float)VPL_PI;
        }
    }
    double sums[3][VPL_LANES] = {{0}};
    if (def->seesEmission && def->emitterLightCount > 0) {
        addAreaLights(shading, &start, irradiance, rays);
    }
    for (int i = 0; i < def->rayCount && vplTask_GoesOn(shading->geometry->context); i++) {
        Walk w = start;
        for (int l = 0; l < VPL_LANES; l++) {
            w.at[l].ray = def->firstRay + (uint32_t)i;
        }
        walk(shading, &w, sums, rays);
    }
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            irradiance[c][l] += (float)(sums[c][l] / def->rayCount);
        }
    }
}

// The number of emitters that a tree chooses for a hit; 0: all emitters light it.
static int emittersOfHit(const vplShadeDef* shade, const vplCompensationDef* def)
{
    const bool many = def->shadows == NULL && def->emitterCount > VPL_EMITTERS_OF_HIT;
    return shade->emittersPerPoint > 0 ? (shade->emittersPerPoint + PER_HIT - 1) / PER_HIT
           : many                      ? VPL_CHOSEN_AT_HIT
                                       : 0;
}

vplResult vplCompensator_Open(vplShading* shading)
{
    const vplShadeDef* shade = shading->def;
    const vplCompensationDef* def = shade->compensation;
    if (def == NULL || shade->lighting != VPL_LIGHTING_PHYSICAL || !(shade->minDistance > 0)) {
        return VPL_SUCCESS;
    }
    vplCompensator* compensator = vplArena_AllocZero(shading->arena, 1, sizeof *compensator);
    TRY(vplArena_Check(shading->arena));
    const float areaLightDistance = fminf(def->emitterLightDistance, shade->minDistance);
    *compensator =
        (vplCompensator){.def = def,
                         .direct = {.emitters = def->emitters,
                                    .shadows = def->shadows,
                                    .emitterCount = def->emitterCount,
                                    .perPoint = emittersOfHit(shade, def),
                                    .trianglesPerPoint = (def->trianglesPerPoint + PER_HIT - 1) / PER_HIT,
                                    .weight = 1,
                                    .areaLights = def->areaLights,
                                    .areaLightCount = def->areaLightCount,
                                    .areaLightInverseClamp = vplInverseSquare(def->areaLightMinDistance)},
                         .sobol = vplSobol_Make(),
                         .distance = shade->minDistance,
                         .areaLightDistance = areaLightDistance,
                         .areaLightInverseClamp = vplInverseSquare(areaLightDistance)};
    shading->compensation = compensator;
    return vplDirectLight_Open(&compensator->direct, shading, VPL_LIGHTING_PHYSICAL);
}
