// SPDX-License-Identifier: MIT
// The one loop that runs stages: order, timing, progress, cancellation, and keeping results from frame to
// frame.
#ifndef VPL_RENDER_RUNNER_H
#define VPL_RENDER_RUNNER_H

#include "render/probe.h"
#include "render/stage.h"

// The last result of a stage.
typedef struct vplSlot {
    void* result;
    vplArena* arena;                       // owns the result's memory
    uint64_t key;                          // hash of the options and poses that it was made for
    uint32_t build;                        // 1, 2, ...: how often it was made
    uint32_t inputBuilds[VPL_STAGE_COUNT]; // builds of the results that it was made from
    int64_t bytes, scratch;                // as measured when it was made
} vplSlot;

// The results of all stages, kept between passes, and between frames that share a history.
struct vplHistory {
    vplContext* context;
    uint64_t scene; // identifies that of the first frame; 0: no frame yet
    bool busy;      // a renderer uses it, which does not own it
    vplSlot slots[VPL_STAGE_COUNT];
};

typedef struct vplRunner {
    vplRun run;
    vplHistory* history;
    vplRenderStats stats;
    bool plans;     // results serve decisions and are not reported yet
    bool foretells; // the plan is for a reader: its bytes may take some time
    vplLook look;
    bool looked; // `look` was taken (planner/look.h)
    vplProbe probe;
    bool probed;         // `probe` was taken
    bool choosesMethods; // the method was left to the planner, which does not refuse its own plans
    vplProgressFcn* progress;
    void* progressUser;
    double stepFrom, stepTo;   // share of the whole that the pass under way has
    double stageFrom, stageTo; // share of the pass that the stage under way has
    double partFrom, partTo;   // share of the stage that its part under way has
    double reported;           // share of the whole; it never shrinks
    double startMs;            // when a nested runner began
    double partMs;             // time that vplRun_AddTime took from the stage under way
    vplClampLoss loss;         // of all passes
    size_t heldBytes; // held by the context when the runner began: the scene and the caller's other memory
    size_t peakBytes; // most that the context held before its counter was reset
} vplRunner;

// Opens the history that the options name, or a new one where there is none or another renderer uses it.
vplResult vplHistory_Open(const vplScene* scene, vplHistory* shared, vplHistory** historyOut);
void vplHistory_Close(vplHistory* history);

// A runner without a plan. It borrows the history.
vplRunner vplRunner_Begin(const vplScene* scene, vplHistory* history);

// The hash of the values that a stage's key names, with spaces between the names; `build` is how often it was made.
uint64_t vplFindStageKey(const vplRun* run, const char* key, uint32_t build);

// Runs a stage whose inputs are there, unless its result in the history is still right.
vplResult vplRunner_RunStage(vplRunner* runner, vplStageId id);

// Runs the stages of the plan up to `last`.
vplResult vplRunner_RunPlan(vplRunner* runner, const vplPlan* plan, vplStageId last);

// A runner for stages within the stage under way: it sees the same results, needs a history of its own, and
// its progress is that of the part under way. Its statistics and time are added by vplRunner_Unnest.
vplRunner vplRunner_Nest(const vplRun* run);
void vplRunner_Unnest(const vplRun* run, const vplRunner* nested);

// Frees results that later stages would continue from, so that what follows has the bits of a new render.
void vplRunner_Forget(vplRunner* runner);

// Takes a result out of the history; the caller destroys it.
void* vplRunner_Take(vplRunner* runner, vplStageId id);

// Most bytes that the context held since the runner began.
size_t vplRunner_PeakBytes(vplRunner* runner);

#endif
