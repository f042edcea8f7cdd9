// SPDX-License-Identifier: MIT
#include "render/render.h"

#include <math.h>

enum { OPTIONS_COOKIE = 0x56504c70 };

vplRenderOptions vplDefaultRenderOptions(void)
{
    vplRenderOptions o = {0};
    o.width = 1280;
    o.height = 720;
    o.antialias = 1;
    o.particles = 10;
    o.reflectivity = 0.5;
    o.accumulation = VPL_ACCUMULATE_USUAL;
    o.batch = 64;
    o.interleave = 4;
    o.cutError = 0.02f;
    o.minDistance = -1;
    o.lightMapSize = 256;
    o.areaLightSamples = 64;
    o.samplesPerPixel = 64;
    o.maxBounces = -1;
    o.shadowMapSize = 1024;
    o.shadow = vplDefaultShadowDef();
    o.clusters = 8;
    o.firstBounce = o.secondBounce = 256;
    o.oversampling = 16;
    o.paraboloidSize = 128;
    o.hemispheres = 1;
    o.w1 = 0.6;
    o.w2 = 0.4;
    o.coherence = VPL_COHERENCE_ON;
    o.patches = 2000;
    o.subdivisions = VPL_MAX_PATCH_ROUNDS;
    o.formSamples = 4;
    o.linkError = vplDefaultLinkDef().error;
    o.iterations = 100;
    o.sharpen = 4;
    o.residual = 1e-4;
    o.cookie = OPTIONS_COOKIE;
    return o;
}

static vplResult checkInt(const vplContext* context, const char* name, int value, int low, int high)
{
    return value >= low && value <= high
               ? VPL_SUCCESS
               : vplFail(context, VPL_INVALID_ARGUMENT, "vplRenderOptions.%s is %d, must be in [%d, %d]",
                         name, value, low, high);
}

// `cameras` of the scene, 1 or more.
static vplResult checkInts(const vplContext* context, const vplRenderOptions* o, int cameras)
{
    const struct {
        const char* name;
        int value, low, high;
    } ints[] = {
        {"method", (int)o->method, 0, VPL_METHOD_RADIOSITY},
        {"lighting", (int)o->lighting, 0, VPL_LIGHTING_DOCUMENTED},
        {"width", o->width, 1, VPL_MAX_IMAGE_SIZE},
        {"height", o->height, 1, VPL_MAX_IMAGE_SIZE},
        {"antialias", o->antialias, 1, 4096},
        {"camera", o->camera, 0, cameras - 1},
        {"particles", o->particles, 0, VPL_MAX_LIGHTS},
        {"sampler", (int)o->sampler, 0, VPL_SAMPLER_HAMMERSLEY},
        {"bounce", (int)o->bounce, 0, VPL_BOUNCE_DIFFUSE},
        {"placement", (int)o->placement, 0, VPL_PLACEMENT_VIEW},
        {"rsmSize", o->rsmSize, 0, VPL_MAX_SHADOW_MAP},
        {"accumulation", (int)o->accumulation, 0, VPL_ACCUMULATE_USUAL},
        {"batch", o->batch, 1, VPL_MAX_LIGHTS},
        {"interleave", o->interleave, 1, VPL_MAX_INTERLEAVE},
        {"particleGeometry", (int)o->particleGeometry, 0, VPL_PARTICLE_GEOMETRY_OBB},
        {"lightShadows", (int)o->lightShadows, 0, VPL_LIGHT_SHADOWS_CLUSTER},
        {"compensation", (int)o->compensation, 0, VPL_COMPENSATION_RAYS},
        {"passes", o->passes, 0, VPL_MAX_PASSES},
        {"lightMapSize", o->lightMapSize, 1, VPL_MAX_SHADOW_MAP},
        {"areaLightSamples", o->areaLightSamples, 1, VPL_MAX_LIGHTS},
        {"samplesPerPixel", o->samplesPerPixel, 1, VPL_MAX_SAMPLES},
        {"maxBounces", o->maxBounces, -1, VPL_MAX_BOUNCES},
        {"pixel", (int)o->pixel, 0, VPL_PIXEL_CENTRE},
        {"showBounce", o->showBounce, 0, VPL_MAX_BOUNCES},
        {"shadowMapSize", o->shadowMapSize, 1, VPL_MAX_SHADOW_MAP},
        {"show", (int)o->show, 0, VPL_SHOW_RESIDUAL},
        {"clusters", o->clusters, 1, VPL_MAX_LIGHTS},
        {"firstBounce", o->firstBounce, 0, VPL_MAX_LIGHTS},
        {"oversampling", o->oversampling, 1, 1024},
        {"secondBounce", o->secondBounce, 0, VPL_MAX_LIGHTS},
        {"paraboloidSize", o->paraboloidSize, 1, VPL_MAX_SHADOW_MAP},
        {"hemispheres", o->hemispheres, 1, 2},
        {"clusterMetric", (int)o->clusterMetric, 0, VPL_CLUSTER_ANGLE},
        {"coherence", (int)o->coherence, 0, VPL_COHERENCE_ON},
        {"clusterPlace", (int)o->clusterPlace, 0, VPL_CLUSTER_PLACE_MEAN},
        {"secondWeight", (int)o->secondWeight, 0, VPL_SECOND_WEIGHT_PRINTED},
        {"showLight", o->showLight, 0, VPL_MAX_LIGHTS},
        {"patches", o->patches, 1, VPL_MAX_PATCHES},
        {"subdivisions", o->subdivisions, 0, VPL_MAX_PATCH_ROUNDS},
        {"patchPlacement", (int)o->patchPlacement, 0, VPL_PATCHES_ADAPTIVE},
        {"formFactors", (int)o->formFactors, 0, VPL_FORM_FACTORS_INCENTRE},
        {"formSamples", o->formSamples, 1, 1024},
        {"rowSums", (int)o->rowSums, 0, VPL_ROW_SUMS_NORMALISE},
        {"hierarchy", (int)o->hierarchy, 0, VPL_HIERARCHY_ON},
        {"patchLightSamples", o->patchLightSamples, 0, VPL_PATCH_CELLS},
        {"solver", (int)o->solver, 0, VPL_SOLVER_SHOOTING},
        {"iterations", o->iterations, 0, VPL_MAX_SWEEPS},
        {"interpolation", (int)o->interpolation, 0, VPL_INTERPOLATION_NONE},
        {"sharpen", o->sharpen, 0, 64},
        {"vertexWeight", (int)o->vertexWeight, 0, VPL_VERTEX_WEIGHT_EQUAL},
    };
    for (size_t i = 0; i < sizeof ints / sizeof *ints; i++) {
        vplResult result = checkInt(context, ints[i].name, ints[i].value, ints[i].low, ints[i].high);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    return VPL_SUCCESS;
}

static vplResult checkReals(const vplContext* context, const vplRenderOptions* o)
{
    if (!(o->reflectivity < 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.reflectivity is %g, must be in [0, 1) or negative for automatic",
                       o->reflectivity);
    }
    if (!(o->cutError > 0 && o->cutError <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplRenderOptions.cutError is %g, must be in (0, 1]",
                       (double)o->cutError);
    }
    if (!(o->budgetMs >= 0 && o->maxError >= 0)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.budgetMs and maxError are %g and %g, must be at least 0",
                       o->budgetMs, o->maxError);
    }
    if (!(o->w1 >= 0 && o->w2 >= 0 && isfinite(o->w1) && isfinite(o->w2))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.w1 and w2 are %g and %g, must be finite and at least 0", o->w1,
                       o->w2);
    }
    if (!(o->linkError > 0 && o->linkError <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplRenderOptions.linkError is %g, must be in (0, 1]",
                       o->linkError);
    }
    if (!(o->residual >= 0 && o->residual <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplRenderOptions.residual is %g, must be in [0, 1]",
                       o->residual);
    }
    if (!(o->patchSize >= 0 && isfinite(o->patchSize))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.patchSize is %g, must be finite and at least 0",
                       (double)o->patchSize);
    }
    if (!isfinite(o->frame)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplRenderOptions.frame is %g, must be finite",
                       o->frame);
    }
    if (!isfinite(o->minDistance)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplRenderOptions.minDistance is %g, must be finite",
                       (double)o->minDistance);
    }
    return VPL_SUCCESS;
}

