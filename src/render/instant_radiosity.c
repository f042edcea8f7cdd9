// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights: simulate particles, render the cube
// shadow map of the point light, render the scene lit by it with shadows, then add every virtual light.
// Direct lighting is the same recipe without particles.
#include "math/sampling.h"
#include "render/render.h"

#include <math.h>

// Shadow maps from some points.
typedef struct Maps {
    vplCubeMap** maps; // NULL where a point needs none
    vplShadow* shadows;
    int count;
} Maps;

typedef struct Ingredients {
    const vplEmitterDef* emitters;
    int emitterCount;
    Maps emitterMaps, lightMaps;
    vplShadeLight* lamps;
    int lampCount;
    float lampMinDistance;
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
        // A light stands for its share of all surfaces; nearer than that share's radius it is no point. Half as
        // much leaves 5 to 35 % more rmse and twice as much takes a few per cent of the light away (room,
        // room-area, cornell-area; 32 to 2048 particles with shadows by rays; --show indirect).
        double share = in->lightCount ? vplGeometry_Area(job->geometry) / in->lightCount : 0;
        in->minDistance = (float)sqrt(share / VPL_PI);
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

static vplResult allocateMaps(vplJob* job, int count, Maps* maps)
{
    maps->count = count;
    maps->maps = vplAllocZero(job->context, (size_t)count, sizeof *maps->maps);
    maps->shadows = vplAllocZero(job->context, (size_t)count, sizeof *maps->shadows);
    return maps->maps && maps->shadows ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static void freeMaps(vplJob* job, Maps* maps)
{
    for (int i = 0; maps->maps != NULL && i < maps->count; i++) {
        vplCubeMap_Destroy(maps->maps[i]);
    }
    vplFree(job->context, maps->maps);
    vplFree(job->context, maps->shadows);
}

// Bounds are found where they cost less than the samples that they save: a texel's cost 0.5 to 0.8 ns, and 1.5 ns
// are saved per sample and pixel (bench/shadow: the room, a conference room).
static vplResult boundMap(vplJob* job, vplCubeMap* map, int samples)
{
    const vplRenderOptions* o = &job->options;
    const double lookedUp = (double)o->width * o->height * o->antialias * samples;
    const bool pays = samples >= VPL_MIN_BOUND_SAMPLES && lookedUp > 3.0 * map->size * map->size;
    return pays ? vplCubeMap_FindBounds(map) : VPL_SUCCESS;
}

static vplResult makeMap(vplJob* job, vplVec3 position, int size, const vplShadowDef* shadowDef, Maps* maps,
                         int i)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = position;
    def.size = size;
    vplResult result = vplCubeMap_Create(job->geometry, &def, vplJob_GetProgress(job), job, &maps->maps[i]);
    if (result == VPL_SUCCESS) {
        vplJob_AddRaster(job, &maps->maps[i]->stats);
        result = boundMap(job, maps->maps[i], shadowDef->pcfSamples);
    }
    if (result == VPL_SUCCESS) {
        result = vplShadow_Create(maps->maps[i], shadowDef, &maps->shadows[i]);
    }
    return result;
}

// Point and spot emitters have cube maps; directional ones, and all where rays are asked for, do without.
static vplResult makeEmitterShadows(vplJob* job, Ingredients* in)
{
    const vplRenderOptions* o = &job->options;
    const bool documented = o->lighting == VPL_LIGHTING_DOCUMENTED;
    vplShadowDef shadowDef = o->shadow;
    if (shadowDef.biasRule == VPL_BIAS_AUTO && documented) {
        shadowDef.biasRule = VPL_BIAS_PAIR;
    }
    vplResult result = allocateMaps(job, in->emitterCount, &in->emitterMaps);
    for (int i = 0; i < in->emitterCount && result == VPL_SUCCESS; i++) {
        if (documented && in->emitters[i].type != VPL_EMITTER_POINT) {
            return vplFail(
                job->context, VPL_INVALID_ARGUMENT,
                "light %d is not a point light, and documented lighting knows no others; use physical", i);
        }
        if (in->emitters[i].type != VPL_EMITTER_DIRECTIONAL && o->lightShadows != VPL_LIGHT_SHADOWS_RAY) {
            result =
                makeMap(job, in->emitters[i].position, o->shadowMapSize, &shadowDef, &in->emitterMaps, i);
        }
    }
    return result;
}

// One small map per virtual light, seen from just above its surface.
static vplResult makeLightShadows(vplJob* job, Ingredients* in)
{
    vplShadowDef shadowDef = vplDefaultShadowDef();
    shadowDef.pcfSamples = 1;
    const float lift = vplGeometry_Diagonal(job->geometry) * 0x1p-14f;
    vplResult result = allocateMaps(job, in->lightCount, &in->lightMaps);
    for (int i = 0; i < in->lightCount && result == VPL_SUCCESS; i++) {
        const vplShadeLight* l = &in->lights[i];
        vplVec3 at = {l->px + lift * l->nx, l->py + lift * l->ny, l->pz + lift * l->nz};
        result = makeMap(job, at, job->options.lightMapSize, &shadowDef, &in->lightMaps, i);
    }
    return result;
}

static vplResult makeLamps(vplJob* job, Ingredients* in)
{
    vplEmission* emission;
    vplResult result = vplEmission_Create(job->geometry, NULL, 0, &emission);
    if (result != VPL_SUCCESS) {
        return result;
    }
    double area = 0;
    if (emission->sourceCount > 0) {
        const int count = job->options.lampLights;
        in->lamps = vplAlloc(job->context, (size_t)count, sizeof *in->lamps);
        in->lampCount = in->lamps ? vplMakeLampLights(emission, count, in->lamps) : 0;
        result = in->lamps ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
        area = vplEmission_Area(emission);
        in->lampMinDistance = (float)(0.5 * sqrt(area / count / VPL_PI));
    }
    vplEmission_Destroy(emission);
    return result;
}

static vplResult makeDirect(vplJob* job, Ingredients* in)
{
    vplResult result = makeEmitterShadows(job, in);
    if (result == VPL_SUCCESS && job->options.lighting == VPL_LIGHTING_PHYSICAL) {
        result = makeLamps(job, in);
    }
    return result;
}

// One look at every pixel at place i of `count`: Hammersley points, so that edges along the axes, too, are cut at
// as many places as there are samples.
static vplResult shadeSample(vplJob* job, const vplShadeDef* def, int i, int count)
{
    double y = vplVanDerCorput((uint32_t)i) + 0.5 / count;
    vplView view = vplView_At(&job->view, (i + 0.5) / count, y - floor(y));
    vplShadeStats stats = {0};
    vplResult result =
        vplShadeView(job->geometry, &view, def, vplJob_GetProgress(job), job, job->image, &stats);
    vplJob_AddRaster(job, &stats.raster);
    job->stats.rays += stats.shadowRays;
    return result;
}

static vplResult shadeSamples(vplJob* job, const vplShadeDef* def)
{
    const int count = job->options.antialias;
    const size_t values = 3 * (size_t)job->image->width * (size_t)job->image->height;
    if (count == 1) {
        return shadeSample(job, def, 0, 1);
    }
    double* sums = vplAllocZero(job->context, values, sizeof *sums);
    vplResult result = sums ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    const double from = job->progressFrom, to = job->progressTo;
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        job->progressFrom = from + (to - from) * i / count;
        job->progressTo = from + (to - from) * (i + 1) / count;
        result = shadeSample(job, def, i, count);
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
    def.interleave = o->interleave;
    def.minDistance = in->minDistance;
    def.emitters = in->emitters;
    def.shadows = in->emitterMaps.shadows;
    def.emitterCount = in->emitterMaps.shadows ? in->emitterCount : 0;
    def.lamps = in->lamps;
    def.lampCount = in->lampCount;
    def.lampMinDistance = in->lampMinDistance;
    def.lightShadows = in->lightMaps.shadows;
    def.lightRays = o->lightShadows == VPL_LIGHT_SHADOWS_RAY;
    def.particleCount = o->method == VPL_METHOD_DIRECT ? 1 : o->particles;
    def.lights = in->lights;
    def.lightCount = in->lightCount;
    def.emission = !indirectOnly;
    vplResult result = vplImage_Create(job->context, o->width, o->height, &job->image);
    return result == VPL_SUCCESS ? shadeSamples(job, &def) : result;
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
        result = makeDirect(job, in);
        vplJob_EndStage(job, "shadow map");
    }
    if (result == VPL_SUCCESS && in->lightCount > 0 && o->lightShadows == VPL_LIGHT_SHADOWS_MAP) {
        vplJob_BeginStage(job, 0.4);
        result = makeLightShadows(job, in);
        vplJob_EndStage(job, "light shadow maps");
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    if (o->show == VPL_SHOW_SHADOW_MAP || o->show == VPL_SHOW_SHADOW_FACTOR) {
        if (in->emitterCount == 0 || in->emitterMaps.maps[0] == NULL) {
            return vplFail(job->context, VPL_INVALID_ARGUMENT,
                           "the scene has no light with a shadow map, or the first casts shadows by rays");
        }
        if (o->show == VPL_SHOW_SHADOW_MAP) {
            return vplUnfoldCubeMap(in->emitterMaps.maps[0], &job->image);
        }
    }
    vplJob_BeginStage(job, 1);
    result = shade(job, in);
    vplJob_EndStage(job, "shading");
    if (result == VPL_SUCCESS && o->show == VPL_SHOW_OVERLAY && in->set != NULL) {
        result = vplGeometry_PrepareRays(job->geometry);
    }
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
    freeMaps(job, &in.emitterMaps);
    freeMaps(job, &in.lightMaps);
    vplFree(job->context, in.lamps);
    vplFree(job->context, in.lights);
    vplLightSet_Destroy(in.set);
    return result;
}
