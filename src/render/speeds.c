// SPDX-License-Identifier: MIT
// Measures the speeds of a machine: small pictures of a built-in scene, in each of which one part of vplSpeeds takes most
// of the time of one stage.
#include "base/clock.h"
#include "base/context.h"
#include "render/plan.h"
#include "scene/scene.h"

#include <math.h>
#include <string.h>

// ---- the context's speeds

vplResult vplContext_SetSpeeds(vplContext* context, const vplSpeeds* speeds)
{
    REQUIRE(context, context);
    vplSpeeds copy = speeds != NULL ? *speeds : vplUsualSpeeds();
    bool good = copy.threads >= 0 && isfinite(copy.threads);
    for (int i = 0; i < VPL_SPEED_COUNT; i++) {
        const double speed = *vplSpeedAt(&copy, i);
        good = good && speed > 0 && isfinite(speed);
    }
    if (!good) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "a time of vplSpeeds is not positive and finite");
    }
    vplSpeeds* kept = speeds != NULL ? vplAlloc(context, 1, sizeof *kept) : NULL;
    if (speeds != NULL && kept == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    if (kept != NULL) {
        *kept = copy;
    }
    vplFree(context, context->speeds);
    context->speeds = kept;
    return VPL_SUCCESS;
}

// ---- the scene

enum { SIDE = 100 }; // squares along a side of the bumpy floor

static vplResult addFloor(vplScene* scene)
{
    vplContext* context = vplScene_GetContext(scene);
    vplVec3* positions = vplAlloc(context, (SIDE + 1) * (SIDE + 1), sizeof *positions);
    uint32_t* indices = vplAlloc(context, 6 * SIDE * SIDE, sizeof *indices);
    vplResult result = positions != NULL && indices != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    for (int i = 0; i < (SIDE + 1) * (SIDE + 1) && result == VPL_SUCCESS; i++) {
        const int x = i % (SIDE + 1), z = i / (SIDE + 1);
        const float height = 0.02f * (float)((x * 5 + z * 7) % 8) + 0.4f * (float)((x / 20 + z / 20) % 2);
        positions[i] = (vplVec3){4.8f * (float)x / SIDE - 2.4f, 0.1f + height, 4.8f * (float)z / SIDE - 2.4f};
    }
    for (int i = 0; i < SIDE * SIDE && result == VPL_SUCCESS; i++) {
        const uint32_t at = (uint32_t)(i / SIDE * (SIDE + 1) + i % SIDE), below = at + SIDE + 1;
        const uint32_t corners[6] = {at, below, at + 1, at + 1, below, below + 1};
        memcpy(indices + 6 * i, corners, sizeof corners);
    }
    if (result == VPL_SUCCESS) {
        vplMeshDef mesh = vplDefaultMeshDef();
        vplObjectDef object = vplDefaultObjectDef();
        mesh.positions = positions;
        mesh.indices = indices;
        mesh.vertexCount = (SIDE + 1) * (SIDE + 1);
        mesh.triangleCount = 2 * SIDE * SIDE;
        object.type = VPL_OBJECT_MESH;
        result = vplScene_AddMesh(scene, &mesh, &object.mesh);
        result = result == VPL_SUCCESS ? vplScene_AddObject(scene, &object, NULL) : result;
    }
    vplFree(context, positions);
    vplFree(context, indices);
    return result;
}

static vplResult addBox(vplScene* scene, vplVec3 place, vplVec3 size)
{
    vplObjectDef def = vplDefaultObjectDef();
    const double turns[3] = {0, 0, 0};
    def.type = VPL_OBJECT_BOX;
    def.transform = vplMat4_FromParts(place, turns, size);
    return vplScene_AddObject(scene, &def, NULL);
}

