// SPDX-License-Identifier: MIT
// Final gather: the indirect irradiance of a pixel is the mean of what cosine-distributed rays from its point
// meet. The caller knows the light of surfaces, coarsely. A hit that is nearer than this light is fine is lit
// for itself: by a point on an area light, by an emitter and by a ray of its own, which may meet another near
// surface. Where neighbours share light, the pixels of a square of K x K share one sequence of directions, and
// each takes its own part of it.
// Based on: Mark Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, Cornell 1992.
// Near hits: Henrik Wann Jensen, Global Illumination using Photon Maps, EGWR 1996 (secondary gathering).
// Departs: squares of pixels share directions, and the filter of interleaved shading makes them one mean.
#include "shading/gather.h"

#include "geometry/bvh.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <math.h>
#include <string.h>

// Near hits of a walk. After so many the light is that of the surface, however near it is.
enum { NEAR_HITS = 4 };

// Sixteen walks, one per point of a block.
typedef struct Walk {
    vplLitPoint at[VPL_LANES];
    float weight[3][VPL_LANES]; // of the irradiance at `at`
    uint32_t active;            // bit per lane
} Walk;

static bool sharesLight(const vplShadeDef* def)
{
    return def->accumulation == VPL_ACCUMULATE_INTERLEAVED && def->interleave > 1;
}

// Each hit is lit by one area light's point and one emitter, as if all were like it, or by one of many that a tree chooses.
static vplResult openDirect(const vplShading* shading, const vplGatherDef* def, vplGather* gather)
{
    vplArena* arena = shading->arena;
    const bool tree = shading->def->emittersPerPoint > 0;
    const size_t points = (size_t)def->areaLightCount, emitters = (size_t)def->emitterCount;
    vplShadeLight* areaLights = vplArena_Alloc(arena, points, sizeof *areaLights);
    TRY(vplArena_Check(arena));
    for (size_t i = 0; i < points; i++) {
        areaLights[i] = def->areaLights[i];
        areaLights[i].r *= (float)points;
        areaLights[i].g *= (float)points;
        areaLights[i].b *= (float)points;
    }
    gather->direct = (vplDirectLight){.emitters = def->emitters,
                                      .emitterCount = def->emitterCount,
                                      .perPoint = tree ? 1 : 0,
                                      .trianglesPerPoint = def->trianglesPerPoint > 0 ? 1 : 0,
                                      .weight = tree ? 1 : (float)emitters,
                                      .areaLights = areaLights,
                                      .areaLightCount = def->areaLightCount,
                                      .areaLightInverseClamp = vplInverseSquare(def->areaLightMinDistance)};
    return vplDirectLight_Open(&gather->direct, shading, VPL_LIGHTING_PHYSICAL);
}

vplResult vplGather_Open(vplShading* shading)
{
    const vplShadeDef* def = shading->def;
    if (def->gather == NULL) {
        return VPL_SUCCESS;
    }
    vplGather* gather = vplArena_AllocZero(shading->arena, 1, sizeof *gather);
    TRY(vplArena_Check(shading->arena));
    gather->def = def->gather;
    gather->sobol = vplSobol_Make();
    gather->side = sharesLight(def) ? def->interleave : 1;
    shading->gather = gather;
    return openDirect(shading, def->gather, gather);
}

// ---- one step of all walks

// Moves walks to their next surface. Those that meet light, or nothing, end; others are at a near hit.
static void meet(const vplShading* s, bool last, Walk* w, double sums[3][VPL_LANES], int64_t* rays)
{
    const vplGather* gather = s->gather;
    const uint32_t active = w->active;
    w->active = 0;
    for (uint32_t left = active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        vplLitPoint* p = &w->at[l];
        float u[VPL_SOBOL_DIMENSIONS];
        vplHit hit;
        vplSobol_Sample(&gather->sobol, gather->def->seed, p->pixel, p->bounce, p->ray, u);
        const vplVec3 direction = vplSampleCosineAround(p->shading, u[0], u[1]);
        if (!(vplDot(direction, p->plane) > 0)) {
            continue;
        }
        const vplRay ray = vplGeometry_Leave(s->geometry, &p->hit, direction);
        *rays += 1;
        if (!vplClosestHit(s->geometry, &ray, INFINITY, NULL, &hit)) {
            continue;
        }
        const vplMetLight met = gather->def->meet(gather->def->user, &hit, direction);
        if (last || !(hit.t < met.size)) {
            sums[0][l] += (double)(w->weight[0][l] * met.radiosity.r);
            sums[1][l] += (double)(w->weight[1][l] * met.radiosity.g);
            sums[2][l] += (double)(w->weight[2][l] * met.radiosity.b);
            continue;
        }
        p->hit = hit;
        p->bounce++;
        vplLitPoint_Face(p, s->geometry, direction);
        w->active |= 1u << l;
    }
}

