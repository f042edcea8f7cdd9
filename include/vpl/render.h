// SPDX-License-Identifier: MIT
// The one-call level: a scene and options in, a picture and statistics out.
#ifndef VPL_RENDER_H
#define VPL_RENDER_H

#include <vpl/radiosity.h>
#include <vpl/shading.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef enum vplMethod {
    VPL_METHOD_INSTANT_RADIOSITY = 0, // Franchi and Ferrante, Virtual Point Lights
    VPL_METHOD_DIRECT,                // the scene's own lights only
    VPL_METHOD_PATH,                  // path tracing: the truth that the others are judged against
    VPL_METHOD_KELLER,                // Keller, Instant Radiosity
    VPL_METHOD_SSVP,     // Aranha, Macedo and Apolinario, Screen-Space Virtual Point Light Propagation
    VPL_METHOD_RADIOSITY // Hemgren, Radiosity in Realtime Rendering
} vplMethod;

// What the picture shows.
typedef enum vplShow {
    VPL_SHOW_PICTURE = 0,
    VPL_SHOW_DEPTH,         // distance along the view axis, metres
    VPL_SHOW_NORMALS,       // components in [-1, 1]
    VPL_SHOW_SHADOW_MAP,    // the first emitter's cube unfolded into a cross of 4 x 3 faces, metres
    VPL_SHOW_SHADOW_FACTOR, // s of the first emitter, 1 in full shadow
    VPL_SHOW_DIRECT,        // light of the scene's emitters only
    VPL_SHOW_INDIRECT,      // light of all virtual lights only
    VPL_SHOW_LIGHT,         // light of virtual light `showLight` only
    VPL_SHOW_OVERLAY,       // the picture with the virtual lights drawn on it, coloured by step
    VPL_SHOW_BOUNCE,        // path: light after `showBounce` reflections before the eye's last; 0 is direct
    // of SSVP:
    VPL_SHOW_RSM,         // reflective shadow maps: position, normal, albedo and flux side by side
    VPL_SHOW_RSM_SAMPLES, // the picture with the first-bounce lights drawn on it
    VPL_SHOW_CLUSTERS,    // the same with clusters, and each first-bounce light in its cluster's colour
    VPL_SHOW_PARABOLOID, // the map of cluster `showLight`: position, normal, albedo and distance side by side
    VPL_SHOW_SECOND_BOUNCE, // the picture with the second-bounce lights drawn on it
    VPL_SHOW_GATHER,        // indirect irradiance before pixels share it, W/m^2: of every pixel's own lights
    VPL_SHOW_DENOISED,      // after that
    // of radiosity, without interpolation:
    VPL_SHOW_PATCHES,         // patches with their outlines, in the colours of their surfaces
    VPL_SHOW_PATCH_RADIOSITY, // radiosity / pi of each patch: emission, direct and indirect light, W/(m^2 sr)
    VPL_SHOW_FORM_FACTOR_SUMS, // sum of each patch's form factors, before they were clamped or normalised: 1 in closed
                               // rooms
    VPL_SHOW_RESIDUAL          // what each patch's radiosity still lacks, / pi, W/(m^2 sr): absolute values
} vplShow;

// Most paths per pixel, and most bounces of a path.
enum { VPL_MAX_SAMPLES = 1 << 24, VPL_MAX_BOUNCES = 1 << 16 };

// Whether light from a virtual light is stopped by what is between.
typedef enum vplLightShadows {
    VPL_LIGHT_SHADOWS_USUAL =
        0, // as the method's document draws: instant radiosity none, Keller's auto, SSVP by the
           // paraboloid map of a light's cluster
    VPL_LIGHT_SHADOWS_NONE,   // it is not: as Franchi and Ferrante draw
    VPL_LIGHT_SHADOWS_MAP,    // a map of the half space above each virtual light, one sample: as Keller draws
    VPL_LIGHT_SHADOWS_RAY,    // a ray per pixel and light: exact
    VPL_LIGHT_SHADOWS_AUTO,   // map or ray, whichever will be cheaper by the measurements of bench/crossover
    VPL_LIGHT_SHADOWS_CLUSTER // SSVP: by the paraboloid map of the light's cluster
} vplLightShadows;

