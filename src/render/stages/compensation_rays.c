// SPDX-License-Identifier: MIT
// The clamp of near virtual lights takes light away, and short rays give it back. This file chooses the
// number of rays and measures how much light was lost.
#include "base/clock.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "render/options.h"
#include "render/runner.h"
#include "render/stages/results.h"

#include <math.h>

// The number of virtual lights that a pixel evaluates.
static double lightsPerPixel(const vplPlan* plan, const vplVirtualLights* lights)
{
    const vplPipelineOptions* o = &plan->options.pipeline;
    const double classes = o->kind == VPL_ACCUMULATE_INTERLEAVED ? o->interleave * o->interleave : 1;
    const double most = o->kind == VPL_ACCUMULATE_LIGHTCUTS ? 2048 : INFINITY;
    return fmin(lights->count / classes, most);
}

// The time that a pixel spends on so many virtual lights, in units of a shadow ray. A light without a shadow ray
// costs a fraction of a nanosecond.
static double workOf(const vplPlan* plan, double lights)
{
    return lights * (plan->options.lights.shadows == VPL_LIGHT_SHADOWS_NONE ? 1.0 / 32 : 1);
}

// The number of virtual lights that are evaluated where a short ray hits a surface. Noise is low once the clamp distance is the radius of
// one light's share of all surfaces. More than 32 lights gain less than they cost; with 16, corners are blotchy in scenes whose clamp
// distance is small (tests/bench/README.md, "Lights of a hit"). A hit evaluates at most twice as many lights as a pixel, or FEWEST_HIT_LIGHTS
// if that is more. This limit matters in the small first passes of a render: a pass of 125 particles in a room with 1,000 boxes takes half
// of the time, and its picture has the same error.
enum { MIN_HIT_LIGHTS = 16, MAX_HIT_LIGHTS = 32, FEWEST_HIT_LIGHTS = 8 };

double vplLightsOfHit(double area, double distance, double pixelLights)
{
    const double wanted = fmax(MIN_HIT_LIGHTS, fmin(area / (VPL_PI * distance * distance), MAX_HIT_LIGHTS));
    return fmin(wanted, fmax(FEWEST_HIT_LIGHTS, 2 * pixelLights));
}

// A pixel casts one short ray for every 48 lights that it evaluates, so that the squared errors of both fall alike: relative error squared
// times time is 1.4 with a ray for 16 lights, 1.0 with one for 48 (cornell-area, 2048 particles). It casts at least two rays, and at least
// one where interleaving averages over 64 pixels or more: in the room (1280x720, K = 16, 2,000 to 8,000 particles) one ray takes 0.65 to
// 0.77 of the time of two and raises the error by a twentieth.
enum { LIGHTS_PER_RAY = 48, MIN_RAYS = 2, MAX_RAYS = 4096 };

int vplShortRaysOf(const vplPlan* plan, double lights)
{
    const vplPipelineOptions* o = &plan->options.pipeline;
    const int least = o->kind == VPL_ACCUMULATE_INTERLEAVED && o->interleave >= 8 ? 1 : MIN_RAYS;
    return (int)fmin(fmax(ceil(workOf(plan, lights) / LIGHTS_PER_RAY), least), MAX_RAYS);
}

// The distance for lights on area lights, which are half of the lights that a hit evaluates.
static float areaLightDistance(const vplGeometry* g)
{
    return (float)sqrt(g->emittingArea / (0.5 * MIN_HIT_LIGHTS * VPL_PI));
}

vplCompensationDef vplMakeCompensation(const vplRun* run, const vplVirtualLights* lights,
                                       const vplShadow* shadows)
{
    const vplPlan* plan = run->plan;
    const vplAreaLights area = vplAreaLightsOfHits(run);
    const bool keller = plan->options.method == VPL_METHOD_KELLER;
    const vplGeometry* geometry = run->results[VPL_STAGE_GEOMETRY];
    const float distance = lights->emitterLightCount > 0 ? areaLightDistance(geometry) : 0;
    const double pixelLights = lightsPerPixel(plan, lights);
    vplCompensationDef def = vplDefaultCompensationDef();
    def.rayCount = vplShortRaysOf(plan, pixelLights);
    def.hitLights =
        (int)ceil(vplLightsOfHit(vplGeometry_Area(geometry), (double)lights->minDistance, pixelLights));
    def.seed = plan->options.seed;
    def.emitters = plan->emitters;
    def.shadows = shadows;
    def.emitterCount = plan->emitterCount;
    def.trianglesPerPoint = plan->trianglesPerPoint;
    def.lights = lights->lights;
    def.lightCount = lights->count;
    def.lightRays = plan->options.lights.shadows != VPL_LIGHT_SHADOWS_NONE;
    def.emitterLightCount = lights->emitterLightCount;
    def.emitterLightDistance = distance;
    def.areaLights = area.lights;
    def.areaLightCount = area.count;
    def.areaLightMinDistance = area.minDistance;
    if (plan->options.lighting == VPL_LIGHTING_DOCUMENTED) {
        def.reflection = (float)(1 / VPL_PI);
    }
    def.seesEmission = plan->options.output.show != VPL_SHOW_INDIRECT;
    def.seesReflection = !(keller && plan->options.output.show == VPL_SHOW_DIRECT);
    return def;
}

// The loss is estimated at some points. A point takes about 7 us, and a light with a shadow ray 31 ns per
// pixel, so one point for 40000 shadow rays takes about half a per cent of the picture's time.
enum { POINT_SHARE = 40000, MIN_POINTS = 32, MAX_POINTS = 1024, POINT_RAYS = 4 };

static int pointsToAsk(const vplPlan* plan, const vplVirtualLights* lights)
{
    const vplOutputOptions* o = &plan->options.output;
    const double work = vplCountPixels(o) * o->supersample * workOf(plan, lightsPerPixel(plan, lights));
    return (int)fmin(fmax(work / POINT_SHARE, MIN_POINTS), MAX_POINTS);
}

vplResult vplEstimateLoss(const vplRun* run, const vplVirtualLights* lights, const vplShadeDef* shown,
                          vplCompensationDef compensation)
{
    const double start = vplClockMs();
    vplShadeDef def = *shown;
    vplClampLoss *sum = &run->runner->loss, loss = {0, 0};
    compensation.rayCount = POINT_RAYS;
    compensation.hitLights = MIN_HIT_LIGHTS;
    compensation.firstRay = (uint32_t)run->pass * MAX_POINTS;
    def.compensation = &compensation;
    def.lightRays = def.lightRays || def.lightClusters != NULL;
    def.lightClusters = NULL;
    const vplResult result = vplEstimateClampLoss(run->results[VPL_STAGE_GEOMETRY], &run->plan->view, &def,
                                                  pointsToAsk(run->plan, lights), &loss);
    sum->lost += loss.lost;
    sum->all += loss.all;
    run->stats->clampLoss = sum->all > 0 ? sum->lost / sum->all : 0;
    vplRun_AddTime(run, "clamp loss", start);
    return result;
}
