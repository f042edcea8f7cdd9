// SPDX-License-Identifier: MIT
// The functions that the table of stages refers to.
#ifndef VPL_RENDER_STAGES_MAKE_H
#define VPL_RENDER_STAGES_MAKE_H

#include "reference/sparse_paths.h"
#include "render/stage.h"

typedef vplResult vplMakeFcn(const vplRun* run, void** resultOut);
typedef void vplDestroyFcn(void* result);
typedef void vplReportFcn(const vplRun* run);

vplMakeFcn vplMakeGeometry, vplMakeNearDistance, vplMakeEmitterMaps, vplMakeEmitterTrees, vplMakeAreaLights,
    vplMakeReflectiveMaps, vplMakeParticles, vplMakeFirstBounce, vplMakeClusters, vplMakeParaboloids,
    vplMakeSecondBounce, vplMakeSecondClusters, vplMakeSecondParaboloids, vplMakeFurtherBounces,
    vplMakeClusteredLights, vplMakeVirtualLights, vplMakePatches, vplMakeSides, vplMakePatchMesh,
    vplMakeFormFactors, vplMakePatchLight, vplMakeSolution, vplMakeVertexLight, vplMakeGbuffer,
    vplMakePicture, vplMakeLightPaths, vplMakePaths;

vplDestroyFcn vplDestroyGeometry, vplDestroyEmitterMaps, vplDestroyEmitterTrees, vplDestroyReflectiveMaps,
    vplDestroyLightSet, vplDestroyBounce, vplDestroyClusters, vplDestroyParaboloids, vplDestroyFurtherBounces,
    vplDestroyClusteredLights, vplDestroyPatches, vplDestroySides, vplDestroyPatchMesh, vplDestroyFormFactors,
    vplDestroyGbuffer, vplDestroyImage, vplDestroyPaths;

vplReportFcn vplReportGeometry, vplReportParticles, vplReportClusteredLights, vplReportVirtualLights,
    vplReportPatches, vplReportSides, vplReportFormFactors, vplReportSolution;

// Adds a set of lights to the statistics.
void vplReportLights(const vplLightSet* set, vplRenderStats* stats);

// Points of a pixel at which surfaces are sampled: its centre and the samples beside it.
static inline int vplCountPoints(const vplPlan* plan)
{
    return (plan->options.output.antialias & ~1) + 1;
}

// True if neighbouring pixels share virtual lights or rays.
static inline bool vplPixelsShareLight(const vplPlan* plan)
{
    return plan->options.pipeline.kind == VPL_ACCUMULATE_INTERLEAVED && (plan->showsVirtual || plan->gathers);
}

// Particles of a pass: --grow-from in the first, twice as many in each that follows, up to --particles.
static inline int vplParticlesOfPass(const vplPlan* plan, int pass)
{
    const int most = plan->options.particles.count, first = plan->options.stop.growFrom;
    const int doublings = pass < 30 ? pass : 30;
    return first <= 0 || first > most >> doublings ? most : first << doublings;
}

// Particles of all passes before it.
static inline int64_t vplParticlesBefore(const vplPlan* plan, int pass)
{
    int64_t sum = 0;
    int k = 0;
    for (; k < pass && vplParticlesOfPass(plan, k) < plan->options.particles.count; k++) {
        sum += vplParticlesOfPass(plan, k);
    }
    return sum + (int64_t)(pass - k) * plan->options.particles.count;
}

// The weight of a pass in the mean of all: 1 for --particles.
static inline double vplShareOfPass(const vplPlan* plan, int pass)
{
    const int most = plan->options.particles.count;
    return most > 0 && plan->options.stop.growFrom > 0 ? (double)vplParticlesOfPass(plan, pass) / most : 1;
}

// Path tracing ends by its time or error only.
static inline bool vplPathsAreOpen(const vplPlan* plan)
{
    return plan->options.method == VPL_METHOD_PATH && plan->options.path.samples == VPL_MAX_SAMPLES;
}

// Most paths per pixel in a pass of path tracing.
int vplPathsOfPass(const vplPlan* plan);

// Passes of a path-traced picture whose number of paths is given.
int vplCountPathPasses(const vplPlan* plan);

// The settings of the path tracer for a picture.
vplPathDef vplDescribePaths(const vplRun* run, vplShow show);

// Runs VPL_STAGE_LIGHT_PATHS, also where the plan has no such stage, if the options leave the number of light vertices open.
vplResult vplFindLightVertices(const vplRun* run);

// The most vertices of a light path: as the options say, or as the result of VPL_STAGE_LIGHT_PATHS decides; 1 without either.
int vplCountLightVertices(const vplRun* run);

// Makes a guide of paths from the patches of the run, in the arena; NULL where the plan has no form factors of all pairs. The results of its
// stages must outlive the guide. (path_guide.c)
vplResult vplMakePathGuide(const vplRun* run, vplArena* arena, const vplPathGuide** guideOut);

// True if the scene's camera sees surfaces of the run's patches that are dark, so that a guide is a gain. (path_guide.c)
bool vplGuidePays(const vplRun* run, const vplPathScene* scene);

// As vplSparsePaths_Trace, with paths that the patches of the run guide where that is a gain. (path_guide.c)
vplResult vplTraceGuided(const vplRun* run, vplSparsePaths* paths, int each, vplProgressRange progress);

// The mean of all paths so far.
vplResult vplResolvePaths(const vplRun* run, vplImage** imageOut);

// The tracer of the picture, or of its direct light, which is NULL if the plan does not split light.
struct vplPathTracer* vplGetPathTracer(const vplRun* run, bool direct);

// Makes a picture of the mean of their direct light; the plan must split light.
vplResult vplResolveDirectPaths(const vplRun* run, vplImage** imageOut);

// Points of a pixel whose mean albedo and normals are.
int vplCountLayerSamples(const vplPlan* plan);

// Makes all layers that the options ask for; the first is the picture. Takes both pictures over, also where
// it fails. `direct` is NULL if the plan does not split light.
vplResult vplMakeLayers(const vplRun* run, vplImage* picture, vplImage* direct, vplLayers** layersOut);

// Writes patches with all their light as a mesh; `scale` turns radiosity into what is shown.
vplResult vplWritePatchMesh(const vplRun* run, vplArena* scratch, float scale, const char* path);

#endif