// Where virtual lights go.
typedef enum vplLightPlacement {
    VPL_PLACEMENT_PARTICLES = 0, // where particles land
    VPL_PLACEMENT_RSM,           // first hits are texels of reflective shadow maps
    VPL_PLACEMENT_VIEW           // particles, of which those are kept that light what the camera sees
} vplLightPlacement;

// What becomes of the light that minDistance takes away.
typedef enum vplCompensation {
    VPL_COMPENSATION_USUAL = 0, // rays for Keller's method with physical lighting and shadows, else none
    VPL_COMPENSATION_NONE,      // it is lost
    VPL_COMPENSATION_RAYS       // short rays from each pixel find it
} vplCompensation;

// Where in a pixel the path tracer looks.
typedef enum vplPixel {
    VPL_PIXEL_AREA = 0, // everywhere: the pixel is the mean over its square, edges are smooth
    VPL_PIXEL_CENTRE    // its centre, as all other methods do: for comparing with them
} vplPixel;

// Where a cluster looks from.
typedef enum vplClusterPlace {
    VPL_CLUSTER_PLACE_MEMBER = 0, // from its light that is nearest to the mean: on a surface
    VPL_CLUSTER_PLACE_MEAN // from the mean, as the document has it: maybe in mid-air or inside of something
} vplClusterPlace;

// What form factors are found between.
typedef enum vplHierarchy {
    VPL_HIERARCHY_AUTO = 0, // all pairs up to VPL_ALL_PAIRS sides, else links
    VPL_HIERARCHY_OFF,      // all pairs of sides
    VPL_HIERARCHY_ON        // links between groups of them
} vplHierarchy;

// More sides of patches than this are linked in groups: as many as VPL_MAX_FORM_FACTOR_BYTES allow. Links are five times as
// fast there and err ten to twenty times as much (bench/form_factors, bench/radiosity_error): more patches should not make a
// picture worse where nobody asked for it.
enum { VPL_ALL_PAIRS = 16384 };

// Where patches are small.
typedef enum vplPatchPlacement {
    VPL_PATCHES_UNIFORM = 0, // everywhere alike, as in the document
    VPL_PATCHES_ADAPTIVE     // where light changes much: found from solutions with fewer patches
} vplPatchPlacement;

// How light varies over a patch.
typedef enum vplInterpolation {
    VPL_INTERPOLATION_GOURAUD = 0, // linearly between the patches' corners
    VPL_INTERPOLATION_NONE         // not at all
} vplInterpolation;

// Whether frames of a sequence have anything to do with each other.
typedef enum vplCoherence {
    VPL_COHERENCE_OFF =
        0, // new sample patterns for each frame, and clusters that start from the frame's own lights
    // The same patterns in all frames, and clusters that start from those of the frame before. Radiosities go on from
    // those of the frame before, `iterations` sweeps a frame: light that moved arrives with the lag of its bounces.
    VPL_COHERENCE_ON
} vplCoherence;

// What frames of a sequence hand on to each other: the geometry, and for SSVP and radiosity what the light sees, lights,
// clusters, patches and form factors, as long as nothing that they depend on has changed. Frames are rendered one after
// another, in any order, with one scene, to which nothing may be added, and options that may change. Pictures have the
// same bits as without a history, but for what `coherence` says. It must outlive renderers that use it.
typedef struct vplHistory vplHistory;

vplResult vplHistory_Create(vplContext* context, vplHistory** historyOut);

// NULL is allowed.
void vplHistory_Destroy(vplHistory* history);

