// SPDX-License-Identifier: MIT
// The functions that the table of stages refers to.
#ifndef VPL_RENDER_STAGES_MAKE_H
#define VPL_RENDER_STAGES_MAKE_H

#include "render/stage.h"

typedef vplResult vplMakeFcn(const vplRun* run, void** resultOut);
typedef void vplDestroyFcn(void* result);
typedef void vplReportFcn(const vplRun* run);

vplMakeFcn vplMakeGeometry, vplMakeNearDistance, vplMakeEmitterMaps, vplMakeAreaLights, vplMakeReflectiveMaps,
    vplMakeParticles, vplMakeFirstBounce, vplMakeClusters, vplMakeParaboloids, vplMakeSecondBounce,
    vplMakeSecondClusters, vplMakeSecondParaboloids, vplMakeClusteredLights, vplMakeVirtualLights,
    vplMakePatches, vplMakeSides, vplMakePatchMesh, vplMakeFormFactors, vplMakePatchLight, vplMakeSolution,
    vplMakeVertexLight, vplMakePicture, vplMakePaths;

vplDestroyFcn vplDestroyGeometry, vplDestroyEmitterMaps, vplDestroyReflectiveMaps, vplDestroyLightSet,
    vplDestroyBounce, vplDestroyClusters, vplDestroyParaboloids, vplDestroyClusteredLights, vplDestroyPatches,
    vplDestroySides, vplDestroyPatchMesh, vplDestroyFormFactors, vplDestroyImage, vplDestroyPaths;

vplReportFcn vplReportGeometry, vplReportParticles, vplReportClusteredLights, vplReportVirtualLights,
    vplReportPatches, vplReportSides, vplReportFormFactors, vplReportSolution;

// Adds a set of lights to the statistics.
void vplReportLights(const vplLightSet* set, vplRenderStats* stats);

// Points of a pixel at which surfaces are sampled: its centre and the samples beside it.
static inline int vplCountPoints(const vplPlan* plan)
{
    return (plan->options.output.antialias & ~1) + 1;
}

// Path tracing ends by its time or error only.
static inline bool vplPathsAreOpen(const vplPlan* plan)
{
    return plan->options.method == VPL_METHOD_PATH && plan->options.path.samples == VPL_MAX_SAMPLES;
}

// Passes of a path-traced picture, and the mean of those so far.
int vplCountPathPasses(const vplPlan* plan);
vplResult vplResolvePaths(const vplRun* run, vplImage** imageOut);

// True if as many paths were traced as the options ask for.
bool vplPathsAreDone(const vplRun* run);

// The tracer of the picture, or of its direct light, which is NULL if the plan does not split light.
struct vplPathTracer* vplGetPathTracer(const vplRun* run, bool direct);

// The mean of their direct light, if the plan splits light. The image is black.
void vplResolveDirectPaths(const vplRun* run, vplImage* image);

// Points of a pixel whose mean albedo and normals are.
int vplCountLayerSamples(const vplPlan* plan);

// Makes all layers that the options ask for; the first is the picture. Takes both pictures over, also where
// it fails. `direct` is NULL if the plan does not split light.
vplResult vplMakeLayers(const vplRun* run, vplImage* picture, vplImage* direct, vplLayers** layersOut);

// Writes patches with all their light as a mesh; `scale` turns radiosity into what is shown.
vplResult vplWritePatchMesh(const vplRun* run, vplArena* scratch, float scale, const char* path);

#endif
