// SPDX-License-Identifier: MIT
// A render as a loop of steps: a plan, then its stages pass by pass until a count, a time or an error estimate
// ends them.
#include "render/renderer.h"

#include "base/clock.h"
#include "base/team.h"
#include "render/planner/patch_plan.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "scene/scene.h"

#include <math.h>

// ---- plans

// Forgets the picture of the plan under way, but not the results of its stages.
static void forget(vplRenderer* r)
{
    vplContext* context = r->runner.run.context;
    vplImage_Destroy(r->base);
    vplImage_Destroy(r->direct);
    vplFree(context, r->sums[0]);
    vplFree(context, r->sums[1]);
    vplPlan_Destroy(r->plan);
    vplRenderer_ForgetEdges(r);
    r->base = r->direct = NULL;
    r->sums[0] = r->sums[1] = NULL;
    r->plan = NULL;
    r->done = r->paths = 0;
    r->stale = false;
    r->weight = r->passMs = r->lastMs = 0;
    r->error = (vplErrorParts){-1, -1, -1};
    r->judgedNoise = 0;
    r->coarserSquare = 0;
    r->closingMs = -1;
}

// A plan that may follow the one under way.
typedef struct NextPlan {
    vplPlan* plan;
    bool replanned;     // for other options than were asked for
    double start, rays; // when planning began
} NextPlan;

static double msOfStages(const vplRenderStats* stats)
{
    double ms = 0;
    for (int i = 0; i < stats->stageCount; i++) {
        ms += stats->stages[i].ms;
    }
    return ms;
}

// Makes a plan. If that fails or is cancelled, the plan under way and its picture are as before. The time of planning does not
// include the stages that decisions run.
static vplResult makePlan(vplRenderer* r, const vplRenderOptions* options, NextPlan* next)
{
    *next = (NextPlan){NULL, options != &r->asked, vplClockMs(), (double)r->runner.stats.rays};
    const double before = msOfStages(&r->runner.stats);
    vplResult result = vplMakePlan(&r->runner, options, NULL, &next->plan);
    if (result == VPL_SUCCESS && next->plan->problem[0] != 0) {
        result = vplFail(r->runner.run.context, next->plan->refusal, "%s", next->plan->problem);
        vplPlan_Destroy(next->plan);
    }
    if (result != VPL_SUCCESS) {
        r->runner.run.plan = r->plan;
        r->stale = r->done > 0;
        return result;
    }
    vplRun_AddTime(&r->runner.run, "planning", next->start + msOfStages(&r->runner.stats) - before);
    return VPL_SUCCESS;
}

static void beginPlan(vplRenderer* r, const NextPlan* next, bool coarse)
{
    if (r->plan != NULL || r->kept.image != NULL) {
        vplRunner_Forget(&r->runner);
    }
    forget(r);
    r->plan = next->plan;
    r->replanned = next->replanned;
    r->planStart = next->start;
    r->planRays = next->rays;
    r->coarse = coarse;
    if (r->lightRays == 0 && r->plan->options.method == VPL_METHOD_RADIOSITY) {
        r->lightRays = vplForeseenLightRays(r->plan);
    }
}

vplResult vplRenderer_Plan(vplRenderer* r, const vplRenderOptions* options, bool coarse)
{
    NextPlan next;
    TRY(makePlan(r, options, &next));
    beginPlan(r, &next, coarse);
    return VPL_SUCCESS;
}

vplResult vplRenderer_Replace(vplRenderer* r, const vplRenderOptions* options, bool coarse, double error)
{
    vplImage* image = NULL;
    NextPlan next;
    vplResult result = vplRenderer_Resolve(r, &image);
    result = result == VPL_SUCCESS ? makePlan(r, options, &next) : result;
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(image);
        return result;
    }
    vplKeptPicture worse = {image, r->plan, r->done, r->paths, r->edgePixels, r->edgePaths, error};
    if (r->kept.image == NULL || r->kept.error < 0 || error <= r->kept.error) {
        const vplKeptPicture before = r->kept;
        r->kept = worse;
        worse = before;
    }
    vplImage_Destroy(worse.image);
    vplPlan_Destroy(worse.plan);
    r->plan = NULL;
    beginPlan(r, &next, coarse);
    return VPL_SUCCESS;
}

// Progress of the render; false where the caller cancels it, or where the time is up and there is a picture.
static bool watch(void* user, double fraction)
{
    vplRenderer* r = user;
    const double now = vplClockMs(), budget = r->asked.stop.budgetMs;
    r->gap = fmax(r->gap, fmin(now - r->watched, 0.3 * budget));
    r->watched = now;
    if (isfinite(r->deadline) && now + 0.7 * r->gap > r->deadline + 0.04 * budget &&
        vplRenderer_HasPicture(r)) {
        r->late = true;
        return false;
    }
    return r->asked.progress == NULL || r->asked.progress(r->asked.progressUser, fraction);
}

