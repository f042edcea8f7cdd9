// SPDX-License-Identifier: MIT
// The picture: direct light, virtual lights and patches, added up for every sample of every pixel.
#include "base/clock.h"
#include "math/sampling.h"
#include "render/options.h"
#include "render/plan.h"
#include "render/show.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

// ---- one view

// Adds the light of patches: at every sample where edges are smooth, because interpolating it costs little.
static vplResult drawPatches(const vplRun* run, const vplView* view, vplImage* image)
{
    const int count = vplCountPoints(run->plan);
    vplImage* sum = NULL;
    if (count == 1) {
        return vplDrawPatchView(run, view, image);
    }
    vplResult result = vplImage_Create(run->context, image->width, image->height, &sum);
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        double x, y;
        vplPixelPoint(i, count, &x, &y);
        const vplView sample = vplView_At(view, x, y);
        result = vplDrawPatchView(run, &sample, sum);
    }
    for (size_t k = 0; k < vplValueCount(image) && result == VPL_SUCCESS; k++) {
        image->pixels[k] += sum->pixels[k] / (float)count;
    }
    vplImage_Destroy(sum);
    return result;
}

// Adds what is seen of the environment behind all surfaces.
static vplResult addBackground(const vplRun* run, const vplView* view, const vplShadeDef* shown,
                               vplImage* image)
{
    const bool smooth =
        shown->accumulation >= VPL_ACCUMULATE_DEFERRED; // passes draw surfaces without smooth edges
    vplShadeDef def = vplDefaultShadeDef();
    def.lighting = shown->lighting;
    def.output = VPL_OUTPUT_BACKGROUND;
    def.samples = smooth ? shown->samples : 0;
    def.gbuffer = smooth ? shown->gbuffer : NULL;
    def.firstRow = shown->firstRow;
    def.endRow = shown->endRow;
    vplImage* background;
    TRY(vplImage_Create(run->context, image->width, image->height, &background));
    const vplResult result = vplShadeView(run->results[VPL_STAGE_GEOMETRY], view, &def, background, NULL);
    for (size_t k = 0; k < vplValueCount(image) && result == VPL_SUCCESS; k++) {
        image->pixels[k] += background->pixels[k];
    }
    vplImage_Destroy(background);
    return result;
}

static vplResult shadeView(const vplRun* run, const vplView* view, const vplShadeDef* def, vplImage* image)
{
    const bool patches =
        run->plan->showsPatches && !run->plan->gathers && (run->parts & VPL_PART_INDIRECT) != 0;
    vplShadeStats stats = {0};
    if (vplShowsPatchesAlone(run->plan->options.output.show)) {
        TRY(vplClear(run->context, image->pixels, vplValueCount(image) * sizeof *image->pixels));
    } else {
        TRY(vplShadeView(run->results[VPL_STAGE_GEOMETRY], view, def, image, &stats));
    }
    vplRun_AddRaster(run, &stats.raster);
    run->stats->rays += stats.shadowRays;
    const vplGeometry* g = run->results[VPL_STAGE_GEOMETRY];
    if (g->environment != NULL && def->emission && def->output == VPL_OUTPUT_RADIANCE) {
        TRY(addBackground(run, view, def, image));
    }
    run->stats->lightEvaluations += stats.lightEvaluations;
    run->stats->cutPixels += stats.cutPixels;
    if (stats.largestCut > run->stats->largestCut) {
        run->stats->largestCut = stats.largestCut;
    }
    return patches ? drawPatches(run, view, image) : VPL_SUCCESS;
}

