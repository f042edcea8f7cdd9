// SPDX-License-Identifier: MIT
#include "render/planner/time_plan.h"

#include "base/clock.h"
#include "math/scalar.h"
#include "render/planner/patch_plan.h"
#include "render/planner/planner.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "scene/scene.h"

#include <math.h>

// ---- foreseen times

double vplTimeOfFirst(const vplRenderer* r)
{
    double ms = r->plan->firstMs;
    for (int i = 0; i < r->plan->stageCount; i++) {
        const vplPlanStage* stage = &r->plan->stages[i];
        const bool made = stage->id == VPL_STAGE_GEOMETRY && r->runner.run.results[stage->id] != NULL;
        ms -= made ? stage->ms : 0;
    }
    return ms * r->pace;
}

// A plan is not begun if this share of the time foreseen for its first picture is more than the time that is left.
static const double HOPELESS = 0.8;

static bool comesTooLate(const vplRenderer* r)
{
    return HOPELESS * vplTimeOfFirst(r) > vplTimeLeft(r);
}

// ---- coarse plans

// Share of the time that may pass until the first picture; times are foreseen within a factor of two.
static const double FIRST_SHARE = 0.25;

// A coarse plan takes a sample of emitters only where there are more.
enum { FEW_EMITTERS = 16 };

static int countEmitters(const vplRenderer* r)
{
    const int asked = r->asked.lights.emitterSamples, all = vplScene_GetEmitterCount(r->runner.run.scene);
    return asked > 0 && asked < all ? asked : all;
}

