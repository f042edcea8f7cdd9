// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights: simulate particles, render the cube
// shadow map of the point light, render the scene lit by it with shadows, then add every virtual light.
// Alexander Keller, Instant Radiosity, SIGGRAPH 1997: the same with particles that begin as lights on the emitters,
// and with shadows. Direct lighting is the recipe without particles.
#include "math/sampling.h"
#include "render/radiosity.h"
#include "render/ssvp.h"

#include <math.h>
#include <string.h>

// The parts of a picture.
typedef enum Part {
    PART_DIRECT = 1,  // emission, and light from emitters and lamps
    PART_INDIRECT = 2 // light of virtual lights
} Part;

typedef struct Recipe {
    vplIngredients in;
    vplImage* base;  // progressive: direct light; else all of the picture
    double* sums[2]; // progressive: of the passes, even and odd
} Recipe;

bool vplNeedsLights(const vplRenderOptions* o)
{
    if (o->method == VPL_METHOD_DIRECT || o->method == VPL_METHOD_RADIOSITY ||
        (o->method == VPL_METHOD_SSVP && o->maxBounces == 0)) {
        return false;
    }
    switch (o->output.show) {
    case VPL_SHOW_PICTURE:
    case VPL_SHOW_INDIRECT:
    case VPL_SHOW_LIGHT:
    case VPL_SHOW_OVERLAY:
    case VPL_SHOW_RSM_SAMPLES:
    case VPL_SHOW_CLUSTERS:
    case VPL_SHOW_PARABOLOID:
    case VPL_SHOW_SECOND_BOUNCE:
    case VPL_SHOW_GATHER:
    case VPL_SHOW_DENOISED:
        return true;
    case VPL_SHOW_DIRECT:
        return o->method == VPL_METHOD_KELLER;
    default:
        return false;
    }
}

bool vplNeedsDirect(const vplRenderOptions* o)
{
    switch (o->output.show) {
    case VPL_SHOW_DEPTH:
    case VPL_SHOW_NORMALS:
    case VPL_SHOW_INDIRECT:
    case VPL_SHOW_LIGHT:
    case VPL_SHOW_RSM:
    case VPL_SHOW_PARABOLOID:
    case VPL_SHOW_GATHER:
    case VPL_SHOW_DENOISED:
    case VPL_SHOW_PATCHES:
    case VPL_SHOW_PATCH_RADIOSITY:
    case VPL_SHOW_FORM_FACTOR_SUMS:
    case VPL_SHOW_RESIDUAL:
        return false;
    default:
        return true;
    }
}

static bool isProgressive(const vplRenderOptions* o)
{
    return o->output.show <= VPL_SHOW_OVERLAY && vplNeedsLights(o) &&
           (o->stop.passes > 1 || o->stop.budgetMs > 0 || o->stop.maxError > 0);
}

// ---- shading

// Patches alone, without light of pixels.
static bool showsPatches(const vplRenderOptions* o)
{
    return o->output.show >= VPL_SHOW_PATCHES && o->output.show <= VPL_SHOW_RESIDUAL;
}

static void clear(vplImage* image)
{
    memset(image->pixels, 0, 3 * (size_t)image->width * (size_t)image->height * sizeof *image->pixels);
}

// One look at every pixel at place i of `count`: Hammersley points, so that edges along the axes, too, are cut at
// as many places as there are samples.
static vplResult shadeSample(vplJob* job, const vplIngredients* in, const vplShadeDef* plain, int i,
                             int count)
{
    vplShadeDef def = *plain;
    vplCompensationDef compensation;
    if (def.compensation != NULL) { // short rays of all looks and passes are one sequence
        compensation = *def.compensation;
        compensation.firstRay = (uint32_t)(job->stepsDone * count + i) * (uint32_t)compensation.rayCount;
        def.compensation = &compensation;
    }
    double y = vplVanDerCorput((uint32_t)i) + 0.5 / count;
    vplView view = vplView_At(&job->view, (i + 0.5) / count, y - floor(y));
    vplShadeStats stats = {0};
    vplResult result = VPL_SUCCESS;
    if (showsPatches(&job->options)) {
        clear(job->image);
    } else {
        result = vplShadeView(job->geometry, &view, &def, vplJob_GetProgress(job), job, job->image, &stats);
    }
    vplJob_AddRaster(job, &stats.raster);
    job->stats.rays += stats.shadowRays;
    job->stats.lightEvaluations += stats.lightEvaluations;
    job->stats.cutPixels += stats.cutPixels;
    job->stats.largestCut =
        stats.largestCut > job->stats.largestCut ? stats.largestCut : job->stats.largestCut;
    if (result == VPL_SUCCESS && in->radiosity != NULL) {
        result = vplRadiosity_Draw(job, in->radiosity, &view, job->image);
    }
    return result;
}

