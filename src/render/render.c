// SPDX-License-Identifier: MIT
// Checks, freezes the scene, counts and times what methods do.
#include "base/clock.h"
#include "render/options.h"
#include "render/history.h"
#include "render/ssvp.h"

#include <string.h>

void vplJob_BeginStage(vplJob* job, double to)
{
    job->progressFrom = job->progressTo;
    job->progressTo = to;
    job->stageStart = vplClockMs();
}

void vplJob_EndStage(vplJob* job, const char* name)
{
    const double ms = vplClockMs() - job->stageStart;
    vplRenderStats* stats = &job->stats;
    for (int i = 0; i < stats->stageCount; i++) {
        if (strcmp(stats->stages[i].name, name) == 0) {
            stats->stages[i].ms += ms;
            return;
        }
    }
    if (stats->stageCount < VPL_MAX_STAGES) {
        stats->stages[stats->stageCount++] = (vplStage){name, ms};
    }
}

bool vplJob_Progress(void* job, double fraction)
{
    const vplJob* j = job;
    double done = j->progressFrom + (j->progressTo - j->progressFrom) * fraction;
    return j->options.progress(j->options.progressUser, j->stepFrom + (j->stepTo - j->stepFrom) * done);
}

vplProgressFcn* vplJob_GetProgress(const vplJob* job)
{
    return job->options.progress ? vplJob_Progress : NULL;
}

void vplJob_AddRaster(vplJob* job, const vplRasterStats* stats)
{
    job->stats.drawCalls += stats->drawCalls;
    job->stats.fragments += stats->fragments;
}

vplLightShadows vplJob_GetLightShadows(const vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    return o->lights.shadows != VPL_LIGHT_SHADOWS_USUAL ? o->lights.shadows
           : o->method == VPL_METHOD_KELLER           ? VPL_LIGHT_SHADOWS_AUTO
           : o->method == VPL_METHOD_SSVP             ? VPL_LIGHT_SHADOWS_CLUSTER
                                                      : VPL_LIGHT_SHADOWS_NONE;
}

vplLighting vplJob_GetShading(const vplJob* job)
{
    return job->options.method == VPL_METHOD_KELLER ? VPL_LIGHTING_PHYSICAL : job->options.lighting;
}

void vplJob_CountLights(vplJob* job, const vplLightSet* set)
{
    vplRenderStats* stats = &job->stats;
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

vplResult vplJob_MakeLights(vplJob* job, vplLightSet** setOut)
{
    const vplRenderOptions* o = &job->options;
    vplParticleDef def = vplDefaultParticleDef();
    const bool keller = o->method == VPL_METHOD_KELLER;
    def.lighting = o->lighting;
    def.start = keller ? VPL_START_EMITTER : VPL_START_FIRST_HIT;
    def.particleCount = o->particles.count;
    def.pass = job->progressive;
    def.firstParticle = (int64_t)job->stepsDone * o->particles.count;
    def.reflectivity = o->particles.reflectivity >= 0 ? o->particles.reflectivity : vplGeometry_MeanReflectance(job->geometry);
    if (keller && o->output.show == VPL_SHOW_DIRECT) {
        def.reflectivity = 0; // the lights on the emitters are all there is
    }
    def.sampler = o->particles.sampler;
    def.bounce = o->particles.bounce;
    def.geometry = o->particles.geometry;
    def.seed = o->seed;
    def.progress = vplJob_GetProgress(job);
    def.progressUser = job;
    vplResult result = vplJob_FindNear(job);
    if (result == VPL_SUCCESS) {
        result = vplJob_PlaceLights(job, job->emitters, job->emitterCount, &def, setOut);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    job->stats.reflectivity = def.reflectivity;
    vplJob_CountLights(job, *setOut);
    return VPL_SUCCESS;
}

// What the method's document uses.
static void chooseUsual(vplRenderOptions* o)
{
    const bool ssvp = o->method == VPL_METHOD_SSVP;
    if (o->pipeline.kind == VPL_ACCUMULATE_USUAL) {
        o->pipeline.kind = ssvp ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
    }
    if (o->shadow.rsmSize == 0) {
        o->shadow.rsmSize = ssvp ? 1024 : 256;
    }
}

static vplResult pose(vplJob* job)
{
    const vplRenderOptions* o = &job->options;
    vplResult result = vplScene_PoseCamera(job->scene, o->output.camera, o->sequence.frame, &job->camera);
    if (result != VPL_SUCCESS) {
        return result;
    }
    job->view = vplView_Create(&job->camera, o->output.width, o->output.height);
    job->emitterCount = vplScene_GetEmitterCount(job->scene);
    job->emitters = vplAlloc(job->context, (size_t)job->emitterCount, sizeof *job->emitters);
    result = job->emitters != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0; i < job->emitterCount && result == VPL_SUCCESS; i++) {
        result = vplScene_PoseEmitter(job->scene, i, o->sequence.frame, &job->emitters[i]);
    }
    return result;
}

// What only SSVP has.
static vplResult checkSsvp(const vplContext* context, const vplRenderOptions* o)
{
    if (o->method == VPL_METHOD_SSVP) {
        return VPL_SUCCESS;
    }
    if (o->lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "only SSVP's lights have clusters to cast shadows by");
    }
    if (o->output.show >= VPL_SHOW_RSM && o->output.show <= VPL_SHOW_SECOND_BOUNCE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "only SSVP has maps, samples and clusters to show");
    }
    return VPL_SUCCESS;
}