// Fewer lights and patches by a factor, no smooth edges and small shadow maps.
static void coarsen(const vplRenderer* r, double share, vplRenderOptions* o)
{
    *o = r->asked;
    const int emitters = countEmitters(r);
    if (emitters > FEW_EMITTERS) {
        const double fits = r->plan != NULL && !r->coarse ? FIRST_SHARE * vplTimeLeft(r) / r->plan->firstMs : 1;
        o->lights.emitterSamples = (int)fmax(FEW_EMITTERS, ceil(fmin(share, fits) * emitters));
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
    o->ssvp.firstBounce = (int)ceil(share * o->ssvp.firstBounce);
    o->ssvp.secondBounce = (int)ceil(share * o->ssvp.secondBounce);
    o->ssvp.clusters = (int)ceil(share * o->ssvp.clusters);
    o->ssvp.maxClusters = (int)ceil(share * o->ssvp.maxClusters);
    o->radiosity.patches = (int)ceil(share * o->radiosity.patches);
    o->radiosity.iterations = o->radiosity.iterations < 20 ? o->radiosity.iterations : 20;
    o->radiosity.gather = 0;
}

vplResult vplRenderer_PlanFirst(vplRenderer* r)
{
    const vplMethod method = r->asked.method;
    const bool patches = method == VPL_METHOD_RADIOSITY; // whose plan takes long, too
    const bool fits = isinf(r->deadline) || method == VPL_METHOD_PATH ||
                      !vplShowsLight(r->asked.output.show) || r->asked.output.aovs != 0;
    vplRenderOptions o;
    if (fits || !patches) {
        TRY(vplRenderer_Plan(r, &r->asked, false));
    }
    const bool comesSoon = !patches && vplTimeOfFirst(r) < FIRST_SHARE * vplTimeLeft(r);
    if (fits || (comesSoon && !vplFillsTimeWithPatches(r))) {
        return VPL_SUCCESS;
    }
    coarsen(r, patches ? 0.02 : 0.0625, &o);
    return vplRenderer_Plan(r, &o, true);
}

// ---- after a coarse picture

// After a coarse picture with a sample of the emitters the next has as many as 0.7 of the time is enough for. Its edges are
// not smooth, because few bright emitters have many rims of shadows, and short rays do not compensate the clamp, because
// all emitters are evaluated where they end: each takes several times as long.
static void addEmitters(const vplRenderer* r, vplRenderOptions* o)
{
    const double spent = vplClockMs() - r->planStart, before = r->plan->options.lights.emitterSamples;
    const double fits = before * fmax(1, 0.7 * vplTimeLeft(r) / fmax(spent, 1));
    if (before > 0 && fits < countEmitters(r)) {
        o->lights.emitterSamples = (int)fits;
        o->output.antialias = 1;
        o->lights.compensation = VPL_COMPENSATION_NONE;
        vplLog(r->runner.run.context, VPL_LOG_INFO, "%d of the scene's %d lights stand for all in this time",
               (int)fits, vplScene_GetEmitterCount(r->runner.run.scene));
    }
}

// After a coarse picture of radiosity the next has as many patches as half of the time is enough for, where the time
// grows with the square of their number.
static vplResult refine(vplRenderer* r)
{
    vplRenderOptions o = r->asked;
    bool coarse = false;
    if (r->plan->options.method == VPL_METHOD_RADIOSITY) {
        const double spent = vplClockMs() - r->planStart, before = r->plan->options.radiosity.patches;
        const double patches = before * sqrt(fmax(1, 0.4 * vplTimeLeft(r) / fmax(spent, 1)));
        coarse = patches < 0.75 * o.radiosity.patches;
        if (coarse) {
            coarsen(r, patches / o.radiosity.patches, &o);
            o.output.antialias = r->asked.output.antialias;
        }
    } else {
        addEmitters(r, &o);
    }
    return vplRenderer_Replace(r, &o, coarse, -1);
}

// A first picture by patches may take this share of the time.
static const double SHARE_OF_PATCHES = 0.5;

// Replaces the planner's first guess by as many patches as the time is enough for; by virtual lights if these are too few. The time of
// what patches exchange grows with the square of their number, that of the picture hardly.
static vplResult fillWithPatches(vplRenderer* r)
{
    double picture = 0;
    for (int i = 0; i < r->plan->stageCount; i++) {
        picture += r->plan->stages[i].id == VPL_STAGE_PICTURE ? r->plan->stages[i].ms : 0;
    }
    const double left = fmax(0, SHARE_OF_PATCHES * vplTimeLeft(r) - picture);
    const double fits = r->plan->options.radiosity.patches * sqrt(left / (r->plan->firstMs - picture));
    const bool few = fits < VPL_FEWEST_PATCHES;
    vplRenderOptions o = few ? vplAskedOfLights(r) : r->asked;
    if (!few) {
        o.method = VPL_METHOD_RADIOSITY;
        o.radiosity.patches = (int)fmin(fits, vplMostPatches(r->runner.run.context));
        vplLog(r->runner.run.context, VPL_LOG_INFO, "the time is enough for %d patches", o.radiosity.patches);
    }
    return vplRenderer_Plan(r, &o, false);
}

// Foreseen times of virtual lights are wrong by a factor of up to four.
static void notePace(vplRenderer* r)
{
    if (r->plan->progressive || r->plan->showsVirtual) {
        r->pace = fmin(4, fmax(0.25, r->passMs / fmax(vplTimeOfFirst(r), 1)));
    }
}

vplResult vplFollowCoarse(vplRenderer* r, bool* doneOut)
{
    notePace(r);
    TRY(refine(r));
    if (r->coarse) {
        return VPL_SUCCESS;
    }
    if (vplFillsTimeWithPatches(r)) {
        TRY(fillWithPatches(r));
    }
    return vplFitPlan(r, doneOut);
}

// ---- smaller plans

// Less and less of what a plan of virtual lights has: samples per pixel, and a share of its particles.
static const struct {
    int antialias;
    double particles;
} LESS[] = {{8, 1}, {4, 1}, {4, 0.5}, {4, 0.25}, {1, 0.25}, {1, 0.125}};

// Only options that the caller has not set become smaller.
static vplResult shrinkPasses(vplRenderer* r)
{
    const vplRenderOptions planned = vplAskedLikePlan(r);
    const bool smooth = r->asked.output.antialias == vplDefaultRenderOptions().output.antialias;
    const bool few = r->asked.particles.count < 0;
    for (size_t i = 0; i < sizeof LESS / sizeof *LESS && comesTooLate(r) && (smooth || few); i++) {
        vplRenderOptions o = planned;
        o.output.antialias = smooth ? vplMini(planned.output.antialias, LESS[i].antialias) : o.output.antialias;
        o.particles.count = few ? (int)(LESS[i].particles * planned.particles.count) : o.particles.count;
        TRY(vplRenderer_Plan(r, &o, false));
    }
    return VPL_SUCCESS;
}

vplResult vplFitPlan(vplRenderer* r, bool* doneOut)
{
    if (comesTooLate(r) && r->asked.method == VPL_METHOD_AUTO &&
        r->plan->options.method == VPL_METHOD_RADIOSITY) {
        TRY(vplFitPatches(r, vplTimeLeft(r) / vplTimeOfFirst(r)));
    }
    if (r->plan->progressive) {
        TRY(shrinkPasses(r));
    }
    *doneOut = comesTooLate(r);
    return VPL_SUCCESS;
}

// Weights are relative to --particles, so they change with it: by a power of two, which leaves all digits of the sums as they are.
static void scaleSums(vplRenderer* r, int factor)
{
    const size_t count = vplValueCount(r->base);
    for (size_t k = 0; k < count; k++) {
        r->sums[0][k] *= factor;
        r->sums[1][k] *= factor;
    }
    for (size_t k = 0; k < count && r->direct != NULL; k++) {
        r->direct->pixels[k] *= (float)factor;
    }
    r->weight *= factor;
}

bool vplStopGrowth(vplRenderer* r)
{
    vplRenderOptions* o = &r->plan->options;
    const int most = o->particles.count, now = r->done > 0 ? vplParticlesOfPass(r->plan, r->done - 1) : most;
    const int factor = now > 0 ? most / now : 1;
    const bool exact = factor > 1 && factor * now == most && (factor & (factor - 1)) == 0;
    if (!r->plan->progressive || !exact || r->asked.particles.count >= 0 ||
        r->lastMs > vplTimeLeft(r) + 0.05 * r->asked.stop.budgetMs) {
        return false;
    }
    scaleSums(r, factor);
    o->particles.count = now;
    return true;
}
