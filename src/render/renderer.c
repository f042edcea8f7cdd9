// SPDX-License-Identifier: MIT
// A render as a loop of steps: a plan, then its stages pass by pass until a count, a time or an error estimate
// ends them.
#include "render/renderer.h"

#include "base/clock.h"
#include "math/scalar.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>
#include <string.h>

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
    r->base = r->direct = NULL;
    r->sums[0] = r->sums[1] = NULL;
    r->plan = NULL;
    r->done = r->paths = 0;
    r->stale = false;
    r->weight = r->passMs = r->lastMs = 0;
    r->error = (vplErrorParts){-1, -1, -1};
    r->judgedNoise = 0;
}

// A plan that may follow the one under way.
typedef struct NextPlan {
    vplPlan* plan;
    double start, rays; // when planning began
} NextPlan;

// Makes a plan. If that fails or is cancelled, the plan under way and its picture are as before.
static vplResult makePlan(vplRenderer* r, const vplRenderOptions* options, NextPlan* next)
{
    *next = (NextPlan){NULL, vplClockMs(), (double)r->runner.stats.rays};
    vplResult result = vplMakePlan(&r->runner, options, NULL, &next->plan);
    if (result == VPL_SUCCESS && next->plan->problem[0] != 0) {
        result = vplFail(r->runner.run.context, next->plan->refusal, "%s", next->plan->problem);
        vplPlan_Destroy(next->plan);
    }
    if (result != VPL_SUCCESS) {
        r->runner.run.plan = r->plan;
        r->stale = r->done > 0;
    }
    return result;
}

static void beginPlan(vplRenderer* r, const NextPlan* next, bool coarse)
{
    if (r->plan != NULL || r->kept.image != NULL) {
        vplRunner_Forget(&r->runner);
    }
    forget(r);
    r->plan = next->plan;
    r->planStart = next->start;
    r->planRays = next->rays;
    r->coarse = coarse;
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
    vplImage_Destroy(r->kept.image);
    vplPlan_Destroy(r->kept.plan);
    r->kept = (vplKeptPicture){image, r->plan, r->done, r->paths, error};
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

vplResult vplRenderer_Create(const vplScene* scene, const vplRenderOptions* options,
                             vplRenderer** rendererOut)
{
    vplContext* context = vplScene_GetContext(scene);
    const double start = vplClockMs(), cpuStart = vplCpuMs();
    vplHistory* history;
    TRY(vplHistory_Open(scene, options->sequence.history, &history));
    vplRenderer* r = vplAllocZero(context, 1, sizeof *r);
    if (r == NULL) {
        vplHistory_Close(history);
        return VPL_OUT_OF_MEMORY;
    }
    r->asked = *options;
    vplResolveQuality(&r->asked);
    r->start = start;
    r->watched = start;
    r->cpuStart = cpuStart;
    r->spreadBefore = INFINITY;
    r->deadline = r->asked.stop.budgetMs > 0 ? start + r->asked.stop.budgetMs : INFINITY;
    r->runner = vplRunner_Begin(scene, history);
    r->runner.progress = isfinite(r->deadline) || options->progress != NULL ? watch : NULL;
    r->runner.progressUser = r;
    r->runner.stats.clampLoss = -1;
    const vplResult result = vplRenderer_PlanFirst(r);
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

// ---- passes

// Estimates the share of the whole render that `passes` are, for progress.
static double shareOf(const vplRenderer* r, int passes)
{
    const vplStopOptions* o = &r->plan->options.stop;
    const bool paths = r->plan->options.method == VPL_METHOD_PATH;
    const int most = r->plan->options.path.samples;
    double share = 0;
    if (paths && !vplPathsAreOpen(r->plan)) {
        share = (double)(r->paths + (passes > r->done ? vplNextPaths(r) : 0)) / most;
    } else if (!paths && o->passes > 0) {
        share = (double)passes / o->passes;
    } else if (o->maxError > 0) {
        share = passes / (passes + 4.0);
    } else if (o->budgetMs <= 0) {
        share = passes;
    }
    if (o->budgetMs > 0) {
        const double spent = (vplClockMs() - r->start) / o->budgetMs;
        share = spent > share ? spent : share;
    }
    return share < 1 ? share : 1;
}

vplResult vplRenderer_OpenSums(vplRenderer* r)
{
    for (int i = 0; i < 2; i++) {
        vplFree(r->runner.run.context, r->sums[i]); // of a first pass that was cancelled
        r->sums[i] = vplAllocZero(r->runner.run.context, vplValueCount(r->base), sizeof *r->sums[i]);
        if (r->sums[i] == NULL) {
            return VPL_OUT_OF_MEMORY;
        }
    }
    return VPL_SUCCESS;
}

// Renders direct light alone for layers: once if there is one pass, else what each pass adds to it.
static vplResult addDirect(vplRenderer* r)
{
    const vplPlan* p = r->plan;
    const bool onSurfaces = p->options.method == VPL_METHOD_KELLER && p->hasAreaLights;
    if (!p->splitsLight || (p->progressive && !onSurfaces)) {
        return VPL_SUCCESS;
    }
    r->runner.run.parts = VPL_PART_EMITTER_LIGHTS | (p->progressive ? 0 : VPL_PART_DIRECT);
    TRY(vplRunner_RunStage(&r->runner, VPL_STAGE_PICTURE));
    vplImage *image = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE), *before = r->direct;
    const float share = (float)vplShareOfPass(p, r->done);
    for (size_t k = 0; k < vplValueCount(image) && p->progressive; k++) {
        image->pixels[k] = share * image->pixels[k] + (before != NULL ? before->pixels[k] : 0);
    }
    vplImage_Destroy(before);
    r->direct = image;
    return VPL_SUCCESS;
}

// The first pass draws direct light. Each pass adds a picture of its own virtual lights to the sums; a pass that is
// cancelled adds nothing.
static vplResult addPass(vplRenderer* r)
{
    const double start = vplClockMs();
    r->baseMs = 0;
    if (r->done == 0) {
        r->runner.run.parts = VPL_PART_DIRECT;
        TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PICTURE));
        vplImage_Destroy(r->base);
        r->base = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
        TRY(vplRenderer_OpenSums(r));
        r->baseMs = vplClockMs() - start;
        r->runner.run.parts = VPL_PART_INDIRECT;
        TRY(vplRunner_RunStage(&r->runner, VPL_STAGE_PICTURE));
    } else {
        r->runner.run.parts = VPL_PART_INDIRECT;
        TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PICTURE));
    }
    vplImage* image = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
    const double share = vplShareOfPass(r->plan, r->done);
    const vplResult result = addDirect(r);
    for (size_t k = 0; k < vplValueCount(image) && result == VPL_SUCCESS; k++) {
        const double x = (double)image->pixels[k];
        r->sums[0][k] += share * x;
        r->sums[1][k] += share * x * x;
    }
    r->weight += result == VPL_SUCCESS ? share : 0;
    vplImage_Destroy(image);
    return result;
}

