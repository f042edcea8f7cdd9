// SPDX-License-Identifier: MIT
// Path tracing: passes over the whole picture, then their mean. What `show` asks for is a range of bounces.
#include "reference/path_trace.h"
#include "render/render.h"

static vplResult describe(vplJob* job, vplPathDef* def)
{
    const vplRenderOptions* o = &job->options;
    if (o->lighting != VPL_LIGHTING_PHYSICAL) {
        return vplFail(job->context, VPL_INVALID_ARGUMENT,
                       "the path tracer knows physical lighting only, not documented");
    }
    def->emission = o->show == VPL_SHOW_PICTURE || o->show == VPL_SHOW_DIRECT;
    def->pixelCentres = o->pixel == VPL_PIXEL_CENTRE;
    def->lastBounce = o->maxBounces >= 0 ? o->maxBounces : VPL_MAX_BOUNCES;
    if (o->show == VPL_SHOW_DIRECT) {
        def->lastBounce = 0;
    } else if (o->show == VPL_SHOW_INDIRECT) {
        def->firstBounce = 1;
    } else if (o->show == VPL_SHOW_BOUNCE) {
        def->firstBounce = o->showBounce;
        def->lastBounce = def->lastBounce < o->showBounce ? def->lastBounce : o->showBounce;
    } else if (o->show != VPL_SHOW_PICTURE) {
        return vplFail(job->context, VPL_INVALID_ARGUMENT,
                       "the path tracer can show the picture, direct, indirect and bounce:K only");
    }
    return VPL_SUCCESS;
}

// Samples per pixel between two looks at the clock, large enough that threads seldom wait for each other.
enum { PASS = 32 };

static vplResult trace(vplJob* job, vplPathTracer* tracer)
{
    const int samples = job->options.samplesPerPixel;
    vplResult result = VPL_SUCCESS;
    for (int done = 0; done < samples && result == VPL_SUCCESS; done += PASS) {
        int now = samples - done < PASS ? samples - done : PASS;
        result = vplPathTracer_Pass(tracer, now, vplJob_GetProgress(job), job, (double)done / samples,
                                    (double)(done + now) / samples);
    }
    return result;
}

static vplResult resolve(vplJob* job, const vplPathTracer* tracer)
{
    vplResult result = vplImage_Create(job->context, job->options.width, job->options.height, &job->image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplPathStats stats;
    vplPathTracer_Resolve(tracer, job->image, &stats);
    job->stats.rays = stats.rays;
    job->stats.errorEstimate = stats.errorEstimate;
    job->stats.relativeErrorEstimate = stats.relativeErrorEstimate;
    if (stats.errorEstimate >= 0) {
        vplLog(job->context, VPL_LOG_INFO, "remaining error about %.3g W/(m^2 sr), %.3g %% of the mean",
               stats.errorEstimate, 100 * stats.relativeErrorEstimate);
    }
    return VPL_SUCCESS;
}

vplResult vplRenderPath(vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    vplPathDef def = vplDefaultPathDef();
    def.camera = vplScene_GetCamera(job->scene, o->camera);
    def.emitterCount = vplScene_GetEmitterCount(job->scene);
    def.emitters = def.emitterCount ? vplScene_GetEmitter(job->scene, 0) : NULL;
    def.width = o->width;
    def.height = o->height;
    def.seed = o->seed;
    vplPathTracer* tracer = NULL;
    vplResult result = describe(job, &def);
    vplJob_BeginStage(job, 1);
    if (result == VPL_SUCCESS) {
        result = vplPathTracer_Create(job->geometry, &def, &tracer);
    }
    if (result == VPL_SUCCESS) {
        result = trace(job, tracer);
    }
    if (result == VPL_SUCCESS) {
        result = resolve(job, tracer);
    }
    vplJob_EndStage(job, "paths");
    vplPathTracer_Destroy(tracer);
    return result;
}
