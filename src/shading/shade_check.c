// SPDX-License-Identifier: MIT
// Default defs of shading, and the checks of defs before anything is allocated.
#include "shading/shading.h"

#include <math.h>
#include <string.h>

enum { SHADE_COOKIE = 0x56504cc0, COMPENSATION_COOKIE, GATHER_COOKIE };

vplShadeDef vplDefaultShadeDef(void)
{
    return (vplShadeDef){.batch = 64, .interleave = 4, .cutError = 0.02f, .cookie = SHADE_COOKIE};
}

vplCompensationDef vplDefaultCompensationDef(void)
{
    return (vplCompensationDef){.rayCount = 2,
                                .hitLights = 16,
                                .reflection = 1,
                                .seesEmission = true,
                                .seesReflection = true,
                                .cookie = COMPENSATION_COOKIE};
}

vplGatherDef vplDefaultGatherDef(void)
{
    return (vplGatherDef){.rayCount = 64, .cookie = GATHER_COOKIE};
}

vplResult vplShadeDef_CheckCookie(const vplContext* context, const vplShadeDef* def)
{
    return def->cookie == SHADE_COOKIE
               ? VPL_SUCCESS
               : vplFail(context, VPL_INVALID_ARGUMENT, "vplShadeDef was not made by vplDefaultShadeDef");
}

vplResult vplShadeDef_CheckCompensation(const vplContext* context, const vplShadeDef* def)
{
    const vplCompensationDef* c = def->compensation;
    if (c != NULL && c->cookie != COMPENSATION_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplCompensationDef was not made by vplDefaultCompensationDef");
    }
    if (c != NULL && (c->rayCount < 1 || c->rayCount > VPL_MAX_NEAR_RAYS || c->hitLights < 1)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "vplCompensationDef.rayCount and hitLights are %d and %d, must be in [1, %d] and at least 1",
            c->rayCount, c->hitLights, VPL_MAX_NEAR_RAYS);
    }
    return VPL_SUCCESS;
}

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

static vplResult checkRows(const vplContext* context, const vplView* view, const vplShadeDef* def)
{
    const int first = def->firstRow, end = def->endRow;
    const bool good =
        end == 0 || (first >= 0 && first < end && end <= view->height && first % VPL_TILE_SIDE == 0 &&
                     (end % VPL_TILE_SIDE == 0 || end == view->height));
    return good ? VPL_SUCCESS
                : vplFail(context, VPL_INVALID_ARGUMENT,
                          "vplShadeDef has rows %d to %d, must be in [0, %d] and multiples of %d", first, end,
                          view->height, VPL_TILE_SIDE);
}

// The fields of one accumulation.
static vplResult checkChoices(const vplContext* context, const vplShadeDef* def)
{
    const struct {
        const char* name;
        unsigned value, last;
    } rows[] = {{"lighting", (unsigned)def->lighting, VPL_LIGHTING_DOCUMENTED},
                {"accumulation", (unsigned)def->accumulation, VPL_ACCUMULATE_USUAL},
                {"output", (unsigned)def->output, VPL_OUTPUT_BACKGROUND}};
    for (int i = 0; i < 3; i++) {
        if (rows[i].value > rows[i].last) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "vplShadeDef.%s is %d, must be in [0, %d]",
                           rows[i].name, (int)rows[i].value, (int)rows[i].last);
        }
    }
    return VPL_SUCCESS;
}

static vplResult checkAccumulation(const vplContext* context, const vplShadeDef* def)
{
    TRY(checkChoices(context, def));
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

static vplResult checkGather(const vplContext* context, const vplShadeDef* def)
{
    const vplGatherDef* g = def->gather;
    if (g != NULL && g->cookie != GATHER_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplGatherDef was not made by vplDefaultGatherDef");
    }
    if (g != NULL && g->meet == NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplGatherDef.meet is NULL, must be a function");
    }
    if (g != NULL && (g->rayCount < 1 || g->rayCount > VPL_MAX_NEAR_RAYS)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplGatherDef.rayCount is %d, must be in [1, %d]",
                       g->rayCount, VPL_MAX_NEAR_RAYS);
    }
    if (g != NULL && def->lighting != VPL_LIGHTING_PHYSICAL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "a final gather needs physical lighting");
    }
    return VPL_SUCCESS;
}

static vplResult checkDistance(const vplContext* context, const char* name, float distance)
{
    return distance >= 0 && isfinite(distance)
               ? VPL_SUCCESS
               : vplFail(context, VPL_INVALID_ARGUMENT, "vplShadeDef.%s is %g, must be finite and >= 0", name,
                         (double)distance);
}

static vplResult checkSamples(const vplContext* context, const vplShadeDef* def)
{
    return def->samples >= 0 && def->samples <= VPL_MAX_SAMPLES_PER_PIXEL
               ? VPL_SUCCESS
               : vplFail(context, VPL_INVALID_ARGUMENT, "vplShadeDef.samples is %d, must be in [0, %d]",
                         def->samples, VPL_MAX_SAMPLES_PER_PIXEL);
}

vplResult vplShadeDef_CheckGbuffer(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def)
{
    TRY(vplShadeDef_CheckCookie(geometry->context, def));
    TRY(checkSamples(geometry->context, def));
    return checkRows(geometry->context, view, def);
}

// Refuses a G-buffer that was made for another picture: its pixels would be shown without a warning.
static vplResult checkKept(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def)
{
    const vplGbuffer* g = def->gbuffer;
    if (g == NULL || !vplShowsSamples(def->output)) {
        return VPL_SUCCESS;
    }
    const int first = vplShadeDef_FirstRow(def), end = vplShadeDef_EndRow(def, view);
    const char* differs = g->geometry != geometry                     ? "geometry"
                          : memcmp(&g->view, view, sizeof *view) != 0 ? "view"
                          : g->samples != (def->samples & ~1)         ? "number of samples"
                          : g->firstRow > first || g->endRow < end    ? "rows"
                                                                      : NULL;
    return differs == NULL ? VPL_SUCCESS
                           : vplFail(geometry->context, VPL_INVALID_ARGUMENT,
                                     "vplShadeDef.gbuffer was made for another %s", differs);
}

vplResult vplShadeDef_Check(const vplGeometry* geometry, const vplView* view, const vplShadeDef* def,
                            const vplImage* image)
{
    const vplContext* context = geometry->context;
    TRY(vplShadeDef_CheckCookie(context, def));
    if (image->width != view->width || image->height != view->height) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "image is %dx%d, must be %dx%d as the view",
                       image->width, image->height, view->width, view->height);
    }
    TRY(checkDistance(context, "minDistance", def->minDistance));
    TRY(checkSamples(context, def));
    TRY(checkDistance(context, "areaLightMinDistance", def->areaLightMinDistance));
    TRY(vplShadeDef_CheckCompensation(context, def));
    TRY(checkRows(context, view, def));
    TRY(checkKept(geometry, view, def));
    TRY(checkGather(context, def));
    if (def->output == VPL_OUTPUT_BACKGROUND && geometry->environment == NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "a background needs an environment");
    }
    if (def->output == VPL_OUTPUT_SHADOW_FACTOR &&
        (def->emitterCount < 1 || ((def->emitterMaps == NULL || def->emitterMaps[0] == NULL) &&
                                   (def->shadows == NULL || def->shadows[0].map == NULL)))) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "a shadow factor needs an emitter with a shadow map");
    }
    return checkAccumulation(context, def);
}
