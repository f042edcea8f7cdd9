// SPDX-License-Identifier: MIT
// Path tracing: each pass adds paths to all pixels. --show chooses a range of bounces.
#include "reference/light_path.h"
#include "reference/path_trace.h"
#include "render/options.h"
#include "render/runner.h"
#include "render/stages/make.h"

// A pass of large pictures takes a few seconds, too.
enum { PATHS_OF_PASS = 4000000 };

int vplPathsOfPass(const vplPlan* plan)
{
    const int64_t fit = PATHS_OF_PASS / (int64_t)vplCountPixels(&plan->options.output);
    return fit < 1 ? 1 : fit < VPL_PATHS_PER_PASS ? (int)fit : VPL_PATHS_PER_PASS;
}

int vplCountPathPasses(const vplPlan* plan)
{
    const int each = vplPathsOfPass(plan);
    return (int)(((int64_t)plan->options.path.samples + each - 1) / each);
}

// The result of the stage.
typedef struct Paths {
    vplPathTracer* picture;
    vplPathTracer* direct; // the same paths up to their first hit; NULL: no layer needs it
} Paths;

_Static_assert(VPL_MAX_LIGHT_VERTICES == (int)VPL_MOST_LIGHT_VERTICES, "the option allows what a path holds");

int vplCountLightVertices(const vplRun* run)
{
    const int given = run->plan->options.path.lightVertices;
    const double* further = run->results[VPL_STAGE_LIGHT_PATHS];
    return given >= 0 ? given : further != NULL && *further > VPL_FURTHER_SHARE ? VPL_MAX_LIGHT_VERTICES : 1;
}

vplPathDef vplDescribePaths(const vplRun* run, vplShow show)
{
    const vplPlan* plan = run->plan;
    const vplRenderOptions* o = &plan->options;
    vplPathDef def = vplDefaultPathDef();
    def.camera = &plan->camera;
    def.emitterCount = plan->emitterCount;
    def.emitters = plan->emitters;
    def.width = o->output.width;
    def.height = o->output.height;
    def.seed = o->seed;
    def.emission = show == VPL_SHOW_PICTURE || show == VPL_SHOW_DIRECT;
    def.pixelCentres = o->path.pixel == VPL_PIXEL_CENTRE;
    def.lightVertices = vplCountLightVertices(run);
    def.lastBounce = def.mostBounces = o->maxBounces >= 0 ? o->maxBounces : VPL_MAX_BOUNCES;
    if (show == VPL_SHOW_DIRECT) {
        def.lastBounce = 0;
    } else if (show == VPL_SHOW_INDIRECT) {
        def.firstBounce = 1;
    } else if (show == VPL_SHOW_BOUNCE) {
        def.firstBounce = o->output.showIndex;
        def.lastBounce = def.lastBounce < def.firstBounce ? def.lastBounce : def.firstBounce;
    }
    return def;
}

vplResult vplMakeLightPaths(const vplRun* run, void** resultOut)
{
    double* further = vplArena_Alloc(run->arena, 1, sizeof *further);
    TRY(vplArena_Check(run->arena));
    *resultOut = further;
    const vplPathDef def = vplDescribePaths(run, VPL_SHOW_PICTURE);
    TRY(vplMeasureFurther(run->results[VPL_STAGE_GEOMETRY], &def, further));
    vplLog(run->context, VPL_LOG_INFO, "%.0f %% of reflected light is found at later vertices of light paths",
           100 * *further);
    return VPL_SUCCESS;
}

vplResult vplFindLightVertices(const vplRun* run)
{
    return run->plan->options.path.lightVertices < 0 ? vplRunner_RunStage(run->runner, VPL_STAGE_LIGHT_PATHS)
                                                     : VPL_SUCCESS;
}

static vplResult createPaths(const vplRun* run, Paths* paths)
{
    const vplPlan* plan = run->plan;
    const vplGeometry* g = run->results[VPL_STAGE_GEOMETRY];
    vplPathDef picture = vplDescribePaths(run, plan->options.output.show),
               direct = vplDescribePaths(run, VPL_SHOW_DIRECT);
    picture.width = direct.width = vplRenderedWidth(&plan->options.output);
    picture.height = direct.height = vplRenderedHeight(&plan->options.output);
    picture.firstRow = direct.firstRow = run->firstRow;
    picture.endRow = direct.endRow = run->endRow;
    picture.trees = direct.trees = run->results[VPL_STAGE_EMITTER_TREES];
    TRY(vplPathTracer_Create(g, &picture, &paths->picture));
    return plan->splitsLight ? vplPathTracer_Create(g, &direct, &paths->direct) : VPL_SUCCESS;
}

// Pass 0 creates tracers; later passes add paths to them. Both tracers have the same paths after a pass that
// is cancelled, too.
vplResult vplMakePaths(const vplRun* run, void** resultOut)
{
    Paths* paths = run->pass > 0 ? run->before : NULL;
    if (paths == NULL) {
        paths = vplArena_AllocZero(run->arena, 1, sizeof *paths);
        TRY(vplArena_Check(run->arena));
        *resultOut = paths;
        TRY(createPaths(run, paths));
    }
    *resultOut = paths;
    const int samples = run->samples;
    const double share = paths->direct != NULL ? 0.3 : 0; // of the time, about
    if (samples > 0 && paths->direct != NULL) {
        TRY(vplPathTracer_Pass(paths->direct, samples, run->progress, run->runner, 0, share));
    }
    const vplResult result =
        samples > 0 ? vplPathTracer_Pass(paths->picture, samples, run->progress, run->runner, share, 1)
                    : VPL_SUCCESS;
    if (result == VPL_CANCELLED && paths->direct != NULL) {
        vplPathTracer_Undo(paths->direct);
    }
    return result;
}

void vplDestroyPaths(void* result)
{
    Paths* paths = result;
    vplPathTracer_Destroy(paths->picture);
    vplPathTracer_Destroy(paths->direct);
}

vplResult vplResolvePaths(const vplRun* run, vplImage** imageOut)
{
    const Paths* paths = run->results[VPL_STAGE_PATHS];
    const vplOutputOptions* o = &run->plan->options.output;
    vplPathStats stats;
    TRY(vplImage_Create(run->context, vplRenderedWidth(o), vplRenderedHeight(o), imageOut));
    vplPathTracer_Resolve(paths->picture, *imageOut, &stats);
    run->stats->rays = stats.rays;
    run->stats->errorEstimate = stats.errorEstimate;
    run->stats->relativeErrorEstimate = stats.relativeErrorEstimate;
    return VPL_SUCCESS;
}

vplResult vplResolveDirectPaths(const vplRun* run, vplImage** imageOut)
{
    const Paths* paths = run->results[VPL_STAGE_PATHS];
    const vplOutputOptions* o = &run->plan->options.output;
    vplPathStats stats;
    TRY(vplImage_Create(run->context, o->width, o->height, imageOut));
    vplPathTracer_Resolve(paths->direct, *imageOut, &stats);
    run->stats->rays += stats.rays;
    return VPL_SUCCESS;
}

vplPathTracer* vplGetPathTracer(const vplRun* run, bool direct)
{
    const Paths* paths = run->results[VPL_STAGE_PATHS];
    return direct ? paths->direct : paths->picture;
}
