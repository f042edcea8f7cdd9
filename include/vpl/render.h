// SPDX-License-Identifier: MIT
// The one-call level: a scene and options in, a picture and statistics out.
#ifndef VPL_RENDER_H
#define VPL_RENDER_H

#include <vpl/plan.h>

#ifdef __cplusplus
extern "C" {
#endif

// What frames of a sequence hand on to each other: the geometry, and for SSVP and radiosity what the light
// sees, lights, clusters, patches and form factors, as long as nothing that they depend on has changed.
// Frames are rendered one after another, in any order, with one scene, to which nothing may be added, and
// options that may change. Pictures have the same bits as without a history, but for what `coherence` says.
// It must outlive renderers that use it.
vplResult vplHistory_Create(vplContext* context, vplHistory** historyOut);

// NULL is allowed.
void vplHistory_Destroy(vplHistory* history);

enum { VPL_MAX_STAGES = 24 };

typedef struct vplStageTime {
    const char* name; // static
    double ms;        // wall-clock
} vplStageTime;

typedef struct vplRenderStats {
    vplStageTime stages[VPL_MAX_STAGES]; // in the order they ran
    int stageCount;
    double totalMs, cpuMs; // wall clock; processor time of all threads
    int64_t drawCalls, fragments;
    int64_t rays, rayObjectTests;
    int triangles, objects;

    int virtualLights;
    int escaped;   // particles that left the scene
    int stepCount; // steps of the particle simulation
    // floor(rho^k N), by which lights are weighted; of all candidates where lights are chosen.
    int particlesPerStep[VPL_MAX_STEPS_REPORTED];
    int lightsPerStep[VPL_MAX_STEPS_REPORTED]; // lights that were really left
    double reflectivity;                       // as used
    float minDistance;                         // as used, metres
    // Share of the virtual lights' light that minDistance takes away, or would without compensation: an estimate
    // from some pixels; negative where there is none.
    double clampLoss;
    vplLightShadows lightShadows; // as used: none, map, ray or cluster
    // What maps and rays were expected to take where they were chosen by cost, ms of one core of the machine of
    // bench/crossover.
    double shadowMapEstimateMs, shadowRayEstimateMs;

    // Lightcuts: pairs of a pixel and a virtual light that were evaluated; pixels that show something, of all
    // passes and samples; most virtual lights evaluated for one pixel.
    int64_t lightEvaluations, cutPixels;
    int largestCut;
    int clusters, clusterIterations; // SSVP: clusters of first-bounce lights; iterations of k-means

    int patches, patchSides; // radiosity: patches, and sides of them that light reaches
    bool linked;             // by the hierarchy
    int64_t formFactors;     // radiosity: pairs of sides, or links
    vplSolveStats solve;     // radiosity: of the last frame

    int passes; // that the picture is the mean of; path: of up to 32 paths per pixel each
    // Expected rmse of the picture, from two independent halves of the samples or passes, and the same divided by
    // the picture's mean; negative where there is none.
    double errorEstimate, relativeErrorEstimate;
    size_t peakBytes;   // most memory that the context held during the call
    uint64_t imageHash; // vplImage_Hash
} vplRenderStats;

// Renders. The picture is radiance in W/(m^2 sr) unless `show` says otherwise; destroy it with
// vplImage_Destroy. statsOut may be NULL.
vplResult vplRender(const vplScene* scene, const vplRenderOptions* options, vplImage** imageOut,
                    vplRenderStats* statsOut);

// Radiosity's patches as a mesh with colours at its vertices: the light that options.method
// VPL_METHOD_RADIOSITY finds, direct and indirect, for tools that draw. Written by vplPatchMesh_WritePly; its
// 8-bit colours are those of pictures of the same exposure (stops). statsOut may be NULL.
vplResult vplBake(const vplScene* scene, const vplRenderOptions* options, float exposure, const char* path,
                  vplRenderStats* statsOut);

// The same step by step, for windows, deadlines and progressive output: after each step there is a picture of
// all that was done. Steps give the same bits as one call of vplRender. One step is one pass.
typedef struct vplRenderer vplRenderer;

vplResult vplRenderer_Create(const vplScene* scene, const vplRenderOptions* options,
                             vplRenderer** rendererOut);

// Does one pass. *doneOut is set where the options ask for no more; further steps are allowed and make the
// picture better, where it is made of passes at all. After a failure the renderer can only be destroyed.
vplResult vplRenderer_Step(vplRenderer* renderer, bool* doneOut);

// The picture so far, at least one step; destroy it with vplImage_Destroy. statsOut may be NULL.
vplResult vplRenderer_GetImage(vplRenderer* renderer, vplImage** imageOut, vplRenderStats* statsOut);

// NULL is allowed. The scene must outlive the renderer.
void vplRenderer_Destroy(vplRenderer* renderer);

// The virtual lights that vplRender would use (in its first pass); destroy with vplLightSet_Destroy.
vplResult vplMakeLights(const vplScene* scene, const vplRenderOptions* options, vplLightSet** setOut);

#ifdef __cplusplus
}
#endif

#endif
