// SPDX-License-Identifier: MIT
// One render of one view: chooses the strategy that accumulates its light, and runs it.
#include "lights/light_set.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "shading/shading.h"
#include "visibility/drawing.h"

#include <math.h>

float vplInverseSquare(float distance)
{
    return distance > 0 ? 1 / (distance * distance) : INFINITY;
}

vplShading vplShading_Make(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def)
{
    const bool documented = def->lighting == VPL_LIGHTING_DOCUMENTED;
    return (vplShading){
        .geometry = geometry,
        .view = view,
        .def = def,
        .kernels = *vplGetShadingKernels(geometry->context->isa, def->lighting),
        .direct = {.emitters = def->emitters,
                   .shadows = def->shadows,
                   .maps = def->emitterMaps,
                   .emitterCount = def->emitterCount,
                   .perPoint = documented ? 0 : def->emittersPerPoint,
                   .trianglesPerPoint = documented ? 0 : def->trianglesPerPoint,
                   .weight = documented && def->particleCount > 0 ? 1 / (float)def->particleCount : 1,
                   .areaLights = def->areaLights,
                   .areaLightCount = def->areaLightCount,
                   .areaLightInverseClamp = vplInverseSquare(def->areaLightMinDistance)},
        .lights = {.lights = def->lights,
                   .count = def->lightCount,
                   .maps = def->lightShadows,
                   .clusters = def->lightClusters,
                   .castsRays = def->lightShadows == NULL && def->lightRays,
                   .inverseClamp = vplInverseSquare(def->minDistance)},
        .samples = def->samples & ~1,
        .smooth = geometry->shadingNormals != NULL,
        .irradiance = def->output == VPL_OUTPUT_GATHER || def->output == VPL_OUTPUT_DENOISED,
        .firstRow = vplShadeDef_FirstRow(def),
        .endRow = view != NULL ? vplShadeDef_EndRow(def, view) : 0};
}

// ---- what a render owns

static vplResult makeObjects(vplShading* s)
{
    const vplGeometry* g = s->geometry;
    const size_t count = (size_t)g->objectCount;
    s->meshes = vplArena_Alloc(s->arena, count, sizeof *s->meshes);
    s->objects = vplArena_Alloc(s->arena, count, sizeof *s->objects);
    TRY(vplArena_Check(s->arena));
    for (int i = 0; i < g->objectCount; i++) {
        const vplGeometryObject* o = &g->objects[i];
        s->meshes[i] = vplMeshOfObject(g, i);
        s->objects[i] = (vplObjectUniforms){s, g->positions + o->firstVertex,
                                            o->smooth ? g->shadingNormals + o->firstVertex : NULL, i};
    }
    return VPL_SUCCESS;
}

static vplResult findTrees(vplDirectLight* direct, const vplShading* s)
{
    const bool emitters = direct->perPoint > 0 && direct->perPoint < direct->emitterCount;
    const bool triangles = direct->trianglesPerPoint > 0;
    const vplTreesWanted wanted = {emitters ? 1 : INT32_MAX, triangles ? 1 : INT32_MAX};
    if (!emitters && !triangles) {
        return VPL_SUCCESS;
    }
    direct->trees = s->def->emitterTrees;
    if (direct->trees == NULL) {
        vplEmitterTrees* own;
        TRY(vplEmitterTrees_Create(s->geometry, direct->emitters, direct->emitterCount, wanted, &own));
        vplArena_Absorb(s->arena, own->arena);
        direct->trees = own;
    }
    direct->tree = emitters ? direct->trees->emitters : NULL;
    direct->triangleTree = triangles ? direct->trees->triangles : NULL;
    direct->firstParallel =
        direct->trees->directionalCount > 0 ? direct->trees->directional[0] : direct->emitterCount;
    return VPL_SUCCESS;
}

vplResult vplDirectLight_Open(vplDirectLight* direct, const vplShading* s, vplLighting lighting)
{
    vplEmitterRay* rays = vplArena_Alloc(s->arena, (size_t)direct->emitterCount, sizeof *rays);
    TRY(vplArena_Check(s->arena));
    for (int i = 0; i < direct->emitterCount; i++) {
        const vplEmitterDef* e = &direct->emitters[i];
        double sine, inner, outer;
        vplSinCos(e->innerAngle, &sine, &inner);
        vplSinCos(e->outerAngle, &sine, &outer);
        rays[i] = (vplEmitterRay){.position = e->position,
                                  .direction = vplNormalize(e->direction),
                                  .cosOuter = (float)outer,
                                  .inverseRing = inner > outer ? (float)(1 / (inner - outer)) : 0x1p100f,
                                  .spot = e->type == VPL_EMITTER_SPOT,
                                  .parallel = e->type == VPL_EMITTER_DIRECTIONAL,
                                  .falloff = lighting == VPL_LIGHTING_PHYSICAL};
    }
    direct->rays = rays;
    return findTrees(direct, s);
}

