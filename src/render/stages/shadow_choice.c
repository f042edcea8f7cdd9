// SPDX-License-Identifier: MIT
#include "render/stages/shadow_choice.h"

#include "base/numbers.h"
#include "math/vec.h"
#include "render/options.h"
#include "render/stages/results.h"
#include "visibility/hemi_map.h"

#include <math.h>
#include <stdio.h>

// Nanoseconds of one core of an AMD EPYC (Zen 4, AVX-512), fitted to `bench/crossover` over room,
// cornell-area, sibenik-spot, conference-spot and sponza-sun with 64x64 to 1280x720 pixels, 16 to 256 lights
// and maps of 64, 128 and 256 texels a side (tests/data/crossover.csv). Single terms are off by a factor of
// up to 2, rays by 1/1.8 at 64x64 and 1.8 at 640x360, where rays of neighbours are coherent. The constants
// are the same on every machine, so that pictures are.
static const double DRAW_TRIANGLE = 25;  // a triangle above the light's plane
static const double DRAW_TEXEL = 0.4;    // a texel, and again for each power of two of these triangles
static const double LOOKUP_PIXEL = 2.3;  // a pixel and a light,
static const double LOOKUP_FACING = 8.5; // that face each other
static const double RAY_PIXEL = 1;
static const double RAY_FACING = 50; // a ray,
static const double RAY_DEPTH = 4;   // and each power of two of the scene's triangles

// Interpolates linearly between powers of two. Unlike the logarithms of C libraries it has the same bits
// everywhere.
static double log2Of(double x)
{
    int exponent;
    const double mantissa = frexp(x, &exponent); // [1/2, 1)
    return x > 1 ? exponent - 1 + (2 * mantissa - 1) : 0;
}

vplShadowCosts vplEstimateShadows(const vplShadowLoad* load)
{
    const double texels = load->mapSize * load->mapSize, pairs = load->lights * load->pixels;
    const double draw =
        DRAW_TRIANGLE * load->trianglesAbove + DRAW_TEXEL * (1 + log2Of(load->trianglesAbove)) * texels;
    const double lookup = LOOKUP_PIXEL + LOOKUP_FACING * load->facing;
    const double ray = RAY_PIXEL + load->facing * (RAY_FACING + RAY_DEPTH * log2Of(load->triangles));
    return (vplShadowCosts){1e-6 * (load->lights * draw + pairs * lookup), 1e-6 * pairs * ray};
}

enum { SAMPLES = 8, SOME_LIGHTS = 8 }; // 8 x 8 pixels; of the lights, counted from the first to the last

static vplVec3 through(const vplView* v, int x, int y)
{
    const float sx = (float)((2 * (x + 0.5) / SAMPLES - 1) / v->scaleX);
    const float sy = (float)((1 - 2 * (y + 0.5) / SAMPLES) / v->scaleY);
    return vplAdd(v->forward, vplAdd(vplScale(sx, v->right), vplScale(sy, v->up)));
}

static int countFacing(const vplHit* hit, vplVec3 from, const vplShadeLight* lights, int count)
{
    const vplVec3 n = vplDot(hit->normal, from) < 0 ? hit->normal : vplNegate(hit->normal);
    int facing = 0;
    for (int i = 0; i < count; i++) {
        const vplShadeLight* l = &lights[i];
        const vplVec3 way = vplSub(vplVec(l->px, l->py, l->pz), hit->position);
        facing += vplDot(way, n) > 0 && vplDot(way, vplVec(l->nx, l->ny, l->nz)) < 0;
    }
    return facing;
}

vplShadowLoad vplMeasureShadowLoad(const vplGeometry* geometry, const vplView* view, double pixels,
                                   const vplShadeLight* lights, int lightCount, int mapSize)
{
    vplShadowLoad load = {lightCount, pixels, 0, 0, geometry->triangleCount, mapSize};
    vplShadeLight some[SAMPLES * SAMPLES];
    const int count = lightCount < SAMPLES * SAMPLES ? lightCount : SAMPLES * SAMPLES;
    for (int i = 0; i < count; i++) {
        some[i] = lights[(int64_t)i * lightCount / count];
    }
    int64_t facing = 0;
    for (int i = 0; i < SAMPLES * SAMPLES; i++) {
        const vplRay ray = {view->eye, through(view, i % SAMPLES, i / SAMPLES), {0, 0}};
        vplHit hit;
        if (vplGeometry_ClosestHit(geometry, &ray, &hit)) {
            facing += countFacing(&hit, ray.direction, some, count);
        }
    }
    const int chosen = count < SOME_LIGHTS ? count : SOME_LIGHTS;
    for (int i = 0; i < chosen; i++) {
        const vplShadeLight* l = &some[(int64_t)i * count / chosen];
        const vplHemiMapPlace place = {{l->px, l->py, l->pz}, {l->nx, l->ny, l->nz}};
        load.trianglesAbove += (double)vplHemiMap_TrianglesAbove(geometry, &place) / chosen;
    }
    load.facing = count > 0 ? (double)facing / count / (SAMPLES * SAMPLES) : 0;
    return load;
}

vplLightShadows vplChooseLightShadows(const vplRun* run, const vplVirtualLights* lights, vplPlan* plan,
                                      char* why)
{
    const vplRenderOptions* o = &plan->options;
    const int side = o->pipeline.kind == VPL_ACCUMULATE_INTERLEAVED ? o->pipeline.interleave : 1;
    const double pixels = vplCountPixels(&o->output) * o->output.supersample / side / side;
    const vplShadowLoad load = vplMeasureShadowLoad(run->results[VPL_STAGE_GEOMETRY], &plan->view, pixels,
                                                    lights->lights, lights->count, o->lights.mapSize);
    const vplShadowCosts costs = vplEstimateShadows(&load);
    const bool map = costs.mapMs < costs.rayMs;
    plan->shadowMapEstimateMs = costs.mapMs;
    plan->shadowRayEstimateMs = costs.rayMs;
    vplFormat(
        why, VPL_PLAN_TEXT,
        "%d lights, %.0f pixels of which %.0f %% face a light, %.0f triangles above it; maps would take "
        "about %.3g ms of one core, rays %.3g ms",
        lights->count, pixels, 100 * load.facing, load.trianglesAbove, costs.mapMs, costs.rayMs);
    return map ? VPL_LIGHT_SHADOWS_MAP : VPL_LIGHT_SHADOWS_RAY;
}
