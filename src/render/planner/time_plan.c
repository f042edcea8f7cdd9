// SPDX-License-Identifier: MIT
#include "render/planner/time_plan.h"

#include "base/clock.h"
#include "math/scalar.h"
#include "render/planner/patch_plan.h"
#include "render/planner/planner.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>

// ---- foreseen times

// The time foreseen for a stage; 0 if the plan does not have it.
static double timeOfStage(const vplPlan* p, vplStageId id)
{
    double ms = 0;
    for (int i = 0; i < p->stageCount; i++) {
        ms += p->stages[i].id == (int)id ? p->stages[i].ms : 0;
    }
    return ms;
}

double vplTimeOfFirst(const vplRenderer* r)
{
    static const vplStageId FIRST[] = {VPL_STAGE_GEOMETRY, VPL_STAGE_PATCHES, VPL_STAGE_SIDES};
    double ms = r->plan->firstMs;
    for (size_t i = 0; i < sizeof FIRST / sizeof *FIRST; i++) {
        const bool made = r->runner.run.results[FIRST[i]] != NULL;
        ms -= made ? timeOfStage(r->plan, FIRST[i]) : 0;
    }
    return r->plan->showsVirtual ? ms * r->pace : ms;
}

double vplShareOfPicture(const vplPlan* p)
{
    return p->firstMs > 0 ? timeOfStage(p, VPL_STAGE_PICTURE) / p->firstMs : 0;
}

bool vplIsInTime(const vplRenderer* r, double share)
{
    return vplTimeOfFirst(r) <= share * vplTimeLeft(r);
}

// A plan is not begun if this share of the time foreseen for its first picture is more than the time that is left.
static const double HOPELESS = 0.8;

static bool comesTooLate(const vplRenderer* r)
{
    return HOPELESS * vplTimeOfFirst(r) > vplTimeLeft(r);
}

// ---- smaller plans

// Smaller and smaller plans of virtual lights: samples per pixel, the share of particles, and whether rays compensate the clamp.
// Smooth edges come first: 250 particles without these rays leave 48 % of error in sibenik-spot, 34 in conference-spot with one sample
// per pixel, 27 and 27 with four in twice the time, 24 and 22 with 125 particles and rays in six and nine times the time.
// The last plan is as small as the coarse picture before it and adds more lights to it: without it a slow machine ended early
// (conference-spot, 200 ms on one core: after 0.6 of the time, with the same error).
static const struct {
    int antialias;
    double particles;
    bool compensates;
} LESS[] = {{8, 1, true},     {4, 1, true},       {4, 0.5, true},    {4, 0.25, true},
            {4, 0.25, false}, {4, 0.0625, false}, {1, 0.0625, false}};

// Short rays whose hits choose few of many emitters have much noise, so there must be time for several passes of them. At 320x180 and 200 ms
// halls with 200 points and 1,000 spots have 17 and 20 % of error with this share, 49 and 40 % with VPL_SURE_SHARE.
static const double SURE_OF_CHOICES = 0.4;

static bool isFirstLate(const vplRenderer* r)
{
    const vplPlan* p = r->plan;
    const bool choosesAtHits =
        p->options.lights.compensation == VPL_COMPENSATION_RAYS && p->emittersPerPoint > 0;
    return !vplIsInTime(r, choosesAtHits ? SURE_OF_CHOICES : VPL_SURE_SHARE);
}

// Only options that the caller has not set become smaller. Without rays, which take most of the time of small passes, passes need not grow.
static vplResult shrinkPasses(vplRenderer* r)
{
    const vplRenderOptions planned = vplAskedLikePlan(r), *asked = &r->asked;
    const bool smooth = asked->output.antialias == vplDefaultRenderOptions().output.antialias;
    const bool few = asked->particles.count < 0;
    const bool compensates = asked->lights.compensation == VPL_COMPENSATION_USUAL;
    for (size_t i = 0; i < sizeof LESS / sizeof *LESS && isFirstLate(r); i++) {
        vplRenderOptions o = planned;
        o.output.antialias =
            smooth ? vplMini(planned.output.antialias, LESS[i].antialias) : o.output.antialias;
        o.particles.count = few ? (int)(LESS[i].particles * planned.particles.count) : o.particles.count;
        if (compensates && !LESS[i].compensates) {
            o.lights.compensation = VPL_COMPENSATION_NONE;
            o.stop.growFrom = few ? o.particles.count : o.stop.growFrom;
        }
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
