// SPDX-License-Identifier: MIT
// Where virtual lights go: what the stages of placement need to know of a render.
#include "render/render.h"

// Where few particles come near to what is seen, more candidates help: in examples/scenes/flat.json 64 per particle
// leave 0.71 of the error of 32 (128: 0.50), in rooms that are seen whole nothing. Judging 32 costs as much as
// shading 8192 pixels, so that in a picture of 512x512 64 of them take a sixteenth of its time.
static int oversamplingFor(const vplRenderOptions* o)
{
    const double times = (double)o->output.width * o->output.height * o->output.antialias / 4096;
    return times < 32 ? 32 : times > 64 ? 64 : (int)times;
}

static vplResult placeByView(vplJob* job, const vplEmitterDef* emitters, int emitterCount,
                             const vplParticleDef* particles, vplLightSet** setOut)
{
    const vplRenderOptions* o = &job->options;
    vplPlacementDef def = vplDefaultPlacementDef();
    int steps;
    int64_t lights;
    const vplResult result = vplCountParticles(job->context, particles->particleCount,
                                               particles->reflectivity, NULL, 0, &steps, &lights);
    if (result != VPL_SUCCESS) {
        return result;
    }
    def.lighting = vplJob_GetShading(job);
    def.camera = job->camera;
    def.width = o->output.width;
    def.height = o->output.height;
    def.oversampling = oversamplingFor(o);
    def.minDistance = vplJob_MinDistance(job, (double)lights);
    def.shadows = vplJob_GetLightShadows(job) != VPL_LIGHT_SHADOWS_NONE;
    def.seed = o->seed;
    def.index = job->stepsDone;
    def.progress = particles->progress;
    def.progressUser = particles->progressUser;
    vplParticleDef candidates = *particles;
    if (candidates.sampler == VPL_SAMPLER_AUTO) { // of so many: error 0.64 in sponza-sun, 0.91 in room
        candidates.sampler = VPL_SAMPLER_HALTON;
    }
    return vplPlaceLights(job->geometry, emitters, emitterCount, &candidates, &def, setOut);
}

vplResult vplJob_DrawReflectiveMaps(vplJob* job, const vplEmitterDef* emitters, int emitterCount,
                                    vplReflectiveMap** maps)
{
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < emitterCount && result == VPL_SUCCESS; i++) {
        const vplRgb intensity = emitters[i].intensity;
        if (!(intensity.r > 0 || intensity.g > 0 || intensity.b > 0)) {
            continue;
        }
        vplReflectiveMapDef def = vplDefaultReflectiveMapDef();
        def.emitter = emitters[i];
        def.size = job->options.shadow.rsmSize;
        result = vplReflectiveMap_Create(job->geometry, &def, vplJob_GetProgress(job), job, &maps[i]);
        if (result == VPL_SUCCESS) {
            vplJob_AddRaster(job, &maps[i]->stats);
        }
    }
    return result;
}

// Maps of all emitters that particles start from.
static vplResult placeByMaps(vplJob* job, const vplEmitterDef* emitters, int emitterCount,
                             const vplParticleDef* particles, vplLightSet** setOut)
{
    vplContext* context = job->context;
    vplReflectiveMap** maps = vplAllocZero(context, (size_t)emitterCount, sizeof *maps);
    vplResult result =
        maps ? vplJob_DrawReflectiveMaps(job, emitters, emitterCount, maps) : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        vplParticleDef def = *particles;
        def.maps = (const vplReflectiveMap* const*)maps;
        result = vplSimulateParticles(job->geometry, emitters, emitterCount, &def, setOut);
    }
    for (int i = 0; maps != NULL && i < emitterCount; i++) {
        vplReflectiveMap_Destroy(maps[i]);
    }
    vplFree(context, maps);
    return result;
}

vplResult vplJob_PlaceLights(vplJob* job, const vplEmitterDef* emitters, int emitterCount,
                             const vplParticleDef* particles, vplLightSet** setOut)
{
    switch (job->options.particles.placement) {
    case VPL_PLACEMENT_VIEW:
        return placeByView(job, emitters, emitterCount, particles, setOut);
    case VPL_PLACEMENT_RSM:
        return placeByMaps(job, emitters, emitterCount, particles, setOut);
    case VPL_PLACEMENT_PARTICLES:
        break;
    }
    return vplSimulateParticles(job->geometry, emitters, emitterCount, particles, setOut);
}
