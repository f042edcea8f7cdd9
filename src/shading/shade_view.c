// SPDX-License-Identifier: MIT
// Sets up one render of one view and hands it to the pipeline that was asked for.
#include "math/scalar.h"
#include "math/vec.h"
#include "shading/shading.h"
#include "visibility/drawing.h"

#include <math.h>
#include <stddef.h>

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
    if (!(def->lampMinDistance >= 0 && isfinite(def->lampMinDistance))) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplShadeDef.lampMinDistance is %g, must be finite and >= 0",
                       (double)def->lampMinDistance);
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
    return VPL_SUCCESS;
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
                        .lampInverseBound = vplInverseSquare(def->lampMinDistance),
                        .smooth = geometry->shadingNormals != NULL};
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
    bool casts = def->lampCount > 0 || def->compensation != NULL ||
                 (def->lightCount > 0 && def->lightShadows == NULL && def->lightRays);
    for (int i = 0; i < def->emitterCount; i++) {
        casts = casts || (vplEmitterMapOf(def, i) == NULL &&
                          (def->emitters[i].type == VPL_EMITTER_DIRECTIONAL || def->shadows[i].map == NULL));
    }
    return casts;
}

vplResult vplShadeView(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                       vplProgressFcn* progress, void* user, vplImage* image, vplShadeStats* statsOut)
{
    vplContext* context = geometry->context;
    vplResult result = checkDef(context, view, def, image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplShading shading = vplShading_Make(geometry, view, def);
    shading.image = image;
    vplShadeStats stats = {0};
    shading.shadowRays = &stats.shadowRays;
    bool deferred = def->accumulation >= VPL_ACCUMULATE_DEFERRED || def->output != VPL_OUTPUT_RADIANCE;
    bool interleaved = def->accumulation == VPL_ACCUMULATE_INTERLEAVED && def->interleave > 1 &&
                       def->lightCount > 0 && def->output == VPL_OUTPUT_RADIANCE;
    const bool cuts = def->accumulation == VPL_ACCUMULATE_LIGHTCUTS && def->lightCount > 0 &&
                      def->output == VPL_OUTPUT_RADIANCE;
    vplFramebuffer framebuffer = vplDefaultFramebuffer(view->width, view->height);
    framebuffer.planeCount = deferred ? VPL_PLANE_POSITION + 3 : VPL_PLANE_TRIANGLE + 1;
    framebuffer.scratchBytes = deferred ? offsetof(vplTileSums, irradiance) : sizeof(vplTileSums);
    for (int k = 0; deferred && k < 3; k++) {
        framebuffer.planes[VPL_PLANE_NORMAL + k].scratch = true; // the triangle's plane says what is there
        framebuffer.planes[VPL_PLANE_POSITION + k].scratch = true;
    }
    vplRaster* raster = NULL;
    void* uniforms = NULL;
    result = makeObjects(&shading);
    if (result == VPL_SUCCESS) {
        result = vplMakeEmitterRays(&shading);
    }
    if (result == VPL_SUCCESS) {
        result = vplOpenNearLight(&shading);
    }
    if (result == VPL_SUCCESS && interleaved) {
        result = vplOpenInterleave(&shading, &framebuffer);
    }
    if (result == VPL_SUCCESS && cuts) {
        result = vplOpenLightcuts(&shading, progress, user);
    }
    if (result == VPL_SUCCESS && deferred && !cuts) {
        result = makeColumns(&shading);
    }
    if (result == VPL_SUCCESS && def->output == VPL_OUTPUT_RADIANCE && castsRays(def)) {
        result = vplGeometry_PrepareRays(geometry);
    }
    if (result == VPL_SUCCESS) {
        result = vplRaster_Create(context, &framebuffer, &raster);
    }
    if (result == VPL_SUCCESS) {
        result =
            deferred ? vplRecordDeferred(&shading, raster) : vplRecordPasses(&shading, raster, &uniforms);
    }
    if (result == VPL_SUCCESS) {
        result = vplRaster_Run(raster, progress, user, &stats.raster);
    }
    if (result == VPL_SUCCESS && interleaved) {
        result = vplGatherInterleaved(&shading, progress, user);
    }
    if (cuts) {
        vplCountLightcuts(&shading, &stats);
    }
    if (result == VPL_SUCCESS && statsOut != NULL) {
        *statsOut = stats;
    }
    vplRaster_Destroy(raster);
    vplCloseInterleave(&shading);
    vplCloseLightcuts(&shading);
    vplCloseNearLight(&shading);
    vplFree(context, uniforms);
    vplFree(context, shading.columns[0]);
    vplFree(context, shading.emitters);
    vplFree(context, shading.objects);
    vplFree(context, shading.meshes);
    return result;
}
