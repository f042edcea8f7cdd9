// SPDX-License-Identifier: MIT
// Plans that cannot be rendered, and the sentence for each: options that contradict each other, too little time, too little memory.
#include "render/plan.h"

#include "base/numbers.h"
#include "geometry/bvh.h"
#include "render/options.h"
#include "render/show.h"

#include <stdio.h>

static const char* refuseLighting(const vplPlan* p)
{
    if (p->options.lighting != VPL_LIGHTING_DOCUMENTED) {
        return NULL;
    }
    switch (p->options.method) {
    case VPL_METHOD_PATH:
        return "the path tracer knows physical lighting only, not documented";
    case VPL_METHOD_SSVP:
        return "the SSVP document prints no lighting formulas of its own; use physical lighting";
    case VPL_METHOD_RADIOSITY:
        return "radiosity's document prints no lighting formulas of its own; use physical lighting";
    default:
        return NULL;
    }
}

// A hemispherical map of a light in the sky would show the whole scene in a part of a texel.
static const char* refuseSky(const vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    if (!p->hasSky) {
        return NULL;
    }
    if (o->lighting == VPL_LIGHTING_DOCUMENTED) {
        return "documented lighting knows no environment; use physical lighting";
    }
    return o->method == VPL_METHOD_KELLER && o->lights.shadows == VPL_LIGHT_SHADOWS_MAP
               ? "lights of the environment are too far away for shadow maps; use --light-shadows ray"
               : NULL;
}

static const char* refuseOptions(const vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    const vplShow show = o->output.show;
    if (refuseSky(p) != NULL) {
        return refuseSky(p);
    }
    if (o->lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER && o->method != VPL_METHOD_SSVP) {
        return "only SSVP's lights have clusters to cast shadows by";
    }
    if (o->method == VPL_METHOD_RADIOSITY && o->radiosity.placement == VPL_PATCHES_ADAPTIVE &&
        o->radiosity.patchSize > 0) {
        return "adaptive patches are counted, not measured: set vplRenderOptions.radiosity.patches and leave "
               "patchSize at 0";
    }
    if (o->output.aovs != 0 && show != VPL_SHOW_PICTURE) {
        return "--aov adds layers to the picture, not to what --show shows instead of it";
    }
    const bool once = o->method == VPL_METHOD_RADIOSITY; // its picture is whole at once
    if (o->path.edgePixels > 0 && ((o->stop.passes <= 0 && !once) || o->stop.budgetMs > 0)) {
        return "edge-pixels needs passes without a budget: they are chosen from the picture of all passes";
    }
    if (o->path.edgePixels > 0 &&
        (show != VPL_SHOW_PICTURE || o->output.aovs != 0 || p->shading != VPL_LIGHTING_PHYSICAL)) {
        return "edge-pixels replaces pixels of the whole picture by physical light: it goes with no other "
               "--show, no --aov and no "
               "--lighting documented";
    }
    if (o->output.pixelSize > 1 &&
        (o->path.edgePixels > 0 || o->output.aovs != 0 || VPL_SHOWS[show].draw != NULL)) {
        return "--edge-pixels, --aov and maps that --show shows have a value of each pixel: use --pixel-size "
               "1";
    }
    const bool map = p->emitterCount > 0 && p->emitters[0].type != VPL_EMITTER_DIRECTIONAL &&
                     !p->emitterRays && o->method != VPL_METHOD_SSVP;
    if ((show == VPL_SHOW_SHADOW_MAP || show == VPL_SHOW_SHADOW_FACTOR) && !map) {
        return "the scene has no light with a shadow map, or the first casts shadows by rays";
    }
    return vplRefuseShow(o);
}

