// SPDX-License-Identifier: MIT
// What --method auto stands for: a method, and those of its options that are as in vplDefaultRenderOptions.
#include "geometry/bvh.h"
#include "render/options.h"
#include "render/planner/look.h"
#include "render/planner/patch_plan.h"
#include "render/planner/planner.h"

#include <math.h>

// The error that a render without goals is made for.
static const double USUAL_ERROR = 0.05;

// From this error on Keller's lights serve area lights and the sky, too, except in tiny pictures: pixels that sample these themselves take longer. At
// 20 % and 320x180 (medians of three) shop takes 0.2 s instead of 0.6, street 0.15 instead of 0.31, shade 12 instead of 16, grove 0.17 instead of 0.95;
// at 96x54 shade would take 5.8 s instead of 3.2.
static const double COARSE_ERROR = 0.15;

static bool isCoarse(const vplRenderOptions* o)
{
    return o->stop.maxError >= COARSE_ERROR && !vplIsTinyPicture(o);
}

// Light that is reflected at least once over all light, about: from a mean surface of the scene it goes on to others, but
// not into the open.
static double reflectedShare(const vplRunner* r, const vplLook* look)
{
    return vplGeometry_MeanReflectance(r->run.results[VPL_STAGE_GEOMETRY]) * (1 - look->open);
}

// True if pixels sample area lights or the sky for direct light.
static bool samplesDirect(const vplRunner* r)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    return g->emittingArea > 0 || vplScene_GetEnvironment(r->run.scene)->type != VPL_ENVIRONMENT_NONE;
}

// Direct light alone where all other light is well below the error, and in black scenes.
static bool chooseDirect(const vplRunner* r, vplPlan* p, double error)
{
    vplRenderOptions* o = &p->options;
    const double share = reflectedShare(r, &p->look);
    const bool can = (vplMethodsFor(o) & VPL_USE_DIRECT) != 0 && o->output.show == VPL_SHOW_PICTURE;
    const bool slower = isCoarse(o) && samplesDirect(r);
    if (can && p->look.points > 0 && (share <= 0 || (1.5 * share < error && !slower))) {
        o->method = VPL_METHOD_DIRECT;
        vplDecide(p, "method",
                  "reflected light is about %.3g %% of all, %.3g %% of the directions lead into the open",
                  100 * share, 100 * p->look.open);
        return true;
    }
    return false;
}

// Shadows by rays are exact, and for the lights of one picture faster than drawing maps.
static void chooseShadows(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    if (o->lights.shadows == VPL_LIGHT_SHADOWS_USUAL && p->options.lighting == VPL_LIGHTING_PHYSICAL) {
        o->lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        vplDecide(p, "light-shadows", "rays are exact, and one per light and surface costs less than a map");
    }
}

// Where so many emitters light each sample of a pixel, smooth edges take most of the time (1,000 lamps at 10 %: 4.3 s with eight
// samples, 3.3 with two, 2.3 with one, whose edges are jagged). For a large error a tree chooses some emitters for each point: 20 %
// take 0.9 s with 32, which leave 16 % of error in direct light, and 3.3 with all.
enum { MANY_EMITTERS = 256, EMITTERS_OF_LARGE_ERROR = 32, MANY_PIXELS = 300000 };

// Each pass draws every triangle of the scene. Above this number of triangles per pixel, a pass of 4,000 particles takes only 1.1 to 2
// times as long as a pass of 1,000 (tests/bench/README.md, "Particles of a pass"). Elsewhere small passes are better: they end sooner.
static const double TRIANGLES_PER_PIXEL = 1.5;
enum { PARTICLES = 1000, PARTICLES_OF_LARGE_PICTURE = 2000, PARTICLES_OF_LARGE_SCENE = 4000 };

static bool isCrowded(const vplRunner* r, const vplRenderOptions* o)
{
    return vplTrianglesPerPixel(r, o) > TRIANGLES_PER_PIXEL;
}

// Chooses the number of particles of a pass.
static void chooseParticles(const vplRunner* r, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool crowded = isCrowded(r, o);
    o->particles.count = crowded                                     ? PARTICLES_OF_LARGE_SCENE
                         : vplCountPixels(&o->output) >= MANY_PIXELS ? PARTICLES_OF_LARGE_PICTURE
                                                                     : PARTICLES;
    vplDecide(p, "particles", "%sin each pass; passes go on until the time or the error is reached",
              crowded ? "many triangles are drawn for each pixel " : "");
    if (crowded && o->stop.maxError > 0 && !(o->stop.budgetMs > 0)) {
        vplGrowFrom(p, PARTICLES);
    }
}

