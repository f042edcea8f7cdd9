// SPDX-License-Identifier: MIT
// The stages for emitters: shadow maps of points and spots, points on area lights, and reflective shadow
// maps.
#include "lights/light_set.h"
#include "render/options.h"
#include "render/plan.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <math.h>

// ---- cube shadow maps

// Bounds of depth let PCF skip samples. They pay where they cost less than the samples that they save: 0.5 to
// 0.8 ns per texel against 1.5 ns per sample and pixel (bench/shadow).
static vplResult boundMap(const vplRun* run, vplCubeMap* map)
{
    const vplRenderOptions* o = &run->plan->options;
    const double samples = o->shadow.pcfSamples;
    const double lookups = vplCountPixels(&o->output) * o->output.supersample * samples;
    const bool pays = samples >= VPL_MIN_BOUND_SAMPLES && lookups > 3.0 * map->size * map->size;
    return pays ? vplCubeMap_FindBounds(map) : VPL_SUCCESS;
}

// The document's radius of PCF is a length: with its lighting an automatic one is a share of the light's
// reach.
static vplShadowDef shadowDefOf(const vplPlan* plan, const vplCubeMap* map)
{
    const vplShadowOptions* o = &plan->options.shadow;
    const bool reaching = plan->shading == VPL_LIGHTING_DOCUMENTED && o->pcfOffset < 0;
    vplShadowDef def = vplDefaultShadowDef();
    def.biasRule = plan->biasRule;
    def.biasStatic = o->bias;
    def.biasDynamic = o->biasSlope;
    def.pcfSamples = o->pcfSamples;
    def.pcfOffset = reaching ? map->farPlane / 128 : o->pcfOffset;
    return def;
}

static vplResult drawMap(const vplRun* run, int i, vplEmitterMaps* maps)
{
    vplCubeMapDef def = vplDefaultCubeMapDef();
    def.position = run->plan->emitters[i].position;
    def.size = run->plan->options.shadow.mapSize;
    vplRun_BeginPart(run, i, maps->count);
    TRY(vplCubeMap_Create(run->results[VPL_STAGE_GEOMETRY], &def, run->progress, run->runner,
                          &maps->maps[i]));
    vplRun_AddRaster(run, &maps->maps[i]->stats);
    TRY(boundMap(run, maps->maps[i]));
    const vplShadowDef shadow = shadowDefOf(run->plan, maps->maps[i]);
    return vplShadow_Create(maps->maps[i], &shadow, &maps->shadows[i]);
}

static void warnOfBias(const vplRun* run)
{
    if (run->plan->biasRule == VPL_BIAS_PAIR && run->plan->options.shadow.bias == 0) {
        vplLog(run->context, VPL_LOG_WARNING,
               "--bias 0: surfaces lie in their own shadow wherever a texel's centre is nearer to the light; "
               "with auto and exact they do not");
    }
}

vplResult vplMakeEmitterMaps(const vplRun* run, void** resultOut)
{
    const size_t count = (size_t)run->plan->emitterCount;
    vplEmitterMaps* maps = vplArena_Alloc(run->arena, 1, sizeof *maps);
    vplCubeMap** cubes = vplArena_AllocZero(run->arena, count, sizeof *cubes);
    vplShadow* shadows = vplArena_AllocZero(run->arena, count, sizeof *shadows);
    TRY(vplArena_Check(run->arena));
    *maps = (vplEmitterMaps){cubes, shadows, (int)count};
    *resultOut = maps;
    warnOfBias(run);
    for (int i = 0; i < maps->count; i++) {
        if (run->plan->emitters[i].type != VPL_EMITTER_DIRECTIONAL) {
            TRY(drawMap(run, i, maps));
        }
    }
    return VPL_SUCCESS;
}

void vplDestroyEmitterMaps(void* result)
{
    vplEmitterMaps* maps = result;
    for (int i = 0; i < maps->count; i++) {
        vplCubeMap_Destroy(maps->maps[i]);
    }
}

