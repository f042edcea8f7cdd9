// SPDX-License-Identifier: MIT
// The public calls: a picture, layers, virtual lights or patches in one call.
#include "base/team.h"
#include "math/scalar.h"
#include "render/planner/planner.h"
#include "render/renderer.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

// ---- pictures

// Takes the last picture. Where no pass follows it is given away without a copy.
static vplResult takeImage(vplRenderer* r, vplImage** imageOut, vplRenderStats* statsOut)
{
    if (r->plan == NULL || r->plan->progressive || r->plan->options.method == VPL_METHOD_PATH ||
        r->kept.image != NULL || r->edges != NULL || r->plan->options.output.pixelSize > 1) {
        return vplRenderer_GetImage(r, imageOut, statsOut);
    }
    if (r->base == NULL) {
        return vplFail(r->runner.run.context, VPL_INVALID_ARGUMENT,
                       "a renderer has no picture before its first step or after its last was taken");
    }
    *imageOut = r->base;
    r->base = NULL;
    if (statsOut != NULL) {
        vplRenderer_FinishStats(r, *imageOut, statsOut);
    }
    return VPL_SUCCESS;
}

// Says how exact the picture is, and warns where it is not as exact as was asked for.
static void sayError(const vplRenderer* r, double asked)
{
    const vplErrorParts* e = &r->error;
    const double reached = e->total >= 0 ? e->total : e->noise;
    vplContext* context = r->runner.run.context;
    const char* why = r->ended[0] != 0         ? r->ended
                      : r->deadline < INFINITY ? "--budget ended the render"
                                               : "--passes or --spp ended the render";
    if (asked > 0 && reached < 0 && vplShowsLight(r->asked.output.show)) {
        vplLog(context, VPL_LOG_WARNING, "the error is not known, and %.3g %% was asked for: %s", 100 * asked,
               why);
    } else if (asked > 0 && reached >= 0 && !(e->bound >= 0 && e->bound <= asked)) {
        vplLog(context, VPL_LOG_WARNING,
               "the error is about %.3g %%, not surely below the %.3g %% asked for: %s", 100 * reached,
               100 * asked, why);
    } else if (reached >= 0) {
        vplLog(context, VPL_LOG_INFO,
               e->bound >= 0 ? "the error is about %.3g %%, and probably below %.3g %%"
                             : "the error is about %.3g %%",
               100 * reached, 100 * e->bound);
    }
}

vplResult vplRenderer_Finish(vplRenderer* r, vplImage** imageOut, vplLayers** layersOut,
                             vplRenderStats* statsOut)
{
    REQUIRE(NULL, r);
    if (layersOut == NULL) {
        CHECK_POINTERS(r->runner.run.context, imageOut);
    }
    TRY(layersOut != NULL ? vplRenderer_GetLayers(r, layersOut, statsOut) : takeImage(r, imageOut, statsOut));
    sayError(r, r->asked.stop.maxError);
    return VPL_SUCCESS;
}

// Renders the picture, or where layersOut is not NULL layers.
static vplResult render(const vplScene* scene, const vplRenderOptions* options, vplImage** imageOut,
                        vplLayers** layersOut, vplRenderStats* statsOut)
{
    vplRenderer* r;
    TRY(vplRenderer_Create(scene, options, &r));
    vplResult result = VPL_SUCCESS;
    for (bool done = false; !done && result == VPL_SUCCESS;) {
        result = vplRenderer_Step(r, &done);
    }
    result = result == VPL_SUCCESS ? vplRenderer_Finish(r, imageOut, layersOut, statsOut) : result;
    vplRenderer_Destroy(r);
    return result;
}

vplResult vplRender(const vplScene* scene, const vplRenderOptions* options, vplImage** imageOut,
                    vplRenderStats* statsOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, options, imageOut);
    vplRenderOptions o = *options;
    o.output.aovs = 0;
    return render(scene, &o, imageOut, NULL, statsOut);
}

vplResult vplRenderLayers(const vplScene* scene, const vplRenderOptions* options, vplLayers** layersOut,
                          vplRenderStats* statsOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, options, layersOut);
    return render(scene, options, NULL, layersOut, statsOut);
}

// ---- into the caller's memory

static vplResult checkTargets(const vplScene* scene, const vplTarget* targets, int count, int* aovsOut)
{
    *aovsOut = 0;
    for (int i = 0; i < count; i++) {
        const int layer = targets[i].layer;
        if (layer != 0 && ((layer & VPL_AOV_ALL) != layer || (layer & (layer - 1)) != 0)) {
            return vplFail(vplScene_GetContext(scene), VPL_INVALID_ARGUMENT,
                           "vplRenderTo: targets[%d].layer is %d, must be 0 or one vplAov", i, layer);
        }
        *aovsOut |= layer;
    }
    return VPL_SUCCESS;
}