// Interleaved shading blurs: K x K pixels share lights. In tiny pictures 8 pixels are a large part of a surface, so K is 4 there for any error
// and any time. At 96x54, against K = 8: for 20 %, shade takes a third of the time, hall two thirds and boxes 0.12 instead of 0.07 s; for 10 %,
// hall takes 1.5 times as long; in 1 s, six-rooms has 9 % of error instead of 15, shade 30 instead of 45, hall 26 instead of 32. At 160x90 and
// 20 %, hall takes half of the time, but shade twice and loft 1.6 times as long.
enum { TINY_PICTURE = 10000 };

bool vplIsTinyPicture(const vplRenderOptions* o)
{
    return vplCountPixels(&o->output) < TINY_PICTURE;
}

// In larger pictures K is 4 for small errors: below FINE, or below FINE_IF_CROWDED where triangles are as small as pixels. With K = 4 and K = 8
// the room has an error of 1.6 and 2.3 %, conference-spot of 7 and 8.6 %. Scenes of few triangles have few edges to blur, and keep K = 8
// (furnace and plain at 2 %, 320x180: 0.45 and 0.8 of the time with K = 4; loft, which has 492 triangles, would take 1.5 times as long),
// unless the picture is small (with K = 8, room-area at 3 %, 96x54, casts 2 to 5 times the rays with four of six seeds).
static const double FINE = 0.04, FINE_IF_CROWDED = 0.15;
enum { FEW_TRIANGLES = 128, SMALL_PICTURE = 50000 };

// Tests whether the picture or the error that was asked for needs K = 4.
static bool allowsLittleBlur(const vplRunner* r, const vplRenderOptions* o)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    const bool small = vplCountPixels(&o->output) < SMALL_PICTURE;
    const double fine = isCrowded(r, o)                             ? FINE_IF_CROWDED
                        : g->triangleCount > FEW_TRIANGLES || small ? FINE
                                                                    : 0;
    return vplIsTinyPicture(o) || (o->stop.maxError > 0 && o->stop.maxError < fine);
}

// From this error on, four samples per pixel are enough for edges: they take 0.8 of the time of eight (boxes, conference-spot, sponza-sun
// and sibenik-spot at 20 %). With two samples, sponza-sun and sibenik-spot take 1.4 to 2 times as long as with eight.
static const double LARGE_ERROR = 0.15;

// Chooses particles, interleaving, samples at edges and the placement of lights.
static void chooseLights(const vplRunner* r, vplPlan* p, double error)
{
    vplRenderOptions* o = &p->options;
    const bool large = vplCountPixels(&o->output) >= MANY_PIXELS;
    const bool goes = o->stop.budgetMs > 0 || o->stop.maxError > 0;
    if (o->particles.count < 0 && goes) {
        chooseParticles(r, p);
    }
    if (o->pipeline.interleave < 0 && goes && allowsLittleBlur(r, o)) {
        o->pipeline.interleave = 4;
        vplDecide(p, "interleave", "so small an error or picture allows little blur");
    }
    const bool many = o->lights.emitterSamples == 0 && vplAskedEmitters(p) >= MANY_EMITTERS;
    if (many && o->stop.maxError >= LARGE_ERROR) {
        o->lights.emitterSamples = EMITTERS_OF_LARGE_ERROR;
    } else if (many && o->output.antialias == 8 && o->stop.maxError > 0 && error >= 0.1) {
        o->output.antialias = 2;
        vplDecide(p, "antialias", "many lights have many rims of shadows, where paths smooth what errs most");
    }
    if (o->output.antialias == 8 && o->stop.maxError >= LARGE_ERROR) {
        o->output.antialias = 4;
        vplDecide(p, "antialias", "edges are a small part of so large an error");
    }
    if (o->output.antialias == 8 && error < 0.1 && goes) {
        o->output.antialias = 16;
        vplDecide(p, "antialias", "edges are a part of so small an error");
    }
    if (o->particles.placement == VPL_PLACEMENT_PARTICLES && p->look.lights > 0 && p->look.reaching < 0.3 &&
        large) {
        o->particles.placement = VPL_PLACEMENT_VIEW;
        vplDecide(p, "placement", "%.3g %% of the lights reach what the camera sees", 100 * p->look.reaching);
    }
}

