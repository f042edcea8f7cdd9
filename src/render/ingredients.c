// SPDX-License-Identifier: MIT
#include "render/choose_shadows.h"
#include "render/radiosity.h"
#include "render/ssvp.h"

#include <math.h>

// ---- shadow maps and lamps

static vplResult allocateMaps(vplJob* job, int count, vplMaps* maps)
{
    maps->count = count;
    maps->maps = vplAllocZero(job->context, (size_t)count, sizeof *maps->maps);
    maps->shadows = vplAllocZero(job->context, (size_t)count, sizeof *maps->shadows);
    return maps->maps && maps->shadows ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static void freeMaps(vplJob* job, vplMaps* maps)
{
    for (int i = 0; maps->maps != NULL && i < maps->count; i++) {
        vplCubeMap_Destroy(maps->maps[i]);
    }
    vplFree(job->context, maps->maps);
    vplFree(job->context, maps->shadows);
    *maps = (vplMaps){0};
}

// Bounds are found where they cost less than the samples that they save: a texel's cost 0.5 to 0.8 ns, and 1.5 ns
// are saved per sample and pixel (bench/shadow: the room, a conference room).
static vplResult boundMap(vplJob* job, vplCubeMap* map, int samples)
{
    const vplRenderOptions* o = &job->options;
    const double lookedUp = (double)o->output.width * o->output.height * o->output.antialias * samples;
    const bool pays = samples >= VPL_MIN_BOUND_SAMPLES && lookedUp > 3.0 * map->size * map->size;
    return pays ? vplCubeMap_FindBounds(map) : VPL_SUCCESS;
}

static vplResult makeMap(vplJob* job, vplVec3 position, int size, const vplShadowDef* shadowDef,
                         vplMaps* maps, int i)
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
static vplResult makeEmitterShadows(vplJob* job, vplIngredients* in)
{
    const vplRenderOptions* o = &job->options;
    const bool documented = vplJob_GetShading(job) == VPL_LIGHTING_DOCUMENTED;
    vplShadowDef shadowDef = vplDefaultShadowDef();
    const bool pair = o->shadow.bias >= 0 || o->shadow.biasSlope >= 0;
    shadowDef.biasRule = pair || (documented && o->shadow.bias != VPL_BIAS_OPTION_EXACT) ? VPL_BIAS_PAIR : VPL_BIAS_EXACT;
    shadowDef.biasStatic = o->shadow.bias;
    shadowDef.biasDynamic = o->shadow.biasSlope;
    shadowDef.pcfSamples = o->shadow.pcfSamples;
    shadowDef.pcfOffset = o->shadow.pcfOffset;
    vplResult result = allocateMaps(job, in->emitterCount, &in->emitterMaps);
    for (int i = 0; i < in->emitterCount && result == VPL_SUCCESS; i++) {
        if (documented && in->emitters[i].type != VPL_EMITTER_POINT) {
            return vplFail(
                job->context, VPL_INVALID_ARGUMENT,
                "light %d is not a point light, and documented lighting knows no others; use physical", i);
        }
        if (in->ssvp == NULL && in->emitters[i].type != VPL_EMITTER_DIRECTIONAL &&
            o->lights.shadows != VPL_LIGHT_SHADOWS_RAY) {
            result =
                makeMap(job, in->emitters[i].position, o->shadow.mapSize, &shadowDef, &in->emitterMaps, i);
        }
    }
    return result;
}

int vplLightBatch(const vplJob* job, const vplIngredients* in)
{
    const size_t room = (size_t)VPL_LIGHT_MAP_BYTES / vplHemiMaps_BytesPerMap(job->options.lights.mapSize);
    return room >= (size_t)in->lightCount ? in->lightCount : room > 0 ? (int)room : 1;
}

vplResult vplMakeLightShadows(vplJob* job, vplIngredients* in, int first, int count)
{
    vplHemiMapPlace* places = vplAlloc(job->context, (size_t)count, sizeof *places);
    vplResult result = places ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS && in->lightMaps == NULL) {
        result = vplHemiMaps_Create(job->context, job->options.lights.mapSize, count, &in->lightMaps);
    }
    for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
        const vplShadeLight* l = &in->lights[in->firstShown + first + i];
        places[i] = (vplHemiMapPlace){{l->px, l->py, l->pz}, {l->nx, l->ny, l->nz}};
    }
    if (result == VPL_SUCCESS) {
        result = vplHemiMaps_Draw(in->lightMaps, job->geometry, places, count, vplJob_GetProgress(job), job);
    }
    vplFree(job->context, places);
    return result;
}

