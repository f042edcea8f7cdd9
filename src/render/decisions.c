// SPDX-License-Identifier: MIT
// Decisions resolve the options "usual" and "auto". These follow from options and method alone; those that need the scene's geometry
// come later (decisions_geometry.c).
#include "render/plan.h"

#include "base/numbers.h"
#include "geometry/cut_outs.h"
#include "render/options.h"
#include "render/show.h"
#include "render/stages/make.h"

#include <stdarg.h>
#include <stdio.h>

void vplDecide(vplPlan* plan, const char* option, const char* format, ...)
{
    if (plan->decisionCount < VPL_MAX_DECISIONS) {
        vplDecision* d = &plan->decisions[plan->decisionCount++];
        va_list arguments;
        d->name = option;
        vplRenderOptions_Get(&plan->options, option, d->value, sizeof d->value);
        va_start(arguments, format);
        vplFormatList(d->why, sizeof d->why, format, arguments);
        va_end(arguments);
    }
}

// Few rays leave noise, a large square blurs corners. relmse by rays and side K of the square (room, loft and door-ajar with 250 patches, the
// others with 5,000):
//             room    loft    door-ajar  conference-spot  sibenik-spot
//   32, K 8   0.0055  0.0074  0.0041     0.115            0.024
//   32, K 4   0.0019  0.0048  0.0058     0.080            0.018
//   128, K 4  0.0014  0.0047  0.0024     0.053            0.013
//   128, K 2  0.0009  0.0034  0.0045     0.032            0.009
// With 16 rays, K 8 has the smaller relmse in room, door-ajar and furnished, K 4 in conference-spot and sibenik-spot.
static int squareOfRays(int rays)
{
    return rays < 32 ? 8 : rays < 128 ? 4 : 2;
}

enum { MOST_RSM = 1024, LEAST_RSM = 16 }; // texels along a side

// A distance and a triangle per texel.
static double rsmBytes(const vplPlan* p, int size)
{
    return vplReflectiveMapFaces(p) * 8 * size * size;
}

// Maps of more than 64 emitters may take a quarter of the memory. Their error is within its noise: 1,000 points with 128^2 and 256^2
// texels have relmse 0.014 and 0.009, energy 0.988 and 0.980, in 300 and 875 MiB; 100 spots with 256^2 and 512^2 texels have
// relmse 0.022 and 0.023, energy 0.949 and 0.950 (bench/lamps_scene.sh).
static double mostRsmBytes(const vplPlan* p)
{
    return p->mapEmitterCount > 64 ? VPL_MAX_EMITTER_MAP_BYTES / 4 : VPL_MAX_EMITTER_MAP_BYTES;
}

void vplDecidePipeline(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool ssvp = o->method == VPL_METHOD_SSVP;
    if (p->gathers) { // passes have no pixels that rays could leave
        o->pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
    }
    if (o->pipeline.kind == VPL_ACCUMULATE_USUAL) {
        o->pipeline.kind = vplUsualPipeline(o);
        const bool shared = o->pipeline.kind == VPL_ACCUMULATE_INTERLEAVED;
        if (p->showsVirtual) {
            vplDecide(p, "pipeline",
                      ssvp                         ? "neighbours share lights, as the document has it"
                      : !shared                    ? "one G-buffer, then all lights per tile"
                      : o->pipeline.interleave > 1 ? "--interleave says that neighbours share lights"
                                                   : "neighbours share so many lights");
        }
    }
    const bool open = p->showsPatches && o->radiosity.gather < 0; // patches decide
    if (o->pipeline.interleave < 0 && !open) {
        o->pipeline.interleave = p->gathers ? squareOfRays(o->radiosity.gather) : vplUsualSquare(o);
        if (vplPixelsShareLight(p)) {
            vplDecide(p, "interleave",
                      ssvp         ? "as the document has it"
                      : p->gathers ? "neighbours share their rays"
                                   : "by the number of lights and of pixels");
        }
    }
    if (o->shadow.rsmSize == 0) {
        const int usual = ssvp ? MOST_RSM : 256;
        o->shadow.rsmSize = usual;
        while (o->shadow.rsmSize > LEAST_RSM && rsmBytes(p, o->shadow.rsmSize) > mostRsmBytes(p)) {
            o->shadow.rsmSize /= 2;
        }
        if (ssvp || o->particles.placement == VPL_PLACEMENT_RSM) {
            vplDecide(p, "rsm-size",
                      o->shadow.rsmSize < usual
                          ? "maps of all emitters take at most 1 GiB, those of more than 64 a quarter of it"
                      : ssvp ? "direct light takes its shadows from it, too"
                             : "first hits need no more texels");
        }
    }
}

