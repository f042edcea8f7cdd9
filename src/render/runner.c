// SPDX-License-Identifier: MIT
#include "render/runner.h"

#include "base/clock.h"
#include "base/team.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

// ---- results of stages

vplResult vplHistory_Create(vplContext* context, vplHistory** historyOut)
{
    REQUIRE(context, context, historyOut);
    vplHistory* history = vplAllocZero(context, 1, sizeof *history);
    if (history == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    history->context = context;
    *historyOut = history;
    return VPL_SUCCESS;
}

static void empty(vplHistory* history, int id)
{
    vplSlot* slot = &history->slots[id];
    if (slot->result != NULL && VPL_STAGES[id].destroy != NULL) {
        VPL_STAGES[id].destroy(slot->result);
    }
    vplArena_Destroy(slot->arena);
    slot->result = NULL;
    slot->arena = NULL;
}

void vplHistory_Destroy(vplHistory* history)
{
    if (history != NULL) {
        for (int id = VPL_STAGE_COUNT; id-- > 0;) { // results refer to those before them
            empty(history, id);
        }
        vplFree(history->context, history);
    }
}

vplResult vplHistory_Open(const vplScene* scene, vplHistory* shared, vplHistory** historyOut)
{
    if (shared != NULL && shared->context != scene->context) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.sequence.history was made with another context than the scene's");
    }
    if (shared != NULL && shared->scene != 0 && shared->scene != scene->identity) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplRenderOptions.sequence.history is of another scene");
    }
    if (shared == NULL || shared->busy) {
        return vplHistory_Create(scene->context, historyOut);
    }
    shared->busy = true;
    shared->scene = scene->identity;
    *historyOut = shared;
    return VPL_SUCCESS;
}

void vplHistory_Close(vplHistory* history)
{
    if (history->busy) { // it is the caller's
        history->busy = false;
    } else {
        vplHistory_Destroy(history);
    }
}

// ---- progress and time

vplRunner vplRunner_Begin(const vplScene* scene, vplHistory* history)
{
    vplContext* context = vplScene_GetContext(scene);
    vplContext_ResetPeakBytes(context);
    return (vplRunner){.run = {.context = context, .scene = scene},
                       .history = history,
                       .stepTo = 1,
                       .heldBytes = vplContext_GetBytes(context)};
}

static bool forwardProgress(void* user, double fraction)
{
    vplRunner* r = user;
    const double part = r->partFrom + (r->partTo - r->partFrom) * fraction;
    const double stage = r->stageFrom + (r->stageTo - r->stageFrom) * part;
    r->reported = fmax(r->reported, r->stepFrom + (r->stepTo - r->stepFrom) * stage);
    return r->progress(r->progressUser, r->reported);
}

void vplRun_BeginPart(const vplRun* run, int i, int count)
{
    run->runner->partFrom = (double)i / count;
    run->runner->partTo = (i + 1.0) / count;
}

static void addTime(vplRenderStats* stats, const char* name, double ms)
{
    for (int i = 0; i < stats->stageCount; i++) {
        if (strcmp(stats->stages[i].name, name) == 0) {
            stats->stages[i].ms += ms;
            return;
        }
    }
    if (stats->stageCount < VPL_MAX_STAGES) {
        stats->stages[stats->stageCount++] = (vplStageTime){name, ms};
    }
}

void vplRun_AddTime(const vplRun* run, const char* name, double start)
{
    const double ms = vplClockMs() - start;
    addTime(run->stats, name, ms);
    run->runner->partMs += ms;
}

vplRunner vplRunner_Nest(const vplRun* run)
{
    const vplRunner* r = run->runner;
    const double width = r->stepTo - r->stepFrom, stage = r->stageTo - r->stageFrom;
    vplRunner nested = *r;
    nested.stepFrom = r->stepFrom + width * (r->stageFrom + stage * r->partFrom);
    nested.stepTo = r->stepFrom + width * (r->stageFrom + stage * r->partTo);
    nested.stageTo = 0;
    nested.startMs = vplClockMs();
    return nested;
}

void vplRunner_Unnest(const vplRun* run, const vplRunner* nested)
{
    run->runner->stats = nested->stats;
    run->runner->peakBytes = nested->peakBytes;
    run->runner->reported = nested->reported;
    run->runner->partMs += vplClockMs() - nested->startMs;
}

size_t vplRunner_PeakBytes(vplRunner* r)
{
    const size_t peak = vplContext_GetPeakBytes(r->run.context);
    r->peakBytes = peak > r->peakBytes ? peak : r->peakBytes;
    return r->peakBytes;
}

// ---- running

static bool isFresh(const vplRunner* r, vplStageId id, uint64_t key)
{
    const vplSlot* slot = &r->history->slots[id];
    bool fresh = slot->result != NULL && slot->key == key;
    for (int i = 0; i < VPL_STAGE_COUNT && fresh; i++) {
        fresh = (VPL_STAGES[id].inputs & 1u << i) == 0 || slot->inputBuilds[i] == r->run.builds[i];
    }
    return fresh;
}

