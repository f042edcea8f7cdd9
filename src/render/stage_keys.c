// SPDX-License-Identifier: MIT
// Keys of stages: hashes of the options and poses that a stage's result depends on.
#include "base/hash.h"
#include "render/options.h"
#include "render/runner.h"
#include "render/stages/ssvp.h"
#include "scene/scene.h"

#include <stddef.h>
#include <string.h>

static uint64_t hashBytes(uint64_t state, const void* bytes, size_t size)
{
    uint32_t words[sizeof(vplView) / sizeof(uint32_t)]; // the longest value
    memcpy(words, bytes, size);
    return vplHashWords(state, words, size / sizeof *words);
}

static uint64_t hashNumber(uint64_t state, double number)
{
    return hashBytes(state, &number, sizeof number);
}

static uint64_t hashEmitters(uint64_t state, const vplPlan* plan)
{
    for (int i = 0; i < plan->emitterCount; i++) {
        state = hashBytes(state, &plan->emitters[i], offsetof(vplEmitterDef, cookie));
    }
    return state;
}

static uint64_t hashView(uint64_t state, const vplPlan* plan)
{
    return hashBytes(state, &plan->view, sizeof plan->view);
}

// Hashes one value that a key names: an option, or a word in capitals.
static uint64_t hashValue(const vplRun* run, const char* word, uint32_t build, uint64_t state)
{
    const vplPlan* plan = run->plan;
    const vplRenderOptions* o = &plan->options;
    if (strcmp(word, "EMITTERS") == 0) { // posed
        return hashEmitters(state, plan);
    }
    if (strcmp(word, "VIEW") == 0) { // posed
        return hashView(state, plan);
    }
    if (strcmp(word, "GROUPS") == 0) { // light at their vertices is found where the camera sees them
        return o->radiosity.groups == VPL_PATCH_GROUPS_ON ? hashView(state, plan) : state;
    }
    if (strcmp(word, "PASS") == 0) {
        return hashNumber(hashNumber(state, run->pass), plan->progressive);
    }
    if (strcmp(word, "SHIFT") == 0) { // of SSVP's sample patterns
        const uint64_t shift = vplSsvpShift(run);
        return hashBytes(state, &shift, sizeof shift);
    }
    if (strcmp(word, "ADAPTIVE") == 0) { // adaptive patches depend on all that their drafts are made with
        const char* drafts =
            "form-factors form-samples row-sums link-error patch-light sky-samples camera seed";
        const uint64_t inner =
            o->radiosity.placement == VPL_PATCHES_ADAPTIVE ? vplFindStageKey(run, drafts, build) : 0;
        return hashBytes(state, &inner, sizeof inner);
    }
    if (strcmp(word, "CONTINUES") == 0) { // each frame goes on from the one before
        const bool goesOn = o->sequence.history != NULL && o->sequence.coherence == VPL_COHERENCE_ON;
        return hashNumber(state, goesOn ? (double)build + 1 : 0);
    }
    if (strcmp(word, "ALWAYS") == 0) { // never the same again
        return hashNumber(state, build);
    }
    if (strcmp(word, "PLACEMENT") == 0) { // particles that are placed by the view depend on it
        const bool byView = o->particles.placement == VPL_PLACEMENT_VIEW;
        state = hashNumber(state, o->particles.placement);
        return byView ? hashNumber(hashView(state, plan), o->lights.shadows != VPL_LIGHT_SHADOWS_NONE)
                      : state;
    }
    if (strcmp(word, "ROWS") == 0) { // those that are needed
        return hashNumber(hashNumber(state, run->firstRow), run->endRow);
    }
    if (strcmp(word, "SCENE") == 0) {
        return hashNumber(hashNumber(state, (double)run->scene->surfaces), plan->castsRays);
    }
    if (strcmp(word, "seed") == 0) { // 64 bits, which a double does not hold
        return hashBytes(state, &o->seed, sizeof o->seed);
    }
    return hashNumber(state, vplOption_GetNumber(vplFindOption(word), o));
}

uint64_t vplFindStageKey(const vplRun* run, const char* key, uint32_t build)
{
    uint64_t state = hashNumber(0, run->draft);
    while (*key != 0) {
        char word[32] = "";
        const size_t length = strcspn(key, " ");
        memcpy(word, key, length);
        key += length + (key[length] == ' ');
        state = hashValue(run, word, build, state);
    }
    return state;
}