// Sample i of `count` of every pixel.
static vplResult shadeSample(const vplRun* run, const vplShadeDef* plain, int i, int count, vplImage* image)
{
    vplShadeDef def = *plain;
    vplCompensationDef compensation;
    vplGatherDef gather;
    if (def.gather != NULL) {
        gather = *def.gather;
        gather.firstRay = (uint32_t)i * (uint32_t)gather.rayCount;
        def.gather = &gather;
    }
    if (def.compensation != NULL) { // short rays of all samples and passes are one sequence
        compensation = *def.compensation;
        compensation.firstRay = (uint32_t)(run->pass * count + i) * (uint32_t)compensation.rayCount;
        def.compensation = &compensation;
    }
    double x, y;
    vplPixelPoint(i, count, &x, &y);
    const vplView view = vplView_At(&run->plan->view, x, y);
    return shadeView(run, &view, &def, image);
}

// Adds a picture to the sums. Asks after each piece, because pages that are touched for the first time take long.
static vplResult addSample(const vplRun* run, const vplImage* image, double* sums)
{
    enum { PIECE = 1 << 20 };
    const size_t values = vplValueCount(image);
    for (size_t from = 0; from < values; from += PIECE) {
        const size_t to = values - from < PIECE ? values : from + PIECE;
        for (size_t k = from; k < to; k++) {
            sums[k] += (double)image->pixels[k];
        }
        TRY(vplAsk(run->context));
    }
    return VPL_SUCCESS;
}

static vplResult shadeSamples(const vplRun* run, const vplShadeDef* def, double* sums, vplImage* image)
{
    const int count = run->plan->options.output.supersample;
    const size_t values = vplValueCount(image);
    if (count == 1) {
        return shadeSample(run, def, 0, 1, image);
    }
    for (int i = 0; i < count; i++) {
        vplRun_BeginPart(run, i, count);
        TRY(shadeSample(run, def, i, count, image));
        TRY(addSample(run, image, sums));
    }
    for (size_t k = 0; k < values; k++) {
        image->pixels[k] = (float)(sums[k] / count);
    }
    return VPL_SUCCESS;
}

// ---- the lights to shade with

static void addDirect(const vplRun* run, const vplShadow* shadows, vplShadeDef* def)
{
    const vplAreaLights* area = run->results[VPL_STAGE_AREA_LIGHTS];
    def->emitters = run->plan->emitters;
    def->shadows = shadows;
    def->emitterCount = run->plan->emitterCount;
    def->emission = true;
    def->trianglesPerPoint = vplPixelsChooseTriangles(run->plan) ? run->plan->trianglesPerPoint : 0;
    if (area != NULL) {
        def->areaLights = area->lights;
        def->areaLightCount = area->count;
        def->areaLightMinDistance = area->minDistance;
    }
}

// Adds `count` virtual lights, beginning with v->first + first.
static void addVirtual(const vplRun* run, const vplVirtualLights* v, const vplHemiMaps* maps, int first,
                       int count, vplShadeDef* def)
{
    const vplClusteredLights* clustered = run->results[VPL_STAGE_CLUSTERED_LIGHTS];
    def->lights = v->lights + v->first + first;
    def->lightCount = count;
    def->lightShadows = maps != NULL ? maps->maps : NULL;
    def->lightRays = run->plan->options.lights.shadows == VPL_LIGHT_SHADOWS_RAY;
    if (v->clusters != NULL) {
        def->lightClusters = v->clusters + first;
        def->clusterShadows = clustered->shadows;
        def->clusterCount = clustered->shadowCount;
    }
}