// What only SSVP has.
static vplResult checkSsvp(const vplContext* context, const vplRenderOptions* o)
{
    if (o->method == VPL_METHOD_SSVP) {
        return VPL_SUCCESS;
    }
    if (o->lightShadows == VPL_LIGHT_SHADOWS_CLUSTER) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "only SSVP's lights have clusters to cast shadows by");
    }
    if (o->show >= VPL_SHOW_RSM && o->show <= VPL_SHOW_SECOND_BOUNCE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "only SSVP has maps, samples and clusters to show");
    }
    return VPL_SUCCESS;
}

// What only radiosity has, and what it has not.
static vplResult checkRadiosity(const vplContext* context, const vplRenderOptions* o)
{
    if (o->method != VPL_METHOD_RADIOSITY) {
        return o->show >= VPL_SHOW_PATCHES ? vplFail(context, VPL_INVALID_ARGUMENT,
                                                     "only radiosity has patches and form factors to show")
                                           : VPL_SUCCESS;
    }
    if (o->lighting == VPL_LIGHTING_DOCUMENTED) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "radiosity's document prints no lighting formulas of its own; use physical lighting");
    }
    if (o->patchPlacement == VPL_PATCHES_ADAPTIVE && o->patchSize > 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "adaptive patches are counted, not measured: set vplRenderOptions.patches and leave "
                       "patchSize at 0");
    }
    if (o->show == VPL_SHOW_LIGHT || o->show == VPL_SHOW_OVERLAY || o->show == VPL_SHOW_GATHER ||
        o->show == VPL_SHOW_DENOISED) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "radiosity has no virtual lights to show");
    }
    return VPL_SUCCESS;
}

vplResult vplCheckOptions(const vplScene* scene, const vplRenderOptions* o)
{
    vplContext* context = vplScene_GetContext(scene);
    if (o->cookie != OPTIONS_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions was not made by vplDefaultRenderOptions");
    }
    const int cameras = vplScene_GetCameraCount(scene);
    if (cameras == 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "the scene has no camera");
    }
    vplResult result = checkInts(context, o, cameras);
    if (result == VPL_SUCCESS) {
        result = checkReals(context, o);
    }
    if (result == VPL_SUCCESS) {
        result = checkSsvp(context, o);
    }
    return result == VPL_SUCCESS ? checkRadiosity(context, o) : result;
}
