// SPDX-License-Identifier: MIT
// The light tree of a render, and the memory of its cuts.
#include "shading/lightcuts.h"

// The tree takes less than a tenth of the time that a picture does: it asks whether to go on, and reports no progress.
typedef struct Asked {
    vplProgressFcn* progress;
    void* user;
} Asked;

static bool askOnly(void* user, double fraction)
{
    (void)fraction;
    const Asked* asked = user;
    return asked->progress(asked->user, 0);
}

vplResult vplOpenLightcuts(vplShading* shading, vplProgressFcn* progress, void* user)
{
    vplContext* context = shading->geometry->context;
    const vplShadeDef* def = shading->def;
    Asked asked = {progress, user};
    vplLightcuts* lightcuts = vplAllocZero(context, 1, sizeof *lightcuts);
    if (lightcuts == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    shading->lightcuts = lightcuts;
    lightcuts->cutCount = context->workerCount;
    lightcuts->cuts = vplAlloc(context, (size_t)lightcuts->cutCount, sizeof *lightcuts->cuts);
    if (lightcuts->cuts == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < lightcuts->cutCount; i++) {
        lightcuts->cuts[i].taken = false;
        for (int k = 0; k < VPL_CUT_CAPACITY; k++) {
            lightcuts->cuts[i].places[k] = k;
        }
    }
    return vplLightTree_Create(context, def->lights, def->lightCount, progress ? askOnly : NULL, &asked,
                               &lightcuts->tree);
}

vplCut* vplTakeCut(vplLightcuts* lightcuts)
{
    for (int i = 0;; i = (i + 1) % lightcuts->cutCount) {
        if (!__atomic_test_and_set(&lightcuts->cuts[i].taken, __ATOMIC_ACQUIRE)) {
            return &lightcuts->cuts[i];
        }
    }
}

void vplReturnCut(vplLightcuts* lightcuts, vplCut* cut, int pixels)
{
    __atomic_fetch_add(&lightcuts->evaluations, (int64_t)cut->evaluations * pixels, __ATOMIC_RELAXED);
    __atomic_fetch_add(&lightcuts->pixels, pixels, __ATOMIC_RELAXED);
    int largest = __atomic_load_n(&lightcuts->largest, __ATOMIC_RELAXED);
    while (cut->evaluations > largest &&
           !__atomic_compare_exchange_n(&lightcuts->largest, &largest, cut->evaluations, false,
                                        __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {
    }
    __atomic_clear(&cut->taken, __ATOMIC_RELEASE);
}

void vplCountLightcuts(const vplShading* shading, vplShadeStats* stats)
{
    const vplLightcuts* lightcuts = shading->lightcuts;
    if (lightcuts != NULL) {
        stats->lightEvaluations = lightcuts->evaluations;
        stats->cutPixels = lightcuts->pixels;
        stats->largestCut = lightcuts->largest;
    }
}

void vplCloseLightcuts(vplShading* shading)
{
    vplContext* context = shading->geometry->context;
    if (shading->lightcuts != NULL) {
        vplLightTree_Destroy(shading->lightcuts->tree);
        vplFree(context, shading->lightcuts->cuts);
        vplFree(context, shading->lightcuts);
    }
}
