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
    lightcuts->workerCount = context->workerCount;
    lightcuts->workers = vplAlloc(context, (size_t)lightcuts->workerCount, sizeof *lightcuts->workers);
    if (lightcuts->workers == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < lightcuts->workerCount; i++) {
        vplCutWorker* worker = &lightcuts->workers[i];
        worker->evaluations = worker->pixels = worker->largest = 0;
        for (int k = 0; k < VPL_CUT_CAPACITY; k++) {
            worker->cut.places[k] = k;
        }
    }
    return vplLightTree_Create(context, def->lights, def->lightCount, progress ? askOnly : NULL, &asked,
                               &lightcuts->tree);
}

void vplCountLightcuts(const vplShading* shading, vplShadeStats* stats)
{
    const vplLightcuts* lightcuts = shading->lightcuts;
    for (int i = 0; lightcuts != NULL && lightcuts->workers != NULL && i < lightcuts->workerCount; i++) {
        const vplCutWorker* worker = &lightcuts->workers[i];
        stats->lightEvaluations += worker->evaluations;
        stats->cutPixels += worker->pixels;
        stats->largestCut = worker->largest > stats->largestCut ? worker->largest : stats->largestCut;
    }
}

void vplCloseLightcuts(vplShading* shading)
{
    vplContext* context = shading->geometry->context;
    if (shading->lightcuts != NULL) {
        vplLightTree_Destroy(shading->lightcuts->tree);
        vplFree(context, shading->lightcuts->workers);
        vplFree(context, shading->lightcuts);
    }
}
