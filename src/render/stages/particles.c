// SPDX-License-Identifier: MIT
// Virtual lights where particles land (Keller; Franchi and Ferrante), placed as the options say.
#include "render/options.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

static vplParticleDef describeParticles(const vplRun* run)
{
    const vplPlan* plan = run->plan;
    const vplRenderOptions* o = &plan->options;
    vplParticleDef def = vplDefaultParticleDef();
    def.lighting = o->lighting;
    def.start = o->method == VPL_METHOD_KELLER ? VPL_START_EMITTER : VPL_START_FIRST_HIT;
    def.particleCount = vplParticlesOfPass(plan, run->pass);
    def.pass = plan->progressive;
    def.firstParticle = vplParticlesBefore(plan, run->pass);
    def.reflectivity = o->particles.reflectivity;
    def.sampler = o->particles.sampler;
    def.bounce = o->particles.bounce;
    def.geometry = o->particles.geometry;
    def.seed = o->seed;
    def.progress = run->progress;
    def.progressUser = run->runner;
    return def;
}

// More candidates per particle help where few particles land near visible surfaces (flat.json: 64 candidates
// leave 0.71 of the error of 32). Judging 32 candidates costs as much as shading 8192 pixels.
static int oversamplingFor(const vplOutputOptions* o)
{
    const double times = vplCountPixels(o) * o->supersample / 4096;
    return times < 32 ? 32 : times > 64 ? 64 : (int)times;
}

static vplResult placeByView(const vplRun* run, const vplParticleDef* particles, vplLightSet** setOut)
{
    const vplPlan* plan = run->plan;
    vplPlacementDef def = vplDefaultPlacementDef();
    const vplParticlePass plain = {0, particles->particleCount, particles->reflectivity};
    vplStepTotals totals;
    TRY(vplCountParticles(run->context, &plain, NULL, 0, &totals));
    def.lighting = plan->shading;
    def.camera = plan->camera;
    def.width = plan->view.width;
    def.height = plan->view.height;
    def.oversampling = oversamplingFor(&plan->options.output);
    def.minDistance = vplClampDistance(run, (double)totals.lightCount);
    def.shadows = plan->options.lights.shadows != VPL_LIGHT_SHADOWS_NONE;
    def.seed = plan->options.seed;
    def.index = run->pass;
    def.progress = particles->progress;
    def.progressUser = particles->progressUser;
    return vplPlaceLights(run->results[VPL_STAGE_GEOMETRY], plan->emitters, plan->emitterCount, particles,
                          &def, setOut);
}

vplResult vplMakeParticles(const vplRun* run, void** resultOut)
{
    const vplPlan* plan = run->plan;
    const vplReflectiveMaps* maps = run->results[VPL_STAGE_REFLECTIVE_MAPS];
    vplParticleDef def = describeParticles(run);
    vplLightSet* set;
    if (plan->options.particles.placement == VPL_PLACEMENT_VIEW) {
        TRY(placeByView(run, &def, &set));
    } else {
        def.maps = maps != NULL ? (const vplReflectiveMap* const*)maps->maps : NULL;
        const bool mapped = maps != NULL; // where there are many emitters, a sample of them has maps
        TRY(vplSimulateParticles(run->results[VPL_STAGE_GEOMETRY],
                                 mapped ? plan->mapEmitters : plan->emitters,
                                 mapped ? plan->mapEmitterCount : plan->emitterCount, &def, &set));
    }
    *resultOut = set;
    return VPL_SUCCESS;
}

void vplDestroyLightSet(void* result)
{
    vplLightSet_Destroy(result);
}

void vplReportLights(const vplLightSet* set, vplRenderStats* stats)
{
    stats->virtualLights += set->lightCount;
    stats->escaped += set->escaped;
    stats->rays += set->rays;
    stats->rayObjectTests += set->rayObjectTests;
    stats->stepCount = set->stepCount < VPL_MAX_STEPS_REPORTED ? set->stepCount : VPL_MAX_STEPS_REPORTED;
    for (int i = 0; i < stats->stepCount; i++) {
        stats->particlesPerStep[i] += set->stepCounts[i];
        stats->lightsPerStep[i] += set->lightsInStep[i];
    }
}

void vplReportParticles(const vplRun* run)
{
    vplReportLights(run->results[VPL_STAGE_PARTICLES], run->stats);
    run->stats->reflectivity = run->plan->options.particles.reflectivity;
}
