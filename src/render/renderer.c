// SPDX-License-Identifier: MIT
// A render as a loop of steps: a plan, then its stages pass by pass until a count, a time or an error estimate
// ends them.
#include "render/renderer.h"

#include "base/clock.h"
#include "math/scalar.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "scene/scene.h"

#include <math.h>

// ---- histories

// Opens the history that the options name, or a new one where there is none or another renderer uses it.
static vplResult openHistory(const vplScene* scene, vplHistory* shared, vplHistory** historyOut)
{
    if (shared != NULL && shared->context != scene->context) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.sequence.history was made with another context than the scene's");
    }
    if (shared != NULL && shared->sceneStamp != 0 && shared->sceneStamp != scene->stamp) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.sequence.history is of another scene, or something was added to the "
                       "scene since");
    }
    if (shared == NULL || shared->busy) {
        return vplHistory_Create(scene->context, historyOut);
    }
    shared->busy = true;
    shared->sceneStamp = scene->stamp;
    *historyOut = shared;
    return VPL_SUCCESS;
}

static void closeHistory(vplHistory* history)
{
    if (history->busy) { // it is the caller's
        history->busy = false;
    } else {
        vplHistory_Destroy(history);
    }
}

// ---- a render as a loop of steps

vplResult vplRenderer_Create(const vplScene* scene, const vplRenderOptions* options,
                             vplRenderer** rendererOut)
{
    vplContext* context = vplScene_GetContext(scene);
    const double start = vplClockMs(), cpuStart = vplCpuMs();
    vplHistory* history;
    TRY(openHistory(scene, options->sequence.history, &history));
    vplRenderer* r = vplAllocZero(context, 1, sizeof *r);
    if (r == NULL) {
        closeHistory(history);
        return VPL_OUT_OF_MEMORY;
    }
    r->start = start;
    r->cpuStart = cpuStart;
    r->runner = vplRunner_Begin(scene, history);
    r->runner.progress = options->progress;
    r->runner.progressUser = options->progressUser;
    r->runner.stats.clampLoss = r->runner.stats.errorEstimate = r->runner.stats.relativeErrorEstimate = -1;
    vplResult result = vplMakePlan(&r->runner, options, NULL, &r->plan);
    if (result == VPL_SUCCESS && r->plan->problem[0] != 0) {
        result = vplFail(context, r->plan->refusal, "%s", r->plan->problem);
    }
    if (result != VPL_SUCCESS) {
        vplRenderer_Destroy(r);
        return result;
    }
    *rendererOut = r;
    return VPL_SUCCESS;
}

// Estimates the share of the whole render that `passes` are, for progress.
static double shareOf(const vplRenderer* r, int passes)
{
    const vplStopOptions* o = &r->plan->options.stop;
    const bool paths = r->plan->options.method == VPL_METHOD_PATH;
    const int count = vplPathsAreOpen(r->plan) ? 0 : paths ? vplCountPathPasses(r->plan) : o->passes;
    double share = 0;
    if (count > 0) {
        share = (double)passes / count;
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
    for (int half = 0; half < 2; half++) {
        vplFree(r->runner.run.context, r->sums[half]); // of a first pass that was cancelled
        r->sums[half] = vplAllocZero(r->runner.run.context, vplValueCount(r->base), sizeof *r->sums[half]);
        if (r->sums[half] == NULL) {
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
    for (size_t k = 0; k < vplValueCount(image) && p->progressive && before != NULL; k++) {
        image->pixels[k] += before->pixels[k];
    }
    vplImage_Destroy(before);
    r->direct = image;
    return VPL_SUCCESS;
}

// The first pass draws direct light. Each pass adds a picture of its own virtual lights to the sums, after
// all that can be cancelled.
static vplResult addPass(vplRenderer* r)
{
    if (r->done == 0) {
        r->runner.run.parts = VPL_PART_DIRECT;
        TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PICTURE));
        vplImage_Destroy(r->base);
        r->base = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
        TRY(vplRenderer_OpenSums(r));
        r->runner.run.parts = VPL_PART_INDIRECT;
        TRY(vplRunner_RunStage(&r->runner, VPL_STAGE_PICTURE));
    } else {
        r->runner.run.parts = VPL_PART_INDIRECT;
        TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_PICTURE));
    }
    vplImage* image = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
    const vplResult result = addDirect(r);
    for (size_t k = 0; k < vplValueCount(image) && result == VPL_SUCCESS; k++) {
        r->sums[r->done % 2][k] += (double)image->pixels[k];
    }
    vplImage_Destroy(image);
    return result;
}

static vplResult runPass(vplRenderer* r)
{
    vplRun* run = &r->runner.run;
    run->pass = r->done;
    if (r->plan->progressive) {
        return addPass(r);
    }
    run->parts = VPL_PART_DIRECT | VPL_PART_INDIRECT;
    TRY(vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_COUNT));
    if (r->plan->options.method != VPL_METHOD_PATH) {
        const vplShowRow* show = &VPL_SHOWS[r->plan->options.output.show];
        vplImage* image = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
        vplResult result = show->drawOver != NULL ? show->drawOver(run, image) : VPL_SUCCESS;
        result = result == VPL_SUCCESS ? addDirect(r) : result;
        vplImage_Destroy(result == VPL_SUCCESS ? r->base : image);
        r->base = result == VPL_SUCCESS ? image : r->base;
        return result;
    }
    return VPL_SUCCESS;
}

