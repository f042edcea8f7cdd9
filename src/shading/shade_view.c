// SPDX-License-Identifier: MIT
// Sets up one render of one view and hands it to the pipeline that was asked for.
#include "math/scalar.h"
#include "math/vec.h"
#include "shading/shading.h"
#include "visibility/drawing.h"

#include <math.h>
#include <stddef.h>

static vplResult checkClusters(const vplContext* context, const vplShadeDef* def)
{
    if (def->lightClusters == NULL) {
        return VPL_SUCCESS;
    }
    if (def->accumulation != VPL_ACCUMULATE_DEFERRED && def->accumulation != VPL_ACCUMULATE_INTERLEAVED) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "clusters of lights share shadows in deferred and interleaved shading only");
    }
    if (def->lightShadows != NULL || def->lightRays || def->compensation != NULL) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "lights whose clusters share shadows have no maps or rays of their own, and no compensation");
    }
    for (int i = 0; i < def->lightCount; i++) {
        if (def->lightClusters[i] < -1 || def->lightClusters[i] >= def->clusterCount) {
            return vplFail(context, VPL_INVALID_ARGUMENT,
                           "vplShadeDef.lightClusters[%d] is %d, must be in [-1, %d)", i,
                           def->lightClusters[i], def->clusterCount);
        }
    }
    return VPL_SUCCESS;
}

// What belongs to one way of accumulating light.
static vplResult checkAccumulation(const vplContext* context, const vplShadeDef* def)
{
    if (def->accumulation == VPL_ACCUMULATE_BATCHED && def->batch < 1) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplShadeDef.batch is %d, must be at least 1",
                       def->batch);
    }
    if (def->accumulation == VPL_ACCUMULATE_INTERLEAVED &&
        (def->interleave < 1 || def->interleave > VPL_MAX_INTERLEAVE)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplShadeDef.interleave is %d, must be in [1, %d]",
                       def->interleave, VPL_MAX_INTERLEAVE);
    }
    if (def->accumulation == VPL_ACCUMULATE_LIGHTCUTS && !(def->cutError > 0 && def->cutError <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplShadeDef.cutError is %g, must be in (0, 1]",
                       (double)def->cutError);
    }
    return checkClusters(context, def);
}

static vplResult checkDef(const vplContext* context, const vplView* view, const vplShadeDef* def,
                          const vplImage* image)
{
    if (image->width != view->width || image->height != view->height) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "image is %dx%d, must be %dx%d as the view",
                       image->width, image->height, view->width, view->height);
    }
    if (!(def->minDistance >= 0 && isfinite(def->minDistance))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplShadeDef.minDistance is %g, must be finite and >= 0", (double)def->minDistance);
    }
    if (!(def->areaLightMinDistance >= 0 && isfinite(def->areaLightMinDistance))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplShadeDef.areaLightMinDistance is %g, must be finite and >= 0",
                       (double)def->areaLightMinDistance);
    }
    if (def->compensation != NULL &&
        (def->compensation->rayCount < 1 || def->compensation->rayCount > VPL_MAX_NEAR_RAYS ||
         def->compensation->hitLights < 1)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "vplCompensationDef.rayCount and hitLights are %d and %d, must be in [1, %d] and at least 1",
            def->compensation->rayCount, def->compensation->hitLights, VPL_MAX_NEAR_RAYS);
    }
    if (def->output == VPL_OUTPUT_SHADOW_FACTOR &&
        (def->emitterCount < 1 || (vplEmitterMapOf(def, 0) == NULL && def->shadows[0].map == NULL))) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "a shadow factor needs an emitter with a shadow map");
    }
    return checkAccumulation(context, def);
}

float vplInverseSquare(float distance)
{
    return distance > 0 ? 1 / (distance * distance) : INFINITY;
}

vplShading vplShading_Make(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def)
{
    const vplIsa isa = geometry->context->isa;
    return (vplShading){.geometry = geometry,
                        .view = view,
                        .def = def,
                        .lightKernel = vplGetLightKernel(isa, def->lighting),
                        .clusterBound = vplGetClusterBound(isa, def->lighting),
                        .addEmitters = vplGetAddEmitters(isa),
                        .cull = vplGetCull(isa, def->lighting),
                        .inverseBound = vplInverseSquare(def->minDistance),
                        .areaLightInverseBound = vplInverseSquare(def->areaLightMinDistance),
                        .smooth = geometry->shadingNormals != NULL,
                        .irradiance = def->output == VPL_OUTPUT_GATHER || def->output == VPL_OUTPUT_DENOISED};
}