static vplResult shadeSamples(vplJob* job, const vplIngredients* in, const vplShadeDef* def)
{
    const int count = job->options.output.antialias;
    const size_t values = 3 * (size_t)job->image->width * (size_t)job->image->height;
    if (count == 1) {
        return shadeSample(job, in, def, 0, 1);
    }
    double* sums = vplAllocZero(job->context, values, sizeof *sums);
    vplResult result = sums ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    const double from = job->progressFrom, to = job->progressTo;
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        job->progressFrom = from + (to - from) * i / count;
        job->progressTo = from + (to - from) * (i + 1) / count;
        result = shadeSample(job, in, def, i, count);
        for (size_t k = 0; k < values && result == VPL_SUCCESS; k++) {
            sums[k] += (double)job->image->pixels[k];
        }
    }
    for (size_t k = 0; k < values && result == VPL_SUCCESS; k++) {
        job->image->pixels[k] = (float)(sums[k] / count);
    }
    vplFree(job->context, sums);
    return result;
}

// What SSVP's maps and clusters see; `first` as in shade, -1: without virtual lights.
static void addSsvp(const vplJob* job, const vplIngredients* in, int first, vplShadeDef* def)
{
    const vplSsvpState* state = in->ssvp;
    if (job->options.lights.shadows !=
        VPL_LIGHT_SHADOWS_RAY) { // as of shadow maps; lights are maybe not there yet
        def->emitterMaps = (const vplReflectiveMap* const*)state->maps;
    }
    if (first >= 0 && in->lightClusters != NULL) {
        def->lightClusters = in->lightClusters + first;
        def->clusterShadows = state->lights->shadows;
        def->clusterCount = state->lights->shadowCount;
    }
}

// With virtual lights first .. first + count - 1.
static vplResult shade(vplJob* job, const vplIngredients* in, int parts, int first, int count)
{
    const vplRenderOptions* o = &job->options;
    const bool direct = parts & PART_DIRECT && vplNeedsDirect(o);
    vplShadeDef def = {0};
    def.lighting = vplJob_GetShading(job);
    def.accumulation = o->pipeline.kind;
    def.output = o->output.show == VPL_SHOW_DEPTH           ? VPL_OUTPUT_DEPTH
                 : o->output.show == VPL_SHOW_NORMALS       ? VPL_OUTPUT_NORMALS
                 : o->output.show == VPL_SHOW_SHADOW_FACTOR ? VPL_OUTPUT_SHADOW_FACTOR
                 : o->output.show == VPL_SHOW_GATHER        ? VPL_OUTPUT_GATHER
                 : o->output.show == VPL_SHOW_DENOISED      ? VPL_OUTPUT_DENOISED
                                                     : VPL_OUTPUT_RADIANCE;
    def.batch = o->pipeline.batch;
    def.interleave = o->pipeline.interleave;
    def.cutError = o->pipeline.cutError;
    def.minDistance = in->minDistance;
    def.particleCount = o->method == VPL_METHOD_DIRECT ? 1 : o->particles.count;
    if (direct) {
        def.emitters = in->emitters;
        def.shadows = in->emitterMaps.shadows;
        def.emitterCount = in->emitterMaps.shadows ? in->emitterCount : 0;
        def.areaLights = in->areaLights;
        def.areaLightCount = in->areaLightCount;
        def.areaLightMinDistance = in->areaLightMinDistance;
        def.emission = true;
    }
    if (parts & PART_INDIRECT) {
        def.lightShadows = in->lightMaps ? in->lightMaps->maps : NULL;
        def.lightRays = in->lightShadows == VPL_LIGHT_SHADOWS_RAY;
        def.lights = in->lights ? in->lights + in->firstShown + first : NULL;
        def.lightCount = count;
    }
    if (in->ssvp != NULL) {
        addSsvp(job, in, parts & PART_INDIRECT ? first : -1, &def);
    }
    // Of all lights at once, whatever batch is shown.
    const bool near = first == 0 && count > 0 && def.output == VPL_OUTPUT_RADIANCE && def.minDistance > 0;
    vplCompensationDef compensation;
    if (near && vplCompensates(job)) {
        compensation = vplMakeCompensation(job, in);
        def.compensation = &compensation;
    }
    vplResult result = vplImage_Create(job->context, o->output.width, o->output.height, &job->image);
    vplJob_BeginStage(
        job, 0.1 + 0.9 * (count > 0 ? (first + count) / (double)(in->lightCount - in->firstShown) : 1));
    if (result == VPL_SUCCESS) {
        result = shadeSamples(job, in, &def);
    }
    vplJob_EndStage(job, "shading");
    const bool known = o->output.show != VPL_SHOW_LIGHT && o->sequence.history == NULL && // frames have no time for it
                       (vplNeedsDirect(o) || vplCompensates(job));
    if (result == VPL_SUCCESS && near && known && def.lighting == VPL_LIGHTING_PHYSICAL) {
        vplJob_BeginStage(job, 1);
        result = vplEstimateLoss(job, in, &def);
        vplJob_EndStage(job, "clamp loss");
    }
    return result;
}