static vplResult makeLamps(vplJob* job, vplIngredients* in)
{
    vplEmission* emission;
    vplResult result = vplEmission_Create(job->geometry, NULL, 0, &emission);
    if (result != VPL_SUCCESS) {
        return result;
    }
    double area = 0;
    if (emission->sourceCount > 0) {
        const int count = job->options.lights.areaLightSamples;
        in->areaLights = vplAlloc(job->context, (size_t)count, sizeof *in->areaLights);
        in->areaLightCount = in->areaLights ? vplSampleAreaLights(emission, count, in->areaLights) : 0;
        result = in->areaLights ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
        area = vplEmission_Area(emission);
        in->areaLightMinDistance = (float)(0.5 * sqrt(area / count / VPL_PI));
    }
    vplEmission_Destroy(emission);
    return result;
}

vplResult vplMakeDirectLight(vplJob* job, vplIngredients* in)
{
    vplResult result = makeEmitterShadows(job, in);
    if (result == VPL_SUCCESS && job->options.method != VPL_METHOD_KELLER &&
        job->options.lighting == VPL_LIGHTING_PHYSICAL) {
        result = makeLamps(job, in);
    }
    return result;
}

// ---- virtual lights

// The lights of the set that are shown: all, or one, or all but those on the emitters. These must be kept where rays
// meet what they light.
static vplResult choose(vplJob* job, vplIngredients* in, vplLightSet* shown)
{
    const vplRenderOptions* o = &job->options;
    const vplLightSet* set = in->set;
    in->emitterLightCount =
        o->method == VPL_METHOD_KELLER && o->output.show != VPL_SHOW_LIGHT ? vplCountEmitterLights(set) : 0;
    in->firstShown = 0;
    *shown = *set;
    if (o->output.show == VPL_SHOW_LIGHT) {
        if (o->output.showIndex >= set->lightCount) {
            return vplFail(job->context, VPL_INVALID_ARGUMENT,
                           "virtual light %d does not exist, there are %d (from 0)", o->output.showIndex,
                           set->lightCount);
        }
        shown->lights += o->output.showIndex;
        shown->lightCount = 1;
    }
    if (o->output.show == VPL_SHOW_INDIRECT && o->method == VPL_METHOD_KELLER && set->stepCount > 0) {
        if (vplCompensates(job)) {
            in->firstShown = in->emitterLightCount;
            return VPL_SUCCESS;
        }
        in->emitterLightCount = 0;
        shown->lights += set->lightsInStep[0];
        shown->lightCount -= set->lightsInStep[0];
    }
    return VPL_SUCCESS;
}

// A light stands for its share of all surfaces; nearer than that share's radius it is no point. Half as much leaves
// 5 to 35 % more rmse and twice as much takes a few per cent of the light away (room, room-area, cornell-area; 32 to
// 2048 particles with shadows by rays; --show indirect). Later passes make the share smaller.
//
// Where rays find the light that is taken away, the bound need not fall with the number of lights, and the square of
// the error does so the faster, like 1/N instead of 1/sqrt(N): near corners a bound that falls like 1/sqrt(N) keeps the
// noise of the nearest lights as it is.
float vplJob_MinDistance(const vplJob* job, double lights)
{
    if (job->options.lights.minDistance >= 0) {
        return job->options.lights.minDistance;
    }
    lights *= job->stepsDone + 1;
    const double area = vplGeometry_Area(job->geometry);
    const double share = lights > 0 ? sqrt(area / lights / VPL_PI) : 0;
    return (float)(lights > 0 && vplCompensates(job) ? fmax(share, (double)job->nearDistance) : share);
}

