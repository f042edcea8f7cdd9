// SPDX-License-Identifier: MIT
// Lightcuts: the light tree of a render, and the memory of its cuts.
#include "shading/lightcuts.h"

// The tree takes less than a tenth of a picture's time: it can be cancelled, and reports no progress.
static bool askOnly(void* user, double fraction)
{
    (void)fraction;
    const vplShadeDef* def = ((const vplShading*)user)->def;
    return def->progress(def->progressUser, 0);
}

static vplResult openLightcuts(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplContext* context = shading->geometry->context;
    vplLightcuts* lightcuts = vplArena_AllocZero(shading->arena, 1, sizeof *lightcuts);
    vplCutWorker* workers = vplArena_Alloc(shading->arena, (size_t)context->workerCount, sizeof *workers);
    TRY(vplArena_Check(shading->arena));
    vplOpenGbuffer(shading, framebuffer, shading->kernels.lightcuts);
    shading->state = lightcuts;
    lightcuts->workers = workers;
    for (int i = 0; i < context->workerCount; i++) {
        workers[i].evaluations = workers[i].pixels = workers[i].largest = 0;
        for (int k = 0; k < VPL_CUT_CAPACITY; k++) {
            workers[i].cut.indices[k] = k;
        }
    }
    TRY(vplLightTree_Create(context, shading->lights.lights, shading->lights.count,
                            shading->def->progress ? askOnly : NULL, shading, &lightcuts->tree));
    vplArena_Absorb(shading->arena, lightcuts->tree->arena);
    return VPL_SUCCESS;
}

static vplResult countLightcuts(vplShading* shading, vplShadeStats* stats)
{
    const vplLightcuts* lightcuts = shading->state;
    for (int i = 0; i < shading->geometry->context->workerCount; i++) {
        const vplCutWorker* worker = &lightcuts->workers[i];
        stats->lightEvaluations += worker->evaluations;
        stats->cutPixels += worker->pixels;
        stats->largestCut = worker->largest > stats->largestCut ? worker->largest : stats->largestCut;
    }
    return VPL_SUCCESS;
}

const vplStrategy vplLightcutsStrategy = {
    .open = openLightcuts, .record = vplRecordGbuffer, .finish = countLightcuts};