// A room of five walls with two boxes, a light and, if asked for, a bumpy floor of 20,000 triangles.
static vplResult fill(vplScene* scene, bool bumpy)
{
    static const vplVec3 boxes[][2] = {
        {{0, -0.1f, 0}, {5, 0.2f, 5}},       {{0, 5.1f, 0}, {5, 0.2f, 5}},
        {{0, 2.5f, -2.6f}, {5, 5, 0.2f}},    {{-2.6f, 2.5f, 0}, {0.2f, 5, 5}},
        {{2.6f, 2.5f, 0}, {0.2f, 5, 5}},     {{-0.9f, 1.65f, -0.8f}, {1.5f, 3.3f, 1.5f}},
        {{0.85f, 1, 0.75f}, {1.5f, 2, 1.5f}}};
    vplMaterialDef material = vplDefaultMaterialDef();
    vplCameraDef camera = vplDefaultCameraDef();
    vplEmitterDef light = vplDefaultEmitterDef();
    material.diffuse = (vplRgb){0.6f, 0.6f, 0.6f};
    camera.eye = (vplVec3){0, 2.5f, 7};
    camera.target = (vplVec3){0, 2.2f, 0};
    light.position = (vplVec3){0, 4.5f, 0};
    light.intensity = (vplRgb){10, 10, 10};
    TRY(vplScene_AddMaterial(scene, &material, NULL));
    TRY(vplScene_AddCamera(scene, &camera, NULL));
    TRY(vplScene_AddEmitter(scene, &light, NULL));
    for (size_t i = 0; i < sizeof boxes / sizeof *boxes; i++) {
        TRY(addBox(scene, boxes[i][0], boxes[i][1]));
    }
    return bumpy ? addFloor(scene) : VPL_SUCCESS;
}

// ---- what is rendered

typedef struct Load {
    double usualMs; // of the stage, on one thread of the machine of our benchmarks
    vplStageId stage;
    bool bumpy;
    const char* words[14]; // names and values of options
} Load;

// One per speed, in the order of vplSpeeds.
static const Load LOADS[VPL_SPEED_COUNT] = {
    {12.5, VPL_STAGE_GEOMETRY, true, {"method", "direct", "light-shadows", "ray", "size", "16x16"}},
    {2.44, VPL_STAGE_EMITTER_MAPS, true, {"method", "direct", "shadow-map", "32", "size", "16x16"}},
    {23.4, VPL_STAGE_EMITTER_MAPS, false, {"method", "direct", "shadow-map", "768", "size", "16x16"}},
    {9.08, VPL_STAGE_PICTURE, false, {"method", "direct", "shadow-map", "16", "pcf", "1", "size", "320x180"}},
    {14.8,
     VPL_STAGE_PICTURE,
     false,
     {"particles", "600", "shadow-map", "16", "size", "160x90", "method", "instant-radiosity"}},
    {38.5,
     VPL_STAGE_PICTURE,
     true,
     {"method", "keller", "particles", "40", "light-shadows", "ray", "compensation", "none", "size",
      "96x54"}},
    {15.5, VPL_STAGE_PATHS, true, {"method", "path", "spp", "2", "size", "64x36"}},
    {14.1,
     VPL_STAGE_FORM_FACTORS,
     false,
     {"method", "radiosity", "patches", "200", "shadow-map", "16", "size", "16x16"}},
};

enum { ROUNDS = 5, PARALLEL = 5 }; // PARALLEL: the load that all threads render, too

static const double LONGEST = 1200; // ms, of measuring

typedef struct Measuring {
    vplScene* scenes[2]; // without and with the bumpy floor
    double end;
} Measuring;

static bool isInTime(void* user, double fraction)
{
    const Measuring* m = user;
    (void)fraction;
    return vplClockMs() < m->end;
}

// Renders, and gets the processor time of the load's stage in ms: the stage's share of that of all stages.
static vplResult run(Measuring* m, const Load* load, double* msOut)
{
    const vplScene* scene = m->scenes[load->bumpy];
    vplRenderOptions o = vplDefaultRenderOptions();
    vplHistory* history = NULL;
    vplPlan* plan = NULL;
    for (int i = 0; load->words[i] != NULL; i += 2) {
        vplRenderOptions_Set(&o, load->words[i], load->words[i + 1]);
    }
    TRY(vplHistory_Create(vplScene_GetContext(scene), &history));
    const double start = vplClockMs(), cpuStart = vplCpuMs();
    vplRunner runner = vplRunner_Begin(scene, history);
    runner.progress = isInTime;
    runner.progressUser = m;
    vplResult result = vplMakePlan(&runner, &o, NULL, &plan);
    if (result == VPL_SUCCESS) {
        runner.run.parts = VPL_PART_DIRECT | VPL_PART_INDIRECT;
        runner.run.samples = o.path.samples;
        result = vplRunner_RunPlan(&runner, plan, load->stage);
    }
    if (result == VPL_SUCCESS) {
        const double share = (vplCpuMs() - cpuStart) / fmax(vplClockMs() - start, 1e-3);
        for (int i = 0; i < runner.stats.stageCount; i++) {
            const vplStageTime* stage = &runner.stats.stages[i];
            *msOut = strcmp(stage->name, VPL_STAGES[load->stage].name) == 0 ? stage->ms * share : *msOut;
        }
    }
    vplPlan_Destroy(plan);
    vplHistory_Destroy(history);
    return result;
}