static vplResult runPass(vplRenderer* r)
{
    vplRun* run = &r->runner.run;
    run->pass = r->done;
    run->samples = vplNextPaths(r);
    if (r->plan->progressive) {
        return addPass(r);
    }
    run->parts = VPL_PART_DIRECT | VPL_PART_INDIRECT;
    TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_COUNT));
    if (r->plan->options.method == VPL_METHOD_PATH) {
        r->paths += run->samples;
        return VPL_SUCCESS;
    }
    const vplShowRow* show = &VPL_SHOWS[r->plan->options.output.show];
    vplImage* image = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
    vplResult result = show->drawOver != NULL ? show->drawOver(run, image) : VPL_SUCCESS;
    result = result == VPL_SUCCESS ? addDirect(r) : result;
    vplImage_Destroy(result == VPL_SUCCESS ? r->base : image);
    r->base = result == VPL_SUCCESS ? image : r->base;
    return result;
}

// Ends the last pass. Where that is cancelled, the pass stays and the next step ends it, with the same decisions.
static vplResult review(vplRenderer* r, bool* doneOut)
{
    const double judgedNoise = r->judgedNoise;
    const vplResult result = vplReview(r, doneOut);
    r->unreviewed = result == VPL_CANCELLED && !r->late;
    if (r->unreviewed) {
        r->judgedNoise = judgedNoise;
        return result;
    }
    r->spreadBefore = INFINITY;
    *doneOut = *doneOut || result == VPL_CANCELLED;
    return result == VPL_CANCELLED ? VPL_SUCCESS : result;
}

