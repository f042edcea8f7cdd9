// SPDX-License-Identifier: MIT
// Tests of plans: they are reproducible, contain every decision, and predict the rendering correctly.
#include "scenes.h"

#include <stdlib.h>

static const char* const METHODS[] = {"instant-radiosity", "direct", "path", "keller", "ssvp", "radiosity"};
enum { METHOD_COUNT = 6 };

// Makes options from pairs of words: "size", "32x24", ..., NULL.
static vplRenderOptions optionsOf(const char* const* words)
{
    vplRenderOptions o = plainOptions();
    for (; words[0] != NULL; words += 2) {
        if (vplRenderOptions_Set(&o, words[0], words[1]) != VPL_SUCCESS) {
            fail_msg("%s", o.problem);
        }
    }
    return o;
}

#define OPTIONS(...) optionsOf((const char* const[]){__VA_ARGS__, NULL})

static vplPlan* planOf(const vplScene* scene, const vplRenderOptions* options)
{
    vplPlan* plan = NULL;
    if (vplPlan_Create(scene, options, NULL, &plan) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return plan;
}

static char* describe(const vplPlan* plan)
{
    const size_t length = vplPlan_Describe(plan, NULL, 0);
    char* text = malloc(length + 1);
    assert_int_equal(vplPlan_Describe(plan, text, length + 1), length);
    assert_int_equal(strlen(text), length);
    return text;
}

static bool hasStage(const vplPlan* plan, const char* name)
{
    for (int i = 0; i < plan->stageCount; i++) {
        if (strcmp(plan->stages[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

static bool isLeftOut(const vplPlan* plan, const char* name)
{
    for (int i = 0; i < plan->leftOutCount; i++) {
        if (strcmp(plan->leftOut[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

// ---- reproducibility

TEST(TwoPlansOfTheSameAreEqual, 2, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    for (int method = 0; method < METHOD_COUNT; method++) {
        const vplRenderOptions options = OPTIONS("method", METHODS[method], "size", "64x36"),
                               before = options;
        vplPlan *a = planOf(scene, &options), *b = planOf(scene, &options);
        char *textOfA = describe(a), *textOfB = describe(b);
        assert_string_equal(textOfA, textOfB);
        free(textOfA);
        free(textOfB);
        assert_memory_equal(&options, &before, sizeof before);
        assert_memory_equal(&a->options, &b->options, offsetof(vplRenderOptions, problem));
        assert_int_equal(a->stageCount, b->stageCount);
        assert_memory_equal(a->particlesPerStep, b->particlesPerStep, sizeof a->particlesPerStep);
        assert_true(a->peakBytes == b->peakBytes && a->virtualLights == b->virtualLights);
        assert_true(a->drawCalls == b->drawCalls && a->patches == b->patches && a->paths == b->paths);
        vplPlan_Destroy(a);
        vplPlan_Destroy(b);
    }
    vplPlan_Destroy(NULL);
    vplScene_Destroy(scene);
}

// The machine affects estimates, never a decision.
TEST(MachinesChangeNoDecision, 1, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    for (int method = 0; method < METHOD_COUNT; method++) {
        const vplRenderOptions options = OPTIONS("method", METHODS[method], "size", "64x36");
        vplPlan *one, *many;
        assert_int_equal(vplPlan_Create(scene, &options, &(vplMachine){.workerCount = 1}, &one), VPL_SUCCESS);
        assert_int_equal(vplPlan_Create(scene, &options, &(vplMachine){.workerCount = 64}, &many),
                         VPL_SUCCESS);
        assert_memory_equal(&one->options, &many->options, offsetof(vplRenderOptions, problem));
        assert_int_equal(one->stageCount, many->stageCount);
        for (int i = 0; i < one->stageCount; i++) {
            assert_string_equal(one->stages[i].name, many->stages[i].name);
        }
        assert_true(one->peakBytes <= many->peakBytes);
        vplPlan_Destroy(one);
        vplPlan_Destroy(many);
    }
    vplScene_Destroy(scene);
}

// A plan sets all options that the method uses. Only lengths of bias and filter stay automatic, because each
// shadow map has its own: they are proportional to its `far`.
TEST(NothingIsLeftToTheLibrary, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    int count, left = 0;
    const vplOption* table = vplGetOptions(&count);
    for (int method = 0; method < METHOD_COUNT; method++) {
        const vplRenderOptions options = OPTIONS("method", METHODS[method], "size", "64x36");
        vplPlan* plan = planOf(scene, &options);
        for (int i = 0; i < count; i++) {
            char value[64];
            if (table[i].kind == VPL_OPTION_PART ||
                strstr("max-bounces bias bias-slope pcf-offset", table[i].name) != NULL ||
                !vplRenderOptions_IsUsed(&plan->options, table[i].name, NULL, 0)) {
                continue;
            }
            assert_int_equal(vplRenderOptions_Get(&plan->options, table[i].name, value, sizeof value),
                             VPL_SUCCESS);
            if (strcmp(value, "usual") == 0 || strcmp(value, "auto") == 0 ||
                (value[0] == '-' && table[i].low >= 0)) {
                printf("# %s leaves %s %s\n", METHODS[method], table[i].name, value);
                left++;
            }
        }
        assert_true(plan->biasRule != VPL_BIAS_AUTO);
        vplPlan_Destroy(plan);
    }
    assert_int_equal(left, 0);
    vplScene_Destroy(scene);
}

// ---- stages

static void assertStages(const vplPlan* plan, const char* wanted)
{
    char names[512] = "";
    for (int i = 0; i < plan->stageCount; i++) {
        snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", i ? ", " : "",
                 plan->stages[i].name);
    }
    assert_string_equal(names, wanted);
}

TEST(EachMethodRunsTheStagesOfItsDocument, 1, SLOW)
{
    static const char* const wanted[METHOD_COUNT] = {
        "geometry, particles, shadow map, area lights, virtual lights, shading",
        "geometry, shadow map, area lights, shading",
        "geometry, paths",
        "geometry, clamp distance, particles, shadow map, virtual lights, shading",
        ("geometry, reflective map, first bounce, clusters, paraboloid, second bounce, second clusters, "
         "second "
         "paraboloid, further bounces, list, area lights, virtual lights, shading"),
        ("geometry, patches, reachable sides, patch mesh, form factors, area lights, patch light, solve, "
         "corners, shadow map, shading")};
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    addEmitter(scene, VPL_EMITTER_POINT, (vplVec3){0, 2, 0}, (vplVec3){0, -1, 0}, 1);
    for (int method = 0; method < METHOD_COUNT; method++) {
        const vplRenderOptions options = OPTIONS("method", METHODS[method], "size", "64x36");
        vplPlan* plan = planOf(scene, &options);
        assertStages(plan, wanted[method]);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// Every input of a stage runs before it, and every stage and everything left out has a reason.
TEST(InputsComeFirstAndReasonsAreGiven, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    for (int method = 0; method < METHOD_COUNT; method++) {
        const vplRenderOptions options = OPTIONS("method", METHODS[method], "size", "64x36");
        vplPlan* plan = planOf(scene, &options);
        for (int i = 0; i < plan->stageCount; i++) {
            char inputs[400];
            snprintf(inputs, sizeof inputs, "%s", plan->stages[i].inputs);
            for (char* input = strtok(inputs, ","); input != NULL; input = strtok(NULL, ",")) {
                bool before = false;
                input += strspn(input, " ");
                for (int k = 0; k < i; k++) {
                    before = before || strcmp(plan->stages[k].name, input) == 0;
                }
                if (!before && !isLeftOut(plan, input) && hasStage(plan, input)) {
                    fail_msg("%s: %s reads %s", METHODS[method], plan->stages[i].name, input);
                }
            }
            assert_true(strlen(plan->stages[i].why) > 8 && plan->stages[i].bytes >= 0);
        }
        for (int i = 0; i < plan->leftOutCount; i++) {
            assert_true(strlen(plan->leftOut[i].why) > 8 && !hasStage(plan, plan->leftOut[i].name));
        }
        for (int i = 0; i < plan->decisionCount; i++) {
            assert_true(strlen(plan->decisions[i].why) > 4 && plan->decisions[i].value[0] != 0);
        }
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

TEST(RenderingRunsTheStagesOfThePlan, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    for (int method = 0; method < METHOD_COUNT; method++) {
        const vplRenderOptions options =
            OPTIONS("method", METHODS[method], "size", "16x12", "patches", "40", "first-bounce", "8",
                    "second-bounce", "8", "paraboloid", "8", "rsm-size", "16", "spp", "1");
        vplPlan* plan = planOf(scene, &options);
        vplRenderStats stats;
        vplImage_Destroy(renderScene(scene, &options, &stats));
        double planning = -1, sum = 0;
        for (int i = 0; i < stats.stageCount; i++) {
            assert_false(isLeftOut(plan, stats.stages[i].name));
            planning = strcmp(stats.stages[i].name, "planning") == 0 ? stats.stages[i].ms : planning;
            sum += stats.stages[i].ms;
        }
        assert_true(planning >= 0 && sum < 1.01 * stats.totalMs); // nothing is counted twice
        for (int i = 0; i < plan->stageCount; i++) {
            bool ran = false;
            for (int k = 0; k < stats.stageCount; k++) {
                ran = ran || strcmp(stats.stages[k].name, plan->stages[i].name) == 0;
            }
            if (!ran) {
                fail_msg("%s did not run %s", METHODS[method], plan->stages[i].name);
            }
        }
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

TEST(WhatNobodyAsksForIsNotMade, 1)
{
    vplScene* dark = sceneOf(context, 0.5f);
    addThing(dark, VPL_OBJECT_QUAD, 0, (vplVec3){0, 0, 0}, 0, 0, (vplVec3){1, 1, 1});
    aim(dark, (vplVec3){0, 0, 3}, (vplVec3){0, 0, 0});
    vplRenderOptions options = OPTIONS("method", "direct", "size", "8x8");
    vplPlan* plan = planOf(dark, &options);
    assert_true(!hasStage(plan, "shadow map") && isLeftOut(plan, "shadow map"));
    assert_true(!hasStage(plan, "area lights") && !plan->castsRays && plan->shadowMapBytes == 0);
    vplPlan_Destroy(plan);
    vplScene_Destroy(dark);

    vplScene* room = loadScene(context, "room.json");
    options = OPTIONS("show", "normals", "size", "8x8");
    plan = planOf(room, &options);
    assertStages(plan, "geometry, shading");
    vplPlan_Destroy(plan);
    options = OPTIONS("light-shadows", "ray", "size", "8x8");
    plan = planOf(room, &options);
    assert_true(plan->castsRays && !hasStage(plan, "shadow map"));
    vplPlan_Destroy(plan);
    options = OPTIONS("method", "ssvp", "max-bounces", "1", "size", "8x8");
    plan = planOf(room, &options);
    assert_true(hasStage(plan, "first bounce") && !hasStage(plan, "second bounce"));
    vplPlan_Destroy(plan);
    vplScene_Destroy(room);
}

// ---- refusals

TEST(WhatCannotBeRenderedHasAPlanThatSaysWhy, 1)
{
    static const char* const refused[][5] = {{"show", "patches", NULL},
                                             {"method", "path", "show", "light:0", NULL},
                                             {"method", "direct", "show", "clusters", NULL},
                                             {"method", "ssvp", "lighting", "documented", NULL},
                                             {"method", "radiosity", "lighting", "documented", NULL}};
    vplScene* scene = loadScene(context, "room.json");
    for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
        const vplRenderOptions options = optionsOf(refused[i]);
        vplImage* image = NULL;
        vplPlan* plan = planOf(scene, &options);
        if (strlen(plan->problem) < 12) {
            fail_msg("%s %s has no problem", refused[i][0], refused[i][1]);
        }
        char* text = describe(plan);
        assert_non_null(strstr(text, plan->problem));
        free(text);
        const vplResult result = vplRender(scene, &options, &image, NULL);
        assert_true(result == plan->refusal && result != VPL_SUCCESS && image == NULL);
        const char* message = takeMessage();
        if (strstr(message, plan->problem) == NULL) {
            fail_msg("\"%s\" lacks \"%s\"", message, plan->problem);
        }
        vplPlan_Destroy(plan);
    }
    vplRenderOptions bad = plainOptions();
    vplPlan* none = NULL;
    bad.particles.count = -2;
    assert_int_equal(vplPlan_Create(scene, &bad, NULL, &none), VPL_INVALID_ARGUMENT);
    assert_null(none);
    vplScene_Destroy(scene);
}

TEST(DescriptionsAreCutLikeSnprintf, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    const vplRenderOptions options = OPTIONS("size", "8x8");
    vplPlan* plan = planOf(scene, &options);
    char *all = describe(plan), few[20];
    memset(few, 'x', sizeof few);
    assert_int_equal(vplPlan_Describe(plan, few, 10), strlen(all));
    assert_memory_equal(few, all, 9);
    assert_true(few[9] == 0 && few[10] == 'x');
    free(all);
    vplPlan_Destroy(plan);
    vplScene_Destroy(scene);
}

// Smaller stages are described without it. The numbers of lights double, so that the memory of some stage is just above the limit.
TEST(StagesOf64KiBAreDescribedWithTheirMemory, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    static const char* const counts[] = {"100", "200", "400", "800", "1600", "3200", "50000"};
    int small = 0, large = 0;
    for (int k = 0; k < 7; k++) {
        const vplRenderOptions options = OPTIONS("method", "keller", "size", "16x9", "particles", counts[k]);
        vplPlan* plan = planOf(scene, &options);
        char* all = describe(plan);
        const char* at = strstr(all, "stages, in this order");
        for (int i = 0; i < plan->stageCount; i++) {
            const double kib = (double)(plan->stages[i].bytes + plan->stages[i].scratch) / 1024;
            double told = 0;
            char unit[4] = "";
            at = strstr(at, plan->stages[i].why);
            assert_non_null(at);
            at += strlen(plan->stages[i].why);
            assert_int_equal(sscanf(at, "; %lf %3s", &told, unit), kib >= 64 ? 2 : 0);
            told *= strcmp(unit, "MiB") == 0 ? 1024 : 1;
            assertNear(told, kib >= 64 ? kib : 0, kib < 1024 ? 0.05 : 0.05 * 1024, plan->stages[i].name, k);
            small += kib >= 32 && kib < 64;
            large += kib >= 64 && kib < 128;
        }
        free(all);
        vplPlan_Destroy(plan);
    }
    printf("# %d stages of 32 to 64 KiB, %d of 64 to 128 KiB\n", small, large);
    assert_true(small > 0 && large > 0);
    vplScene_Destroy(scene);
}

// ---- memory

// Covers about twenty pictures: scene x method x size x threads.
TEST_ALONE(PeakBytesAreTrueWithin15Percent)
{
    static const char* const scenes[] = {"examples/scenes/room-area.json", "examples/scenes/testmodel.json",
                                         "examples/scenes/closed-room.json"};
    static const char* const sizes[] = {"160x90", "480x270", "97x301"};
    int wrong = 0;
    for (int i = 0; i < 3 * METHOD_COUNT + 3; i++) {
        const int method = i < 3 * METHOD_COUNT ? i % METHOD_COUNT : 3 + i % 3;
        const char* size = sizes[i / 2 % 3];
        vplContext* context = openTestContext(1 + i % 3);
        vplScene* scene = openScene(context, scenes[i / METHOD_COUNT % 3]);
        const vplRenderOptions options =
            OPTIONS("method", METHODS[method], "size", size, "patches", i % 2 ? "300" : "700", "spp", "2");
        vplPlan* plan = planOf(scene, &options);
        const int64_t planned = plan->peakBytes;
        vplPlan_Destroy(plan);
        vplRenderStats stats;
        vplImage_Destroy(renderScene(scene, &options, &stats));
        const double ratio = (double)planned / (double)stats.peakBytes;
        if (!(fabs(ratio - 1) <= 0.15)) {
            printf("# %s %s %s %d threads: %.2f MiB planned, %.2f held (%.2f)\n",
                   scenes[i / METHOD_COUNT % 3], METHODS[method], size, 1 + i % 3, (double)planned / 1048576,
                   (double)stats.peakBytes / 1048576, ratio);
            wrong++;
        }
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
    assert_int_equal(wrong, 0);
}

// Large numbers of particles, lights, links and clusters, which small scenes hold little besides.
TEST_ALONE(PeakBytesAreTrueWithin15PercentForLargeCounts)
{
    static const char* const cases[][17] = {
        {"room-area", "method", "keller", "particles", "20000", "light-shadows", "none"},
        {"closed-room", "method", "keller", "particles", "20000", "pipeline", "deferred", "light-shadows",
         "none"},
        {"room-area", "method", "keller", "particles", "20000", "pipeline", "interleaved"},
        {"room-area", "method", "keller", "particles", "2000", "light-shadows", "map", "light-map", "4"},
        {"room-area", "method", "keller", "particles", "10000", "pipeline", "lightcuts"},
        {"room", "method", "instant-radiosity", "particles", "50000", "light-shadows", "none"},
        {"room", "method", "radiosity", "hierarchy", "on", "patches", "20"},
        {"flat", "method", "radiosity", "hierarchy", "on", "patches", "1000"},
        {"closed-room", "method", "radiosity", "hierarchy", "on", "patches", "1000"},
        {"room-area", "method", "radiosity", "hierarchy", "on", "patches", "300", "link-error", "1e-5"},
        {"loft", "method", "radiosity", "hierarchy", "on", "patches", "2000", "link-error", "0.01"},
        {"closed-room", "method", "ssvp", "first-bounce", "50000", "rsm-size", "32"},
        {"room", "method", "ssvp", "first-bounce", "40000", "light-shadows", "none", "rsm-size", "32"},
        {"room", "method", "ssvp", "second-bounce", "20000", "paraboloid", "16", "clusters", "100",
         "rsm-size", "32", "next-bounce", "maps", "max-bounces", "2"},
        {"loft", "method", "keller", "particles", "30000", "light-shadows", "ray", "pipeline", "interleaved"},
        {"closed-room", "method", "keller", "particles", "1000", "light-shadows", "map", "light-map", "32"},
        {"room", "method", "keller", "particles", "100000", "light-shadows", "none"},
        {"loft", "method", "radiosity", "hierarchy", "on", "patches", "500", "patch-cuts", "on"},
        {"room", "method", "radiosity", "hierarchy", "on", "patches", "3000", "link-error", "1e-4"},
        {"closed-room", "method", "ssvp", "first-bounce", "5000", "clusters", "64", "paraboloid", "64"},
        {"loft", "method", "ssvp", "first-bounce", "20000", "second-bounce", "20000", "rsm-size", "128"},
        {"room-area", "method", "path", "size", "120x80", "spp", "1"},
        {"room-area", "method", "direct", "size", "120x80", "supersample", "3"}};
    int wrong = 0;
    enum { CASES = sizeof cases / sizeof *cases };
    for (int k = 0; k < 2 * CASES; k++) {
        const int i = k % CASES, workers = k < CASES ? 1 : 3;
        char path[64];
        snprintf(path, sizeof path, "examples/scenes/%s.json", cases[i][0]);
        vplContext* context = openTestContext(workers);
        vplScene* scene = openScene(context, path);
        vplRenderOptions options = plainOptions();
        assert_int_equal(vplRenderOptions_SetAll(&options, " --size 16x16 --shadow-map 16"), VPL_SUCCESS);
        for (const char* const* word = cases[i] + 1; *word != NULL; word += 2) {
            assert_int_equal(vplRenderOptions_Set(&options, word[0], word[1]), VPL_SUCCESS);
        }
        vplPlan* plan = planOf(scene, &options);
        vplRenderStats stats;
        vplImage_Destroy(renderScene(scene, &options, &stats));
        const double ratio = (double)plan->peakBytes / (double)stats.peakBytes;
        printf("# %s %s, case %d, %d threads: %.2f MiB planned, %.2f held (%.3f)\n", cases[i][0], cases[i][2],
               i, workers, (double)plan->peakBytes / 1048576, (double)stats.peakBytes / 1048576, ratio);
        wrong += !(fabs(ratio - 1) <= 0.15);
        vplPlan_Destroy(plan);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
    assert_int_equal(wrong, 0);
}

// 153 of 305 patches of the flat are groups of its 408 triangles. With a patch for each triangle there are none.
TEST(PixelsGatherTheirLightWherePatchesAreGroups, 2)
{
    static const struct {
        int patches, asked, gather;
    } cases[] = {{300, -1, 16}, {300, 0, 0}, {300, 5, 5}, {1000, -1, 0}};
    vplScene* scene;
    assert_int_equal(vplScene_Load(context, "examples/scenes/flat.json", &scene), VPL_SUCCESS);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplRenderOptions o = vplDefaultRenderOptions();
        o.method = VPL_METHOD_RADIOSITY;
        o.radiosity.patches = cases[i].patches;
        o.radiosity.gather = cases[i].asked;
        vplPlan* plan = planOf(scene, &o);
        assert_true((plan->patchGroups > 0) == (cases[i].patches == 300));
        assert_int_equal(plan->options.radiosity.gather, cases[i].gather);
        assert_true(plan->gathers == (cases[i].gather > 0));
        assert_true(plan->options.pipeline.interleave > 0);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// Who waits for a picture sees a coarse one first, of an eighth or half of the particles, unless a small error is wanted: then
// all passes are whole.
TEST(SmallErrorsAreNotReachedThroughCoarsePasses, 1)
{
    static const struct {
        float maxError;
        int parts;
    } rows[] = {{0.2f, 8}, {0.1f, 2}, {0.05f, 0}};
    vplScene* scene = openScene(context, "examples/scenes/room.json");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        vplRenderOptions o = plainOptions();
        vplPlan* plan;
        o.method = VPL_METHOD_KELLER;
        o.particles.count = 1600;
        o.stop.maxError = rows[i].maxError;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->options.particles.count, 1600);
        assert_int_equal(plan->options.stop.growFrom, rows[i].parts > 0 ? 1600 / rows[i].parts : 0);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// Lights are those of one whole pass: what ends a render and how its passes grow does not matter to them.
TEST(LightsAreMadeWhereOnlyTheErrorEndsARender, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room.json");
    vplRenderOptions o = plainOptions();
    vplLightSet *growing, *plain;
    o.method = VPL_METHOD_KELLER;
    o.particles.count = 100;
    assert_int_equal(vplMakeLights(scene, &o, &plain), VPL_SUCCESS);
    o.stop.maxError = 0.1f;
    o.stop.growFrom = 10;
    assert_int_equal(vplMakeLights(scene, &o, &growing), VPL_SUCCESS);
    assert_int_equal(growing->lightCount, plain->lightCount);
    vplLightSet_Destroy(growing);
    vplLightSet_Destroy(plain);
    vplScene_Destroy(scene);
}
