// SPDX-License-Identifier: MIT
// A plan from start to end: poses, decisions (decisions.c and after it decisions_geometry.c), what cannot be rendered (refusals.c), stages, and
// estimates.
#include "render/plan.h"

#include "base/rng.h"
#include "geometry/bvh.h"
#include "math/vec.h"
#include "render/options.h"
#include "render/planner/planner.h"
#include "render/show.h"

#include <stdio.h>
#include <string.h>

// ---- stages

static const vplStageId* recipeOf(vplMethod method)
{
    static const vplStageId* const recipes[] = {
        VPL_INSTANT_RADIOSITY_RECIPE, VPL_DIRECT_RECIPE, VPL_PATH_RECIPE, VPL_KELLER_RECIPE, VPL_SSVP_RECIPE,
        VPL_RADIOSITY_RECIPE};
    return recipes[method];
}

static void listInputs(const vplPlan* p, uint32_t inputs, char* text, size_t size)
{
    size_t length = 0;
    text[0] = 0;
    for (int i = 0; i < p->stageCount; i++) {
        if ((inputs & 1u << p->stages[i].id) != 0 && length < size) {
            length += (size_t)snprintf(text + length, size - length, "%s%s", length > 0 ? ", " : "",
                                       p->stages[i].name);
        }
    }
}

static void listStages(vplPlan* p)
{
    p->stageCount = p->leftOutCount = 0;
    for (const vplStageId* id = recipeOf(p->options.method); *id != VPL_STAGE_COUNT; id++) {
        char why[VPL_PLAN_TEXT];
        if (VPL_STAGES[*id].isNeeded(p, why)) {
            vplPlanStage* stage = &p->stages[p->stageCount];
            *stage = (vplPlanStage){.id = (int)*id, .name = VPL_STAGES[*id].name};
            memcpy(stage->why, why, sizeof why);
            listInputs(p, VPL_STAGES[*id].inputs, stage->inputs, sizeof stage->inputs);
            p->stageCount++;
        } else if (p->leftOutCount < VPL_MAX_DECISIONS) {
            vplDecision* left = &p->leftOut[p->leftOutCount++];
            *left = (vplDecision){.name = VPL_STAGES[*id].name};
            memcpy(left->why, why, sizeof why);
        }
    }
}

// ---- the plan

enum { EMITTER_SAMPLE_STREAM = 0x80000011u }; // of random numbers

// Chooses `wanted` of the emitters by systematic sampling. One that is chosen several times is listed once, as bright as
// its choices together. Scales them to keep the sum of strengths.
static vplResult sampleEmitters(const vplPlan* p, int wanted, const vplEmitterDef** emittersOut,
                                int* countOut)
{
    vplEmitterDef* chosen = vplArena_Alloc(p->arena, (size_t)wanted, sizeof *chosen);
    TRY(vplArena_Check(p->arena));
    double total = 0, sum = 0;
    for (int i = 0; i < p->emitterCount; i++) {
        total += vplRgbMean(p->emitters[i].intensity);
    }
    const double step = total / wanted;
    const double offset =
        (double)vplUnitFloat(vplRandomAt(p->options.seed, EMITTER_SAMPLE_STREAM, 0).v[0]) * step;
    int count = 0;
    for (int i = 0, taken = 0; i < p->emitterCount && taken < wanted && step > 0; i++) {
        const int before = taken;
        sum += vplRgbMean(p->emitters[i].intensity);
        while (taken < wanted && sum > offset + taken * step) {
            taken++;
        }
        if (taken > before) {
            chosen[count] = p->emitters[i];
            chosen[count].intensity =
                vplRgbScale((float)((taken - before) * step / vplRgbMean(p->emitters[i].intensity)),
                            chosen[count].intensity);
            count++;
        }
    }
    *emittersOut = chosen;
    *countOut = count;
    return VPL_SUCCESS;
}

