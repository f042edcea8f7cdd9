// SPDX-License-Identifier: MIT
// Decisions that need the scene's geometry: the clamp, the lights and bounces, what passes share, and light shadows.
#include "render/options.h"
#include "render/plan.h"

#include "render/show.h"
#include "render/stages/results.h"
#include "render/stages/ssvp.h"

// ---- the clamp and the lights

static vplResult chooseClamp(vplRunner* r, vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    if (!p->showsVirtual || p->options.lights.minDistance >= 0) {
        p->options.lights.minDistance = p->showsVirtual ? p->options.lights.minDistance : 0;
        return VPL_SUCCESS;
    }
    p->clampArea = vplGeometry_Area(g);
    if (p->compensates && g->triangleCount > 0) {
        TRY(vplRunner_RunStage(r, VPL_STAGE_NEAR_DISTANCE));
        const float* near = r->run.results[VPL_STAGE_NEAR_DISTANCE];
        p->nearDistance = *near;
    }
    return VPL_SUCCESS;
}

static vplResult countLights(vplRunner* r, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    if ((VPL_USE_PARTICLES & 1 << o->method) == 0) {
        return VPL_SUCCESS;
    }
    if (o->method == VPL_METHOD_KELLER && o->output.show == VPL_SHOW_DIRECT) {
        o->particles.reflectivity = 0;
        vplDecide(p, "reflectivity", "lights on the emitters are all that direct light needs");
    } else if (o->particles.reflectivity < 0) {
        o->particles.reflectivity = vplGeometry_MeanReflectance(r->run.results[VPL_STAGE_GEOMETRY]);
        vplDecide(p, "reflectivity", "the mean reflectance over the area of the scene");
    }
    const vplParticlePass pass = {0, o->particles.count, o->particles.reflectivity};
    vplStepTotals totals;
    TRY(vplCountParticles(r->run.context, &pass, p->particlesPerStep, VPL_MAX_STEPS_REPORTED, &totals));
    p->stepCount = totals.stepCount;
    p->virtualLights = totals.lightCount;
    return VPL_SUCCESS;
}

static void decideClamp(const vplRunner* r, vplPlan* p)
{
    if (p->clampArea > 0) {
        const double passes = p->options.stop.passes > 1 ? p->options.stop.passes : 1;
        p->options.lights.minDistance = vplClampDistance(&r->run, (double)p->virtualLights);
        vplDecide(p, "min-distance", "%s%s",
                  p->nearDistance > 0 && p->options.lights.minDistance <= p->nearDistance
                      ? "within it surfaces see a fifth of what they see; nearer light is found by short rays"
                      : "the radius of a disc with one light's share of the area of the scene",
                  passes > 1 ? "; less in later passes" : "");
    }
}

// ---- what passes share

double vplTrianglesPerPixel(const vplRunner* r, const vplRenderOptions* o)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    return g->triangleCount / vplCountPixels(&o->output);
}

// Above this number of triangles per pixel, all passes share one G-buffer. Below it, rasterization takes about a twentieth of a pass or
// less (tests/bench/README.md, "One G-buffer for all passes"). With eight samples per pixel, the G-buffer takes at most 120 bytes per
// triangle.
static const double SHARED_TRIANGLES_PER_PIXEL = 0.5;

// Decides whether passes share a G-buffer: they must be lit from one, and show the same view.
static void decideGbuffer(const vplRunner* r, vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    p->keepsGbuffer = p->progressive && o->pipeline.kind >= VPL_ACCUMULATE_DEFERRED &&
                      o->output.supersample == 1 && VPL_SHOWS[o->output.show].output == VPL_OUTPUT_RADIANCE &&
                      vplTrianglesPerPixel(r, o) > SHARED_TRIANGLES_PER_PIXEL;
}

// ---- the bounces of SSVP

// SSVP stops where all further bounces would add less than this share of the indirect light of a closed room.
static const double LEAST_BOUNCE_SHARE = 1.0 / 64;