// True if surfaces emit, but few of them, and nothing comes from outside.
static bool hasLamps(const vplRunner* r)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    return g->emittingArea > 0 && g->emittingArea < VPL_MOST_LAMPS * g->area &&
           vplScene_GetEnvironment(r->run.scene)->type == VPL_ENVIRONMENT_NONE;
}

// Keller's lights on area lights are shared by neighbours, too, which blurs the shadows of what is small. Where only
// reflected light comes from shared lights, and that of area lights by shadow rays from each pixel, relmse falls to a half
// of Keller's in room-area, a fifth in cornell-area and a 38th in a model of trees and towers, in 0.5 to 2 times the time
// (320x180). A budget of time has no room for these rays beside small passes, and in a furnace, where all walls emit, the
// error is four times as large.
static bool samplesLamps(const vplRunner* r, const vplRenderOptions* o)
{
    const bool rays =
        o->lights.shadows == VPL_LIGHT_SHADOWS_USUAL || o->lights.shadows == VPL_LIGHT_SHADOWS_RAY;
    const bool shares =
        o->pipeline.kind == VPL_ACCUMULATE_USUAL && vplUsualPipeline(o) == VPL_ACCUMULATE_INTERLEAVED;
    return rays && shares && o->stop.budgetMs == 0 && o->lighting == VPL_LIGHTING_PHYSICAL &&
           (vplMethodsFor(o) & VPL_USE_INSTANT_RADIOSITY) != 0 && hasLamps(r);
}

// All of Keller's defaults but for the lights on area lights.
static void sampleLamps(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    vplParticleOptions* particles = &o->particles;
    particles->reflectivity = particles->reflectivity < -1 ? -1 : particles->reflectivity;
    particles->sampler = particles->sampler == VPL_SAMPLER_AUTO ? VPL_SAMPLER_HALTON : particles->sampler;
    if (particles->count < 0) {
        particles->count = 4000;
        vplDecide(p, "particles", "as many as for keller");
    }
    if (o->pipeline.interleave < 0) {
        o->pipeline.interleave = vplUsualSquare(o);
        vplDecide(p, "interleave", "by the number of lights and of pixels");
    }
    o->pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
    vplDecide(p, "pipeline", "neighbours share the virtual lights");
    if (o->lights.compensation == VPL_COMPENSATION_USUAL) {
        o->lights.compensation = VPL_COMPENSATION_RAYS;
        vplDecide(p, "compensation", "short rays find the light that the clamp takes away");
    }
    o->method = VPL_METHOD_INSTANT_RADIOSITY;
    vplDecide(p, "method",
              "area lights light each pixel by rays: sharing their virtual lights blurs shadows");
}

// True if a time is given without an error, and patches suit the scene (time_plan.c).
static bool patchesMayFollow(const vplRunner* r, const vplPlan* p)
{
    const vplStopOptions* stop = &p->options.stop;
    int gather;
    return stop->budgetMs > 0 && !(stop->maxError > 0) &&
           vplPatchesSuitTime(r, p, &p->options, INFINITY, &gather);
}

vplResult vplChooseMethod(vplRunner* r, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const double error = o->stop.maxError > 0 ? o->stop.maxError : USUAL_ERROR;
    o->method = vplFirstMethodFor(o);
    if (o->method != VPL_METHOD_KELLER) {
        vplDecide(p, "method", "other options are for it");
        return VPL_SUCCESS;
    }
    p->castsRays = true;
    TRY(vplRunner_RunStage(r, VPL_STAGE_GEOMETRY));
    TRY(vplTakeLook(r, p, &p->look));
    if (!chooseDirect(r, p, error) && !vplChoosePatches(r, p)) {
        const bool lamps = !isCoarse(o) && samplesLamps(r, o);
        if (!lamps) {
            vplDecide(p, "method",
                      patchesMayFollow(r, p)
                          ? "a coarse picture comes first; patches follow if there is time for them"
                          : "virtual lights with shadows leave the least error in short times");
        }
        chooseLights(r, p, error);
        if (lamps) {
            sampleLamps(p);
        }
    }
    chooseShadows(p);
    return VPL_SUCCESS;
}
