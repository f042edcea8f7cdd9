// SPDX-License-Identifier: MIT
// A render as a loop of steps, and when it ends: a count, a time or an error estimate.
#include "base/clock.h"
#include "render/render.h"

struct vplRenderer {
    vplJob job;
    const vplMethodFcns* method;
    double start, cpuStart; // ms
    double stepMs;          // of all steps
};

vplResult vplRenderer_Create(const vplScene* scene, const vplRenderOptions* options,
                             vplRenderer** rendererOut)
{
    vplJob job = {0};
    const double start = vplClockMs(), cpuStart = vplCpuMs();
    vplResult result = vplJob_Begin(scene, options, &job);
    vplRenderer* r = result == VPL_SUCCESS ? vplAllocZero(job.context, 1, sizeof *r) : NULL;
    if (r == NULL) {
        vplJob_End(&job);
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    r->job = job;
    r->method = options->method == VPL_METHOD_PATH ? &vplPathMethod : &vplVirtualLightMethod;
    r->start = start;
    r->cpuStart = cpuStart;
    r->job.stats.triangles = job.geometry->triangleCount;
    r->job.stats.objects = job.geometry->objectCount;
    result = r->method->begin(&r->job);
    if (result != VPL_SUCCESS) {
        vplRenderer_Destroy(r);
        return result;
    }
    *rendererOut = r;
    return VPL_SUCCESS;
}

// The share of the whole that so many steps are, as far as it can be told.
static double shareOf(const vplRenderer* r, int steps)
{
    const vplRenderOptions* o = &r->job.options;
    const int count =
        o->method == VPL_METHOD_PATH ? (o->path.samples + VPL_PATH_PASS - 1) / VPL_PATH_PASS : o->stop.passes;
    double share = 0;
    if (count > 0) {
        share = (double)steps / count;
    } else if (o->stop.maxError > 0) {
        share = steps / (steps + 4.0);
    } else if (o->stop.budgetMs <= 0) {
        share = steps;
    }
    if (o->stop.budgetMs > 0) {
        const double spent = (vplClockMs() - r->start) / o->stop.budgetMs;
        share = spent > share ? spent : share;
    }
    return share < 1 ? share : 1;
}

static bool isTimeUp(const vplRenderer* r)
{
    const double budget = r->job.options.stop.budgetMs;
    return budget > 0 && vplClockMs() - r->start + r->stepMs / r->job.stepsDone > budget;
}

static vplResult checkError(vplRenderer* r, bool* doneOut)
{
    vplJob* job = &r->job;
    vplResult result = r->method->resolve(job);
    vplImage_Destroy(job->image);
    job->image = NULL;
    const double error = job->stats.relativeErrorEstimate;
    *doneOut = *doneOut || (error >= 0 && error <= job->options.stop.maxError);
    return result;
}

vplResult vplRenderer_Step(vplRenderer* r, bool* doneOut)
{
    vplJob* job = &r->job;
    const double begin = vplClockMs();
    bool done = false;
    job->stepFrom = shareOf(r, job->stepsDone);
    job->stepTo = shareOf(r, job->stepsDone + 1);
    job->progressTo = 0;
    vplResult result = r->method->step(job, &done);
    if (result != VPL_SUCCESS) {
        return result;
    }
    r->stepMs += vplClockMs() - begin;
    job->stepsDone++;
    if (!done && job->options.stop.maxError > 0) {
        result = checkError(r, &done);
    }
    *doneOut = done || isTimeUp(r);
    return result;
}

vplResult vplRenderer_GetImage(vplRenderer* r, vplImage** imageOut, vplRenderStats* statsOut)
{
    vplJob* job = &r->job;
    if (job->stepsDone == 0) {
        return vplFail(job->context, VPL_INVALID_ARGUMENT, "a renderer has no picture before its first step");
    }
    vplResult result = r->method->resolve(job);
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(job->image);
        job->image = NULL;
        return result;
    }
    if (statsOut != NULL) {
        vplRenderStats* stats = &job->stats;
        stats->passes = job->stepsDone;
        stats->totalMs = vplClockMs() - r->start;
        stats->cpuMs = vplCpuMs() - r->cpuStart;
        stats->peakBytes = vplContext_GetPeakBytes(job->context);
        stats->imageHash = vplImage_Hash(job->image);
        *statsOut = *stats;
    }
    *imageOut = job->image;
    job->image = NULL;
    return VPL_SUCCESS;
}

void vplRenderer_Destroy(vplRenderer* r)
{
    if (r != NULL) {
        vplContext* context = r->job.context;
        r->method->end(&r->job);
        vplImage_Destroy(r->job.image);
        vplJob_End(&r->job);
        vplFree(context, r);
    }
}

vplResult vplRender(const vplScene* scene, const vplRenderOptions* options, vplImage** imageOut,
                    vplRenderStats* statsOut)
{
    vplRenderer* r;
    vplResult result = vplRenderer_Create(scene, options, &r);
    if (result != VPL_SUCCESS) {
        return result;
    }
    for (bool done = false; !done && result == VPL_SUCCESS;) {
        result = vplRenderer_Step(r, &done);
    }
    r->job.last = true;
    if (result == VPL_SUCCESS) {
        result = vplRenderer_GetImage(r, imageOut, statsOut);
    }
    const vplRenderStats* stats = &r->job.stats;
    if (result == VPL_SUCCESS && stats->errorEstimate >= 0) {
        vplLog(r->job.context, VPL_LOG_INFO, "remaining error about %.3g W/(m^2 sr), %.3g %% of the mean",
               stats->errorEstimate, 100 * stats->relativeErrorEstimate);
    }
    vplRenderer_Destroy(r);
    return result;
}