// The one emitter and the one point of an area light that light the near hits of a step.
static vplDirectLight drawDirect(const vplGather* gather, const vplLitPoint* p)
{
    vplDirectLight one = gather->direct;
    float u[VPL_SOBOL_DIMENSIONS];
    vplSobol_Sample(&gather->sobol, gather->def->seed, p->pixel, p->bounce, p->ray, u);
    if (one.emitterCount > 0 && one.tree == NULL) {
        const int e = (int)(u[2] * (float)one.emitterCount) % one.emitterCount;
        one.emitters += e;
        one.rays += e;
        one.emitterCount = 1;
    }
    if (one.areaLightCount > 0) {
        one.areaLights += (int)(u[3] * (float)one.areaLightCount) % one.areaLightCount;
        one.areaLightCount = 1;
    }
    return one;
}

// Adds the reflected direct light of near hits. Weights become those of the next hits.
static void reflectDirect(const vplShading* s, Walk* w, double sums[3][VPL_LANES], int64_t* rays)
{
    vplSurface surface, plane;
    vplPoints points = {.surface = &surface, .plane = &plane};
    float direct[3][VPL_LANES];
    memset(&surface, 0, sizeof surface);
    memset(&plane, 0, sizeof plane);
    memset(points.triangle, 0xff, sizeof points.triangle);
    for (uint32_t left = w->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplLitPoint* p = &w->at[l];
        points.triangle[l] = p->hit.triangle;
        vplSurface_Put(&surface, l, p->hit.position, p->shading);
        vplSurface_Put(&plane, l, p->hit.position, p->plane);
    }
    const vplDirectLight one = drawDirect(s->gather, &w->at[__builtin_ctz(w->active)]);
    vplDirectIrradiance(s, &one, &points, direct, rays);
    for (uint32_t left = w->active; left != 0; left &= left - 1) {
        const int l = __builtin_ctz(left);
        const vplRgb rho = vplLitPoint_Reflectance(&w->at[l], s->geometry);
        const float factor[3] = {rho.r, rho.g, rho.b};
        for (int c = 0; c < 3; c++) {
            w->weight[c][l] *= factor[c];
            sums[c][l] += (double)(w->weight[c][l] * direct[c][l]);
        }
    }
}

// ---- points

static vplLitPoint startAt(const vplShading* s, const vplPoints* points, int l, uint32_t pixel)
{
    const vplGather* gather = s->gather;
    const vplSurface *p = points->surface, *plane = points->plane;
    const uint32_t side = (uint32_t)gather->side, x = pixel & 0xffff, y = pixel >> 16;
    const uint32_t class = y % side * side + x % side;
    return (vplLitPoint){
        .hit = vplHitOfPoint(s->geometry, points->triangle[l], vplVec(p->px[l], p->py[l], p->pz[l])),
        .shading = vplVec(p->nx[l], p->ny[l], p->nz[l]),
        .plane = vplVec(plane->nx[l], plane->ny[l], plane->nz[l]),
        .pixel = y / side << 16 | x / side,
        .ray = gather->def->firstRay * side * side + class * (uint32_t)gather->def->rayCount};
}

void vplAddGathered(const vplShading* shading, const vplPoints* points, const uint32_t pixels[VPL_LANES],
                    float irradiance[3][VPL_LANES], int64_t* rays)
{
    const int count = shading->gather->def->rayCount;
    double sums[3][VPL_LANES] = {{0}};
    Walk start = {.active = 0};
    for (int l = 0; l < VPL_LANES; l++) {
        if (points->triangle[l] >= 0) {
            start.active |= 1u << l;
            start.at[l] = startAt(shading, points, l, pixels[l]);
        }
        start.weight[0][l] = start.weight[1][l] = start.weight[2][l] = 1;
    }
    for (int i = 0; i < count && vplTask_GoesOn(shading->geometry->context); i++) {
        Walk w = start;
        for (int l = 0; l < VPL_LANES; l++) {
            w.at[l].ray += (uint32_t)i;
        }
        meet(shading, false, &w, sums, rays);
        for (int k = 1; k <= NEAR_HITS && w.active != 0; k++) {
            reflectDirect(shading, &w, sums, rays);
            meet(shading, k == NEAR_HITS, &w, sums, rays);
        }
    }
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            irradiance[c][l] += (float)(sums[c][l] / count);
        }
    }
}
