// SPDX-License-Identifier: MIT
// A plan from the inside: its fields, and the speeds by which it predicts times.
#ifndef VPL_PLANTOOLS_H
#define VPL_PLANTOOLS_H

#include <vpl/plan.h>
#include <vpl/render.h>
#include <vpl/shading.h>

VPL_HEADER_BEGIN

enum {
    VPL_MAX_PLAN_STAGES = 24,
    VPL_MAX_DECISIONS = 24,
    VPL_PLAN_TEXT = 200, // bytes of a reason
    // Most paths per pixel in a pass of path tracing, so many that threads seldom wait for each other.
    VPL_PATHS_PER_PASS = 32
};

// A stage that will run.
typedef struct vplPlanStage {
    int id;                     // in the library's table of stages
    const char* name;           // as in vplRenderStats.stages
    char inputs[VPL_PLAN_TEXT]; // names of the stages whose results it reads, with commas between
    char why[VPL_PLAN_TEXT];
    int64_t bytes;   // estimated size of its result
    int64_t scratch; // estimated further memory while it runs
    double ms;       // predicted wall-clock time, in one pass
} vplPlanStage;

// An option that was left to the library, or a stage that could run and will not.
typedef struct vplDecision {
    const char* name; // the option, as in vplRenderOptions_Set, or the stage
    char value[32];   // the chosen value; empty for a stage that is left out
    char why[VPL_PLAN_TEXT];
} vplDecision;

// What the planner saw of the scene, from some hundred rays and virtual lights; see vplPlan.look.
typedef struct vplLook {
    int points;        // places in the picture that were looked at; 0: no look was taken, and the rest is 0
    double background; // share of them where nothing is seen
    double open;       // share of the directions from visible surfaces in which there is nothing
    double
        nearShare; // share of these directions in which something is nearer than a 32nd of the scene's diagonal
    int lights;    // virtual lights that were made
    double reaching; // share of them whose light reaches a visible surface
    // Virtual lights of equal contribution that would be as good as one of those that were made, in [0, 1]: 0 where none of
    // the lights reaches the picture, small where few do, as behind a door ajar.
    double worth;
    double lightLeaving; // share of the particles that left the scene
    int64_t rays;        // cast for the look
} vplLook;

// Read only. Two plans of the same scene, options and machine are equal.
struct vplPlan {
    // Resolved: no value is "usual", "auto" or negative. Three exceptions have their meaning in later stages:
    // maxBounces -1 is no limit, automatic bias and PCF lengths of shadow maps follow from each map, and the row
    // sums of links follow a rule of their own.
    vplRenderOptions options;
    // Lighting formulas. For Keller they are physical even where particles lose light as printed.
    vplLighting shading;
    vplBiasRule biasRule; // of shadow maps of emitters
    int linkAbove;        // patches exchange light by links where more sides than this take part
    float nearDistance;   // metres; smallest clamp distance of compensated lights; 0: none
    double clampArea;     // m^2; each of N lights is clamped at the radius of a disc of clampArea / N; 0:
                          // options.lights.minDistance is given
    bool progressive;     // the picture is the mean of several passes
    bool keepsGbuffer;    // passes share one G-buffer
    bool castsRays;       // some stage casts rays, so the geometry has a ray tree
    bool emitterRays;     // emitters are shadowed by rays, not by maps
    int emittersPerPoint; // that a tree chooses for each point, in direct light; 0: all light it
    int emittingTriangles;
    // How many of the emitting triangles a tree chooses for each point that direct light falls on; 0: samples on them stand for
    // all. If options.lights.areaLightSamples is greater, pixels use that many samples, and only hits of rays use the tree.
    int trianglesPerPoint;
    bool hasAreaLights; // a material emits light
    bool hasSky;        // the scene has an environment
    bool hasCutOuts;    // materials let light through
    bool showsDirect;   // the picture shows emission, and light from emitters and area lights
    bool showsVirtual;  // the picture shows light from virtual lights
    bool showsPatches;  // the picture shows patches
    bool gathers;       // rays from pixels find the light of patches
    bool
        splitsLight; // direct light is rendered a second time, alone, for layers of direct and indirect light
    bool compensates;   // short rays add the light that the clamp takes away
    bool estimatesLoss; // statistics say how much light the clamp takes away
    vplView view;       // the camera, posed
    vplCameraDef camera;
    const vplEmitterDef* emitters; // those of the scene, posed
    int emitterCount;
    const vplEmitterDef*
        mapEmitters; // those with reflective maps: all, or a sample of them where there are many
    int mapEmitterCount;

    vplPlanStage stages[VPL_MAX_PLAN_STAGES]; // in the order in which they run
    int stageCount;
    vplDecision decisions[VPL_MAX_DECISIONS];
    int decisionCount;
    vplDecision leftOut[VPL_MAX_DECISIONS];
    int leftOutCount;