vplResult vplMakeColumns(vplShading* s)
{
    vplLightList* list = &s->lights;
    if (list->count == 0 || list->maps != NULL || list->castsRays) {
        return VPL_SUCCESS;
    }
    const size_t groups = ((size_t)list->count + VPL_LIGHT_GROUP - 1) / VPL_LIGHT_GROUP;
    // Culling reads whole vectors, of interleaved lights from any light on.
    const size_t padded = groups * VPL_LIGHT_GROUP + VPL_LANES;
    float* storage = vplArena_AllocZero(s->arena, 6 * padded, sizeof *storage);
    TRY(vplArena_Check(s->arena));
    for (int k = 0; k < 6; k++) {
        list->columns[k] = storage + (size_t)k * padded;
    }
    for (int i = 0; i < list->count; i++) {
        for (int k = 0; k < 6; k++) {
            list->columns[k][i] = vplShadeLight_Column(&list->lights[i], k);
        }
    }
    return VPL_SUCCESS;
}

// ---- the strategy

static const vplStrategy* chooseStrategy(const vplShadeDef* def, const vplGeometry* geometry)
{
    if (def->output == VPL_OUTPUT_BACKGROUND) {
        return &vplBackgroundStrategy;
    }
    if (!vplIsLight(def->output)) {
        return &vplShowStrategy;
    }
    // Cut-outs are put into a G-buffer; multipass and batched pictures have the same bits as deferred ones.
    if (def->accumulation < VPL_ACCUMULATE_DEFERRED && def->output == VPL_OUTPUT_RADIANCE &&
        geometry->cutOuts == NULL) {
        return &vplPassesStrategy;
    }
    if ((def->lightCount > 0 || def->gather != NULL) && def->accumulation == VPL_ACCUMULATE_INTERLEAVED &&
        def->interleave > 1) {
        return &vplInterleavedStrategy;
    }
    if (def->lightCount > 0 && def->accumulation == VPL_ACCUMULATE_LIGHTCUTS) {
        return &vplLightcutsStrategy;
    }
    return &vplDeferredStrategy;
}

static vplResult draw(vplShading* s, const vplStrategy* strategy, const vplFramebuffer* framebuffer,
                      vplRasterStats* stats)
{
    vplRaster* raster = NULL;
    TRY(vplRaster_Create(s->geometry->context, framebuffer, &raster));
    vplResult result = strategy->record(s, raster);
    if (result == VPL_SUCCESS) {
        result = vplRaster_Run(raster, s->def->progress, s->def->progressUser, stats);
    }
    vplRaster_Destroy(raster);
    return result;
}

static vplResult shade(vplShading* s, const vplStrategy* strategy, vplShadeStats* stats)
{
    vplFramebuffer framebuffer = vplDefaultFramebuffer(s->view->width, s->view->height);
    framebuffer.reversedDepth = true;
    framebuffer.firstRow = s->firstRow;
    framebuffer.endRow = s->endRow;
    TRY(makeObjects(s));
    TRY(vplDirectLight_Open(&s->direct, s, s->def->lighting));
    TRY(vplCompensator_Open(s));
    TRY(vplGather_Open(s));
    TRY(strategy->open(s, &framebuffer));
    TRY(draw(s, strategy, &framebuffer, &stats->raster));
    return strategy->finish != NULL ? strategy->finish(s, stats) : VPL_SUCCESS;
}

static vplResult shadeInArena(vplShading* s, const vplStrategy* strategy, vplShadeStats* stats)
{
    s->arena = vplArena_Create(s->geometry->context);
    const vplResult result = shade(s, strategy, stats);
    vplArena_Destroy(s->arena);
    return result;
}

vplResult vplShadeView(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                       vplImage* image, vplShadeStats* statsOut)
{
    REQUIRE(CONTEXT_OF(geometry) ?: CONTEXT_OF(image), geometry, view, def, image);
    TRY(vplShadeDef_Check(geometry, view, def, image));
    vplShadeStats stats = {0};
    vplShading shading = vplShading_Make(geometry, view, def);
    shading.image = image;
    shading.shadowRays = &stats.shadowRays;
    TRY(shadeInArena(&shading, chooseStrategy(def, geometry), &stats));
    if (statsOut != NULL) {
        *statsOut = stats;
    }
    return VPL_SUCCESS;
}

vplResult vplGbuffer_Create(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                            vplGbuffer** gbufferOut, vplRasterStats* statsOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, view, def, gbufferOut);
    TRY(vplShadeDef_CheckGbuffer(geometry, view, def));
    vplShadeDef unlit = vplDefaultShadeDef();
    unlit.samples = def->samples;
    unlit.firstRow = def->firstRow;
    unlit.endRow = def->endRow;
    unlit.progress = def->progress;
    unlit.progressUser = def->progressUser;
    vplGbuffer* g = vplAllocZero(geometry->context, 1, sizeof *g);
    if (g == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    g->context = geometry->context;
    g->geometry = geometry;
    g->view = *view;
    vplShadeStats stats = {0};
    vplShading shading = vplShading_Make(geometry, view, &unlit);
    shading.state = g;
    const vplResult result = shadeInArena(&shading, &vplKeepStrategy, &stats);
    if (result != VPL_SUCCESS) {
        vplGbuffer_Destroy(g);
        return result;
    }
    *gbufferOut = g;
    if (statsOut != NULL) {
        *statsOut = stats.raster;
    }
    return VPL_SUCCESS;
}

void vplGbuffer_Destroy(vplGbuffer* g)
{
    if (g != NULL) {
        vplContext* context = g->context;
        vplFree(context, g->tiles);
        vplFree(context, g);
    }
}
