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
    def->emission = o->output.show == VPL_SHOW_PICTURE || o->output.show == VPL_SHOW_DIRECT;
    def->pixelCentres = o->path.pixel == VPL_PIXEL_CENTRE;
    def->lastBounce = o->maxBounces >= 0 ? o->maxBounces : VPL_MAX_BOUNCES;
    if (o->output.show == VPL_SHOW_DIRECT) {
        def->lastBounce = 0;
    } else if (o->output.show == VPL_SHOW_INDIRECT) {
        def->firstBounce = 1;
    } else if (o->output.show == VPL_SHOW_BOUNCE) {
        def->firstBounce = o->output.showIndex;
        def->lastBounce = def->lastBounce < o->output.showIndex ? def->lastBounce : o->output.showIndex;
    } else if (o->output.show != VPL_SHOW_PICTURE) {
        return vplFail(job->context, VPL_INVALID_ARGUMENT,
                       "the path tracer can show the picture, direct, indirect and bounce:K only");
    }
    return VPL_SUCCESS;
}

typedef struct PathState {
    vplPathTracer* tracer;
    int done; // samples per pixel
} PathState;

static vplResult begin(vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    PathState* state = job->state = vplAllocZero(job->context, 1, sizeof *state);
    if (state == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplPathDef def = vplDefaultPathDef();
    def.camera = &job->camera;
    def.emitterCount = job->emitterCount;
    def.emitters = job->emitters;
    def.width = o->output.width;
    def.height = o->output.height;
    def.seed = o->seed;
    vplResult result = describe(job, &def);
    return result == VPL_SUCCESS ? vplPathTracer_Create(job->geometry, &def, &state->tracer) : result;
}

static vplResult step(vplJob* job, bool* doneOut)
{
    PathState* state = job->state;
    const int left = job->options.path.samples - state->done;
    const int now = left > 0 && left < VPL_PATH_PASS ? left : VPL_PATH_PASS;
    vplJob_BeginStage(job, 1);
    vplResult result = vplPathTracer_Pass(state->tracer, now, vplJob_GetProgress(job), job, 0, 1);
    vplJob_EndStage(job, "paths");
    state->done += now;
    *doneOut = state->done >= job->options.path.samples;
    return result;
}

static vplResult resolve(vplJob* job)
{
    const PathState* state = job->state;
    vplResult result = vplImage_Create(job->context, job->options.output.width, job->options.output.height, &job->image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplPathStats stats;
    vplPathTracer_Resolve(state->tracer, job->image, &stats);
    job->stats.rays = stats.rays;
    job->stats.errorEstimate = stats.errorEstimate;
    job->stats.relativeErrorEstimate = stats.relativeErrorEstimate;
    return VPL_SUCCESS;
}

static void end(vplJob* job)
{
    PathState* state = job->state;
    if (state != NULL) {
        vplPathTracer_Destroy(state->tracer);
        vplFree(job->context, state);
    }
}

const vplMethodFcns vplPathMethod = {begin, step, resolve, end};
