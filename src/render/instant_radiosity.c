// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights: simulate particles, render the cube
// shadow map of the point light, render the scene lit by it with shadows, then add every virtual light.
// Direct lighting is the same recipe without particles.
#include "render/render.h"

#include <math.h>

typedef struct Ingredients {
    const vplEmitterDef* emitters;
    int emitterCount;
    vplCubeMap** maps; // one per emitter
    vplShadow* shadows;
    vplLightSet* set;
    vplShadeLight* lights;
    int lightCount;
    float minDistance;
} Ingredients;

static bool needsLights(const vplRenderOptions* o)
{
    bool shown = o->show == VPL_SHOW_PICTURE || o->show == VPL_SHOW_INDIRECT || o->show == VPL_SHOW_LIGHT ||
                 o->show == VPL_SHOW_OVERLAY;
    return shown && o->method != VPL_METHOD_DIRECT;
}

static bool needsShadows(const vplRenderOptions* o)
{
    return o->show != VPL_SHOW_DEPTH && o->show != VPL_SHOW_NORMALS && o->show != VPL_SHOW_INDIRECT &&
           o->show != VPL_SHOW_LIGHT;
}

static vplResult simulate(vplJob* job, Ingredients* in)
{
    const vplRenderOptions* o = &job->options;
    vplResult result = vplJob_MakeLights(job, &in->set);
    if (result != VPL_SUCCESS) {
        return result;
    }
    in->lights = vplAlloc(job->context, (size_t)in->set->lightCount, sizeof *in->lights);
    if (in->lights == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplPrepareLights(in->set, o->lighting, in->lights);
    in->lightCount = in->set->lightCount;
    in->minDistance = o->minDistance;
    if (o->minDistance < 0) {
        // A light stands for its share of all surfaces; nearer than about that share's radius it is no point.
        double share = in->lightCount ? vplGeometry_Area(job->geometry) / in->lightCount : 0;
        in->minDistance = (float)(0.5 * sqrt(share / VPL_PI));
    }
    job->stats.minDistance = in->minDistance;
    if (o->show == VPL_SHOW_LIGHT) {
        if (o->showLight >= in->lightCount) {
            return vplFail(job->context, VPL_INVALID_ARGUMENT,
                           "virtual light %d does not exist, there are %d (from 0)", o->showLight,
                           in->lightCount);
        }
        in->lights[0] = in->lights[o->showLight];
        in->lightCount = 1;
    }
    return VPL_SUCCESS;
}

static vplResult makeShadows(vplJob* job, Ingredients* in)
{
    const vplRenderOptions* o = &job->options;
    in->maps = vplAllocZero(job->context, (size_t)in->emitterCount, sizeof *in->maps);
    in->shadows = vplAlloc(job->context, (size_t)in->emitterCount, sizeof *in->shadows);
    vplResult result = in->maps && in->shadows ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    vplShadowDef shadowDef = o->shadow;
    if (shadowDef.biasRule == VPL_BIAS_AUTO && o->lighting == VPL_LIGHTING_DOCUMENTED) {
        shadowDef.biasRule = VPL_BIAS_PAIR;
    }
    for (int i = 0; i < in->emitterCount && result == VPL_SUCCESS; i++) {
        if (in->emitters[i].type != VPL_EMITTER_POINT) {
            return vplFail(job->context, VPL_INVALID_ARGUMENT, "light %d is not a point light", i);
        }
        vplCubeMapDef def = vplDefaultCubeMapDef();
        def.position = in->emitters[i].position;
        def.size = o->shadowMapSize;
        result = vplCubeMap_Create(job->geometry, &def, vplJob_GetProgress(job), job, &in->maps[i]);
        if (result == VPL_SUCCESS) {
            vplJob_AddRaster(job, &in->maps[i]->stats);
            result = vplShadow_Create(in->maps[i], &shadowDef, &in->shadows[i]);
        }
    }
    return result;
}

static vplResult shade(vplJob* job, const Ingredients* in)
{
    const vplRenderOptions* o = &job->options;
    bool indirectOnly = o->show == VPL_SHOW_INDIRECT || o->show == VPL_SHOW_LIGHT;
    vplShadeDef def = {0};
    def.lighting = o->lighting;
    def.accumulation = o->accumulation;
    def.output = o->show == VPL_SHOW_DEPTH           ? VPL_OUTPUT_DEPTH
                 : o->show == VPL_SHOW_NORMALS       ? VPL_OUTPUT_NORMALS
                 : o->show == VPL_SHOW_SHADOW_FACTOR ? VPL_OUTPUT_SHADOW_FACTOR
                                                     : VPL_OUTPUT_RADIANCE;
    def.batch = o->batch;
    def.minDistance = in->minDistance;
    def.emitters = in->emitters;
    def.shadows = in->shadows;
    def.emitterCount = in->shadows ? in->emitterCount : 0;
    def.particleCount = o->method == VPL_METHOD_DIRECT ? 1 : o->particles;
    def.lights = in->lights;
    def.lightCount = in->lightCount;
    def.emission = !indirectOnly;
    vplResult result = vplImage_Create(job->context, o->width, o->height, &job->image);
    vplRasterStats stats = {0};
    if (result == VPL_SUCCESS) {
        result =
            vplShadeView(job->geometry, &job->view, &def, vplJob_GetProgress(job), job, job->image, &stats);
    }
    vplJob_AddRaster(job, &stats);
    return result;
}

static vplResult cook(vplJob* job, Ingredients* in)
{
    const vplRenderOptions* o = &job->options;
    vplResult result = VPL_SUCCESS;
    if (needsLights(o)) {
        vplJob_BeginStage(job, 0.05);
        result = simulate(job, in);
        vplJob_EndStage(job, "particles");
    }
    if (result == VPL_SUCCESS && needsShadows(o)) {
        vplJob_BeginStage(job, 0.15);
        result = makeShadows(job, in);
        vplJob_EndStage(job, "shadow map");
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    if (o->show == VPL_SHOW_SHADOW_MAP || o->show == VPL_SHOW_SHADOW_FACTOR) {
        if (in->emitterCount == 0) {
            return vplFail(job->context, VPL_INVALID_ARGUMENT, "the scene has no light that casts shadows");
        }
        if (o->show == VPL_SHOW_SHADOW_MAP) {
            return vplUnfoldCubeMap(in->maps[0], &job->image);
        }
    }
    vplJob_BeginStage(job, 1);
    result = shade(job, in);
    vplJob_EndStage(job, "shading");
    if (result == VPL_SUCCESS && o->show == VPL_SHOW_OVERLAY && in->set != NULL) {
        vplDrawLights(job->image, job->geometry, &job->view, in->set);
    }
    return result;
}

vplResult vplRenderInstantRadiosity(vplJob* job)
{
    Ingredients in = {0};
    in.emitterCount = vplScene_GetEmitterCount(job->scene);
    in.emitters = in.emitterCount ? vplScene_GetEmitter(job->scene, 0) : NULL;
    vplResult result = cook(job, &in);
    for (int i = 0; in.maps != NULL && i < in.emitterCount; i++) {
        vplCubeMap_Destroy(in.maps[i]);
    }
    vplFree(job->context, in.maps);
    vplFree(job->context, in.shadows);
    vplFree(job->context, in.lights);
    vplLightSet_Destroy(in.set);
    return result;
}
