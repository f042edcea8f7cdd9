// SPDX-License-Identifier: MIT
// The first plan of a render that has a time: a coarse one where the picture that was asked for would come late.
#include "render/planner/coarse_plan.h"

#include "render/planner/patch_plan.h"
#include "render/planner/planner.h"
#include "render/planner/time_plan.h"
#include "render/show.h"
#include "scene/scene.h"

#include <math.h>

// Share of the time that may pass until the first picture; times are foreseen within a factor of two.
static const double FIRST_SHARE = 0.25;

// Particles of a coarse plan that would not come in time with more (1280x720, 200 ms: furnished, sibenik-spot).
enum { VERY_FEW = 60 };

// Rays per pixel that gather the light of few groups, in a tenth of the time that light at the vertices of all triangles takes.
enum { COARSE_GATHER = 2 };

// If there are more than FEW_EMITTERS, a tree chooses COARSE_CHOICES of them for each point of a coarse picture.
enum { FEW_EMITTERS = 16, COARSE_CHOICES = 4 };

void vplCoarsen(const vplRenderer* r, double share, vplRenderOptions* o)
{
    *o = r->asked;
    if (o->method != VPL_METHOD_PATH && vplScene_GetEmitterCount(r->runner.run.scene) > FEW_EMITTERS &&
        (o->lights.emitterSamples == 0 || o->lights.emitterSamples > COARSE_CHOICES)) {
        o->lights.emitterSamples = COARSE_CHOICES;
    }
    o->stop.budgetMs =
        o->method == VPL_METHOD_RADIOSITY ? o->stop.budgetMs : 0; // which it may not be able to hold
    o->stop.maxError = 0;
    o->stop.passes = o->stop.growFrom = 0;
    o->output.antialias = share < 0.2 ? 1 : o->output.antialias;
    o->output.supersample = 1;
    o->shadow.mapSize = o->shadow.mapSize < 256 ? o->shadow.mapSize : 256;
    o->shadow.rsmSize = o->shadow.rsmSize > 0 && o->shadow.rsmSize < 256 ? o->shadow.rsmSize : 256;
    o->particles.count = o->particles.count >= 0 && o->particles.count < 250 ? o->particles.count : 250;
    if (o->method == VPL_METHOD_AUTO ||
        o->method == VPL_METHOD_KELLER) { // light that is missing is better than none
        o->pipeline.kind =
            o->pipeline.kind == VPL_ACCUMULATE_USUAL ? VPL_ACCUMULATE_INTERLEAVED : o->pipeline.kind;
        o->pipeline.interleave = o->pipeline.interleave < 0 ? 8 : o->pipeline.interleave;
        o->lights.compensation = VPL_COMPENSATION_NONE;
    }
    if (o->method == VPL_METHOD_KELLER && o->lights.shadows == VPL_LIGHT_SHADOWS_USUAL) {
        o->lights.shadows = VPL_LIGHT_SHADOWS_RAY; // as in plans that have a budget
    }
    o->path.samples = 1;
    o->path.edgePixels = 0;
    o->ssvp.firstBounce = (int)ceil(share * o->ssvp.firstBounce);
    o->ssvp.secondBounce = (int)ceil(share * o->ssvp.secondBounce);
    o->ssvp.clusters = (int)ceil(share * o->ssvp.clusters);
    o->ssvp.maxClusters = (int)ceil(share * o->ssvp.maxClusters);
    o->radiosity.patches = (int)ceil(share * o->radiosity.patches);
    o->radiosity.iterations = o->radiosity.iterations < 20 ? o->radiosity.iterations : 20;
    o->radiosity.gather = 0;
}

bool vplSuitsPatches(const vplRenderer* r, double rays, int* gatherOut)
{
    return vplHasTimeAlone(r) && vplPatchesSuitTime(&r->runner, r->plan, &r->asked, rays, gatherOut);
}

vplResult vplEnlargePixels(vplRenderer* r, int most, vplRenderOptions* o)
{
    while (o->output.pixelSize < most && !vplIsInTime(r, VPL_SURE_SHARE)) {
        o->output.pixelSize *= 2;
        TRY(vplRenderer_Plan(r, o, true));
        vplDecide(r->plan, "pixel-size", "a coarse picture of all pixels would come too late");
    }
    return VPL_SUCCESS;
}

// SSVP's first two bounces, without maps that light of the third needs.
static vplResult leaveBouncesOut(vplRenderer* r, vplRenderOptions* o)
{
    o->maxBounces = 2;
    TRY(vplRenderer_Plan(r, o, true));
    vplDecide(r->plan, "max-bounces", "a coarse picture with more bounces would come too late");
    return VPL_SUCCESS;
}

// Makes a coarse plan of virtual lights smaller until it is foreseen to come in time. Four choices for one of 2x2 pixels have less noise than one
// for each pixel.
static vplResult shrinkCoarse(vplRenderer* r, vplRenderOptions* o)
{
    if (o->particles.count > VERY_FEW && !vplIsInTime(r, VPL_SURE_SHARE)) {
        o->particles.count = VERY_FEW;
        TRY(vplRenderer_Plan(r, o, true));
    }
    if (o->method == VPL_METHOD_SSVP && o->maxBounces < 0 && !vplIsInTime(r, VPL_SURE_SHARE)) {
        TRY(leaveBouncesOut(r, o));
    }
    if (o->lights.emitterSamples > 1) {
        TRY(vplEnlargePixels(r, 2, o));
        if (!vplIsInTime(r, VPL_SURE_SHARE)) {
            o->lights.emitterSamples = 1;
            TRY(vplRenderer_Plan(r, o, true));
        }
    }
    return vplEnlargePixels(r, VPL_MOST_ENLARGED, o);
}

vplResult vplRenderer_PlanFirst(vplRenderer* r)
{
    const vplMethod method = r->asked.method;
    const bool patches = method == VPL_METHOD_RADIOSITY, // whose plan takes long, too
        paths = method == VPL_METHOD_PATH;               // whose first picture is not replaced, but refined
    const bool fits = isinf(r->deadline) || !vplShowsLight(r->asked.output.show) || r->asked.output.aovs != 0;
    vplRenderOptions o;
    int gather;
    if (fits || !patches) {
        TRY(vplRenderer_Plan(r, &r->asked, false));
    }
    const bool comesSoon = !patches && vplIsInTime(r, paths ? VPL_SURE_SHARE : FIRST_SHARE);
    if (fits || (comesSoon && !vplSuitsPatches(r, INFINITY, &gather))) {
        return VPL_SUCCESS;
    }
    vplCoarsen(r, patches ? 0.02 : 0.0625, &o);
    TRY(vplRenderer_Plan(r, &o, true));
    if (patches && r->plan->patchGroups > 0 && r->asked.radiosity.gather < 0) {
        o.radiosity.gather = COARSE_GATHER;
        TRY(vplRenderer_Plan(r, &o, true));
    }
    return patches || paths ? vplEnlargePixels(r, VPL_MOST_ENLARGED, &o) : shrinkCoarse(r, &o);
}
