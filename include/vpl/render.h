// SPDX-License-Identifier: MIT
// The one-call level: a scene and options in, a picture and statistics out.
#ifndef VPL_RENDER_H
#define VPL_RENDER_H

#include <vpl/image.h>
#include <vpl/plan.h>

VPL_HEADER_BEGIN

// Results of stages that frames of a sequence share: the geometry, and for SSVP and radiosity reflective
// maps, lights, clusters, patches and form factors. A result is reused as long as nothing that it depends on
// has changed. Frames are rendered one after another, in any order, with one scene, which may change between
// them (vplScene_SetTransform and its like); options may change. Pictures have the same bits as without a history, except where
// sequence.coherence says otherwise. A history must outlive the renderers that use it.
vplResult vplHistory_Create(vplContext* context, vplHistory** historyOut);

// NULL is allowed.
void vplHistory_Destroy(vplHistory* history);

enum { VPL_MAX_STAGES = 24 };

typedef struct vplStageTime {
    const char* name; // static
    double ms;        // wall-clock
} vplStageTime;

typedef struct vplRenderStats {
    // Stages in the order they ran, and parts of the work that are timed by themselves, such as "planning": the planner's decisions
    // without the stages that they run.
    vplStageTime stages[VPL_MAX_STAGES];
    int stageCount;
    double totalMs, cpuMs; // wall clock; processor time of all threads
    int64_t drawCalls, fragments;
    // Rays of all passes and plans, of pixels at edges, and of the pixels that tell the error; and tests of rays against
    // objects.
    int64_t rays, rayObjectTests;
    int triangles, objects;

    int virtualLights;
    int escaped;   // particles that left the scene
    int stepCount; // steps of the particle simulation
    // floor(rho^k N), by which lights are weighted; where lights are chosen by use, the count of all
    // candidates.
    int particlesPerStep[VPL_MAX_STEPS_REPORTED];
    int lightsPerStep[VPL_MAX_STEPS_REPORTED]; // virtual lights that were made
    double reflectivity;                       // as used
    float minDistance;                         // as used, metres
    // Share of the virtual lights' light that the clamp takes away, or would take away without compensation.
    // An estimate from some pixels; negative: not estimated.
    double clampLoss;
    vplLightShadows lightShadows; // as used: none, map, ray or cluster
    // Estimated costs of shadow maps and rays, if shadows were chosen by cost; see vplPlan.
    double shadowMapEstimateMs, shadowRayEstimateMs;

    // Lightcuts: evaluated pairs of a pixel and a virtual light; pixels that show a surface, over all passes
    // and samples; largest number of virtual lights evaluated for one pixel.
    int64_t lightEvaluations, cutPixels;
    int largestCut;
    int clusters, clusterIterations; // SSVP: clusters of first-bounce lights; iterations of k-means
    int allClusters;                 // SSVP: clusters of all bounces
    // SSVP: share of the light at some points that the camera sees that is wrong because a cluster sees other
    // points than its lights; by test rays, after clusters were split. Negative: not measured.
    double clusterDisagreement;

    int patches, litPatches,
        patchSides; // radiosity: patches; those that light reaches; their sides that it reaches
    int patchGroups, groupedTriangles; // radiosity: patches that are groups, and the triangles in them
    bool linked;                       // radiosity: light was exchanged by links
    int64_t formFactors;               // radiosity: pairs of sides, or links
    vplSolveStats solve;               // radiosity: the solver of the last frame

    int passes; // the picture is their mean; path tracing: up to 32 paths per pixel each
    // Estimated rmse of the picture against the true one, and the same divided by the picture's mean; negative: not
    // estimated.
    double errorEstimate, relativeErrorEstimate;
    // Upper bound of the relative error; it holds in nineteen of twenty pictures. The estimate above is rough, because it
    // comes from a few hundred pixels. Negative: unknown.
    double relativeErrorBound;
    // Its two parts, relative; the error is the root of the sum of their squares. Noise differs from pass to pass
    // (path tracing: from path to path) and is found by comparing them. Bias is common to all passes: jagged edges, light
    // that is blurred, clamped or left out. It is found by comparing the picture with some hundred path-traced pixels,
    // where --max-error asks for it or --method auto has the time; until then the error is its noise alone. Negative: not
    // estimated.
    double relativeNoise, relativeBias;
    int truthPaths;     // paths of each of these pixels; 0: none were traced
    size_t peakBytes;   // most memory that the context held at a time during the call
    uint64_t imageHash; // vplImage_Hash
} vplRenderStats;

// Renders. The picture is radiance in W/(m^2 sr) unless `show` says otherwise; destroy it with
// vplImage_Destroy. It has no layers, whatever options.output.aovs says. statsOut may be NULL.
vplResult vplRender(const vplScene* scene, const vplRenderOptions* options, vplImage** imageOut,
                    vplRenderStats* statsOut);

// A layer and the caller's memory that it goes to.
typedef struct vplTarget {
    int layer;           // 0: the picture; else one of vplAov
    vplPixelsDef pixels; // of options.output.width x height
} vplTarget;

// Renders into the caller's memory: the picture of vplRender, with the same bits, and the layers that the targets name,
// whatever options.output.aovs says. Where progress cancels the render after a pass, or a budget of time ends it, targets
// get the picture so far; passesOut (may be NULL) receives its number of passes, 0 if the targets are untouched.
// statsOut may be NULL. VPL_CANCELLED, VPL_INVALID_ARGUMENT and what vplRender fails with.
vplResult vplRenderTo(const vplScene* scene, const vplRenderOptions* options, const vplTarget* targets,
                      int targetCount, int* passesOut, vplRenderStats* statsOut);

// Radiosity's patches as a mesh with colours at its vertices: the light that options.method
// VPL_METHOD_RADIOSITY finds, direct and indirect, for tools that draw. Written by vplPatchMesh_WritePly; its
// 8-bit colours are those of pictures of the same exposure (stops). statsOut may be NULL.
vplResult vplBake(const vplScene* scene, const vplRenderOptions* options, float exposure, const char* path,
                  vplRenderStats* statsOut);

// Renders step by step, for windows, deadlines and progressive output: after each step the picture so far can
// be read. Steps give the same bits as one call of vplRender. One step is one pass.
typedef struct vplRenderer vplRenderer;

vplResult vplRenderer_Create(const vplScene* scene, const vplRenderOptions* options,
                             vplRenderer** rendererOut);

// Renders one pass. *doneOut says whether all that the options ask for is done; further steps are allowed and
// improve pictures that are means of passes. A step that vplRenderOptions.progress cancels (VPL_CANCELLED) during its pass
// leaves the renderer as it was before the step; one that is cancelled later, while it estimates the error, keeps the
// pass. In both cases pictures of the passes so far can be read, and the next step does what was cancelled, so that the
// same bits follow. After any other failure the renderer can only be destroyed.
vplResult vplRenderer_Step(vplRenderer* renderer, bool* doneOut);

// Returns the number of passes of the picture that vplRenderer_GetImage gets; 0: there is no picture yet.
int vplRenderer_GetPassCount(const vplRenderer* renderer);

// Gets the picture so far, after at least one step; destroy it with vplImage_Destroy. statsOut may be NULL.
vplResult vplRenderer_GetImage(vplRenderer* renderer, vplImage** imageOut, vplRenderStats* statsOut);

// NULL is allowed. The scene must outlive the renderer.
void vplRenderer_Destroy(vplRenderer* renderer);

VPL_HEADER_END

#endif
