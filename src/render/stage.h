// SPDX-License-Identifier: MIT
// A picture is made in stages. A stage is a function from the plan and the results of other stages to a new
// value, which later stages read and nobody changes.
#ifndef VPL_RENDER_STAGE_H
#define VPL_RENDER_STAGE_H

#include <vpl/stages.h>

#include "base/arena.h"

typedef enum vplStageId {
    VPL_STAGE_GEOMETRY,
    VPL_STAGE_NEAR_DISTANCE,
    VPL_STAGE_EMITTER_MAPS,
    VPL_STAGE_EMITTER_TREES,
    VPL_STAGE_AREA_LIGHTS,
    VPL_STAGE_REFLECTIVE_MAPS,
    VPL_STAGE_PARTICLES,
    VPL_STAGE_FIRST_BOUNCE,
    VPL_STAGE_CLUSTERS,
    VPL_STAGE_PARABOLOIDS,
    VPL_STAGE_SECOND_BOUNCE,
    VPL_STAGE_SECOND_CLUSTERS,
    VPL_STAGE_SECOND_PARABOLOIDS,
    VPL_STAGE_FURTHER_BOUNCES,
    VPL_STAGE_CLUSTERED_LIGHTS,
    VPL_STAGE_VIRTUAL_LIGHTS,
    VPL_STAGE_PATCHES,
    VPL_STAGE_SIDES,
    VPL_STAGE_PATCH_MESH,
    VPL_STAGE_FORM_FACTORS,
    VPL_STAGE_PATCH_LIGHT,
    VPL_STAGE_SOLUTION,
    VPL_STAGE_VERTEX_LIGHT,
    VPL_STAGE_GBUFFER,
    VPL_STAGE_PICTURE,
    VPL_STAGE_LIGHT_PATHS,
    VPL_STAGE_PATHS,
    VPL_STAGE_COUNT
} vplStageId;

// The parts of a picture that the picture stage adds up.
typedef enum vplPart {
    VPL_PART_DIRECT = 1,        // emission, and light from emitters and area lights
    VPL_PART_INDIRECT = 2,      // light of virtual lights and patches
    VPL_PART_EMITTER_LIGHTS = 4 // of the virtual lights only those that lie on area lights: direct light, too
} vplPart;

// The inputs of a stage. Results are indexed by vplStageId and NULL where a stage did not run.
typedef struct vplRun {
    vplContext* context;
    const vplScene* scene;
    const vplPlan* plan;
    const void* results[VPL_STAGE_COUNT];
    // The last result of a stage that continues, from the frame or pass before. The stage may change and
    // return it.
    void* before;
    uint32_t builds[VPL_STAGE_COUNT]; // counts how often each result was made, which tells two results apart
    int pass;
    int samples; // paths per pixel in this pass; 0: the tracer is made, and its sums come from a file
    int parts;   // vplPart: what the picture stage adds up
    int firstRow, endRow;     // the only rows of the picture that are needed; endRow 0: all
    bool draft;               // it is a round of adaptive patches before the last
    vplArena* arena;          // memory of the result
    vplArena* scratch;        // memory that is freed when the stage ends
    vplProgressFcn* progress; // of the stage under way; its `user` is the runner; NULL where nobody listens
    struct vplRunner* runner; // for timing of parts of a stage, progress and nested runs
    vplRenderStats* stats;    // counts of work are added here
} vplRun;

typedef struct vplStage {
    const char* name; // as in vplRenderStats.stages
    double progress;  // share of a pass that is done when the stage ends
    uint32_t inputs;  // bits: 1 << vplStageId
    // Names everything besides the inputs that the result depends on: options, and words in capitals
    // (hashValue).
    const char* key;
    // Returns true if the picture needs it, and writes the reason for either answer into `why`, VPL_PLAN_TEXT
    // bytes.
    bool (*isNeeded)(const vplPlan* plan, char* why);
    vplResult (*make)(const vplRun* run, void** resultOut); // a result is destroyed also where it failed
    void (*destroy)(void* result);     // frees objects that its arena does not own; NULL: there are none
    void (*report)(const vplRun* run); // adds the result, kept or new, to the statistics; may be NULL
    bool continues;                    // it starts from its last result
    bool updates; // likewise, but the new result has the bits of one that is made without it
    bool undoes;  // if cancelled, it leaves its last result whole
} vplStage;

// One row per vplStageId.
extern const vplStage VPL_STAGES[VPL_STAGE_COUNT];

// The recipes of the methods: stages in the order in which they run, ended by VPL_STAGE_COUNT.
extern const vplStageId VPL_DIRECT_RECIPE[], VPL_INSTANT_RADIOSITY_RECIPE[], VPL_KELLER_RECIPE[],
    VPL_SSVP_RECIPE[], VPL_RADIOSITY_RECIPE[], VPL_PATH_RECIPE[];

// Part i of `count` of the stage under way begins: progress is that of the part.
void vplRun_BeginPart(const vplRun* run, int i, int count);

// Time since `start` (vplClockMs) counts as that of `name`, and not of the stage under way.
void vplRun_AddTime(const vplRun* run, const char* name, double start);

static inline void vplRun_AddRaster(const vplRun* run, const vplRasterStats* stats)
{
    run->stats->drawCalls += stats->drawCalls;
    run->stats->fragments += stats->fragments;
}

#endif