vplResult vplRenderer_Step(vplRenderer* r, bool* doneOut)
{
    const double begin = vplClockMs();
    r->runner.stepFrom = shareOf(r, r->done);
    r->runner.stepTo = shareOf(r, r->done + !r->unreviewed);
    if (r->unreviewed) {
        return review(r, doneOut);
    }
    const vplRunner before = r->runner;
    const vplResult result = runPass(r);
    if (result == VPL_CANCELLED) { // nothing of the pass counts
        r->runner.stats = before.stats;
        r->runner.loss = before.loss;
        r->stale = r->done > 0;
        *doneOut = r->late;
        return r->late ? VPL_SUCCESS : result;
    }
    TRY(result);
    r->stale = false;
    r->passMs += vplClockMs() - begin;
    r->lastMs = vplClockMs() - begin - r->baseMs;
    r->done++;
    return review(r, doneOut);
}

// ---- the picture

// The noise of the mean of passes whose variance is that of a whole pass over their share of it. Errors that all passes
// have alike (of direct light, and light that the accumulation loses or moves) are not in it.
static void estimateNoise(vplRenderer* r, const vplImage* image)
{
    const size_t values = vplValueCount(image);
    double variance = 0, sum = 0;
    for (size_t k = 0; k < values && r->done > 1; k++) {
        variance += fmax(0, r->sums[1][k] - r->sums[0][k] * r->sums[0][k] / r->weight);
        sum += (double)image->pixels[k];
    }
    if (r->done > 1) {
        const double noise = sqrt(variance / (double)values / (r->done - 1) / r->weight);
        r->error.noise = sum > 0 ? noise * (double)values / sum : 0;
    }
}

// Makes the virtual lights of the last pass again, for marks on the picture, where a pass was cancelled or
// the render was loaded since.
static vplResult refreshLights(vplRenderer* r)
{
    const vplRunner before = r->runner;
    if (!r->stale || VPL_SHOWS[r->plan->options.output.show].drawOver == NULL) {
        return VPL_SUCCESS;
    }
    r->runner.progress = NULL; // it is short, and not part of a pass
    r->runner.run.pass = r->done - 1;
    const vplResult result = vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_VIRTUAL_LIGHTS);
    r->runner.progress = before.progress;
    r->runner.stats = before.stats;
    r->stale = result != VPL_SUCCESS;
    return result;
}

vplResult vplRenderer_Resolve(vplRenderer* r, vplImage** imageOut)
{
    vplRun* run = &r->runner.run;
    const vplShowRow* show = &VPL_SHOWS[r->plan->options.output.show];
    if (r->plan->options.method == VPL_METHOD_PATH) {
        TRY(vplResolvePaths(run, imageOut));
        r->error.noise = r->error.total = run->stats->relativeErrorEstimate;
        r->error.bound = 1.06 * r->error.noise;
        return VPL_SUCCESS;
    }
    TRY(r->plan->progressive ? refreshLights(r) : VPL_SUCCESS);
    TRY(vplImage_Create(run->context, r->base->width, r->base->height, imageOut));
    for (size_t k = 0; k < vplValueCount(r->base); k++) {
        const double mean = r->plan->progressive ? r->sums[0][k] / r->weight : 0;
        (*imageOut)->pixels[k] = (float)((double)r->base->pixels[k] + mean);
    }
    if (r->plan->progressive) {
        estimateNoise(r, *imageOut);
    }
    return r->plan->progressive && show->drawOver != NULL ? show->drawOver(run, *imageOut) : VPL_SUCCESS;
}

// Direct light alone of all passes so far; NULL where light is not split.
static vplResult resolveDirect(vplRenderer* r, vplImage** imageOut)
{
    const vplOutputOptions* o = &r->plan->options.output;
    if (!r->plan->splitsLight) {
        return VPL_SUCCESS;
    }
    TRY(vplImage_Create(r->runner.run.context, o->width, o->height, imageOut));
    if (r->plan->options.method == VPL_METHOD_PATH) {
        vplResolveDirectPaths(&r->runner.run, *imageOut);
        return VPL_SUCCESS;
    }
    for (size_t k = 0; k < vplValueCount(*imageOut); k++) {
        const float added = r->direct != NULL ? r->direct->pixels[k] : 0;
        (*imageOut)->pixels[k] = r->plan->progressive ? r->base->pixels[k] + added / (float)r->weight : added;
    }
    return VPL_SUCCESS;
}