// Pictures have smooth edges; stages are shown as they are.
static void chooseSamples(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const vplShow show = o->output.show;
    const bool light = show == VPL_SHOW_PICTURE || show == VPL_SHOW_DIRECT || show == VPL_SHOW_INDIRECT;
    const bool passes = p->showsVirtual && (o->pipeline.kind == VPL_ACCUMULATE_MULTIPASS ||
                                            o->pipeline.kind == VPL_ACCUMULATE_BATCHED);
    if (o->output.antialias > 1 && (o->output.supersample > 1 || passes || !light)) {
        o->output.antialias = 1;
        vplDecide(p, "antialias",
                  o->output.supersample > 1 ? "every sample is a whole picture"
                  : passes                  ? "passes over the scene light the pixels' centres"
                                            : "stages are shown as they are");
    }
}

static void chooseParticleCount(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool keller = o->method == VPL_METHOD_KELLER, shown = (VPL_USE_PARTICLES & 1 << o->method) != 0;
    if (o->particles.count < 0) {
        o->particles.count = keller ? 4000 : 10;
        if (shown) {
            vplDecide(p, "particles",
                      keller ? "2.3 %% error in the room; 2000 leave 2.5 %%, 8000 leave 1.9 %%"
                             : "as in the document");
        }
    }
    if (o->particles.reflectivity < -1) {
        o->particles.reflectivity = keller ? -1 : 0.5;
        if (shown && !keller) {
            vplDecide(p, "reflectivity", "as in the document");
        }
    }
}

static void choosePaths(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool open = o->stop.budgetMs > 0 || o->stop.maxError > 0;
    if (o->path.samples < 0) {
        o->path.samples = open ? VPL_MAX_SAMPLES : 64;
        if (o->method == VPL_METHOD_PATH) {
            vplDecide(p, "spp",
                      open ? "the time or the error that is asked for ends it before" : "a first look");
        }
    }
}

void vplGrowFrom(vplPlan* p, int particles)
{
    if (p->options.stop.growFrom == 0 && p->options.stop.passes == 0) {
        p->options.stop.growFrom = particles;
        vplDecide(p, "grow-from", "a coarse picture comes first");
    }
}

// Pictures that are to be there in time, or to stop when they are good enough, begin with small passes. A pass of 125
// particles takes 0.6 to 0.9 of the time of one of 500 (room, hall, plain, cornell-area at 640x360), because short rays
// of the compensation and direct light take theirs, and has twice its error: only a coarse picture is worth it.
static void choosePasses(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool ends = o->stop.budgetMs > 0 || o->stop.maxError > 0;
    const bool particles = (VPL_USE_PARTICLES & 1 << o->method) != 0;
    if (p->progressive && ends && particles && o->particles.count >= 32) {
        const int parts = o->stop.budgetMs > 0 || o->stop.maxError >= 0.15 ? 8
                          : o->stop.maxError >= 0.08                       ? 2
                                                                           : 1;
        if (parts > 1) {
            vplGrowFrom(p, o->particles.count / parts);
        }
    }
}