static vplResult pose(const vplScene* scene, vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    if (o->view != NULL) {
        p->camera = *o->view;
    } else {
        TRY(vplScene_PoseCamera(scene, o->output.camera, o->sequence.frame, &p->camera));
    }
    p->view = vplView_Create(&p->camera, o->output.width, o->output.height);
    p->view.width = vplRenderedWidth(&o->output); // with the same directions at its borders
    p->view.height = vplRenderedHeight(&o->output);
    p->emitterCount = vplScene_GetEmitterCount(scene);
    vplEmitterDef* emitters = vplArena_Alloc(p->arena, (size_t)p->emitterCount, sizeof *emitters);
    TRY(vplArena_Check(p->arena));
    for (int i = 0; i < p->emitterCount; i++) {
        TRY(vplScene_PoseEmitter(scene, i, o->sequence.frame, &emitters[i]));
    }
    p->emitters = emitters;
    p->mapEmitters = p->emitters;
    p->mapEmitterCount = p->emitterCount;
    const int wanted = o->lights.emitterSamples;
    const int most = wanted > 0 && wanted < VPL_MAPPED_EMITTERS ? wanted : VPL_MAPPED_EMITTERS;
    return o->lighting == VPL_LIGHTING_PHYSICAL && p->emitterCount > most
               ? sampleEmitters(p, most, &p->mapEmitters, &p->mapEmitterCount)
               : VPL_SUCCESS;
}

static vplResult decideAll(vplRunner* r, vplPlan* p)
{
    const bool asked = p->options.method != VPL_METHOD_AUTO && !r->choosesMethods;
    p->refusal = VPL_INVALID_ARGUMENT;
    TRY(pose(r->run.scene, p));
    if (p->options.method == VPL_METHOD_AUTO) {
        TRY(vplChooseMethod(r, p));
    }
    vplDecideByOptions(r->run.scene, p);
    vplRefuseOptions(p);
    if (p->problem[0] != 0) { // before anything is built
        return VPL_SUCCESS;
    }
    TRY(vplRunner_RunStage(r, VPL_STAGE_GEOMETRY));
    if (asked) {
        vplRefuseTime(r, p);
    }
    if (p->problem[0] != 0) {
        return VPL_SUCCESS;
    }
    TRY(vplDecideByGeometry(r, p));
    listStages(p);
    TRY(vplDecideLightShadows(r, p));
    listStages(p); // shadows may have decided what clusters are for
    return r->foretells ? vplForetellClusters(r, p) : VPL_SUCCESS;
}

vplResult vplMakePlan(vplRunner* r, const vplRenderOptions* options, const vplMachine* machine,
                      vplPlan** planOut)
{
    TRY(vplCheckOptions(r->run.scene, options));
    vplArena* arena = vplArena_Create(r->run.context);
    vplPlan* p = vplArena_AllocZero(arena, 1, sizeof *p);
    vplResult result = vplArena_Check(arena);
    if (result == VPL_SUCCESS) {
        p->arena = arena;
        p->options = *options;
        vplResolveQuality(&p->options);
        r->run.plan = p;
        r->plans = true;
        result = decideAll(r, p);
        r->plans = false;
    }
    if (result == VPL_SUCCESS && r->run.results[VPL_STAGE_GEOMETRY] != NULL) {
        result = vplEstimatePlan(r, machine, p);
        vplRefuseMemory(r->run.context, p);
    }
    if (result == VPL_SUCCESS && r->run.results[VPL_STAGE_GEOMETRY] != NULL) {
        vplEstimateTime(r, machine, p);
    }
    return vplArena_Deliver(arena, result, p, planOut);
}

vplResult vplPlan_Create(const vplScene* scene, const vplRenderOptions* options, const vplMachine* machine,
                         vplPlan** planOut)
{
    REQUIRE(vplScene_GetContext(scene), scene, options, planOut);
    vplContext* context = vplScene_GetContext(scene);
    vplPlan* plan = NULL;
    vplHistory* history = NULL;
    vplResult result = vplHistory_Create(context, &history);
    if (result == VPL_SUCCESS) {
        vplRunner runner = vplRunner_Begin(scene, history);
        runner.foretells = true;
        result = vplMakePlan(&runner, options, machine, &plan);
    }
    vplHistory_Destroy(history);
    result = vplTeam_Agree(context, result);
    if (result != VPL_SUCCESS) {
        vplPlan_Destroy(plan);
        return result;
    }
    *planOut = plan;
    return VPL_SUCCESS;
}

void vplPlan_Destroy(vplPlan* plan)
{
    vplArena_Destroy(plan != NULL ? plan->arena : NULL);
}