// ---- solving

static double medianOf(double* values, int count)
{
    for (int i = 1; i < count; i++) {
        for (int k = i; k > 0 && values[k] < values[k - 1]; k--) {
            const double value = values[k];
            values[k] = values[k - 1];
            values[k - 1] = value;
        }
    }
    return values[count / 2];
}

typedef struct Samples {
    double ms[VPL_SPEED_COUNT][ROUNDS], parallelMs[ROUNDS];
    int counts[VPL_SPEED_COUNT], parallelCount;
} Samples;

// Each speed is the usual one, in the ratio of the time of its load to the usual time. Speeds without a sample follow the
// mean ratio of those that have one.
static vplSpeeds solve(Samples* s, int workers)
{
    vplSpeeds speeds = vplUsualSpeeds();
    double logs = 0;
    int known = 0;
    for (int i = 0; i < VPL_SPEED_COUNT; i++) {
        if (s->counts[i] > 0) {
            const double ratio = fmax(medianOf(s->ms[i], s->counts[i]), 1e-3) / LOADS[i].usualMs;
            *vplSpeedAt(&speeds, i) *= ratio;
            logs += log(ratio);
            known++;
        }
    }
    for (int i = 0; i < VPL_SPEED_COUNT; i++) {
        *vplSpeedAt(&speeds, i) *= s->counts[i] == 0 && known > 0 ? exp(logs / known) : 1;
    }
    speeds.threads = 0.1 + 0.9 * workers;
    if (s->parallelCount > 0 && s->counts[PARALLEL] > 0) {
        const double one = medianOf(s->ms[PARALLEL], s->counts[PARALLEL]);
        const double all = fmax(medianOf(s->parallelMs, s->parallelCount), 1e-3);
        speeds.threads = fmin(fmax(workers * one / all, 1), workers);
    }
    return speeds;
}

static vplResult measure(Measuring* one, Measuring* all, Samples* s)
{
    vplResult result = VPL_SUCCESS;
    for (int round = 0; round < ROUNDS && result == VPL_SUCCESS; round++) {
        for (int i = 0; i < VPL_SPEED_COUNT && result == VPL_SUCCESS; i++) {
            double ms = 0;
            result = run(one, &LOADS[i], &ms);
            if (result == VPL_SUCCESS) {
                s->ms[i][s->counts[i]++] = ms;
            }
        }
        if (result == VPL_SUCCESS && all->scenes[1] != NULL) {
            double ms = 0;
            result = run(all, &LOADS[PARALLEL], &ms);
            if (result == VPL_SUCCESS) {
                s->parallelMs[s->parallelCount++] = ms;
            }
        }
        if (result == VPL_SUCCESS && !isInTime(one, 0)) {
            break;
        }
    }
    return result == VPL_CANCELLED ? VPL_SUCCESS : result; // the time is up
}

static vplResult build(const vplContextDef* def, bool plain, vplContext** contextOut, Measuring* m)
{
    TRY(vplContext_Create(def, contextOut));
    for (int i = plain ? 0 : 1; i < 2; i++) {
        TRY(vplScene_Create(*contextOut, &m->scenes[i]));
        TRY(fill(m->scenes[i], i == 1));
    }
    return VPL_SUCCESS;
}

vplResult vplSpeeds_Measure(vplContext* context, vplSpeeds* speedsOut)
{
    REQUIRE(context, context, speedsOut);
    vplContextDef def = context->def, alone = context->def;
    vplContext* contexts[2] = {NULL, NULL};
    const double end = vplClockMs() + LONGEST;
    Measuring one = {.end = end}, all = {.end = end};
    Samples samples = {0};
    alone.workerCount = 1;
    alone.log = def.log = NULL;
    vplResult result = build(&alone, true, &contexts[0], &one);
    if (result == VPL_SUCCESS && context->workerCount > 1) {
        result = build(&def, false, &contexts[1], &all);
    }
    if (result == VPL_SUCCESS) {
        result = measure(&one, &all, &samples);
    }
    for (int i = 0; i < 2; i++) {
        vplScene_Destroy(one.scenes[i]);
        vplScene_Destroy(all.scenes[i]);
    }
    for (int i = 0; i < 2; i++) {
        vplContext_Destroy(contexts[i]);
    }
    if (result != VPL_SUCCESS) {
        return vplFail(context, result, "the speeds of the machine could not be measured: %s",
                       vplResult_GetName(result));
    }
    *speedsOut = solve(&samples, context->workerCount);
    return VPL_SUCCESS;
}