typedef struct vplRenderOptions {
    vplMethod method;     // default VPL_METHOD_INSTANT_RADIOSITY
    vplLighting lighting; // default VPL_LIGHTING_PHYSICAL
    int width, height;    // pixels, [1, VPL_MAX_IMAGE_SIZE]; default 1280 x 720
    int antialias; // samples per pixel of rasterizing methods, averaged as the path tracer's box filter
                   // does; [1, 4096]; default 1: the pixel's centre
    int camera;    // index, [0, cameras of the scene); default 0

    int particles;               // N, [0, VPL_MAX_LIGHTS]; default 10
    double reflectivity;         // rho, [0, 1), or negative: the scene's area-weighted mean; default 0.5
    vplLightPlacement placement; // default VPL_PLACEMENT_PARTICLES
    int rsmSize; // texels along a side of a reflective shadow map, [0, VPL_MAX_SHADOW_MAP]; 0 (default): 256 for
                 // VPL_PLACEMENT_RSM, 1024 for SSVP, whose direct light takes its shadows from it
    vplSampler sampler;                   // default VPL_SAMPLER_AUTO
    vplBounce bounce;                     // default VPL_BOUNCE_AUTO
    vplParticleGeometry particleGeometry; // default VPL_PARTICLE_GEOMETRY_EXACT
    uint64_t seed;                        // default 0

    vplAccumulation accumulation; // default VPL_ACCUMULATE_USUAL: interleaved for SSVP, else deferred
    int batch;                    // virtual lights per pass, [1, VPL_MAX_LIGHTS]; default 64; batched only
    int interleave;    // K: each pixel meets every K^2-th virtual light, [1, VPL_MAX_INTERLEAVE]; default 4;
                       // interleaved only
    float minDistance; // bound of cos cos / max(d^2, D^2), metres, >= 0; 0: unbounded; negative
                       // (default): the radius of a disc with one light's share of the area

    // Lightcuts only: error of a pixel as a share of its light (r + g + b), (0, 1]; default 0.02. Guaranteed: no
    // cluster of lights errs by more than an eighth of it, whatever is hidden. Measured: nor do all together by more
    // than it. Where less than a sixteenth of the virtual lights' light gets through, the share is of that
    // sixteenth. Source: Walter et al., Lightcuts, SIGGRAPH 2005.
    float cutError;
    vplCompensation compensation; // default VPL_COMPENSATION_USUAL

    vplLightShadows lightShadows; // of virtual lights; RAY also replaces the emitters' shadow maps; default
                                  // VPL_LIGHT_SHADOWS_USUAL
    int lightMapSize; // texels along the side of a virtual light's map (vplHemiMap), [1, VPL_MAX_SHADOW_MAP];
                      // default 256: in simple scenes as near to rays as cube maps of 128 were, in large ones
                      // twice as near (bench/crossover), with two thirds of the texels
    int areaLightSamples;   // lights that stand for area emitters in direct light, with shadow rays,
                      // [1, VPL_MAX_LIGHTS]; default 64

    int samplesPerPixel; // path: [1, VPL_MAX_SAMPLES]; default 64
    int maxBounces;      // path: reflections before the eye's last, [0, VPL_MAX_BOUNCES]; 0: direct light
        // only; -1 (default): ended by Russian roulette alone. SSVP: 0, 1 or 2 (more count as 2)
    vplPixel pixel; // path: default VPL_PIXEL_AREA

    // SSVP only.
    int clusters;    // C, [1, VPL_MAX_LIGHTS]; default 8
    int firstBounce; // first-bounce lights, samples of the reflective map, [0, VPL_MAX_LIGHTS]; default 256
    int oversampling; // where much of the first bounce's light leaves the scene, up to so many times as many samples are
        // taken, of which about firstBounce are kept: those whose light stays; [1, 1024]; 1: as in the
        // document; default 16
    int secondBounce;   // second-bounce lights, samples of all paraboloid maps together; default 256
    int paraboloidSize; // texels along a side of a paraboloid map, [1, VPL_MAX_SHADOW_MAP]; default 128
    double w1, w2;      // weights of distance, 1/metres, and of the normals; >= 0; default 0.6, 0.4
    vplClusterMetric clusterMetric; // default VPL_CLUSTER_ONE_MINUS
    int hemispheres; // that a cluster sees, 1 or 2; default 1: its lights do not shine behind the plane through it, even
                     // where they might; 2: behind it, too, unless it is flat
    vplClusterPlace clusterPlace; // default VPL_CLUSTER_PLACE_MEMBER
    vplSecondWeight secondWeight; // default VPL_SECOND_WEIGHT_COSINE

    // Radiosity only.
    float patchSize;  // T, metres: longest edge allowed; 0 (default): about `patches` patches
    int patches;      // [1, VPL_MAX_PATCHES]; default 2000
    int subdivisions; // rounds of bisection, at most, [0, VPL_MAX_PATCH_ROUNDS]; default VPL_MAX_PATCH_ROUNDS
    vplPatchPlacement patchPlacement; // default VPL_PATCHES_UNIFORM
    vplFormFactorKind formFactors;    // default VPL_FORM_FACTORS_MONTE_CARLO
    int formSamples;                  // pairs of points per pair of patches, [1, 1024]; default 4
    vplRowSums rowSums;               // default VPL_ROW_SUMS_USUAL
    vplHierarchy hierarchy;           // default VPL_HIERARCHY_AUTO
    double linkError; // of the hierarchy, as a share of what a patch receives, (0, 1]; default 0.002
    int patchLightSamples; // points of each patch where emitters' light is found with shadow rays, [0, 16]; 0 (default):
        // 16 for Monte Carlo form factors, for incentres 1: the incentre, as in the document
    vplSolver solver; // default VPL_SOLVER_GAUSS_SEIDEL; links know VPL_SOLVER_JACOBI only, and use it
    int iterations;   // sweeps, at most, [0, VPL_MAX_SWEEPS]; default 100; with a history: per frame
    double residual; // ends when a sweep changes no radiosity by more than this share of the largest, [0, 1];
                     // default 1e-4
    vplInterpolation interpolation; // default VPL_INTERPOLATION_GOURAUD
    vplVertexWeight vertexWeight;   // default VPL_VERTEX_WEIGHT_ANGLE
    int sharpen; // rounds of vplPatchMesh_Sharpen, [0, 64]; 0: means alone, as in the document; default 4: a third to a
        // half less relmse than with 0, and a tenth less than with 2 (room-area, cornell-area, the report's box)

    double frame;        // number of the frame that cameras and emitters with a path are posed at; default 0
    vplHistory* history; // what the frame before hands on, see vplHistory_Create; NULL (default): nothing
    vplCoherence coherence; // SSVP and radiosity with a history: default VPL_COHERENCE_ON

    int passes; // pictures of N particles each, whose mean is the picture, [0, VPL_MAX_PASSES]; 0 (default):
                // one, or as many as budgetMs or maxError ask for; methods with virtual lights
    double budgetMs; // ends with the last pass that is expected to fit into so many milliseconds of the wall
                     // clock; the first is always done; 0 (default): no such end
    double maxError; // ends when the relative error estimate is not larger; 0 (default): no such end

    int shadowMapSize;   // texels along a face, [1, VPL_MAX_SHADOW_MAP]; default 1024
    vplShadowDef shadow; // bias and PCF of the emitters' shadows; default vplDefaultShadowDef()

    vplShow show;             // default VPL_SHOW_PICTURE
    int showLight;            // index of a virtual light for VPL_SHOW_LIGHT; default 0
    int showBounce;           // for VPL_SHOW_BOUNCE, [0, VPL_MAX_BOUNCES]; default 0
    vplProgressFcn* progress; // default NULL
    void* progressUser;
    uint32_t cookie; // set by vplDefaultRenderOptions
} vplRenderOptions;

