// SPDX-License-Identifier: MIT
// The steps of a render: each runs the stages of one pass, adds it to the picture, and asks what follows.
#include "base/clock.h"
#include "render/renderer.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "scene/scene.h"

#include <math.h>

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
    vplContext* context = r->runner.run.context;
    const size_t values = vplValueCount(r->base);
    const vplWatch outer =
        vplSetWatch(context, r->runner.progress, r->runner.progressUser, r->runner.reported);
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < 2 && result == VPL_SUCCESS; i++) {
        vplFree(context, r->sums[i]); // of a first pass that was cancelled
        r->sums[i] = vplAlloc(context, values, sizeof *r->sums[i]);
        result = r->sums[i] != NULL ? vplClear(context, r->sums[i], values * sizeof *r->sums[i])
                                    : VPL_OUT_OF_MEMORY;
    }
    context->watch = outer;
    return result;
}

bool vplPassesSplitLight(const vplPlan* p)
{
    const bool onSurfaces = p->options.method == VPL_METHOD_KELLER && (p->hasAreaLights || p->hasSky);
    return p->splitsLight && (!p->progressive || onSurfaces);
}

vplResult vplRenderer_DrawDirect(vplRenderer* r, vplImage** imageOut)
{
    r->runner.run.parts = VPL_PART_EMITTER_LIGHTS | (r->plan->progressive ? 0 : VPL_PART_DIRECT);
    TRY(vplRunner_RunStage(&r->runner, VPL_STAGE_PICTURE));
    *imageOut = vplRunner_Take(&r->runner, VPL_STAGE_PICTURE);
    return VPL_SUCCESS;
}

// Adds the direct light of a pass to that of the passes before.
static vplResult addDirect(vplRenderer* r)
{
    const vplPlan* p = r->plan;
    vplImage *image, *before = r->direct;
    if (!vplPassesSplitLight(p)) {
        return VPL_SUCCESS;
    }
    TRY(vplRenderer_DrawDirect(r, &image));
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

vplResult vplRenderer_RunPass(vplRenderer* r)
{
    TRY(runPass(r));
    vplRenderer_ForgetEdges(r); // not before: if the pass is cancelled, the picture with them stays
    return VPL_SUCCESS;
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
    REQUIRE(vplRenderer_ContextOf(r), r, doneOut);
    const double begin = vplClockMs();
    if (r->stamp != r->runner.run.scene->stamp) {
        return vplFail(r->runner.run.context, VPL_INVALID_ARGUMENT,
                       "vplRenderer_Step: the scene was changed since the renderer was created");
    }
    r->runner.stepFrom = shareOf(r, r->done);
    r->runner.stepTo = shareOf(r, r->done + !r->unreviewed);
    if (r->unreviewed) {
        return review(r, doneOut);
    }
    const vplRunner before = r->runner;
    const vplResult result = vplRenderer_RunPass(r);
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
    r->edgeTries = 0;
    r->done++;
    return review(r, doneOut);
}
