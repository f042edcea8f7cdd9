// SPDX-License-Identifier: MIT
// The picture of the passes so far, its layers and its statistics.
#include "base/clock.h"
#include "image/enlarge.h"
#include "render/renderer.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>
#include <string.h>

// The noise of the mean of passes whose variance is that of a whole pass over their share of it. Errors that all passes
// have alike (of direct light, and light that the accumulation loses or moves) are not in it.
static void estimateNoise(vplRenderer* r, const vplImage* image)
{
    const size_t values = vplValueCount(image);
    double variance = 0, sum = 0;
    double traced = 0;
    for (size_t k = 0; k < values && r->done > 1; k++) {
        const double paths = r->edges != NULL ? vplEdges_VarianceAt(r->edges, k / 3) : -1;
        traced += fmax(0, paths);
        variance += paths >= 0 ? 0 : fmax(0, r->sums[1][k] - r->sums[0][k] * r->sums[0][k] / r->weight);
        sum += (double)image->pixels[k];
    }
    if (r->done > 1) {
        const double noise =
            sqrt(variance / (double)values / (r->done - 1) / r->weight + traced / (double)values);
        r->error.noise = sum > 0 ? noise * (double)values / sum : 0;
    }
}

// Makes the results of the last pass up to `last` again.
static vplResult refresh(vplRenderer* r, vplStageId last)
{
    const vplRenderStats before = r->runner.stats;
    r->runner.run.pass = r->done - 1;
    const vplResult result = vplRunner_RunPlan(&r->runner, r->plan, last);
    r->runner.stats = before;
    r->stale = result != VPL_SUCCESS;
    return result;
}

// Makes the virtual lights of the last pass again, for marks on the picture, where a pass was cancelled or
// the render was loaded since.
static vplResult refreshLights(vplRenderer* r)
{
    vplProgressFcn* progress = r->runner.progress;
    if (!r->stale || VPL_SHOWS[r->plan->options.output.show].drawOver == NULL) {
        return VPL_SUCCESS;
    }
    r->runner.progress = NULL; // it is short, and not part of a pass
    const vplResult result = refresh(r, VPL_STAGE_VIRTUAL_LIGHTS);
    r->runner.progress = progress;
    return result;
}

vplResult vplRenderer_RefreshPatches(vplRenderer* r)
{
    return r->stale && r->plan->options.method == VPL_METHOD_RADIOSITY ? refresh(r, VPL_STAGE_SOLUTION)
                                                                       : VPL_SUCCESS;
}

// The picture of the passes.
static vplResult resolvePasses(vplRenderer* r, vplImage** imageOut)
{
    vplRun* run = &r->runner.run;
    const vplShowRow* show = &VPL_SHOWS[r->plan->options.output.show];
    TRY(r->plan->progressive ? refreshLights(r) : VPL_SUCCESS);
    TRY(vplImage_Create(run->context, r->base->width, r->base->height, imageOut));
    for (size_t k = 0; k < vplValueCount(r->base); k++) {
        const double mean = r->plan->progressive ? r->sums[0][k] / r->weight : 0;
        (*imageOut)->pixels[k] = (float)((double)r->base->pixels[k] + mean);
    }
    if (r->edges != NULL) {
        vplEdges_Draw(r->edges, *imageOut);
    }
    if (r->plan->progressive) {
        estimateNoise(r, *imageOut);
    }
    return r->plan->progressive && show->drawOver != NULL ? show->drawOver(run, *imageOut) : VPL_SUCCESS;
}

// Paths have no error but noise. Where a pixel is rendered for several of the picture, the error of interpolating between them is unknown.
static vplResult resolvePaths(vplRenderer* r, vplImage** imageOut)
{
    TRY(vplResolvePaths(&r->runner.run, imageOut));
    r->error.noise = r->runner.run.stats->relativeErrorEstimate;
    const bool all = r->plan->options.output.pixelSize == 1;
    r->error.total = all ? r->error.noise : -1;
    r->error.bound = all ? 1.06 * r->error.noise : -1;
    return VPL_SUCCESS;
}

// The picture in the size in which it is rendered.
static vplResult resolveSmall(vplRenderer* r, vplImage** imageOut)
{
    return r->plan->options.method == VPL_METHOD_PATH ? resolvePaths(r, imageOut)
                                                      : resolvePasses(r, imageOut);
}

vplResult vplRenderer_Resolve(vplRenderer* r, vplImage** imageOut)
{
    const vplOutputOptions* o = &r->plan->options.output;
    if (o->pixelSize == 1) {
        return resolveSmall(r, imageOut);
    }
    vplImage* small = NULL;
    vplResult result = resolveSmall(r, &small);
    result = result == VPL_SUCCESS ? vplImage_Enlarge(small, o->width, o->height, imageOut) : result;
    vplImage_Destroy(small);
    return result;
}

// Direct light alone of all passes so far; NULL where light is not split.
static vplResult resolveDirect(vplRenderer* r, vplImage** imageOut)
{
    const vplOutputOptions* o = &r->plan->options.output;
    if (!r->plan->splitsLight) {
        return VPL_SUCCESS;
    }
    if (r->plan->options.method == VPL_METHOD_PATH) {
        return vplResolveDirectPaths(&r->runner.run, imageOut);
    }
    TRY(vplImage_Create(r->runner.run.context, o->width, o->height, imageOut));
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
    const double error = e->total >= 0 ? e->total : e->noise;
    stats->relativeErrorEstimate = isfinite(error) ? error : -1; // a black picture has none
    stats->errorEstimate = stats->relativeErrorEstimate >= 0 ? stats->relativeErrorEstimate * sum : -1;
    stats->relativeErrorBound = stats->relativeErrorEstimate < 0 ? -1 : e->bound;
    stats->relativeNoise = e->noise;
    stats->relativeBias = vplRenderer_GetPlan(r)->options.method == VPL_METHOD_PATH ? 0
                          : stats->relativeErrorEstimate < 0                        ? -1
                          : e->total >= 0 && e->noise >= 0
                              ? sqrt(fmax(0, e->total * e->total - e->noise * e->noise))
                              : e->total;
    stats->truthPaths = r->truth != NULL ? vplTruth_Paths(r->truth) : 0;
    stats->totalMs = vplClockMs() - r->start;
    stats->cpuMs = vplCpuMs() - r->cpuStart;
    stats->peakBytes = vplRunner_PeakBytes(&r->runner);
    stats->imageHash = image != NULL ? vplImage_Hash(image) : 0;
    *statsOut = *stats;
    statsOut->rays += r->otherRays + vplTruth_Rays(r->truth); // which no plan counts as its own
}

vplShown vplRenderer_Shown(const vplRenderer* r)
{
    const vplKeptPicture* kept = &r->kept;
    return kept->image != NULL && (r->showsKept || r->done == 0)
               ? (vplShown){kept->plan, kept->passes, kept->paths, kept->edgePixels, kept->edgePaths}
               : (vplShown){r->plan, r->done, r->paths, r->edgePixels, r->edgePaths};
}

int vplRenderer_GetPassCount(const vplRenderer* r)
{
    if (r == NULL) {
        return 0;
    }
    return vplRenderer_Shown(r).passes;
}

const vplPlan* vplRenderer_GetPlan(const vplRenderer* r)
{
    if (r == NULL) {
        return NULL;
    }
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
    REQUIRE(vplRenderer_ContextOf(r), r, imageOut);
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
    REQUIRE(vplRenderer_ContextOf(r), r, layersOut);
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