// Before a result is made anew, frees the results that were made from the old one. Results that later stages
// continue from stay, but not where surfaces change: they refer to them.
static void emptyFrom(vplHistory* history, vplStageId id)
{
    for (int i = VPL_STAGE_COUNT; i-- > 1 && id == VPL_STAGE_GEOMETRY;) {
        empty(history, i);
    }
    uint32_t stale = 1u << id;
    for (int i = (int)id + 1; i < VPL_STAGE_COUNT; i++) {
        stale |= (VPL_STAGES[i].inputs & stale) != 0 ? 1u << i : 0u;
    }
    for (int i = VPL_STAGE_COUNT; i-- > (int)id;) {
        if ((stale & 1u << i) != 0 && !VPL_STAGES[i].continues && !VPL_STAGES[i].updates) {
            empty(history, i);
        }
    }
}

static vplResult make(vplRunner* r, vplStageId id)
{
    const vplStage* stage = &VPL_STAGES[id];
    vplSlot* slot = &r->history->slots[id];
    vplContext* context = r->run.context;
    emptyFrom(r->history, id);
    r->run.before = slot->result;
    r->stageFrom = r->stageTo;
    r->stageTo = stage->progress > r->stageFrom ? stage->progress : r->stageFrom;
    r->partFrom = r->partMs = 0;
    r->partTo = 1;
    vplRunner_PeakBytes(r);
    vplContext_ResetPeakBytes(context);
    const int64_t held = (int64_t)vplContext_GetBytes(context);
    const double start = vplClockMs();
    const vplWatch outer = vplSetWatch(context, r->run.progress, r, 0);
    void* result = NULL;
    r->run.arena = vplArena_Create(context);
    r->run.scratch = vplArena_Create(context);
    vplResult made = vplArena_Check(r->run.arena);
    made = made == VPL_SUCCESS ? vplArena_Check(r->run.scratch) : made;
    made = made == VPL_SUCCESS ? stage->make(&r->run, &result) : made;
    r->partTo = 1;
    const bool cancelled = atomic_exchange(&context->cancelled, false); // outside of the loops that notice
    const bool asks = !stage->undoes && r->run.progress != NULL; // the tracer takes its own passes back
    if (made == VPL_SUCCESS && (cancelled || (asks && !r->run.progress(r, 1)))) {
        made = VPL_CANCELLED;
    }
    context->watch = outer;
    made = vplTeam_Agree(context, made);
    vplArena_Destroy(r->run.scratch);
    addTime(&r->stats, stage->name, vplClockMs() - start - r->partMs);
    if (result != NULL && result == slot->result) { // the stage has changed its last result
        vplArena_Destroy(r->run.arena);
    } else {
        empty(r->history, (int)id);
        slot->result = result;
        slot->arena = r->run.arena;
    }
    const bool whole = made == VPL_CANCELLED && stage->undoes && result != NULL && result == r->run.before;
    if (made != VPL_SUCCESS) { // a result that is incomplete is of no use
        if (!whole) {
            empty(r->history, (int)id);
        }
        return made;
    }
    slot->bytes = (int64_t)vplContext_GetBytes(context) - held;
    slot->scratch = (int64_t)vplContext_GetPeakBytes(context) - held - slot->bytes;
    slot->build++;
    memcpy(slot->inputBuilds, r->run.builds, sizeof slot->inputBuilds);
    return VPL_SUCCESS;
}

vplResult vplRunner_RunStage(vplRunner* r, vplStageId id)
{
    vplSlot* slot = &r->history->slots[id];
    r->run.runner = r;
    r->run.progress = r->progress != NULL ? forwardProgress : NULL;
    r->run.stats = &r->stats;
    const uint64_t key = vplFindStageKey(&r->run, VPL_STAGES[id].key, slot->build);
    if (!isFresh(r, id, key)) {
        TRY(make(r, id));
        slot->key = key;
    }
    r->run.results[id] = slot->result;
    r->run.builds[id] = slot->build;
    return VPL_SUCCESS;
}

vplResult vplRunner_RunPlan(vplRunner* r, const vplPlan* plan, vplStageId last)
{
    uint32_t planned = 0;
    for (int i = 0; i < plan->stageCount; i++) {
        planned |= 1u << plan->stages[i].id;
    }
    for (int id = 0; id < VPL_STAGE_COUNT; id++) { // a stage must not find results of an earlier plan
        r->run.results[id] = (planned & 1u << id) != 0 ? r->run.results[id] : NULL;
    }
    r->run.plan = plan;
    r->stageTo = 0;
    for (int i = 0; i < plan->stageCount; i++) {
        const vplStageId id = (vplStageId)plan->stages[i].id;
        TRY(vplRunner_RunStage(r, id));
        if (VPL_STAGES[id].report != NULL && !r->plans) {
            VPL_STAGES[id].report(&r->run);
        }
        if (id == last) {
            break;
        }
    }
    return VPL_SUCCESS;
}

void vplRunner_Forget(vplRunner* r)
{
    for (int id = VPL_STAGE_COUNT; id-- > 0;) {
        if (VPL_STAGES[id].continues) {
            empty(r->history, id);
        }
    }
}

void* vplRunner_Take(vplRunner* r, vplStageId id)
{
    void* result = r->history->slots[id].result;
    r->history->slots[id].result = NULL;
    r->run.results[id] = NULL;
    return result;
}