static vplShadeDef describe(const vplRun* run)
{
    const vplRenderOptions* o = &run->plan->options;
    const vplVirtualLights* v = run->results[VPL_STAGE_VIRTUAL_LIGHTS];
    const vplReflectiveMaps* maps = run->results[VPL_STAGE_REFLECTIVE_MAPS];
    const bool mapped = maps != NULL && o->method == VPL_METHOD_SSVP && !run->plan->emitterRays;
    vplShadeDef def = vplDefaultShadeDef();
    def.lighting = run->plan->shading;
    def.accumulation = o->pipeline.kind;
    def.output = VPL_SHOWS[o->output.show].output;
    def.batch = o->pipeline.batch;
    def.interleave = o->pipeline.interleave;
    def.cutError = o->pipeline.cutError;
    def.samples = o->output.antialias;
    def.minDistance = v != NULL ? v->minDistance : 0;
    def.particleCount = o->method == VPL_METHOD_DIRECT ? 1 : vplParticlesOfPass(run->plan, run->pass);
    def.firstRow = run->firstRow;
    def.endRow = run->endRow;
    def.gbuffer = run->results[VPL_STAGE_GBUFFER];
    def.emittersPerPoint = run->plan->emittersPerPoint;
    def.emitterTrees = run->results[VPL_STAGE_EMITTER_TREES];
    def.emitterMaps = mapped ? (const vplReflectiveMap* const*)maps->maps : NULL;
    def.progress = run->progress;
    def.progressUser = run->runner;
    return def;
}

// The memory of one call of the stage, besides its picture.
typedef struct Shading {
    const vplShadow* shadows; // of emitters
    double* sums;             // of samples; NULL for one
    vplHemiMaps* lightMaps;   // of a batch of virtual lights; NULL if they have none
    vplHemiMapPlace* places;  // of these maps
} Shading;

static vplResult shade(const vplRun* run, const Shading* s, int parts, int first, int count, vplImage* image)
{
    const vplPlan* plan = run->plan;
    const vplVirtualLights* v = run->results[VPL_STAGE_VIRTUAL_LIGHTS];
    vplShadeDef def = describe(run);
    vplCompensationDef compensation;
    vplGatherDef gather;
    if ((parts & VPL_PART_DIRECT) != 0 && plan->showsDirect) {
        addDirect(run, s->shadows, &def);
    }
    if (count > 0) {
        addVirtual(run, v, s->lightMaps, first, count, &def);
    }
    if (plan->gathers && (parts & VPL_PART_INDIRECT) != 0) {
        TRY(vplDescribeGather(run, &gather));
        def.gather = &gather;
    }
    // Compensation is computed once, for all batches together.
    const bool whole = (run->parts & VPL_PART_INDIRECT) != 0;
    const bool near = first == 0 && count > 0 && def.output == VPL_OUTPUT_RADIANCE && def.minDistance > 0;
    if (near && (plan->compensates || plan->estimatesLoss)) {
        compensation = vplMakeCompensation(run, v, s->shadows);
        compensation.seesReflection = compensation.seesReflection && whole;
        def.compensation = plan->compensates ? &compensation : NULL;
    }
    if (s->sums != NULL) {
        TRY(vplClear(run->context, s->sums, vplValueCount(image) * sizeof *s->sums));
    }
    TRY(shadeSamples(run, &def, s->sums, image));
    return near && whole && plan->estimatesLoss ? vplEstimateLoss(run, v, &def, compensation) : VPL_SUCCESS;
}

// ---- virtual lights with maps

static vplResult drawLightMaps(const vplRun* run, Shading* s, int first, int count)
{
    const vplVirtualLights* v = run->results[VPL_STAGE_VIRTUAL_LIGHTS];
    const double start = vplClockMs();
    for (int i = 0; i < count; i++) {
        const vplShadeLight* l = &v->lights[v->first + first + i];
        s->places[i] = (vplHemiMapPlace){{l->px, l->py, l->pz}, {l->nx, l->ny, l->nz}};
    }
    TRY(vplHemiMaps_Draw(s->lightMaps, run->results[VPL_STAGE_GEOMETRY], s->places, count, run->progress,
                         run->runner));
    vplRun_AddTime(run, "light shadow maps", start);
    return VPL_SUCCESS;
}