// Virtual lights whose maps fit into memory at the same time, with the direct light, then more of them: each batch
// makes a picture, and their sum counts.
static vplResult shadeBatches(vplJob* job, vplIngredients* in, int parts)
{
    const int batch = vplLightBatch(job, in), total = in->lightCount - in->firstShown;
    vplImage* sum = NULL;
    vplResult result = VPL_SUCCESS;
    for (int first = 0; first < total && result == VPL_SUCCESS; first += batch) {
        const int count = total - first < batch ? total - first : batch;
        vplJob_BeginStage(job, 0.1 + 0.9 * (first + 0.4 * count) / total);
        result = vplMakeLightShadows(job, in, first, count);
        vplJob_EndStage(job, "light shadow maps");
        if (result == VPL_SUCCESS) {
            result = shade(job, in, first == 0 ? parts : PART_INDIRECT, first, count);
        }
        if (result == VPL_SUCCESS && sum != NULL) {
            const size_t values = 3 * (size_t)sum->width * (size_t)sum->height;
            for (size_t k = 0; k < values; k++) {
                job->image->pixels[k] += sum->pixels[k];
            }
        }
        vplImage_Destroy(sum);
        sum = job->image;
        job->image = NULL;
    }
    job->image = sum;
    return result;
}

static vplResult overlay(vplJob* job, const vplLightSet* set)
{
    vplResult result = vplGeometry_PrepareRays(job->geometry);
    if (result == VPL_SUCCESS) {
        vplDrawLights(job->image, job->geometry, &job->view, set);
    }
    return result;
}

static vplResult makeRadiosity(vplJob* job, vplIngredients* in)
{
    vplResult result = vplRadiosity_Begin(job, &in->radiosity);
    if (result == VPL_SUCCESS && vplFindRadiosityNeed(&job->options) == VPL_NEED_LIGHT) {
        result = vplRadiosity_Light(job, in->radiosity);
        if (result != VPL_SUCCESS) { // half a frame's light is none that the next could go on from
            vplRadiosity_Destroy(in->radiosity);
            in->radiosity = NULL;
        }
    }
    return result;
}

// ---- the recipe