// The means of the even and the odd passes differ by their errors: half of the difference is the error to
// expect in the mean of both. Errors that both share (of direct light, and light that the accumulation loses
// or moves) are not in it.
static void estimateError(vplRenderer* r, const vplImage* image)
{
    const size_t values = vplValueCount(image);
    const int odd = r->done / 2, even = r->done - odd;
    vplRenderStats* stats = &r->runner.stats;
    double squares = 0, sum = 0;
    for (size_t k = 0; k < values && odd > 0; k++) {
        const double half = 0.5 * (r->sums[0][k] / even - r->sums[1][k] / odd);
        squares += half * half;
        sum += (double)image->pixels[k];
    }
    if (odd > 0) {
        stats->errorEstimate = sqrt(squares / (double)values);
        stats->relativeErrorEstimate = sum > 0 ? stats->errorEstimate * (double)values / sum : 0;
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

static vplResult resolve(vplRenderer* r, vplImage** imageOut)
{
    vplRun* run = &r->runner.run;
    const vplShowRow* show = &VPL_SHOWS[r->plan->options.output.show];
    if (r->plan->options.method == VPL_METHOD_PATH) {
        return vplResolvePaths(run, imageOut);
    }
    TRY(r->plan->progressive ? refreshLights(r) : VPL_SUCCESS);
    TRY(vplImage_Create(run->context, r->base->width, r->base->height, imageOut));
    for (size_t k = 0; k < vplValueCount(r->base); k++) {
        const double mean = r->plan->progressive ? (r->sums[0][k] + r->sums[1][k]) / r->done : 0;
        (*imageOut)->pixels[k] = (float)((double)r->base->pixels[k] + mean);
    }
    if (r->plan->progressive) {
        estimateError(r, *imageOut);
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
        (*imageOut)->pixels[k] = r->plan->progressive ? r->base->pixels[k] + added / (float)r->done : added;
    }
    return VPL_SUCCESS;
}

vplResult vplRenderer_IsDone(vplRenderer* r, bool* doneOut)
{
    const vplRenderOptions* o = &r->plan->options;
    const bool paths = o->method == VPL_METHOD_PATH;
    bool done = paths                  ? vplPathsAreDone(&r->runner.run)
                : r->plan->progressive ? o->stop.passes > 0 && r->done >= o->stop.passes
                                       : true;
    if (!done && o->stop.maxError > 0) {
        vplImage* image = NULL;
        const vplResult result = resolve(r, &image);
        vplImage_Destroy(image);
        TRY(result);
        const double error = r->runner.stats.relativeErrorEstimate;
        done = error >= 0 && error <= o->stop.maxError;
    }
    const double budget = o->stop.budgetMs;
    *doneOut = done || (budget > 0 && vplClockMs() - r->start + r->passMs / r->done > budget);
    return VPL_SUCCESS;
}

vplResult vplRenderer_Step(vplRenderer* r, bool* doneOut)
{
    const double begin = vplClockMs();
    r->runner.stepFrom = shareOf(r, r->done);
    r->runner.stepTo = shareOf(r, r->done + 1);
    const vplRunner before = r->runner;
    const vplResult result = runPass(r);
    if (result == VPL_CANCELLED) { // nothing of the pass counts
        r->runner.stats = before.stats;
        r->runner.loss = before.loss;
        r->stale = r->done > 0;
    }
    TRY(result);
    r->stale = false;
    r->passMs += vplClockMs() - begin;
    r->done++;
    return vplRenderer_IsDone(r, doneOut);
}

void vplRenderer_FinishStats(vplRenderer* r, const vplImage* image, vplRenderStats* statsOut)
{
    vplRenderStats* stats = &r->runner.stats;
    stats->passes = r->done;
    stats->totalMs = vplClockMs() - r->start;
    stats->cpuMs = vplCpuMs() - r->cpuStart;
    stats->peakBytes = vplRunner_PeakBytes(&r->runner);
    stats->imageHash = image != NULL ? vplImage_Hash(image) : 0;
    *statsOut = *stats;
}

vplResult vplRenderer_GetImage(vplRenderer* r, vplImage** imageOut, vplRenderStats* statsOut)
{
    vplImage* image = NULL;
    if (r->done == 0) {
        return vplFail(r->runner.run.context, VPL_INVALID_ARGUMENT,
                       "a renderer has no picture before its first step");
    }
    const vplResult result = resolve(r, &image);
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

void vplRenderer_Destroy(vplRenderer* r)
{
    if (r != NULL) {
        vplContext* context = r->runner.run.context;
        vplImage_Destroy(r->base);
        vplImage_Destroy(r->direct);
        vplFree(context, r->sums[0]);
        vplFree(context, r->sums[1]);
        vplPlan_Destroy(r->plan);
        closeHistory(r->runner.history);
        vplFree(context, r);
    }
}
