// SPDX-License-Identifier: MIT
// Patches on pictures: smooth indirect light, or a stage for eyes; and as a mesh for other tools.
#include "base/clock.h"
#include "math/scalar.h"
#include "render/radiosity.h"

#include <math.h>

static vplResult findValues(const vplJob* job, const vplRadiosityState* s, vplRgb* values)
{
    const vplTransport transport = vplRadiosity_Transport(s);
    const int count = s->sides->count;
    const float scale = (float)(1 / VPL_PI);
    switch (job->options.output.show) {
    case VPL_SHOW_PATCHES:
        for (int i = 0; i < count; i++) {
            values[i] = s->sides->sides[i].reflectance;
        }
        return VPL_SUCCESS;
    case VPL_SHOW_PATCH_RADIOSITY:
        for (int i = 0; i < count; i++) {
            const vplRgb b = s->radiosity[i];
            values[i] = (vplRgb){scale * b.r, scale * b.g, scale * b.b};
        }
        return VPL_SUCCESS;
    case VPL_SHOW_FORM_FACTOR_SUMS:
        for (int i = 0; i < count; i++) {
            const float sum = s->factors != NULL ? s->factors->rowSums[i] : 1;
            values[i] = (vplRgb){sum, sum, sum};
        }
        return s->factors != NULL ? VPL_SUCCESS : vplGatherRadiosity(&transport, values, values);
    default: {
        vplResult result = vplRadiosityResidual(&transport, s->source, s->radiosity, values);
        for (int i = 0; i < count && result == VPL_SUCCESS; i++) {
            values[i] =
                (vplRgb){scale * fabsf(values[i].r), scale * fabsf(values[i].g), scale * fabsf(values[i].b)};
        }
        return result;
    }
    }
}

vplResult vplRadiosity_Draw(vplJob* job, const vplRadiosityState* s, const vplView* view, vplImage* image)
{
    const vplRenderOptions* o = &job->options;
    const bool light = o->output.show == VPL_SHOW_PICTURE || o->output.show == VPL_SHOW_INDIRECT;
    const bool smooth = light && o->radiosity.interpolation == VPL_INTERPOLATION_GOURAUD;
    float(*clip)[4] = vplAlloc(job->context, (size_t)s->mesh->vertexCount, sizeof *clip);
    vplRgb* values = vplAllocZero(job->context, light ? 0 : (size_t)s->sides->count, sizeof *values);
    vplResult result = clip != NULL && values != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS && !light) {
        result = findValues(job, s, values);
    }
    if (result == VPL_SUCCESS) {
        const vplPatchDraw draw = {.mesh = s->mesh,
                                   .vertexValues = smooth ? s->corners : NULL,
                                   .values = light ? s->irradiance : values,
                                   .reflect = light,
                                   .outlines = o->output.show == VPL_SHOW_PATCHES};
        vplRasterStats stats = {0};
        vplView_ToClip(view, s->mesh->positions, s->mesh->vertexCount, clip);
        result = vplDrawPatches(&draw, (const float(*)[4])clip, NULL, NULL, image, &stats);
        vplJob_AddRaster(job, &stats);
    }
    vplFree(job->context, clip);
    vplFree(job->context, values);
    return result;
}

// ---- as a mesh

// All light: direct light, too, is a patch's mean here.
static vplResult writeMesh(vplJob* job, const vplRadiosityState* s, float scale, const char* path)
{
    const size_t count = (size_t)s->sides->count, corners = 2 * (size_t)s->mesh->vertexCount;
    vplRgb* all = vplAlloc(job->context, count, sizeof *all);
    vplRgb* vertices = vplAlloc(job->context, corners, sizeof *vertices);
    vplResult result = all != NULL && vertices != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        result = vplRadiosity_Receive(s, s->radiosity, all);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatchMesh_Interpolate(s->mesh, job->options.radiosity.vertexWeight, all, vertices);
    }
    if (result == VPL_SUCCESS) {
        result =
            vplPatchMesh_Sharpen(s->mesh, job->options.radiosity.vertexWeight, all, job->options.radiosity.sharpen, vertices);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatchMesh_WritePly(s->mesh, vertices, scale, path);
    }
    vplFree(job->context, all);
    vplFree(job->context, vertices);
    return result;
}

static vplResult bake(vplJob* job, float exposure, const char* path)
{
    const float scale = (float)(vplPow(2, (double)exposure) / VPL_PI); // radiance, as pictures have it
    vplRadiosityState* s;
    vplResult result = vplRadiosity_Begin(job, &s);
    if (result != VPL_SUCCESS) {
        return result;
    }
    result = vplRadiosity_Light(job, s);
    if (result == VPL_SUCCESS) {
        vplJob_BeginStage(job, 1);
        result = writeMesh(job, s, scale, path);
        vplJob_EndStage(job, "write mesh");
    }
    vplRadiosity_End(job, s);
    return result;
}

vplResult vplBake(const vplScene* scene, const vplRenderOptions* options, float exposure, const char* path,
                  vplRenderStats* statsOut)
{
    vplRenderOptions o = *options;
    vplJob job;
    const double start = vplClockMs(), cpuStart = vplCpuMs();
    o.method = VPL_METHOD_RADIOSITY;
    o.output.show = VPL_SHOW_PICTURE;
    vplResult result = vplJob_Begin(scene, &o, &job);
    if (result == VPL_SUCCESS) {
        result = bake(&job, exposure, path);
    }
    if (result == VPL_SUCCESS && statsOut != NULL) {
        vplRenderStats* stats = &job.stats;
        stats->triangles = job.geometry->triangleCount;
        stats->objects = job.geometry->objectCount;
        stats->totalMs = vplClockMs() - start;
        stats->cpuMs = vplCpuMs() - cpuStart;
        stats->peakBytes = vplContext_GetPeakBytes(job.context);
        *statsOut = *stats;
    }
    vplJob_End(&job);
    return result;
}