static vplResult makeObjects(vplShading* s)
{
    const vplGeometry* g = s->geometry;
    size_t count = (size_t)g->objectCount;
    s->meshes = vplAlloc(g->context, count, sizeof *s->meshes);
    s->objects = vplAlloc(g->context, count, sizeof *s->objects);
    if (s->meshes == NULL || s->objects == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < g->objectCount; i++) {
        const vplGeometryObject* o = &g->objects[i];
        s->meshes[i] = vplMeshOfObject(g, i);
        s->objects[i] = (vplObjectUniforms){s, g->positions + o->firstVertex,
                                            o->smooth ? g->shadingNormals + o->firstVertex : NULL, i};
    }
    return VPL_SUCCESS;
}

vplResult vplMakeEmitterRays(vplShading* s)
{
    const vplShadeDef* def = s->def;
    s->emitters = vplAlloc(s->geometry->context, (size_t)def->emitterCount, sizeof *s->emitters);
    for (int i = 0; s->emitters != NULL && i < def->emitterCount; i++) {
        const vplEmitterDef* e = &def->emitters[i];
        double sine, inner, outer;
        vplSinCos(e->innerAngle, &sine, &inner);
        vplSinCos(e->outerAngle, &sine, &outer);
        s->emitters[i] =
            (vplEmitterRay){.position = e->position,
                            .direction = vplNormalize(e->direction),
                            .cosOuter = (float)outer,
                            .inverseRing = inner > outer ? (float)(1 / (inner - outer)) : 0x1p100f,
                            .spot = e->type == VPL_EMITTER_SPOT,
                            .parallel = e->type == VPL_EMITTER_DIRECTIONAL,
                            .falloff = def->lighting == VPL_LIGHTING_PHYSICAL};
    }
    return s->emitters ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// Columns of the virtual lights, from which those that give nothing can be told; not where each light's shadow is
// asked for anyway.
static vplResult makeColumns(vplShading* s)
{
    const vplShadeDef* def = s->def;
    if (def->lightCount == 0 || def->lightShadows != NULL || def->lightRays) {
        return VPL_SUCCESS;
    }
    const size_t groups = ((size_t)def->lightCount + VPL_LIGHT_GROUP - 1) / VPL_LIGHT_GROUP;
    // Whole vectors are read, of interleaved lights from anywhere on.
    const size_t padded = groups * VPL_LIGHT_GROUP + VPL_LANES;
    float* storage = vplAllocZero(s->geometry->context, 6 * padded, sizeof *storage);
    if (storage == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int k = 0; k < 6; k++) {
        s->columns[k] = storage + (size_t)k * padded;
    }
    for (int i = 0; i < def->lightCount; i++) {
        const vplShadeLight* light = &def->lights[i];
        const float values[6] = {light->px, light->py, light->pz, light->nx, light->ny, light->nz};
        for (int k = 0; k < 6; k++) {
            s->columns[k][i] = values[k];
        }
    }
    return VPL_SUCCESS;
}

// Whether any shadow is found by rays, which want their tree before tasks begin.
static bool castsRays(const vplShadeDef* def)
{
    bool casts = def->areaLightCount > 0 || def->compensation != NULL ||
                 (def->lightCount > 0 && def->lightShadows == NULL && def->lightRays);
    for (int i = 0; i < def->emitterCount; i++) {
        casts = casts || (vplEmitterMapOf(def, i) == NULL &&
                          (def->emitters[i].type == VPL_EMITTER_DIRECTIONAL || def->shadows[i].map == NULL));
    }
    return casts;
}

// How a view is shaded.
typedef struct Way {
    bool deferred; // from a G-buffer: all but multipass and batched, and all that is not radiance
    bool interleaved, cuts;
} Way;

static Way findWay(const vplShadeDef* def)
{
    const bool lit = def->lightCount > 0 && vplShowsLight(def->output);
    return (Way){.deferred =
                     def->accumulation >= VPL_ACCUMULATE_DEFERRED || def->output != VPL_OUTPUT_RADIANCE,
                 .interleaved = lit && def->accumulation == VPL_ACCUMULATE_INTERLEAVED && def->interleave > 1,
                 .cuts = lit && def->accumulation == VPL_ACCUMULATE_LIGHTCUTS};
}

static vplFramebuffer framebufferOf(const vplView* view, Way way)
{
    vplFramebuffer framebuffer = vplDefaultFramebuffer(view->width, view->height);
    framebuffer.planeCount = way.deferred ? VPL_PLANE_POSITION + 3 : VPL_PLANE_TRIANGLE + 1;
    framebuffer.scratchBytes = way.deferred ? offsetof(vplTileSums, irradiance) : sizeof(vplTileSums);
    for (int k = 0; way.deferred && k < 3; k++) {
        framebuffer.planes[VPL_PLANE_NORMAL + k].scratch = true; // the triangle's plane says what is there
        framebuffer.planes[VPL_PLANE_POSITION + k].scratch = true;
    }
    return framebuffer;
}

// What a way of shading needs. Interleaved shading replaces shading->def and has planes of its own.
static vplResult openShading(vplShading* s, Way way, vplFramebuffer* framebuffer, vplProgressFcn* progress,
                             void* user)
{
    vplResult result = makeObjects(s);
    if (result == VPL_SUCCESS) {
        result = vplMakeEmitterRays(s);
    }
    if (result == VPL_SUCCESS) {
        result = vplOpenNearLight(s);
    }
    if (result == VPL_SUCCESS && way.interleaved) {
        result = vplOpenInterleave(s, framebuffer);
    }
    if (result == VPL_SUCCESS && way.cuts) {
        result = vplOpenLightcuts(s, progress, user);
    }
    if (result == VPL_SUCCESS && way.deferred && !way.cuts) {
        result = makeColumns(s);
    }
    if (result == VPL_SUCCESS && vplShowsLight(s->def->output) && castsRays(s->def)) {
        result = vplGeometry_PrepareRays(s->geometry);
    }
    return result;
}

static void closeShading(vplShading* s)
{
    vplContext* context = s->geometry->context;
    vplCloseInterleave(s);
    vplCloseLightcuts(s);
    vplCloseNearLight(s);
    vplFree(context, s->columns[0]);
    vplFree(context, s->emitters);
    vplFree(context, s->objects);
    vplFree(context, s->meshes);
}

static vplResult shade(vplShading* s, Way way, const vplFramebuffer* framebuffer, vplProgressFcn* progress,
                       void* user, vplShadeStats* stats)
{
    vplContext* context = s->geometry->context;
    vplRaster* raster = NULL;
    void* uniforms = NULL;
    vplResult result = vplRaster_Create(context, framebuffer, &raster);
    if (result == VPL_SUCCESS) {
        result = way.deferred ? vplRecordDeferred(s, raster) : vplRecordPasses(s, raster, &uniforms);
    }
    if (result == VPL_SUCCESS) {
        result = vplRaster_Run(raster, progress, user, &stats->raster);
    }
    if (result == VPL_SUCCESS && way.interleaved) {
        result = vplGatherInterleaved(s, progress, user);
    }
    vplRaster_Destroy(raster);
    vplFree(context, uniforms);
    return result;
}

vplResult vplShadeView(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                       vplProgressFcn* progress, void* user, vplImage* image, vplShadeStats* statsOut)
{
    vplResult result = checkDef(geometry->context, view, def, image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplShadeStats stats = {0};
    vplShading shading = vplShading_Make(geometry, view, def);
    shading.image = image;
    shading.shadowRays = &stats.shadowRays;
    const Way way = findWay(def);
    vplFramebuffer framebuffer = framebufferOf(view, way);
    result = openShading(&shading, way, &framebuffer, progress, user);
    if (result == VPL_SUCCESS) {
        result = shade(&shading, way, &framebuffer, progress, user, &stats);
    }
    if (way.cuts) {
        vplCountLightcuts(&shading, &stats);
    }
    if (result == VPL_SUCCESS && statsOut != NULL) {
        *statsOut = stats;
    }
    closeShading(&shading);
    return result;
}