// What only radiosity has, and what it has not.
static vplResult checkRadiosity(const vplContext* context, const vplRenderOptions* o)
{
    if (o->method != VPL_METHOD_RADIOSITY) {
        return o->output.show >= VPL_SHOW_PATCHES ? vplFail(context, VPL_INVALID_ARGUMENT,
                                                     "only radiosity has patches and form factors to show")
                                           : VPL_SUCCESS;
    }
    if (o->lighting == VPL_LIGHTING_DOCUMENTED) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "radiosity's document prints no lighting formulas of its own; use physical lighting");
    }
    if (o->radiosity.placement == VPL_PATCHES_ADAPTIVE && o->radiosity.patchSize > 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "adaptive patches are counted, not measured: set vplRenderOptions.patches and leave "
                       "patchSize at 0");
    }
    if (o->output.show == VPL_SHOW_LIGHT || o->output.show == VPL_SHOW_OVERLAY || o->output.show == VPL_SHOW_GATHER ||
        o->output.show == VPL_SHOW_DENOISED) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "radiosity has no virtual lights to show");
    }
    return VPL_SUCCESS;
}

vplResult vplJob_Begin(const vplScene* scene, const vplRenderOptions* options, vplJob* job)
{
    memset(job, 0, sizeof *job);
    job->context = vplScene_GetContext(scene);
    vplResult result = vplCheckOptions(scene, options);
    if (result == VPL_SUCCESS) {
        result = checkSsvp(job->context, options);
    }
    if (result == VPL_SUCCESS) {
        result = checkRadiosity(job->context, options);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    job->scene = scene;
    job->options = *options;
    job->stepTo = 1;
    job->stats.clampLoss = -1;
    job->stats.errorEstimate = job->stats.relativeErrorEstimate = -1;
    chooseUsual(&job->options);
    vplContext_ResetPeakBytes(job->context);
    vplJob_BeginStage(job, 0);
    result = pose(job);
    if (result == VPL_SUCCESS) {
        result = options->sequence.history != NULL ? vplHistory_Open(options->sequence.history, scene, &job->geometry)
                                          : vplGeometry_Create(scene, &job->geometry);
    }
    vplJob_EndStage(job, "geometry");
    return result;
}

void vplJob_End(vplJob* job)
{
    vplFree(job->context, job->emitters);
    if (job->options.sequence.history == NULL) {
        vplGeometry_Destroy(job->geometry);
    }
}

vplResult vplMakeLights(const vplScene* scene, const vplRenderOptions* options, vplLightSet** setOut)
{
    vplJob job;
    vplResult result = vplJob_Begin(scene, options, &job);
    if (result == VPL_SUCCESS) {
        result = options->method == VPL_METHOD_SSVP ? vplSsvp_TakeLights(&job, setOut)
                                                    : vplJob_MakeLights(&job, setOut);
    }
    vplJob_End(&job);
    return result;
}