void vplRenderer_FinishStats(vplRenderer* r, const vplImage* image, vplRenderStats* statsOut)
{
    vplRenderStats* stats = &r->runner.stats;
    const vplErrorParts* e = &r->error;
    double sum = 0;
    for (size_t k = 0; image != NULL && k < vplValueCount(image); k++) {
        sum += (double)image->pixels[k] / (double)vplValueCount(image);
    }
    stats->passes = vplRenderer_Shown(r).passes;
    stats->relativeErrorEstimate = e->total >= 0 ? e->total : e->noise;
    stats->errorEstimate = stats->relativeErrorEstimate >= 0 ? stats->relativeErrorEstimate * sum : -1;
    stats->relativeNoise = e->noise;
    stats->relativeBias = vplRenderer_GetPlan(r)->options.method == VPL_METHOD_PATH ? 0
                          : e->total >= 0 && e->noise >= 0
                              ? sqrt(fmax(0, e->total * e->total - e->noise * e->noise))
                              : e->total;
    stats->truthPaths = r->truth != NULL ? vplTruth_Paths(r->truth) : 0;
    stats->totalMs = vplClockMs() - r->start;
    stats->cpuMs = vplCpuMs() - r->cpuStart;
    stats->peakBytes = vplRunner_PeakBytes(&r->runner);
    stats->imageHash = image != NULL ? vplImage_Hash(image) : 0;
    *statsOut = *stats;
}

vplShown vplRenderer_Shown(const vplRenderer* r)
{
    const vplKeptPicture* kept = &r->kept;
    return kept->image != NULL && (r->showsKept || r->done == 0)
               ? (vplShown){kept->plan, kept->passes, kept->paths}
               : (vplShown){r->plan, r->done, r->paths};
}

int vplRenderer_GetPassCount(const vplRenderer* r)
{
    return vplRenderer_Shown(r).passes;
}

const vplPlan* vplRenderer_GetPlan(const vplRenderer* r)
{
    return vplRenderer_Shown(r).plan;
}

// The picture of the plan under way, or one that was kept, where the plan has none or a worse one.
static vplResult takePicture(vplRenderer* r, vplImage** imageOut)
{
    const vplKeptPicture* kept = &r->kept;
    r->showsKept = false;
    if (r->done > 0) {
        TRY(vplRenderer_Resolve(r, imageOut));
        if (r->truth != NULL && r->plan->options.method != VPL_METHOD_PATH) {
            vplJudgePicture(r, *imageOut);
        }
        if (kept->image == NULL || kept->error < 0 || r->error.total < 0 || r->error.total <= kept->error) {
            return VPL_SUCCESS;
        }
        vplImage_Destroy(*imageOut);
        *imageOut = NULL;
    }
    r->showsKept = true;
    TRY(vplImage_Create(r->runner.run.context, kept->image->width, kept->image->height, imageOut));
    memcpy((*imageOut)->pixels, kept->image->pixels,
           vplValueCount(kept->image) * sizeof *kept->image->pixels);
    r->error = (vplErrorParts){-1, kept->error, kept->error};
    return VPL_SUCCESS;
}

vplResult vplRenderer_GetImage(vplRenderer* r, vplImage** imageOut, vplRenderStats* statsOut)
{
    vplImage* image = NULL;
    if (!vplRenderer_HasPicture(r)) {
        return vplFail(r->runner.run.context, VPL_INVALID_ARGUMENT,
                       "a renderer has no picture before its first step");
    }
    const vplResult result = takePicture(r, &image);
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(image);
        return result;
    }
    if (statsOut != NULL) {
        vplRenderer_FinishStats(r, image, statsOut);
    }
    *imageOut = image;
    return VPL_SUCCESS;
}

vplResult vplRenderer_GetLayers(vplRenderer* r, vplLayers** layersOut, vplRenderStats* statsOut)
{
    vplImage *picture = NULL, *direct = NULL;
    vplLayers* layers;
    TRY(vplRenderer_GetImage(r, &picture, NULL));
    const vplResult result = resolveDirect(r, &direct);
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(picture);
        return result;
    }
    TRY(vplMakeLayers(&r->runner.run, picture, direct, &layers));
    if (statsOut != NULL) {
        vplRenderer_FinishStats(r, picture, statsOut);
    }
    *layersOut = layers;
    return VPL_SUCCESS;
}
