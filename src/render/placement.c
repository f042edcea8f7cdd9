// SPDX-License-Identifier: MIT
// Where virtual lights go: what the stages of placement need to know of a render.
#include "render/render.h"

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
    def.camera = *vplScene_GetCamera(job->scene, o->camera);
    def.width = o->width;
    def.height = o->height;
    def.minDistance = vplJob_MinDistance(job, (double)lights);
    def.shadows = o->lightShadows != VPL_LIGHT_SHADOWS_NONE &&
                  (o->lightShadows != VPL_LIGHT_SHADOWS_USUAL || o->method == VPL_METHOD_KELLER);
    def.seed = o->seed;
    def.index = job->stepsDone;
    def.progress = particles->progress;
    def.progressUser = particles->progressUser;
    return vplPlaceLights(job->geometry, emitters, emitterCount, particles, &def, setOut);
}

vplResult vplJob_PlaceLights(vplJob* job, const vplEmitterDef* emitters, int emitterCount,
                             const vplParticleDef* particles, vplLightSet** setOut)
{
    switch (job->options.placement) {
    case VPL_PLACEMENT_VIEW:
        return placeByView(job, emitters, emitterCount, particles, setOut);
    case VPL_PLACEMENT_PARTICLES:
    case VPL_PLACEMENT_RSM:
        break;
    }
    return vplSimulateParticles(job->geometry, emitters, emitterCount, particles, setOut);
}
