// SPDX-License-Identifier: MIT
// Path tracing: each pass adds paths to all pixels. --show chooses a range of bounces.
#include "reference/path_trace.h"
#include "render/stages/make.h"

// Paths per pixel in a pass, large enough that threads seldom wait for each other.
enum { PASS_SAMPLES = 32 };

int vplCountPathPasses(const vplPlan* plan)
{
    return (plan->options.path.samples + PASS_SAMPLES - 1) / PASS_SAMPLES;
}

static vplPathDef describe(const vplPlan* plan)
{
    const vplRenderOptions* o = &plan->options;
    vplPathDef def = vplDefaultPathDef();
    def.camera = &plan->camera;
    def.emitterCount = plan->emitterCount;
    def.emitters = plan->emitters;
    def.width = o->output.width;
    def.height = o->output.height;
    def.seed = o->seed;
    def.emission = o->output.show == VPL_SHOW_PICTURE || o->output.show == VPL_SHOW_DIRECT;
    def.pixelCentres = o->path.pixel == VPL_PIXEL_CENTRE;
    def.lastBounce = o->maxBounces >= 0 ? o->maxBounces : VPL_MAX_BOUNCES;
    if (o->output.show == VPL_SHOW_DIRECT) {
        def.lastBounce = 0;
    } else if (o->output.show == VPL_SHOW_INDIRECT) {
        def.firstBounce = 1;
    } else if (o->output.show == VPL_SHOW_BOUNCE) {
        def.firstBounce = o->output.showIndex;
        def.lastBounce = def.lastBounce < def.firstBounce ? def.lastBounce : def.firstBounce;
    }
    return def;
}

// Pass 0 creates a tracer; later passes add paths to it.
vplResult vplMakePaths(const vplRun* run, void** resultOut)
{
    vplPathTracer* tracer = run->pass > 0 ? run->before : NULL;
    if (tracer == NULL) {
        const vplPathDef def = describe(run->plan);
        TRY(vplPathTracer_Create(run->results[VPL_STAGE_GEOMETRY], &def, &tracer));
    }
    const int left = run->plan->options.path.samples - run->pass * PASS_SAMPLES;
    const int samples = left > 0 && left < PASS_SAMPLES ? left : PASS_SAMPLES;
    *resultOut = tracer;
    return vplPathTracer_Pass(tracer, samples, run->progress, run->runner, 0, 1);
}

void vplDestroyPaths(void* result)
{
    vplPathTracer_Destroy(result);
}

vplResult vplResolvePaths(const vplRun* run, vplImage** imageOut)
{
    const vplOutputOptions* o = &run->plan->options.output;
    vplPathStats stats;
    TRY(vplImage_Create(run->context, o->width, o->height, imageOut));
    vplPathTracer_Resolve(run->results[VPL_STAGE_PATHS], *imageOut, &stats);
    run->stats->rays = stats.rays;
    run->stats->errorEstimate = stats.errorEstimate;
    run->stats->relativeErrorEstimate = stats.relativeErrorEstimate;
    return VPL_SUCCESS;
}
