// SPDX-License-Identifier: MIT
// A plan from start to end: poses, decisions (decisions.c and after it decisions_geometry.c), what cannot be rendered, stages, and estimates.
#include "render/plan.h"

#include "base/rng.h"
#include "geometry/bvh.h"
#include "math/vec.h"
#include "render/options.h"
#include "render/planner/planner.h"
#include "render/show.h"

#include <stdio.h>
#include <string.h>

// ---- what cannot be rendered

static const char* refuseLighting(const vplPlan* p)
{
    if (p->options.lighting != VPL_LIGHTING_DOCUMENTED) {
        return NULL;
    }
    switch (p->options.method) {
    case VPL_METHOD_PATH:
        return "the path tracer knows physical lighting only, not documented";
    case VPL_METHOD_SSVP:
        return "the SSVP document prints no lighting formulas of its own; use physical lighting";
    case VPL_METHOD_RADIOSITY:
        return "radiosity's document prints no lighting formulas of its own; use physical lighting";
    default:
        return NULL;
    }
}

// A hemispherical map of a light in the sky would show the whole scene in a part of a texel.
static const char* refuseSky(const vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    if (!p->hasSky) {
        return NULL;
    }
    if (o->lighting == VPL_LIGHTING_DOCUMENTED) {
        return "documented lighting knows no environment; use physical lighting";
    }
    return o->method == VPL_METHOD_KELLER && o->lights.shadows == VPL_LIGHT_SHADOWS_MAP
               ? "lights of the environment are too far away for shadow maps; use --light-shadows ray"
               : NULL;
}

static const char* refuseOptions(const vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    const vplShow show = o->output.show;
    if (refuseSky(p) != NULL) {
        return refuseSky(p);
    }
    if (o->lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER && o->method != VPL_METHOD_SSVP) {
        return "only SSVP's lights have clusters to cast shadows by";
    }
    if (o->method == VPL_METHOD_RADIOSITY && o->radiosity.placement == VPL_PATCHES_ADAPTIVE &&
        o->radiosity.patchSize > 0) {
        return "adaptive patches are counted, not measured: set vplRenderOptions.radiosity.patches and leave "
               "patchSize at 0";
    }
    if (o->output.aovs != 0 && show != VPL_SHOW_PICTURE) {
        return "--aov adds layers to the picture, not to what --show shows instead of it";
    }
    const bool once = o->method == VPL_METHOD_RADIOSITY; // its picture is whole at once
    if (o->path.edgePixels > 0 && ((o->stop.passes <= 0 && !once) || o->stop.budgetMs > 0)) {
        return "edge-pixels needs passes without a budget: they are chosen from the picture of all passes";
    }
    if (o->path.edgePixels > 0 &&
        (show != VPL_SHOW_PICTURE || o->output.aovs != 0 || p->shading != VPL_LIGHTING_PHYSICAL)) {
        return "edge-pixels replaces pixels of the whole picture by physical light: it goes with no other "
               "--show, no --aov and no "
               "--lighting documented";
    }
    if (o->output.pixelSize > 1 &&
        (o->path.edgePixels > 0 || o->output.aovs != 0 || VPL_SHOWS[show].draw != NULL)) {
        return "--edge-pixels, --aov and maps that --show shows have a value of each pixel: use --pixel-size "
               "1";
    }
    const bool map = p->emitterCount > 0 && p->emitters[0].type != VPL_EMITTER_DIRECTIONAL &&
                     !p->emitterRays && o->method != VPL_METHOD_SSVP;
    if ((show == VPL_SHOW_SHADOW_MAP || show == VPL_SHOW_SHADOW_FACTOR) && !map) {
        return "the scene has no light with a shadow map, or the first casts shadows by rays";
    }
    return vplRefuseShow(o);
}