void vplRefuseOptions(vplPlan* p)
{
    const vplStopOptions* stop = &p->options.stop;
    const bool endless =
        stop->growFrom > 0 && stop->passes == 0 && !(stop->budgetMs > 0) && !(stop->maxError > 0);
    const char* problem = endless
                              ? "grow-from needs passes, budget or max-error: nothing else ends the passes"
                              : refuseLighting(p);
    problem = problem != NULL ? problem : refuseOptions(p);
    if (problem != NULL) {
        snprintf(p->problem, sizeof p->problem, "%s", problem);
        return;
    }
    for (int i = 0; i < p->emitterCount && p->shading == VPL_LIGHTING_DOCUMENTED && p->showsDirect; i++) {
        if (p->emitters[i].type != VPL_EMITTER_POINT) {
            snprintf(p->problem, sizeof p->problem,
                     "light %d is not a point light, and documented lighting knows no others; use physical",
                     i);
            return;
        }
    }
}

// Without groups each triangle is at least one patch. Measured on two cores: 0.1 us for a pair of sides of all pairs (room), and 1 to
// 1.5 ms for a side by links (Sibenik, Sponza); 3 to 5 us for a triangle that is in a group (furnished, Conference, Sibenik, Sponza,
// boxes).
static double leastMsOfPatches(double triangles, bool groups)
{
    return groups                       ? 4.6e-3 * triangles
           : triangles <= VPL_ALL_PAIRS ? 1e-4 * triangles * triangles
                                        : triangles;
}

// SSVP draws all triangles into a reflective map of each emitter and, with few clusters, into about four paraboloid maps (furnished, Sponza:
// 0.05 us for each on two cores, and 0.15 to 0.2 us for a triangle of the ray tree).
static double leastMsOfMaps(const vplPlan* p, double triangles)
{
    enum { FEWEST_PARABOLOIDS = 4 };
    return (1.5e-4 + 4e-5 * (p->mapEmitterCount + FEWEST_PARABOLOIDS)) * triangles;
}

void vplRefuseTime(const vplRunner* r, vplPlan* p)
{
    const int triangles = ((const vplGeometry*)r->run.results[VPL_STAGE_GEOMETRY])->triangleCount;
    const vplRadiosityOptions* o = &p->options.radiosity;
    const bool groups = o->groups != VPL_PATCH_GROUPS_OFF && !vplIsDocumented(o),
               maps = p->options.method == VPL_METHOD_SSVP && p->showsVirtual;
    const double ms = p->showsPatches ? leastMsOfPatches(triangles, groups)
                      : maps          ? leastMsOfMaps(p, triangles)
                                      : 0;
    if (p->options.stop.budgetMs > 0 && ms > p->options.stop.budgetMs) {
        vplFormat(
            p->problem, sizeof p->problem,
            "--budget %g: %s all %d triangles, which takes about %.2g s at least; use %sanother method or "
            "more time",
            p->options.stop.budgetMs, maps ? "SSVP draws its maps of" : "radiosity makes patches of",
            triangles, 1e-3 * ms, groups || maps ? "" : "--patch-groups auto, ");
    }
}

// Names the stage that takes most.
void vplRefuseMemory(const vplContext* context, vplPlan* p)
{
    const double mib = 1 / 1048576.0;
    const vplPlanStage* most = &p->stages[0];
    if (context->memoryLimit == 0 || p->problem[0] != 0 || p->peakBytes <= (int64_t)context->memoryLimit) {
        return;
    }
    for (int i = 1; i < p->stageCount; i++) {
        most = p->stages[i].bytes + p->stages[i].scratch > most->bytes + most->scratch ? &p->stages[i] : most;
    }
    p->refusal = VPL_OUT_OF_MEMORY;
    vplFormat(p->problem, sizeof p->problem,
              "the picture needs about %.0f MiB of memory, and %.0f MiB are allowed; %.0f MiB of them are "
              "for: %s (%.80s)",
              mib * (double)p->peakBytes, mib * (double)context->memoryLimit,
              mib * (double)(most->bytes + most->scratch), most->name, most->why);
}