// Shades lights in batches, as many as have maps that fit into memory, and sums the pictures of the batches.
static vplResult shadeBatches(const vplRun* run, Shading* s, int total, vplImage* image)
{
    const size_t values = vplValueCount(image);
    const vplLightOptions* o = &run->plan->options.lights;
    const size_t room = ((size_t)o->mapMemory << 20) / vplHemiMaps_BytesPerMap(o->mapSize);
    const int batch = room >= (size_t)total ? total : room > 0 ? (int)room : 1;
    float* sum = vplArena_Alloc(run->scratch, batch < total ? values : 0, sizeof *sum);
    s->places = vplArena_Alloc(run->scratch, (size_t)batch, sizeof *s->places);
    TRY(vplArena_Check(run->scratch));
    TRY(vplHemiMaps_Create(run->context, o->mapSize, batch, &s->lightMaps));
    for (int first = 0; first < total; first += batch) {
        const int count = total - first < batch ? total - first : batch;
        TRY(drawLightMaps(run, s, first, count));
        TRY(shade(run, s, first == 0 ? run->parts : VPL_PART_INDIRECT, first, count, image));
        for (size_t k = 0; k < values && batch < total; k++) {
            sum[k] = first == 0 ? image->pixels[k] : image->pixels[k] + sum[k];
            image->pixels[k] = sum[k];
        }
    }
    return VPL_SUCCESS;
}

// ---- the G-buffer that all passes share

vplResult vplMakeGbuffer(const vplRun* run, void** resultOut)
{
    const vplView view = vplView_At(&run->plan->view, 0.5, 0.5); // as shadeSample has it for one sample
    const vplShadeDef def = describe(run);
    vplGbuffer* gbuffer = NULL;
    vplRasterStats stats;
    TRY(vplGbuffer_Create(run->results[VPL_STAGE_GEOMETRY], &view, &def, &gbuffer, &stats));
    *resultOut = gbuffer;
    vplRun_AddRaster(run, &stats);
    return VPL_SUCCESS;
}

void vplDestroyGbuffer(void* result)
{
    vplGbuffer_Destroy(result);
}

// ---- the stage

static int countLights(const vplRun* run)
{
    const vplVirtualLights* v = run->results[VPL_STAGE_VIRTUAL_LIGHTS];
    return v == NULL                                     ? 0
           : (run->parts & VPL_PART_INDIRECT) != 0       ? v->count - v->first
           : (run->parts & VPL_PART_EMITTER_LIGHTS) != 0 ? v->emitterLightCount - v->first
                                                         : 0;
}

static vplResult shadePicture(const vplRun* run, Shading* s, vplImage* image)
{
    const vplPlan* plan = run->plan;
    const vplEmitterMaps* maps = run->results[VPL_STAGE_EMITTER_MAPS];
    const bool many = plan->options.output.supersample > 1;
    const int lights = countLights(run);
    s->shadows = maps != NULL ? maps->shadows : NULL; // rays
    s->sums = many ? vplArena_Alloc(run->scratch, vplValueCount(image), sizeof *s->sums) : NULL;
    TRY(vplArena_Check(run->scratch));
    return lights > 0 && plan->options.lights.shadows == VPL_LIGHT_SHADOWS_MAP
               ? shadeBatches(run, s, lights, image)
               : shade(run, s, run->parts, 0, lights, image);
}

vplResult vplMakePicture(const vplRun* run, void** resultOut)
{
    const vplOutputOptions* o = &run->plan->options.output;
    const vplShowRow* show = &VPL_SHOWS[o->show];
    vplImage* image = NULL;
    if (show->draw != NULL) {
        TRY(show->draw(run, &image));
        *resultOut = image;
        return VPL_SUCCESS;
    }
    TRY(vplImage_Create(run->context, vplRenderedWidth(o), vplRenderedHeight(o), &image));
    *resultOut = image;
    Shading shading = {0};
    const vplResult result = shadePicture(run, &shading, image);
    vplHemiMaps_Destroy(shading.lightMaps);
    return result;
}

void vplDestroyImage(void* result)
{
    vplImage_Destroy(result);
}
