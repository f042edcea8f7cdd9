// SPDX-License-Identifier: MIT
// Whether, and with how many rays, a picture gets back what the bound of near virtual lights takes away.
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "render/ingredients.h"

#include <math.h>

int vplCountEmitterLights(const vplLightSet* set)
{
    int count = 0;
    for (int i = 0; set->stepCount > 0 && i < set->lightsInStep[0]; i++) {
        count += set->lights[i].object >= 0;
    }
    return count;
}

bool vplCompensates(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    const bool keller = o->method == VPL_METHOD_KELLER;
    const bool usual = keller && o->lighting == VPL_LIGHTING_PHYSICAL &&
                       vplJob_GetLightShadows(job) != VPL_LIGHT_SHADOWS_NONE;
    const bool wanted =
        o->lights.compensation == VPL_COMPENSATION_RAYS || (o->lights.compensation == VPL_COMPENSATION_USUAL && usual);
    const bool shown = o->output.show == VPL_SHOW_PICTURE || o->output.show == VPL_SHOW_INDIRECT ||
                       o->output.show == VPL_SHOW_OVERLAY || (o->output.show == VPL_SHOW_DIRECT && keller);
    return wanted && shown && o->lights.minDistance != 0 && o->method != VPL_METHOD_DIRECT &&
           vplJob_GetShading(job) == VPL_LIGHTING_PHYSICAL;
}

// The share of what surfaces see that is near. Squared error times processor time for bounds around that
// (interleaved 4, 4096 particles, 128x128): room 0.23 at 0.5 m, 0.16 at 1 m, 0.14 at 1.8 m; room-area and cornell-area
// have their best at 0.14 sqrt(area), which is the same; sponza-sun 12 at 1 m, 9 at 2 m, 8 at 16 m, but there nearly all
// light comes by short rays, and what was smooth is speckled.
#define NEAR_SHARE 0.2

vplResult vplJob_FindNear(vplJob* job)
{
    const bool wanted = job->nearDistance == 0 && job->options.lights.minDistance < 0 && vplCompensates(job);
    return wanted ? vplFindNearDistance(job->geometry, &job->view, NEAR_SHARE, &job->nearDistance)
                  : VPL_SUCCESS;
}

// What a pixel-light costs in shadow rays: without one, a fraction of a nanosecond of a vector.
static double workOf(const vplJob* job, const vplIngredients* in)
{
    const vplRenderOptions* o = &job->options;
    const double classes = o->pipeline.kind == VPL_ACCUMULATE_INTERLEAVED ? o->pipeline.interleave * o->pipeline.interleave : 1;
    const double most = o->pipeline.kind == VPL_ACCUMULATE_LIGHTCUTS ? 2048 : INFINITY;
    const double each = in->lightShadows == VPL_LIGHT_SHADOWS_NONE ? 1.0 / 32 : 1;
    return fmin(in->lightCount / classes, most) * each;
}

// Few lights are enough for what a ray meets, if each of them is bounded like so few: where D is the radius of a light's
// share of all surfaces, and on lamps with half of the chosen lights.
enum { MIN_HIT_LIGHTS = 16 };

static int hitLightsOf(const vplJob* job, const vplIngredients* in)
{
    const double distance = (double)in->minDistance;
    const double shares = vplGeometry_Area(job->geometry) / (VPL_PI * distance * distance);
    return (int)fmax(MIN_HIT_LIGHTS, fmin(ceil(shares), in->lightCount));
}

// A ray for every so many lights that a pixel meets, so that the squared error of both falls alike. With 16 lights per
// hit and D = 0.12 sqrt(area), the square of the relative error times processor time was (2048 particles, room-area and
// cornell-area): a ray for 8 lights 0.34 and 2.2, for 16 0.24 and 1.4, for 32 0.19 and 1.04; D = 0.147 sqrt(area), for
// 59 0.17 and 1.01. With 256 particles 32 and 59 are alike. Where hits meet more lights, D is smaller and hits are as
// much rarer as that takes more time with sqrt(MIN_HIT_LIGHTS / hitLights) as many rays.
enum { LIGHTS_PER_RAY = 48, MIN_RAYS = 2, MAX_RAYS = 4096 };