static vplResult cook(vplJob* job, vplIngredients* in, int parts)
{
    const vplRenderOptions* o = &job->options;
    vplResult result = VPL_SUCCESS;
    if (o->method == VPL_METHOD_SSVP && in->ssvp == NULL) {
        result = vplSsvp_Begin(job, &in->ssvp);
    }
    if (vplFindRadiosityNeed(o) != VPL_NEED_NOTHING && in->radiosity == NULL) {
        result = makeRadiosity(job, in);
    }
    if (result == VPL_SUCCESS && parts & PART_INDIRECT && vplNeedsLights(o)) {
        vplJob_BeginStage(job, 0.05);
        result = vplMakeVirtualLights(job, in);
        vplJob_EndStage(job, "particles");
    }
    if (result == VPL_SUCCESS && parts & PART_DIRECT && (vplNeedsDirect(o) || vplCompensates(job))) {
        vplJob_BeginStage(job, 0.15);
        result = vplMakeDirectLight(job, in);
        vplJob_EndStage(job, "shadow map");
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    if (o->output.show == VPL_SHOW_RSM || o->output.show == VPL_SHOW_PARABOLOID) {
        return vplSsvp_ShowMap(job, in->ssvp);
    }
    if (o->output.show == VPL_SHOW_SHADOW_MAP || o->output.show == VPL_SHOW_SHADOW_FACTOR) {
        if (in->emitterCount == 0 || in->emitterMaps.maps[0] == NULL) {
            return vplFail(job->context, VPL_INVALID_ARGUMENT,
                           "the scene has no light with a shadow map, or the first casts shadows by rays");
        }
        if (o->output.show == VPL_SHOW_SHADOW_MAP) {
            return vplUnfoldCubeMap(in->emitterMaps.maps[0], &job->image);
        }
    }
    const bool maps =
        parts & PART_INDIRECT && in->lightCount > in->firstShown && in->lightShadows == VPL_LIGHT_SHADOWS_MAP;
    return maps ? shadeBatches(job, in, parts) : shade(job, in, parts, 0, in->lightCount - in->firstShown);
}

static vplResult begin(vplJob* job)
{
    Recipe* r = job->state = vplAllocZero(job->context, 1, sizeof *r);
    if (r == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    r->in.emitterCount = job->emitterCount;
    r->in.emitters = job->emitters;
    job->progressive = isProgressive(&job->options);
    return VPL_SUCCESS;
}

static void takeImage(vplJob* job, vplImage** to)
{
    vplImage_Destroy(*to);
    *to = job->image;
    job->image = NULL;
}

// Direct light once, then virtual lights: those of each pass make a picture, and the passes' mean counts.
static vplResult addPass(vplJob* job, Recipe* r)
{
    const size_t values = 3 * (size_t)job->options.output.width * (size_t)job->options.output.height;
    vplResult result = VPL_SUCCESS;
    if (job->stepsDone == 0) {
        result = cook(job, &r->in, PART_DIRECT);
        takeImage(job, &r->base);
        for (int half = 0; half < 2 && result == VPL_SUCCESS; half++) {
            r->sums[half] = vplAllocZero(job->context, values, sizeof(double));
            result = r->sums[half] ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
        }
    }
    if (result == VPL_SUCCESS) {
        result = cook(job, &r->in, PART_INDIRECT);
    }
    double* sums = r->sums[job->stepsDone % 2];
    for (size_t k = 0; k < values && result == VPL_SUCCESS; k++) {
        sums[k] += (double)job->image->pixels[k];
    }
    vplImage_Destroy(job->image);
    job->image = NULL;
    return result;
}

static vplResult step(vplJob* job, bool* doneOut)
{
    const vplRenderOptions* o = &job->options;
    Recipe* r = job->state;
    vplResult result;
    if (job->progressive) {
        *doneOut = o->stop.passes > 0 && job->stepsDone + 1 >= o->stop.passes;
        return addPass(job, r);
    }
    result = cook(job, &r->in, PART_DIRECT | PART_INDIRECT);
    if (result == VPL_SUCCESS && o->output.show == VPL_SHOW_OVERLAY && r->in.set != NULL) {
        result = overlay(job, r->in.set);
    }
    if (result == VPL_SUCCESS && r->in.ssvp != NULL) {
        result = vplSsvp_ShowLights(job, r->in.ssvp);
    }
    takeImage(job, &r->base);
    *doneOut = true;
    return result;
}

// The two halves of the passes differ by their errors: half of that is expected in their mean. What both have in
// common (the direct light's error, light lost or moved by the accumulation) is not in it.
static void estimateError(vplJob* job, const Recipe* r)
{
    const size_t values = 3 * (size_t)job->image->width * (size_t)job->image->height;
    const int odd = job->stepsDone / 2, even = job->stepsDone - odd;
    double squares = 0, sum = 0;
    for (size_t k = 0; k < values && odd > 0; k++) {
        const double half = 0.5 * (r->sums[0][k] / even - r->sums[1][k] / odd);
        squares += half * half;
        sum += (double)job->image->pixels[k];
    }
    if (odd > 0) {
        job->stats.errorEstimate = sqrt(squares / (double)values);
        job->stats.relativeErrorEstimate = sum > 0 ? job->stats.errorEstimate * (double)values / sum : 0;
    }
}

static vplResult resolve(vplJob* job)
{
    Recipe* r = job->state;
    if (job->last && !job->progressive) {
        job->image = r->base;
        r->base = NULL;
        return VPL_SUCCESS;
    }
    vplResult result = vplImage_Create(job->context, r->base->width, r->base->height, &job->image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const size_t values = 3 * (size_t)r->base->width * (size_t)r->base->height;
    for (size_t k = 0; k < values; k++) {
        const double mean = job->progressive ? (r->sums[0][k] + r->sums[1][k]) / job->stepsDone : 0;
        job->image->pixels[k] = (float)((double)r->base->pixels[k] + mean);
    }
    if (job->progressive) {
        estimateError(job, r);
        if (job->options.output.show == VPL_SHOW_OVERLAY) {
            result = overlay(job, r->in.set);
        }
    }
    return result;
}

static void end(vplJob* job)
{
    Recipe* r = job->state;
    if (r != NULL) {
        vplFreeIngredients(job, &r->in);
        vplImage_Destroy(r->base);
        vplFree(job->context, r->sums[0]);
        vplFree(job->context, r->sums[1]);
        vplFree(job->context, r);
    }
}

const vplMethodFcns vplVirtualLightMethod = {begin, step, resolve, end};
