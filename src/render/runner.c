// SPDX-License-Identifier: MIT
#include "render/runner.h"

#include "base/clock.h"
#include "base/hash.h"
#include "render/options.h"
#include "render/stages/ssvp.h"
#include "scene/scene.h"

#include <string.h>

// ---- the store

vplResult vplStore_Create(vplContext* context, vplStore** storeOut)
{
    vplStore* store = vplAllocZero(context, 1, sizeof *store);
    if (store == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    store->context = context;
    *storeOut = store;
    return VPL_SUCCESS;
}

static void empty(vplStore* store, vplStageId id)
{
    VPL_STAGES[id].destroy(store->slots[id].result);
    store->slots[id].result = NULL;
}

void vplStore_Destroy(vplStore* store)
{
    if (store != NULL) {
        for (int id = VPL_STAGE_COUNT; id-- > 0;) { // results refer to those before them
            empty(store, id);
        }
        vplFree(store->context, store);
    }
}

// ---- progress and time

vplRunner vplRunner_Begin(const vplScene* scene, vplStore* store)
{
    vplContext* context = vplScene_GetContext(scene);
    vplContext_ResetPeakBytes(context);
    return (vplRunner){.run = {.context = context, .scene = scene},
                       .store = store,
                       .stepTo = 1,
                       .heldBytes = vplContext_GetBytes(context)};
}

static bool forwardProgress(void* user, double fraction)
{
    const vplRunner* r = user;
    const double part = r->partFrom + (r->partTo - r->partFrom) * fraction;
    const double stage = r->stageFrom + (r->stageTo - r->stageFrom) * part;
    return r->progress(r->progressUser, r->stepFrom + (r->stepTo - r->stepFrom) * stage);
}

vplProgressFcn* vplRun_Progress(const vplRun* run)
{
    return run->runner->progress != NULL ? forwardProgress : NULL;
}

void* vplRun_ProgressUser(const vplRun* run)
{
    return run->runner;
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
    run->runner->partMs += vplClockMs() - nested->startMs;
}

size_t vplRunner_PeakBytes(vplRunner* r)
{
    const size_t peak = vplContext_GetPeakBytes(r->run.context);
    r->peakBytes = peak > r->peakBytes ? peak : r->peakBytes;
    return r->peakBytes;
}

// ---- keys

static uint64_t hashNumbers(uint64_t state, const double* numbers, int count)
{
    for (int i = 0; i < count; i++) {
        uint32_t words[2];
        memcpy(words, &numbers[i], sizeof words);
        state = vplHashWords(state, words, 2);
    }
    return state;
}

static uint64_t hashBits(uint64_t state, uint64_t bits)
{
    const uint32_t words[] = {(uint32_t)bits, (uint32_t)(bits >> 32)};
    return vplHashWords(state, words, 2);
}

static uint64_t hashEmitters(uint64_t state, const vplPlan* plan)
{
    for (int i = 0; i < plan->emitterCount; i++) {
        const vplEmitterDef* e = &plan->emitters[i];
        const double numbers[] = {(double)e->type,        (double)e->position.x,  (double)e->position.y,
                                  (double)e->position.z,  (double)e->direction.x, (double)e->direction.y,
                                  (double)e->direction.z, (double)e->intensity.r, (double)e->intensity.g,
                                  (double)e->intensity.b, (double)e->innerAngle,  (double)e->outerAngle};
        state = hashNumbers(state, numbers, sizeof numbers / sizeof *numbers);
    }
    return state;
}

static uint64_t hashView(uint64_t state, const vplView* v)
{
    const double numbers[] = {(double)v->eye.x,
                              (double)v->eye.y,
                              (double)v->eye.z,
                              (double)v->right.x,
                              (double)v->right.y,
                              (double)v->right.z,
                              (double)v->up.x,
                              (double)v->up.y,
                              (double)v->up.z,
                              (double)v->forward.x,
                              (double)v->forward.y,
                              (double)v->forward.z,
                              v->scaleX,
                              v->scaleY,
                              v->near,
                              v->far,
                              v->width,
                              v->height};
    return hashNumbers(state, numbers, sizeof numbers / sizeof *numbers);
}

// Hashes the values that a stage's key names: options; the posed SCENE, its EMITTERS and the VIEW; the PASS;
// the SHIFT of SSVP's patterns, and whether its clusters SEE; the BIAS rule; what PLACEMENT of particles
// depends on; what drafts of ADAPTIVE patches are made with; and ALWAYS, which is never the same again.
static uint64_t findKey(const vplRun* run, const char* key, uint32_t build)
{
    const vplRenderOptions* o = &run->plan->options;
    const double draft = run->draft;
    uint64_t state = hashNumbers(0, &draft, 1);
    while (*key != 0) {
        char word[32] = "";
        const size_t length = strcspn(key, " ");
        memcpy(word, key, length < sizeof word ? length : sizeof word - 1);
        key += length + (key[length] == ' ');
        if (strcmp(word, "EMITTERS") == 0) {
            state = hashEmitters(state, run->plan);
        } else if (strcmp(word, "VIEW") == 0) {
            state = hashView(state, &run->plan->view);
        } else if (strcmp(word, "PASS") == 0) {
            const double pass[] = {run->pass, run->plan->progressive};
            state = hashNumbers(state, pass, 2);
        } else if (strcmp(word, "SHIFT") == 0) {
            state = hashBits(state, vplSsvpShift(run));
        } else if (strcmp(word, "BIAS") == 0) {
            state = hashBits(state, run->plan->biasRule);
        } else if (strcmp(word, "SEES") == 0) {
            state = hashBits(state, vplSsvpSees(run->plan));
        } else if (strcmp(word, "ADAPTIVE") == 0) {
            const bool adaptive = o->radiosity.placement == VPL_PATCHES_ADAPTIVE;
            const char* drafts = "form-factors form-samples row-sums link-error patch-light camera seed";
            state = hashBits(state, adaptive ? findKey(run, drafts, build) : 0);
        } else if (strcmp(word, "ALWAYS") == 0) {
            state = hashBits(state, build);
        } else if (strcmp(word, "PLACEMENT") == 0) {
            const bool byView = o->particles.placement == VPL_PLACEMENT_VIEW;
            const double placement[] = {o->particles.placement, o->lights.shadows != VPL_LIGHT_SHADOWS_NONE};
            state =
                hashNumbers(byView ? hashView(state, &run->plan->view) : state, placement, byView ? 2 : 1);
        } else if (strcmp(word, "SCENE") == 0) {
            state =
                vplHashWords(state, (const uint32_t[]){(uint32_t)run->scene->stamp, run->plan->castsRays}, 2);
        } else if (strcmp(word, "seed") == 0) {
            state = hashBits(state, o->seed);
        } else {
            const double value = vplOption_GetNumber(vplFindOption(word), o);
            state = hashNumbers(state, &value, 1);
        }
    }
    return state;
}

// ---- running

static bool isFresh(const vplRunner* r, vplStageId id, uint64_t key)
{
    const vplSlot* slot = &r->store->slots[id];
    bool fresh = slot->result != NULL && slot->key == key;
    for (int i = 0; i < VPL_STAGE_COUNT && fresh; i++) {
        fresh = (VPL_STAGES[id].inputs & 1u << i) == 0 || slot->inputBuilds[i] == r->run.builds[i];
    }
    return fresh;
}

// Before a result is made anew: what was made from the old one goes, but for what continues it.
static void emptyFrom(vplStore* store, vplStageId id)
{
    uint32_t stale = 1u << id;
    for (int i = id + 1; i < VPL_STAGE_COUNT; i++) {
        stale |= (VPL_STAGES[i].inputs & stale) != 0 ? 1u << i : 0;
    }
    for (int i = VPL_STAGE_COUNT; i-- > (int)id;) {
        if ((stale & 1u << i) != 0 && !VPL_STAGES[i].continues) {
            empty(store, i);
        }
    }
}

static vplResult make(vplRunner* r, vplStageId id)
{
    const vplStage* stage = &VPL_STAGES[id];
    vplSlot* slot = &r->store->slots[id];
    vplContext* context = r->run.context;
    emptyFrom(r->store, id);
    r->run.before = slot->result;
    r->stageFrom = r->stageTo;
    r->stageTo = stage->progress > r->stageFrom ? stage->progress : r->stageFrom;
    r->partFrom = r->partMs = 0;
    r->partTo = 1;
    vplRunner_PeakBytes(r);
    vplContext_ResetPeakBytes(context);
    const int64_t held = (int64_t)vplContext_GetBytes(context);
    const double start = vplClockMs();
    void* result = NULL;
    const vplResult made = stage->make(&r->run, &result);
    addTime(&r->stats, stage->name, vplClockMs() - start - r->partMs);
    if (result != slot->result) {
        empty(r->store, id);
    }
    slot->result = result;
    if (made != VPL_SUCCESS) { // what was half made, or half changed, is of no use
        empty(r->store, id);
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
    vplSlot* slot = &r->store->slots[id];
    r->run.runner = r;
    r->run.stats = &r->stats;
    const uint64_t key = findKey(&r->run, VPL_STAGES[id].key, slot->build);
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

void* vplRunner_Take(vplRunner* r, vplStageId id)
{
    void* result = r->store->slots[id].result;
    r->store->slots[id].result = NULL;
    r->run.results[id] = NULL;
    return result;
}