static int raysOf(const vplJob* job, const vplIngredients* in)
{
    const double rays =
        workOf(job, in) / LIGHTS_PER_RAY * sqrt((double)MIN_HIT_LIGHTS / hitLightsOf(job, in));
    return (int)fmin(fmax(ceil(rays), MIN_RAYS), MAX_RAYS);
}

static float lampDistance(const vplGeometry* g)
{
    double area = 0;
    for (int i = 0; i < g->triangleCount; i++) {
        const vplRgb e = g->materials[g->triangleMaterials[i]].emission;
        area += e.r + e.g + e.b > 0 ? vplGeometry_TriangleArea(g, i) : 0;
    }
    return (float)sqrt(area / (0.5 * MIN_HIT_LIGHTS * VPL_PI));
}

vplCompensationDef vplMakeCompensation(const vplJob* job, const vplIngredients* in)
{
    const vplRenderOptions* o = &job->options;
    const bool keller = o->method == VPL_METHOD_KELLER;
    vplCompensationDef def = {.rayCount = raysOf(job, in),
                              .hitLights = hitLightsOf(job, in),
                              .seed = o->seed,
                              .emitters = in->emitters,
                              .shadows = in->emitterMaps.shadows,
                              .emitterCount = in->emitterMaps.shadows ? in->emitterCount : 0,
                              .areaLights = in->areaLights,
                              .areaLightCount = in->areaLightCount,
                              .areaLightMinDistance = in->areaLightMinDistance,
                              .lights = in->lights,
                              .lightCount = in->lightCount,
                              .lightRays = in->lightShadows != VPL_LIGHT_SHADOWS_NONE,
                              .reflection = 1,
                              .emitterLightCount = in->emitterLightCount,
                              .emitterLightDistance = in->emitterLightCount > 0 ? lampDistance(job->geometry) : 0};
    if (o->lighting == VPL_LIGHTING_DOCUMENTED) {
        def.reflection = (float)(1 / VPL_PI);
    }
    def.seesEmission = o->output.show != VPL_SHOW_INDIRECT;
    def.seesReflection = !(keller && o->output.show == VPL_SHOW_DIRECT);
    return def;
}

// A point takes about 7 us and a light with a shadow ray per pixel 31 ns: so many points take about half a hundredth of
// the picture's time.
enum { POINT_SHARE = 40000, MIN_POINTS = 32, MAX_POINTS = 1024, POINT_RAYS = 4 };

static int pointsToAsk(const vplJob* job, const vplIngredients* in)
{
    const vplRenderOptions* o = &job->options;
    const double work = (double)o->output.width * o->output.height * o->output.antialias * workOf(job, in);
    return (int)fmin(fmax(work / POINT_SHARE, MIN_POINTS), MAX_POINTS);
}

vplResult vplEstimateLoss(vplJob* job, const vplIngredients* in, const vplShadeDef* shown)
{
    vplShadeDef def = *shown;
    vplCompensationDef compensation = vplMakeCompensation(job, in);
    vplClampLoss loss = {0, 0};
    compensation.rayCount = POINT_RAYS;
    compensation.hitLights = MIN_HIT_LIGHTS;
    compensation.firstRay = (uint32_t)job->stepsDone * MAX_POINTS;
    def.compensation = &compensation;
    def.lightRays = def.lightRays || def.lightClusters != NULL;
    def.lightClusters = NULL;
    const vplResult result =
        vplEstimateClampLoss(job->geometry, &job->view, &def, pointsToAsk(job, in), &loss);
    job->loss.lost += loss.lost;
    job->loss.all += loss.all;
    job->stats.clampLoss = job->loss.all > 0 ? job->loss.lost / job->loss.all : 0;
    return result;
}