vplRenderOptions vplDefaultRenderOptions(void);

// Most memory that maps of virtual lights take; more lights are added batch by batch. With 256 MB 900 lights in the room
// took 1.5 times as much time at 640x360, because new pages cost more than maps of few triangles; with 64 and 16 MB the
// same: then a batch costs another look at the scene.
#define VPL_LIGHT_MAP_BYTES ((int64_t)32 << 20)

// Most passes of a render.
enum { VPL_MAX_PASSES = 1 << 20 };

enum { VPL_MAX_STAGES = 24, VPL_MAX_STEPS_REPORTED = 64 };

typedef struct vplStage {
    const char* name; // static
    double ms;        // wall-clock
} vplStage;

typedef struct vplRenderStats {
    vplStage stages[VPL_MAX_STAGES]; // in the order they ran
    int stageCount;
    double totalMs;
    int64_t drawCalls, fragments;
    int64_t rays, rayObjectTests;
    int virtualLights;
    int64_t lightEvaluations; // lightcuts: pairs of a pixel and a virtual light that were evaluated
    int64_t cutPixels;        // lightcuts: pixels that show something, of all passes and samples
    int largestCut;           // lightcuts: most virtual lights evaluated for one pixel
    int clusters;             // SSVP: clusters of first-bounce lights
    int clusterIterations;    // SSVP: of k-means
    int patches, patchSides;  // radiosity: patches, and sides of them that light reaches
    bool linked;              // by the hierarchy
    int64_t formFactors;      // radiosity: pairs of sides, or links
    vplSolveStats solve;      // radiosity: of the last frame
    int stepCount;            // steps of the particle simulation
    int particlesPerStep
        [VPL_MAX_STEPS_REPORTED]; // nominal: floor(rho^k N), by which lights are weighted; of all
                                  // candidates where lights are chosen
    int lightsPerStep[VPL_MAX_STEPS_REPORTED]; // lights that were really left
    int escaped;                               // particles that left the scene
    int triangles, objects;
    float minDistance;   // as used, metres
    double clampLoss;    // share of the virtual lights' light that minDistance takes away, or would without
                         // compensation; an estimate from some pixels; negative where there is none
    double reflectivity; // as used
    double cpuMs;        // processor time of all threads
    vplLightShadows lightShadows; // as used: none, map, ray or cluster
    double shadowMapEstimateMs;   // where they were chosen by cost: what maps and
    double shadowRayEstimateMs; // rays were expected to take, ms of one core of the machine that was measured
    int passes;                 // that the picture is the mean of; path: of up to 32 paths per pixel each
    double
        errorEstimate; // expected rmse of the picture, from two independent halves of the samples or passes;
                       // negative where there is none
    double relativeErrorEstimate; // the same divided by the picture's mean
    size_t peakBytes;             // most memory held by the context during the call
    uint64_t imageHash;           // vplImage_Hash
} vplRenderStats;

// Renders. The picture is radiance in W/(m^2 sr) unless `show` says otherwise; destroy it with
// vplImage_Destroy. statsOut may be NULL.
vplResult vplRender(const vplScene* scene, const vplRenderOptions* options, vplImage** imageOut,
                    vplRenderStats* statsOut);

// Radiosity's patches as a mesh with colours at its vertices: the light that options.method VPL_METHOD_RADIOSITY finds,
// direct and indirect, for tools that draw. Written by vplPatchMesh_WritePly; its 8-bit colours are those of pictures of
// the same exposure (stops). statsOut may be NULL.
vplResult vplBake(const vplScene* scene, const vplRenderOptions* options, float exposure, const char* path,
                  vplRenderStats* statsOut);

// The same step by step, for windows, deadlines and progressive output: after each step there is a picture of all
// that was done. Steps give the same bits as one call of vplRender. One step is one pass.
typedef struct vplRenderer vplRenderer;

vplResult vplRenderer_Create(const vplScene* scene, const vplRenderOptions* options,
                             vplRenderer** rendererOut);

// Does one pass. *doneOut is set where the options ask for no more; further steps are allowed and make the picture
// better, where it is made of passes at all. After a failure the renderer can only be destroyed.
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
