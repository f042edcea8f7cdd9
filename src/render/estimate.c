// SPDX-License-Identifier: MIT
// Counts and bytes of a plan. A stage that ran while decisions were made is known exactly; for the others
// sizes follow from what they allocate. tests/test_plan.c compares the sum with what rendering holds.
#include "radiosity/links/links.h"
#include "render/estimate_bytes.h"
#include "render/options.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include "scene/scene.h"

int vplEmitterMapFaces(const vplPlan* p)
{
    int faces = 0;
    for (int i = 0; i < p->emitterCount; i++) {
        faces += p->emitters[i].type != VPL_EMITTER_DIRECTIONAL ? 6 : 0;
    }
    return faces;
}

double vplEmitterMapBytes(const vplPlan* p)
{
    const double texels = (double)p->options.shadow.mapSize * p->options.shadow.mapSize;
    return vplEmitterMapFaces(p) * texels * sizeof(float);
}

double vplReflectiveMapFaces(const vplPlan* p)
{
    double faces = 0;
    for (int i = 0; i < p->mapEmitterCount; i++) {
        faces += p->mapEmitters[i].type == VPL_EMITTER_POINT ? 6 : 1;
    }
    return faces;
}

// Keller's lights of step 0 are drawn where they lie on area lights; elsewhere they are the emitter itself.
static int64_t drawnLights(const vplRunner* r, const vplPlan* p)
{
    const bool asEmitters = p->options.method == VPL_METHOD_KELLER && !p->hasAreaLights && !p->hasSky;
    const vplVirtualLights* known = r->history->slots[VPL_STAGE_VIRTUAL_LIGHTS].result;
    return known != NULL ? known->count : p->virtualLights - (asEmitters ? p->particlesPerStep[0] : 0);
}

static void countDraws(const vplPlanScale* s, vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    const int64_t objects = (int64_t)s->objects, supersample = o->output.supersample;
    p->passes = o->stop.passes;
    if (o->method == VPL_METHOD_PATH) {
        p->passes = vplPathsAreOpen(p) ? 0 : vplCountPathPasses(p);
        p->paths = vplPathsAreOpen(p) ? 0 : (int64_t)s->pixels * o->path.samples;
        return;
    }
    if (o->method == VPL_METHOD_SSVP) {
        p->drawCalls = objects * ((int64_t)vplReflectiveMapFaces(p) + supersample);
        return;
    }
    const int64_t perPass = o->pipeline.kind == VPL_ACCUMULATE_BATCHED ? o->pipeline.batch : 1;
    const int64_t passes =
        o->pipeline.kind >= VPL_ACCUMULATE_DEFERRED ? 0 : ((int64_t)s->drawn + perPass - 1) / perPass;
    const bool drawn = o->method == VPL_METHOD_RADIOSITY && !p->gathers;
    const int64_t patchDraws = drawn ? 2 : 0; // of fronts and of backs
    const int64_t faces = p->emitterRays ? 0 : vplEmitterMapFaces(p);
    p->drawCalls =
        objects * (faces + (1 + passes) * supersample) + patchDraws * supersample * vplCountPoints(p);
}

enum {
    SHADOW_MAPS = 1 << VPL_STAGE_EMITTER_MAPS | 1 << VPL_STAGE_REFLECTIVE_MAPS | 1 << VPL_STAGE_PARABOLOIDS |
                  1 << VPL_STAGE_SECOND_PARABOLOIDS | 1 << VPL_STAGE_FURTHER_BOUNCES,
    LIGHTS = 1 << VPL_STAGE_AREA_LIGHTS | 1 << VPL_STAGE_PARTICLES | 1 << VPL_STAGE_FIRST_BOUNCE |
             1 << VPL_STAGE_SECOND_BOUNCE | 1 << VPL_STAGE_CLUSTERED_LIGHTS | 1 << VPL_STAGE_VIRTUAL_LIGHTS,
    // Each pass makes them before it drops those of the last.
    REMADE = 1 << VPL_STAGE_PARABOLOIDS | 1 << VPL_STAGE_SECOND_PARABOLOIDS | 1 << VPL_STAGE_FURTHER_BOUNCES
};

// Links depend on what sees what, so a sample of them is found; not for a render, of which that takes 3 %.
static vplResult estimateLinks(const vplRunner* r, vplPlanScale* s)
{
    const vplPatchSides* sides = r->run.results[VPL_STAGE_SIDES];
    if (!r->foretells || !s->plan->linked || sides == NULL) {
        return VPL_SUCCESS;
    }
    vplLinkDef def = vplDefaultLinkDef();
    def.error = s->plan->options.radiosity.linkError;
    def.samples = s->plan->options.radiosity.formSamples;
    def.seed = s->plan->options.seed;
    return vplLinks_EstimateBytes(sides, &def, &s->links.held, &s->links.scratch);
}

vplResult vplEstimatePlan(vplRunner* r, const vplMachine* machine, vplPlan* p)
{
    const vplGeometry* g = r->run.results[VPL_STAGE_GEOMETRY];
    vplPlanScale s = {.plan = p,
                      .workers =
                          machine != NULL ? machine->workerCount : vplContext_GetWorkerCount(r->run.context),
                      .triangles = g->triangleCount,
                      .objects = g->objectCount,
                      .smooth = g->shadingNormals != NULL,
                      .pixels = vplCountPixels(&p->options.output),
                      .lights = (double)p->virtualLights,
                      .drawn = (double)drawnLights(r, p),
                      .sides = p->patchSides};
    TRY(estimateLinks(r, &s));
    s.factors = vplEstimateFactors(r, p);
    // The caller's own memory in the context does not count, but the scene's does.
    const int64_t foreign = (int64_t)r->heldBytes - (int64_t)vplScene_GetBytes(r->run.scene);
    const int64_t peak = (int64_t)vplContext_GetPeakBytes(r->run.context), before = (int64_t)r->peakBytes;
    int64_t live = (int64_t)vplContext_GetBytes(r->run.context) - foreign, remade = 0;
    p->peakBytes = (peak > before ? peak : before) - foreign;
    for (int i = 0; i < p->stageCount; i++) {
        vplPlanStage* stage = &p->stages[i];
        const vplSlot* slot = &r->history->slots[stage->id];
        if (slot->result != NULL) { // it ran while decisions were made, and is part of `live`
            stage->bytes = slot->bytes;
            stage->scratch = slot->scratch;
        } else {
            const vplStageBytes bytes = vplEstimateStage(&s, (vplStageId)stage->id);
            stage->bytes = (int64_t)bytes.held;
            stage->scratch = (int64_t)bytes.scratch;
            live += stage->bytes;
            p->peakBytes = live + stage->scratch > p->peakBytes ? live + stage->scratch : p->peakBytes;
        }
        remade =
            p->progressive && (1 << stage->id & REMADE) != 0 && stage->bytes > remade ? stage->bytes : remade;
        p->shadowMapBytes += (1 << stage->id & SHADOW_MAPS) != 0 ? stage->bytes : 0;
        p->lightBytes += (1 << stage->id & LIGHTS) != 0 ? stage->bytes : 0;
    }
    const vplStageBytes more = vplEstimateLayers(&s);
    live += (int64_t)(more.held + more.scratch) + remade;
    p->peakBytes = live > p->peakBytes ? live : p->peakBytes;
    p->layerBytes = (int64_t)(12 * s.pixels) * __builtin_popcount((unsigned)p->options.output.aovs);
    p->pictureBytes = 12 * (int64_t)p->options.output.width * p->options.output.height;
    countDraws(&s, p);
    return VPL_SUCCESS;
}