// Most bounces that SSVP makes by itself: in a room that reflects 0.77 of its light they leave out a 64th.
enum { MOST_SSVP_BOUNCES = 16 };

// In a closed room whose surfaces reflect the share rho of their light, the share rho^n is left after n further bounces.
static void chooseBounces(const vplRunner* r, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    p->reflectance = vplGeometry_MeanReflectance(r->run.results[VPL_STAGE_GEOMETRY]);
    if (o->maxBounces < 0) {
        double left = p->reflectance;
        o->maxBounces = 1;
        for (; o->maxBounces < MOST_SSVP_BOUNCES && left >= LEAST_BOUNCE_SHARE; o->maxBounces++) {
            left *= p->reflectance;
        }
        vplDecide(p, "max-bounces",
                  "surfaces reflect %.2g of their light on average; further bounces would add %.2g %%",
                  p->reflectance, 100 * left);
    }
    o->maxBounces = o->maxBounces < VPL_MAX_STEPS_REPORTED ? o->maxBounces : VPL_MAX_STEPS_REPORTED;
}

// Counts the lights of each bounce; SSVP has at most so many.
static void countSsvpLights(vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    for (int i = 0; i < o->maxBounces; i++) {
        const int lights = i == 0 ? o->ssvp.firstBounce : vplSsvpCountLights(p, i);
        p->stepCount += lights > 0;
        p->particlesPerStep[i] = lights;
        p->virtualLights += lights;
    }
}

// The number of clusters follows from what their lights see, and most of the memory from that number.
vplResult vplForetellClusters(vplRunner* r, const vplPlan* p)
{
    const bool splits = p->options.method == VPL_METHOD_SSVP && p->showsVirtual && vplSsvpSplits(p);
    return splits ? vplRunner_RunPlan(r, p, VPL_STAGE_CLUSTERED_LIGHTS) : VPL_SUCCESS;
}

// ---- all

vplResult vplDecideByGeometry(vplRunner* r, vplPlan* p)
{
    decideGbuffer(r, p);
    TRY(vplDecideTriangles(r, p));
    TRY(chooseClamp(r, p));
    TRY(countLights(r, p));
    if (p->options.method == VPL_METHOD_SSVP) {
        chooseBounces(r, p);
        countSsvpLights(p);
    }
    decideClamp(r, p);
    if (p->options.method == VPL_METHOD_PATH) {
        TRY(vplDecideLightVertices(r, p));
    }
    if (p->options.method == VPL_METHOD_RADIOSITY) {
        TRY(vplDecidePatches(r, p));
    }
    return VPL_SUCCESS;
}

vplResult vplDecideLightShadows(vplRunner* r, vplPlan* p)
{
    char why[VPL_PLAN_TEXT];
    vplLightShadows* shadows = &p->options.lights.shadows;
    if (*shadows != VPL_LIGHT_SHADOWS_AUTO) {
        return VPL_SUCCESS;
    }
    if (!p->showsVirtual || p->virtualLights == 0 || p->options.pipeline.kind == VPL_ACCUMULATE_LIGHTCUTS) {
        *shadows = VPL_LIGHT_SHADOWS_RAY;
        if (p->showsVirtual) {
            vplDecide(p, "light-shadows",
                      p->virtualLights == 0
                          ? "there are no lights to draw maps for"
                          : "each pixel evaluates few of the lights, which maps cannot know before");
        }
        return VPL_SUCCESS;
    }
    if (p->hasSky && p->options.method == VPL_METHOD_KELLER) {
        *shadows = VPL_LIGHT_SHADOWS_RAY;
        vplDecide(p, "light-shadows", "some of the lights are in the sky, too far away for maps");
        return VPL_SUCCESS;
    }
    TRY(vplRunner_RunPlan(r, p, VPL_STAGE_VIRTUAL_LIGHTS));
    const vplVirtualLights* lights = r->run.results[VPL_STAGE_VIRTUAL_LIGHTS];
    *shadows = vplChooseLightShadows(&r->run, lights, p, why);
    vplDecide(p, "light-shadows", "%s", why);
    return VPL_SUCCESS;
}