// Copies each layer to the target that asks for it. Layers lie behind the picture in the order of vplAov.
static vplResult copyLayers(const vplLayers* layers, int aovs, const vplTarget* targets, int count)
{
    for (int i = 0; i < count; i++) {
        const int before =
            targets[i].layer > 0 ? 1 + __builtin_popcount((unsigned)(aovs & (targets[i].layer - 1))) : 0;
        TRY(vplImage_CopyTo(layers->layers[before].image, &targets[i].pixels));
    }
    return VPL_SUCCESS;
}

vplResult vplRenderTo(const vplScene* scene, const vplRenderOptions* options, const vplTarget* targets,
                      int targetCount, int* passesOut, vplRenderStats* statsOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, options);
    REQUIRE_ARRAY(vplScene_GetContext(scene), targets, targetCount);
    vplRenderOptions o = *options;
    vplLayers* layers = NULL;
    vplRenderer* r;
    if (passesOut != NULL) {
        *passesOut = 0;
    }
    TRY(checkTargets(scene, targets, targetCount, &o.output.aovs));
    TRY(vplRenderer_Create(scene, &o, &r));
    vplResult result = VPL_SUCCESS;
    for (bool done = false; !done && result == VPL_SUCCESS;) {
        result = vplRenderer_Step(r, &done);
    }
    const int passes = vplRenderer_GetPassCount(r);
    if (result == VPL_SUCCESS || (result == VPL_CANCELLED && passes > 0)) {
        const vplResult ended = result;
        r->asked.progress =
            ended == VPL_CANCELLED ? NULL : r->asked.progress; // it would cancel the layers, too
        result = vplRenderer_Finish(r, NULL, &layers, statsOut);
        result = result == VPL_SUCCESS ? copyLayers(layers, o.output.aovs, targets, targetCount) : result;
        if (result == VPL_SUCCESS) {
            result = ended;
            if (passesOut != NULL) {
                *passesOut = passes;
            }
        }
    }
    vplLayers_Destroy(layers);
    vplRenderer_Destroy(r);
    return result;
}

// ---- other results of the same stages

// Opens a renderer of the options' picture by a method, of which only some stages will be run: no time or error ends it.
static vplResult openForStages(const vplScene* scene, const vplRenderOptions* options, vplMethod method,
                               vplRenderer** rendererOut)
{
    vplRenderOptions o = *options;
    o.method = method;
    o.output.show = VPL_SHOW_PICTURE;
    o.output.aovs = 0;
    o.stop.budgetMs = o.stop.maxError = 0;
    o.stop.growFrom = o.stop.passes > 0 ? o.stop.growFrom : 0;
    o.stop.quality = VPL_QUALITY_NONE;
    return vplRenderer_Create(scene, &o, rendererOut);
}

vplResult vplMakeLights(const vplScene* scene, const vplRenderOptions* options, vplLightSet** setOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, options, setOut);
    vplMethod method = options->method == VPL_METHOD_AUTO ? vplFirstMethodFor(options) : options->method;
    const bool ssvp = method == VPL_METHOD_SSVP;
    const vplStageId stage = ssvp ? VPL_STAGE_CLUSTERED_LIGHTS : VPL_STAGE_PARTICLES;
    vplRenderer* r;
    if (!ssvp && method != VPL_METHOD_KELLER) {
        method = VPL_METHOD_INSTANT_RADIOSITY;
    }
    TRY(openForStages(scene, options, method, &r));
    const vplResult result = vplRunner_RunPlan(&r->runner, r->plan, stage);
    if (result == VPL_SUCCESS && ssvp) {
        vplClusteredLights* lights = r->runner.history->slots[stage].result;
        *setOut = lights->set;
        lights->set = NULL;
    } else if (result == VPL_SUCCESS) {
        *setOut = vplRunner_Take(&r->runner, stage);
    }
    vplRenderer_Destroy(r);
    return result;
}

vplResult vplBake(const vplScene* scene, const vplRenderOptions* options, float exposure, const char* path,
                  vplRenderStats* statsOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, options, path);
    const float scale = (float)(vplPow(2, (double)exposure) / VPL_PI); // radiance, as pictures have it
    vplRenderOptions all = *options;
    vplRenderer* r;
    all.radiosity.faintSides = VPL_FAINT_SIDES_KEEP; // a mesh is for all cameras
    TRY(openForStages(scene, &all, VPL_METHOD_RADIOSITY, &r));
    vplResult result = vplRunner_RunPlan(&r->runner, r->plan, VPL_STAGE_SOLUTION);
    if (result == VPL_SUCCESS) {
        vplArena* scratch = vplArena_Create(r->runner.run.context);
        result = vplWritePatchMesh(&r->runner.run, scratch, scale, path);
        vplArena_Destroy(scratch);
        result = vplTeam_Agree(r->runner.run.context, result);
    }
    if (result == VPL_SUCCESS && statsOut != NULL) {
        vplRenderer_FinishStats(r, NULL, statsOut);
    }
    vplRenderer_Destroy(r);
    return result;
}