// ---- trees

vplResult vplMakeEmitterTrees(const vplRun* run, void** resultOut)
{
    const vplPlan* p = run->plan;
    vplEmitterTrees* trees = NULL;
    TRY(vplEmitterTrees_Create(run->results[VPL_STAGE_GEOMETRY], p->emitters, p->emitterCount, vplTreesOf(p),
                               &trees));
    *resultOut = trees;
    return VPL_SUCCESS;
}

void vplDestroyEmitterTrees(void* result)
{
    vplEmitterTrees_Destroy(result);
}

// ---- area lights and the environment

// Writes samples on area lights: none if a tree chooses triangles for pixels, and at least one on each face if many objects emit.
static int samplePoints(const vplRun* run, const vplEmission* emission, vplShadeLight* out)
{
    const vplGeometry* g = run->results[VPL_STAGE_GEOMETRY];
    const int count = run->plan->options.lights.areaLightSamples;
    if (vplPixelsChooseTriangles(run->plan)) {
        return 0;
    }
    return run->plan->trianglesPerPoint > 0 && g->emittingObjects > VPL_EMITTERS_PER_POINT
               ? vplSampleEmittingFaces(emission, count, out)
               : vplSampleAreaLights(emission, count, out);
}

vplResult vplMakeAreaLights(const vplRun* run, void** resultOut)
{
    const vplLightOptions* o = &run->plan->options.lights;
    const int skyCount = run->plan->hasSky ? o->skySamples : 0;
    const size_t room = 2 * (size_t)o->areaLightSamples + (size_t)skyCount; // faces are no more than samples
    vplAreaLights* area = vplArena_AllocZero(run->arena, 1, sizeof *area);
    vplShadeLight* lights = vplArena_Alloc(run->arena, room, sizeof *lights);
    vplEmission* emission;
    TRY(vplArena_Check(run->arena));
    TRY(vplEmission_Create(run->results[VPL_STAGE_GEOMETRY], NULL, 0, &emission));
    if (emission->sourceCount > 0) {
        area->lights = lights;
        area->count = samplePoints(run, emission, lights);
        area->minDistance = (float)(0.5 * sqrt(vplEmission_Area(emission) / o->areaLightSamples / VPL_PI));
        area->skyCount = skyCount > 0 ? vplSampleSky(emission, skyCount, lights + area->count) : 0;
        area->count += area->skyCount;
    }
    vplEmission_Destroy(emission);
    *resultOut = area;
    return VPL_SUCCESS;
}

// ---- reflective shadow maps

vplResult vplMakeReflectiveMaps(const vplRun* run, void** resultOut)
{
    const vplPlan* plan = run->plan;
    vplReflectiveMaps* maps = vplArena_Alloc(run->arena, 1, sizeof *maps);
    vplReflectiveMap** each = vplArena_AllocZero(run->arena, (size_t)plan->mapEmitterCount, sizeof *each);
    TRY(vplArena_Check(run->arena));
    *maps = (vplReflectiveMaps){each, plan->mapEmitterCount};
    *resultOut = maps;
    for (int i = 0; i < maps->count; i++) {
        const vplRgb intensity = plan->mapEmitters[i].intensity;
        if (intensity.r > 0 || intensity.g > 0 || intensity.b > 0) {
            vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
            def.emitter = plan->mapEmitters[i];
            def.size = plan->options.shadow.rsmSize;
            vplRun_BeginPart(run, i, maps->count);
            TRY(vplReflectiveMap_Create(run->results[VPL_STAGE_GEOMETRY], &def, run->progress, run->runner,
                                        &each[i]));
            vplRun_AddRaster(run, &each[i]->stats);
        }
    }
    return VPL_SUCCESS;
}

void vplDestroyReflectiveMaps(void* result)
{
    vplReflectiveMaps* maps = result;
    for (int i = 0; i < maps->count; i++) {
        vplReflectiveMap_Destroy(maps->maps[i]);
    }
}