static void chooseParticles(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool keller = o->method == VPL_METHOD_KELLER, byView = o->particles.placement == VPL_PLACEMENT_VIEW;
    const bool mirror = o->lighting == VPL_LIGHTING_DOCUMENTED && !keller;
    const bool shown = (VPL_USE_PARTICLES & 1 << o->method) != 0;
    if (o->particles.sampler == VPL_SAMPLER_AUTO) { // by view: error 0.64 in sponza-sun, 0.91 in room
        o->particles.sampler = keller || byView ? VPL_SAMPLER_HALTON : VPL_SAMPLER_RANDOM;
        if (shown) {
            vplDecide(p, "sampler",
                      keller   ? "as Keller's document has it"
                      : byView ? "less noise among so many candidates"
                               : "the document's particles start at random");
        }
    }
    if (o->particles.bounce == VPL_BOUNCE_AUTO) {
        o->particles.bounce = mirror ? VPL_BOUNCE_REFLECT : VPL_BOUNCE_DIFFUSE;
        if (shown) {
            vplDecide(p, "bounce",
                      mirror ? "particles reflect like mirrors in documented lighting"
                             : "surfaces are diffuse");
        }
    }
}

static void chooseShadows(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool documented = p->shading == VPL_LIGHTING_DOCUMENTED;
    const bool pair = o->shadow.bias >= 0 || o->shadow.biasSlope >= 0;
    const bool exact = o->shadow.bias == VPL_BIAS_OPTION_EXACT;
    if (o->method == VPL_METHOD_KELLER && o->stop.budgetMs > 0 &&
        o->lights.shadows == VPL_LIGHT_SHADOWS_USUAL) {
        o->lights.shadows = VPL_LIGHT_SHADOWS_RAY;
        vplDecide(p, "light-shadows", "rays need no maps, which may take longer than the time");
    }
    // The document's shadows are those of maps, however many there are.
    const double maps = o->method == VPL_METHOD_SSVP ? rsmBytes(p, MOST_RSM) : vplEmitterMapBytes(p);
    p->emitterRays =
        o->lights.shadows == VPL_LIGHT_SHADOWS_RAY || (!documented && maps > VPL_MAX_EMITTER_MAP_BYTES);
    p->emitterRays = p->emitterRays || p->mapEmitters != p->emitters; // not each has a map
    int placed;
    const int chosen = vplChosenEmitters(p, o->lights.emitterSamples, &placed);
    if (chosen > 0 && !documented && o->method != VPL_METHOD_PATH) {
        p->emitterRays = true;
        p->emittersPerPoint = chosen;
        vplDecide(p, "emitter-samples", "for each point a tree chooses %d of the %d lights",
                  p->emittersPerPoint, placed);
    }
    p->biasRule = pair || (documented && !exact) ? VPL_BIAS_PAIR : VPL_BIAS_EXACT;
    if (o->lights.shadows == VPL_LIGHT_SHADOWS_USUAL) {
        o->lights.shadows = o->method == VPL_METHOD_KELLER ? VPL_LIGHT_SHADOWS_AUTO
                            : o->method == VPL_METHOD_SSVP ? VPL_LIGHT_SHADOWS_CLUSTER
                                                           : VPL_LIGHT_SHADOWS_NONE;
        if (p->showsVirtual && o->lights.shadows != VPL_LIGHT_SHADOWS_AUTO) {
            vplDecide(p, "light-shadows",
                      o->method == VPL_METHOD_SSVP ? "lights of a cluster share its paraboloid map"
                                                   : "the document draws virtual lights without shadows");
        }
    }
}