// Lights of one cluster follow each other, in the order that they had. `first` is the set's index of the first light.
static vplResult sortByCluster(vplJob* job, vplIngredients* in, int first)
{
    const vplSsvpLights* l = in->ssvp->lights;
    const size_t count = (size_t)in->lightCount;
    vplShadeLight* sorted = vplAlloc(job->context, count, sizeof *sorted);
    int* starts = vplAllocZero(job->context, (size_t)l->shadowCount + 1, sizeof *starts);
    in->lightClusters = vplAlloc(job->context, count, sizeof *in->lightClusters);
    if (sorted == NULL || starts == NULL || in->lightClusters == NULL) {
        vplFree(job->context, sorted);
        vplFree(job->context, starts);
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < in->lightCount; i++) {
        starts[l->clusterOf[first + i] + 1]++;
    }
    for (int i = 0; i < l->shadowCount; i++) {
        starts[i + 1] += starts[i];
    }
    for (int i = 0; i < in->lightCount; i++) {
        const int cluster = l->clusterOf[first + i], at = starts[cluster]++;
        sorted[at] = in->lights[i];
        in->lightClusters[at] = cluster;
    }
    vplFree(job->context, starts);
    vplFree(job->context, in->lights);
    in->lights = sorted;
    return VPL_SUCCESS;
}

static vplResult makeSet(vplJob* job, vplIngredients* in)
{
    if (in->ssvp == NULL) {
        return vplJob_MakeLights(job, &in->set);
    }
    vplResult result = vplSsvp_MakeLights(job, in->ssvp);
    if (result == VPL_SUCCESS) {
        in->set = in->ssvp->lights->set;
        const vplLightClusters* clusters = in->ssvp->lights->bounce[0].clusters;
        vplJob_CountLights(job, in->set);
        job->stats.clusters = clusters != NULL ? clusters->count : 0;
        job->stats.clusterIterations = clusters != NULL ? clusters->iterations : 0;
    }
    return result;
}

vplResult vplMakeVirtualLights(vplJob* job, vplIngredients* in)
{
    vplFreeVirtualLights(job, in);
    vplLightSet shown;
    vplResult result = makeSet(job, in);
    if (result == VPL_SUCCESS) {
        result = choose(job, in, &shown);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    in->lights = vplAlloc(job->context, (size_t)shown.lightCount, sizeof *in->lights);
    if (in->lights == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    in->lightCount = vplPrepareLights(&shown, vplJob_GetShading(job), in->lights);
    if (in->ssvp != NULL && in->ssvp->lights->clusterOf != NULL) {
        result = sortByCluster(job, in, (int)(shown.lights - in->set->lights));
    }
    in->minDistance = job->stats.minDistance = vplJob_MinDistance(job, in->set->lightCount);
    in->lightShadows = vplJob_GetLightShadows(job);
    if (in->lightShadows == VPL_LIGHT_SHADOWS_AUTO) {
        in->lightShadows = vplChooseLightShadows(job, in);
    }
    job->stats.lightShadows = in->lightShadows;
    return result;
}

void vplFreeVirtualLights(vplJob* job, vplIngredients* in)
{
    vplHemiMaps_Destroy(in->lightMaps);
    in->lightMaps = NULL;
    vplFree(job->context, in->lights);
    vplFree(job->context, in->lightClusters);
    if (in->ssvp == NULL) {
        vplLightSet_Destroy(in->set);
    }
    in->lights = NULL;
    in->lightClusters = NULL;
    in->set = NULL;
    in->lightCount = 0;
}

void vplFreeIngredients(vplJob* job, vplIngredients* in)
{
    vplFreeVirtualLights(job, in);
    vplSsvp_End(job, in->ssvp);
    vplRadiosity_End(job, in->radiosity);
    freeMaps(job, &in->emitterMaps);
    vplFree(job->context, in->areaLights);
}
