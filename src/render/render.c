// SPDX-License-Identifier: MIT
// Checks, freezes the scene, calls the method, fills in what all methods report.
#include "render/render.h"
#include "base/clock.h"

#include <string.h>

void vplJob_BeginStage(vplJob* job, double to)
{
    job->progressFrom = job->progressTo;
    job->progressTo = to;
    job->stageStart = vplClockMs();
}

void vplJob_EndStage(vplJob* job, const char* name)
{
    if (job->stats.stageCount < VPL_MAX_STAGES) {
        job->stats.stages[job->stats.stageCount++] = (vplStage){name, vplClockMs() - job->stageStart};
    }
}

bool vplJob_Progress(void* job, double fraction)
{
    const vplJob* j = job;
    double done = j->progressFrom + (j->progressTo - j->progressFrom) * fraction;
    return j->options.progress(j->options.progressUser, done);
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

vplResult vplJob_MakeLights(vplJob* job, vplLightSet** setOut)
{
    const vplRenderOptions* o = &job->options;
    const vplScene* scene = job->scene;
    vplParticleDef def = vplDefaultParticleDef();
    def.lighting = o->lighting;
    def.particleCount = o->particles;
    def.reflectivity = o->reflectivity >= 0 ? o->reflectivity : vplGeometry_MeanReflectance(job->geometry);
    def.sampler = o->sampler;
    def.bounce = o->bounce;
    def.geometry = o->particleGeometry;
    def.seed = o->seed;
    def.progress = vplJob_GetProgress(job);
    def.progressUser = job;
    int emitters = vplScene_GetEmitterCount(scene);
    vplResult result = vplSimulateParticles(job->geometry, emitters ? vplScene_GetEmitter(scene, 0) : NULL,
                                            emitters, &def, setOut);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const vplLightSet* set = *setOut;
    vplRenderStats* stats = &job->stats;
    stats->reflectivity = def.reflectivity;
    stats->virtualLights = set->lightCount;
    stats->escaped = set->escaped;
    stats->rays = set->rays;
    stats->rayObjectTests = set->rayObjectTests;
    stats->stepCount = set->stepCount < VPL_MAX_STEPS_REPORTED ? set->stepCount : VPL_MAX_STEPS_REPORTED;
    for (int i = 0; i < stats->stepCount; i++) {
        stats->particlesPerStep[i] = set->stepCounts[i];
        stats->lightsPerStep[i] = set->lightsInStep[i];
    }
    return VPL_SUCCESS;
}

static vplResult beginJob(const vplScene* scene, const vplRenderOptions* options, vplJob* job)
{
    vplResult result = vplCheckOptions(scene, options);
    if (result != VPL_SUCCESS) {
        return result;
    }
    memset(job, 0, sizeof *job);
    job->context = vplScene_GetContext(scene);
    job->scene = scene;
    job->options = *options;
    job->stats.errorEstimate = job->stats.relativeErrorEstimate = -1;
    vplContext_ResetPeakBytes(job->context);
    vplJob_BeginStage(job, 0);
    result = vplGeometry_Create(scene, &job->geometry);
    vplJob_EndStage(job, "geometry");
    job->view = vplView_Create(vplScene_GetCamera(scene, options->camera), options->width, options->height);
    return result;
}

vplResult vplRender(const vplScene* scene, const vplRenderOptions* options, vplImage** imageOut,
                    vplRenderStats* statsOut)
{
    vplJob job;
    double start = vplClockMs(), cpuStart = vplCpuMs();
    vplResult result = beginJob(scene, options, &job);
    if (result != VPL_SUCCESS) {
        return result;
    }
    result = options->method == VPL_METHOD_PATH ? vplRenderPath(&job) : vplRenderInstantRadiosity(&job);
    job.stats.triangles = job.geometry->triangleCount;
    job.stats.objects = job.geometry->objectCount;
    vplGeometry_Destroy(job.geometry);
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(job.image);
        return result;
    }
    job.stats.totalMs = vplClockMs() - start;
    job.stats.cpuMs = vplCpuMs() - cpuStart;
    job.stats.peakBytes = vplContext_GetPeakBytes(job.context);
    if (statsOut != NULL) {
        job.stats.imageHash = vplImage_Hash(job.image);
        *statsOut = job.stats;
    }
    *imageOut = job.image;
    return VPL_SUCCESS;
}

vplResult vplMakeLights(const vplScene* scene, const vplRenderOptions* options, vplLightSet** setOut)
{
    vplJob job;
    vplResult result = beginJob(scene, options, &job);
    if (result == VPL_SUCCESS) {
        result = vplJob_MakeLights(&job, setOut);
        vplGeometry_Destroy(job.geometry);
    }
    return result;
}