// The part of a budget that is kept for handing over the picture: copying it, its mean and its hash. Most of this time the system clears memory.
static double finishingMs(const vplRenderOptions* o)
{
    const double ms = 2e-5 * o->output.width * o->output.height;
    return fmin(ms, 0.2 * o->stop.budgetMs);
}

static vplResult create(const vplScene* scene, const vplRenderOptions* options, vplRenderer** rendererOut)
{
    vplContext* context = vplScene_GetContext(scene);
    const double start = vplClockMs(), cpuStart = vplCpuMs();
    if (options->output.pixelSize > 1 && (options->stop.budgetMs > 0 || options->stop.maxError > 0 ||
                                          options->stop.quality != VPL_QUALITY_NONE)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "pixel-size is chosen by budget, max-error and quality: set it without them");
    }
    vplHistory* history;
    TRY(vplHistory_Open(scene, options->sequence.history, &history));
    vplRenderer* r = vplAllocZero(context, 1, sizeof *r);
    if (r == NULL) {
        vplHistory_Close(history);
        return VPL_OUT_OF_MEMORY;
    }
    r->asked = *options;
    r->stamp = scene->stamp;
    if (options->view != NULL) {
        r->view = *options->view;
        r->asked.view = &r->view;
    }
    vplResolveQuality(&r->asked);
    r->start = start;
    r->watched = start;
    r->cpuStart = cpuStart;
    r->spreadBefore = INFINITY;
    r->pace = 1;
    r->deadline =
        r->asked.stop.budgetMs > 0 ? start + r->asked.stop.budgetMs - finishingMs(&r->asked) : INFINITY;
    r->runner = vplRunner_Begin(scene, history);
    r->runner.progress = isfinite(r->deadline) || options->progress != NULL ? watch : NULL;
    r->runner.progressUser = r;
    r->runner.stats.clampLoss = -1;
    r->runner.choosesMethods = options->method == VPL_METHOD_AUTO;
    *rendererOut = r;
    return vplRenderer_PlanFirst(r);
}

vplResult vplRenderer_Create(const vplScene* scene, const vplRenderOptions* options,
                             vplRenderer** rendererOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, options, rendererOut);
    vplRenderer* r = NULL;
    const vplResult result = vplTeam_Agree(vplScene_GetContext(scene), create(scene, options, &r));
    if (result != VPL_SUCCESS) {
        vplRenderer_Destroy(r);
        return result;
    }
    *rendererOut = r;
    return VPL_SUCCESS;
}

void vplRenderer_Destroy(vplRenderer* r)
{
    if (r != NULL) {
        forget(r);
        vplTruth_Destroy(r->truth);
        vplImage_Destroy(r->kept.image);
        vplPlan_Destroy(r->kept.plan);
        vplHistory_Close(r->runner.history);
        vplFree(r->runner.run.context, r);
    }
}

bool vplRenderer_HasPicture(const vplRenderer* r)
{
    return r->done > 0 || r->kept.image != NULL;
}

// ---- pixels at edges

void vplRenderer_ForgetEdges(vplRenderer* r)
{
    vplEdges_Destroy(r->edges);
    r->edges = NULL;
    r->edgePixels = r->edgePaths = 0;
}

static vplResult openEdges(vplRenderer* r, int pixels, int paths)
{
    vplImage* image = NULL;
    vplRenderer_ForgetEdges(r);
    vplResult result = vplRenderer_Resolve(r, &image);
    result =
        result == VPL_SUCCESS ? vplEdges_Create(&r->runner.run, image, pixels, paths, &r->edges) : result;
    vplImage_Destroy(image);
    return result;
}

vplResult vplRenderer_TraceEdges(vplRenderer* r, int pixels, int paths)
{
    const double start = vplClockMs();
    TRY(vplRenderer_RefreshPatches(r));
    const bool goesOn = r->edges != NULL && r->edgePixels == pixels && r->edgePaths <= paths;
    const int64_t before = goesOn ? vplEdges_Rays(r->edges) : 0;
    const vplResult result =
        goesOn ? vplEdges_Refine(&r->runner.run, r->edges, paths) : openEdges(r, pixels, paths);
    if (result == VPL_SUCCESS) {
        r->edgePixels = pixels;
        r->edgePaths = paths;
        r->otherRays += vplEdges_Rays(r->edges) - before;
    }
    vplRun_AddTime(&r->runner.run, "edges", start);
    return result;
}