static void refuse(vplPlan* p)
{
    const vplStopOptions* stop = &p->options.stop;
    const bool endless =
        stop->growFrom > 0 && stop->passes == 0 && !(stop->budgetMs > 0) && !(stop->maxError > 0);
    const char* problem = endless
                              ? "grow-from needs passes, budget or max-error: nothing else ends the passes"
                              : refuseLighting(p);
    problem = problem != NULL ? problem : refuseOptions(p);
    if (problem != NULL) {
        snprintf(p->problem, sizeof p->problem, "%s", problem);
        return;
    }
    for (int i = 0; i < p->emitterCount && p->shading == VPL_LIGHTING_DOCUMENTED && p->showsDirect; i++) {
        if (p->emitters[i].type != VPL_EMITTER_POINT) {
            snprintf(p->problem, sizeof p->problem,
                     "light %d is not a point light, and documented lighting knows no others; use physical",
                     i);
            return;
        }
    }
}

// Without groups each triangle is at least one patch. Measured on two cores: 0.1 us for a pair of sides of all pairs (room), and 1 to
// 1.5 ms for a side by links (Sibenik, Sponza); 3 to 4.6 us for a triangle that is in a group (furnished, Conference, Sibenik, Sponza).
static double leastMsOfPatches(double triangles, bool groups)
{
    return groups ? 4e-3 * triangles : triangles <= VPL_ALL_PAIRS ? 1e-4 * triangles * triangles : triangles;
}

// SSVP draws all triangles into a reflective map of each emitter and, with few clusters, into about four paraboloid maps (furnished, Sponza:
// 0.05 us for each on two cores, and 0.15 to 0.2 us for a triangle of the ray tree).
static double leastMsOfMaps(const vplPlan* p, double triangles)
{
    enum { FEWEST_PARABOLOIDS = 4 };
    return (1.5e-4 + 4e-5 * (p->mapEmitterCount + FEWEST_PARABOLOIDS)) * triangles;
}

static void refuseTime(const vplRunner* r, vplPlan* p)
{
    const int triangles = ((const vplGeometry*)r->run.results[VPL_STAGE_GEOMETRY])->triangleCount;
    const vplRadiosityOptions* o = &p->options.radiosity;
    const bool groups = o->groups != VPL_PATCH_GROUPS_OFF && !vplIsDocumented(o),
               maps = p->options.method == VPL_METHOD_SSVP && p->showsVirtual;
    const double ms = p->showsPatches ? leastMsOfPatches(triangles, groups)
                      : maps          ? leastMsOfMaps(p, triangles)
                                      : 0;
    if (p->options.stop.budgetMs > 0 && ms > p->options.stop.budgetMs) {
        snprintf(
            p->problem, sizeof p->problem,
            "--budget %g: %s all %d triangles, which takes about %.2g s at least; use %sanother method or "
            "more time",
            p->options.stop.budgetMs, maps ? "SSVP draws its maps of" : "radiosity makes patches of",
            triangles, 1e-3 * ms, groups || maps ? "" : "--patch-groups auto, ");
    }
}

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
    refuse(p);
    if (p->problem[0] != 0) { // before anything is built
        return VPL_SUCCESS;
    }
    TRY(vplRunner_RunStage(r, VPL_STAGE_GEOMETRY));
    if (asked) {
        refuseTime(r, p);
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

// Names the stage that takes most.
static void refuseMemory(const vplContext* context, vplPlan* p)
{
    const double mib = 1 / 1048576.0;
    const vplPlanStage* most = &p->stages[0];
    if (context->memoryLimit == 0 || p->problem[0] != 0 || p->peakBytes <= (int64_t)context->memoryLimit) {
        return;
    }
    for (int i = 1; i < p->stageCount; i++) {
        most = p->stages[i].bytes + p->stages[i].scratch > most->bytes + most->scratch ? &p->stages[i] : most;
    }
    p->refusal = VPL_OUT_OF_MEMORY;
    snprintf(p->problem, sizeof p->problem,
             "the picture needs about %.0f MiB of memory, and %.0f MiB are allowed; %.0f MiB of them are "
             "for: %s (%.80s)",
             mib * (double)p->peakBytes, mib * (double)context->memoryLimit,
             mib * (double)(most->bytes + most->scratch), most->name, most->why);
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
        refuseMemory(r->run.context, p);
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
