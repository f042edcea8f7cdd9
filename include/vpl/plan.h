// SPDX-License-Identifier: MIT
// What a picture needs, as a value: every decision made, every stage that will run, and what is left out,
// each with its reason. Rendering follows a plan and decides nothing; vpl info, --explain, --dry-run and
// refusals print one.
#ifndef VPL_PLAN_H
#define VPL_PLAN_H

#include <vpl/options.h>

#ifdef __cplusplus
extern "C" {
#endif

enum {
    VPL_MAX_PLAN_STAGES = 24,
    VPL_MAX_DECISIONS = 24,
    VPL_MAX_STEPS_REPORTED = 64,
    VPL_PLAN_TEXT = 200 // bytes of a reason
};

// A stage that will run.
typedef struct vplPlanStage {
    int id;                     // in the library's table of stages
    const char* name;           // as in vplRenderStats.stages
    char inputs[VPL_PLAN_TEXT]; // names of the stages whose results it reads, with commas between
    char why[VPL_PLAN_TEXT];
    int64_t bytes;   // that its result holds, about
    int64_t scratch; // that it needs besides while it runs, about
} vplPlanStage;

// An option that was left to the library, or a stage that could run and will not.
typedef struct vplDecision {
    const char* name; // of the option, as in vplRenderOptions_Set, or of the stage
    char value[32];   // what was decided; empty for a stage that is left out
    char why[VPL_PLAN_TEXT];
} vplDecision;

// Read only. Two plans of the same scene, options and machine are equal.
typedef struct vplPlan {
    // Nothing in it is "usual", "auto" or negative but for maxBounces -1 (no limit), lengths of shadow maps' bias and
    // PCF that follow each map's far distance, and row sums of links, which have a rule of their own.
    vplRenderOptions options;
    // Formulas of shading: physical for Keller also where particles lose light as printed.
    vplLighting shading;
    vplBiasRule biasRule; // of shadow maps of emitters
    int linkAbove;        // patches exchange light by links where more sides than this take part
    float nearDistance;   // metres; least clamp distance of compensated lights; 0: none
    double clampArea;     // m^2; each of N lights is clamped at the radius of a disc of clampArea / N; 0:
                          // options.lights.minDistance is given
    bool progressive;     // the picture is the mean of several passes
    bool castsRays;       // so geometry has a ray tree
    bool emitterRays;     // shadows of emitters come by rays, not from maps
    bool hasAreaLights;   // a material emits
    bool showsDirect;     // the picture shows emission, and light from emitters and area lights
    bool showsVirtual;    // it shows light of virtual lights
    bool showsPatches;    // it shows patches
    bool compensates;     // short rays find the light that the clamp takes away
    bool estimatesLoss;   // statistics tell how much that is
    vplView view;         // the camera, posed
    vplCameraDef camera;
    const vplEmitterDef* emitters; // of the scene, posed
    int emitterCount;

    vplPlanStage stages[VPL_MAX_PLAN_STAGES]; // in the order in which they run
    int stageCount;
    vplDecision decisions[VPL_MAX_DECISIONS];
    int decisionCount;
    vplDecision leftOut[VPL_MAX_DECISIONS];
    int leftOutCount;

    int stepCount; // steps of the particle simulation; bounces of SSVP
    int particlesPerStep[VPL_MAX_STEPS_REPORTED];
    int64_t virtualLights; // of a pass, most
    int64_t drawCalls;     // of a pass
    int64_t paths;         // of path tracing
    int patches, patchSides;
    double longestEdge;      // of patches, metres
    bool linked;             // patches exchange light by links between groups
    int64_t formFactorBytes; // of all pairs
    int64_t shadowMapBytes, lightBytes, pictureBytes;
    int64_t peakBytes; // that rendering holds at most; within 15 %
    // The costs that chose the shadows of virtual lights, ms of one core of the machine of bench/crossover; 0
    // if not asked.
    double shadowMapEstimateMs, shadowRayEstimateMs;
    char problem[VPL_PLAN_TEXT]; // why it cannot be rendered; empty: it can
    vplResult refusal;           // what rendering then returns: VPL_INVALID_ARGUMENT or VPL_LIMIT
    struct vplArena* arena;      // owns the emitters
} vplPlan;

// What a plan needs to know of a machine. It changes estimates only, never a decision: pictures are the same
// everywhere.
typedef struct vplMachine {
    int workerCount; // threads
} vplMachine;

// Plans a render. `machine` NULL: that of the scene's context. A picture that cannot be rendered has a plan
// too, whose `problem` says why; VPL_INVALID_ARGUMENT is for options out of their range.
vplResult vplPlan_Create(const vplScene* scene, const vplRenderOptions* options, const vplMachine* machine,
                         vplPlan** planOut);

// NULL is allowed.
void vplPlan_Destroy(vplPlan* plan);

// Writes the plan as text, a sentence per decision, as snprintf does: returns the length of all of it.
size_t vplPlan_Describe(const vplPlan* plan, char* text, size_t size);

#ifdef __cplusplus
}
#endif

#endif