    double reflectance; // SSVP: mean reflectance over the area of the scene, which sets the number of bounces
    int stepCount;      // steps of the particle simulation; bounces of SSVP
    int particlesPerStep[VPL_MAX_STEPS_REPORTED];
    int64_t virtualLights; // upper limit per pass
    int64_t drawCalls;     // per pass; if keepsGbuffer, of all passes together
    int passes;            // that the options ask for; 0: a time or an error ends them
    int64_t paths;         // path tracing: paths of all pixels; 0: as many as the time or the error asks for
    int patches, litPatches, patchSides; // litPatches: those that light reaches
    int patchGroups, groupedTriangles;   // patches that are groups of triangles, and the triangles in them
    int faintSides;                      // sides of patches that are left out (vplPatchSidesDef.leaveFaint)
    double longestEdge;                  // longest edge of a patch, metres
    bool linked;                         // patches exchange light by links between groups
    int64_t formFactorBytes;             // form factors of all pairs
    int64_t shadowMapBytes, lightBytes, pictureBytes, layerBytes;
    int64_t peakBytes; // most memory that rendering holds at a time, within 15 %
    // Estimated costs of shadow maps and rays, by which the shadows of virtual lights were chosen, ms on one
    // core of the machine of bench/crossover; 0 where there was no choice.
    double shadowMapEstimateMs, shadowRayEstimateMs;
    // Predicted wall-clock times, which no decision follows, ms: all passes that the options count, until the first
    // picture, and a further pass. Where only a time or an error ends the passes, predictedMs is that of the first, and
    // of 32 paths per pixel. Two of three were within a factor 1.5 of the truth (src/render/README.md).
    double predictedMs, firstMs, passMs;
    bool usualSpeeds;            // they are those of vplUsualSpeeds, and not of this machine
    vplLook look;                // of --method auto
    char problem[VPL_PLAN_TEXT]; // why the picture cannot be rendered; empty: it can
    vplResult refusal;      // the result of rendering it all the same: VPL_INVALID_ARGUMENT, VPL_LIMIT or
                            // VPL_OUT_OF_MEMORY
    struct vplArena* arena; // owns the emitters
};

// Times of the parts of a render, nanoseconds of one thread, > 0; by them vplPlan.predictedMs is predicted.
typedef struct vplSpeeds {
    double buildTriangle; // adding a triangle to the scene's ray tree
    double drawTriangle;  // drawing a small triangle
    double drawTexel;     // filling and drawing a texel of a shadow map, in a scene of few triangles
    double drawPixel;     // drawing and resolving a pixel's surface, without light
    double pixelLight;    // adding a light without shadow to a pixel
    double shadowRay;     // a shadow ray from a pixel to a light, in a scene of few triangles
    double pathRay;       // a ray of a path with its shading, in a scene of few triangles
    double formFactor;    // a form factor of two sides of patches
    double threads; // how many times as fast as one thread all threads are; 0: nearly as many as there are
} vplSpeeds;

// Speeds of the machine of our benchmarks.
vplSpeeds vplUsualSpeeds(void);

// Measures the speeds of this machine with the context's threads and instruction set, by rendering small pictures of a
// built-in scene for about a second. What the time is not enough for is scaled like the rest. The clock is that of the
// processor, so other programs disturb little; other threads of the process should rest. Memory is that of the context's
// allocator. VPL_OUT_OF_MEMORY.
vplResult vplSpeeds_Measure(vplContext* context, vplSpeeds* speedsOut);

// Facts about the machine. They change estimates only, never a decision, so pictures are the same on every
// machine.
struct vplMachine {
    int workerCount;         // threads
    const vplSpeeds* speeds; // NULL: as usual
};

// From now on the context's plans predict times by these speeds, which are copied; NULL (default): vplUsualSpeeds.
// VPL_INVALID_ARGUMENT if a speed is not positive and finite; VPL_OUT_OF_MEMORY.
vplResult vplContext_SetSpeeds(vplContext* context, const vplSpeeds* speeds);

// Writes the plan as JSON: the version of the format, the hash of the scene (vplScene_GetHash), every option
// as vplRenderOptions_Get writes it, decisions, stages, what is left out, and estimates.
// vplRenderOptions_Load reads the options back, and they render the same bits with any number of threads,
// instruction set and compiler, as far as no time ends the render; see vplRenderer_WritePlan. Options are
// written as the plan resolved them (vplPlan.options). Three may stay auto, because they would mean something else as a
// number or word: min-distance (each pass has its own), light-shadows where rays were chosen (ray would also replace
// the shadow maps of emitters), and hierarchy for adaptive patches.
vplResult vplPlan_Write(const vplPlan* plan, const vplScene* scene, const char* path);

// Sets the options that a plan file has; others stay as they are. *sceneHashOut (may be NULL) is the hash of
// the file's scene, to be compared with vplScene_GetHash: with another scene the options are valid, but the
// picture is another. VPL_FILE_ERROR, VPL_OUT_OF_MEMORY, or VPL_PARSE_ERROR with "file:line:column:" in its
// message; then the options are as they were.
vplResult vplRenderOptions_Load(vplContext* context, const char* path, vplRenderOptions* options,
                                uint64_t* sceneHashOut);

// The plan of the picture so far, which the renderer owns. Budgets and errors may replace it in the next step.
const vplPlan* vplRenderer_GetPlan(const vplRenderer* renderer);

VPL_HEADER_END

#endif