static void chooseCompensation(vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const bool keller = o->method == VPL_METHOD_KELLER;
    const bool pays =
        keller && o->lighting == VPL_LIGHTING_PHYSICAL && o->lights.shadows != VPL_LIGHT_SHADOWS_NONE;
    if (o->lights.compensation == VPL_COMPENSATION_USUAL) {
        o->lights.compensation = pays ? VPL_COMPENSATION_RAYS : VPL_COMPENSATION_NONE;
        if (p->showsVirtual) {
            vplDecide(p, "compensation",
                      pays     ? "short rays find the light that the clamp takes away"
                      : keller ? "it needs physical lighting and shadows"
                               : "only keller's lights stand for all light near by");
        }
    }
    const vplShow show = o->output.show;
    const bool shown = show == VPL_SHOW_PICTURE || show == VPL_SHOW_INDIRECT || show == VPL_SHOW_OVERLAY ||
                       show == VPL_SHOW_DIRECT;
    p->compensates = o->lights.compensation == VPL_COMPENSATION_RAYS && shown && p->showsVirtual &&
                     o->lights.minDistance != 0 && p->shading == VPL_LIGHTING_PHYSICAL;
    p->estimatesLoss = show != VPL_SHOW_LIGHT && o->sequence.history == NULL && // frames have no time for it
                       p->shading == VPL_LIGHTING_PHYSICAL && (p->showsDirect || p->compensates);
}

enum { CUT_OUT_RAYS = 64 }; // from each pixel, where patches are not drawn

// Decides which kinds of light the picture adds up.
static void choosePicture(const vplScene* scene, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    const vplShowRow* row = &VPL_SHOWS[o->output.show];
    const bool keller = o->method == VPL_METHOD_KELLER;
    const bool lit = (VPL_USE_VIRTUAL_LIGHTS & 1 << o->method) != 0 &&
                     (o->method != VPL_METHOD_SSVP || o->maxBounces != 0);
    p->shading = keller ? VPL_LIGHTING_PHYSICAL : o->lighting;
    p->showsDirect = row->direct && o->method != VPL_METHOD_PATH;
    p->showsVirtual = lit && row->lights && (o->output.show != VPL_SHOW_DIRECT || keller);
    p->showsPatches = o->method == VPL_METHOD_RADIOSITY && row->patches != VPL_NO_PATCHES;
    p->hasCutOuts = vplScene_HasCutOuts(scene);
    if (p->showsPatches && vplShowsLight(o->output.show) && o->radiosity.gather <= 0 && p->hasCutOuts) {
        o->radiosity.gather = CUT_OUT_RAYS;
        vplDecide(p, "gather", "patches cannot be seen through holes: pixels gather their light");
    }
    p->gathers = o->radiosity.gather > 0 && p->showsPatches && vplShowsLight(o->output.show);
    p->splitsLight = (o->output.aovs & (VPL_AOV_DIRECT | VPL_AOV_INDIRECT)) != 0 &&
                     (p->showsVirtual || p->showsPatches || o->method == VPL_METHOD_PATH);
    p->progressive =
        row->passes && p->showsVirtual &&
        (o->stop.passes > 0 || o->stop.growFrom > 0 || o->stop.budgetMs > 0 || o->stop.maxError > 0);
    for (int i = 0; i < vplScene_GetMaterialCount(scene); i++) {
        const vplRgb e = vplScene_GetMaterial(scene, i)->emission;
        p->hasAreaLights = p->hasAreaLights || e.r > 0 || e.g > 0 || e.b > 0;
    }
    p->hasSky = vplScene_GetEnvironment(scene)->type != VPL_ENVIRONMENT_NONE;
}

static void chooseRays(vplPlan* p)
{
    bool direct = p->hasAreaLights || p->hasSky || p->emitterRays;
    for (int i = 0; i < p->emitterCount; i++) {
        direct = direct || p->emitters[i].type == VPL_EMITTER_DIRECTIONAL;
    }
    p->castsRays = p->showsVirtual || p->showsPatches || p->options.method == VPL_METHOD_PATH ||
                   (p->showsDirect && direct);
}

void vplDecideByOptions(const vplScene* scene, vplPlan* p)
{
    choosePicture(scene, p);
    chooseParticleCount(p);
    choosePasses(p);
    vplDecidePipeline(p);
    chooseSamples(p);
    chooseParticles(p);
    choosePaths(p);
    chooseShadows(p);
    chooseCompensation(p);
    chooseRays(p);
}
