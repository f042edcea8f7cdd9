// SPDX-License-Identifier: MIT
// Tests of predicted times and of the speeds that they follow.
#include "failing.h"

#include <stdlib.h>
#include <time.h>

enum { SPEEDS = sizeof(vplSpeeds) / sizeof(double) }; // all fields are doubles

static const char* const METHODS[] = {"instant-radiosity", "direct", "path", "keller", "ssvp", "radiosity"};
enum { METHOD_COUNT = 6 };

static vplRenderOptions optionsOf(const char* method, const char* option, const char* value)
{
    vplRenderOptions o = plainOptions();
    assert_int_equal(vplRenderOptions_Set(&o, "method", method), VPL_SUCCESS);
    assert_int_equal(vplRenderOptions_Set(&o, "size", "32x24"), VPL_SUCCESS);
    assert_int_equal(vplRenderOptions_Set(&o, "spp", "2"), VPL_SUCCESS);
    if (option != NULL) {
        assert_int_equal(vplRenderOptions_Set(&o, option, value), VPL_SUCCESS);
    }
    return o;
}

// Predicted milliseconds: whole, first, pass.
static vplVec3 predict(const vplScene* scene, const vplRenderOptions* o, const vplMachine* machine)
{
    vplPlan* plan;
    double sum = 0;
    assert_int_equal(vplPlan_Create(scene, o, machine, &plan), VPL_SUCCESS);
    for (int i = 0; i < plan->stageCount; i++) {
        assert_true(plan->stages[i].ms >= 0 && isfinite(plan->stages[i].ms));
        sum += plan->stages[i].ms;
    }
    const vplVec3 times = {(float)plan->predictedMs, (float)plan->firstMs, (float)plan->passMs};
    assert_true(plan->predictedMs >= 0.999 * sum && plan->firstMs > 0 && plan->passMs > 0);
    vplPlan_Destroy(plan);
    return times;
}

static float timeOf(const vplScene* scene, const char* method, const char* option, const char* value)
{
    const vplRenderOptions o = optionsOf(method, option, value);
    return predict(scene, &o, NULL).x;
}

static bool isPositive(const vplSpeeds* speeds, bool threads)
{
    const double* values = (const double*)speeds;
    bool good = true;
    for (int i = 0; i < SPEEDS - !threads; i++) {
        good = good && values[i] > 0 && isfinite(values[i]);
    }
    return good;
}

// ---- speeds

TEST_ALONE(UsualSpeedsArePositive)
{
    const vplSpeeds speeds = vplUsualSpeeds();
    assert_true(isPositive(&speeds, false));
}

// The promise is 1.5 s of an idle machine; a stage under way ends later on one that is busy or instrumented.
TEST(MeasuringEndsInTimeAndHoldsNothing, 2, SLOW)
{
    const size_t before = vplContext_GetBytes(context);
    struct timespec start, end;
    vplSpeeds speeds = {0};
    clock_gettime(CLOCK_MONOTONIC, &start);
    assert_int_equal(vplSpeeds_Measure(context, &speeds), VPL_SUCCESS);
    clock_gettime(CLOCK_MONOTONIC, &end);
    assert_true((double)(end.tv_sec - start.tv_sec) + 1e-9 * (double)(end.tv_nsec - start.tv_nsec) < 6);
    assert_true(isPositive(&speeds, true));
    const vplSpeeds usual = vplUsualSpeeds();
    for (int i = 0; i < SPEEDS - 1; i++) { // no machine is a hundred times as fast as another one
        assert_true(((const double*)&speeds)[i] > 0.01 * ((const double*)&usual)[i]);
    }
    assert_true(speeds.threads >= 1 && speeds.threads <= 2);
    assert_int_equal(vplContext_GetBytes(context), before);
}

// Bytes, and allocations after which each load has been rendered once.
enum { LITTLE_MEMORY = 24 << 20, ONE_ROUND = 1600 };

typedef struct Held {
    size_t now, most;
    int allocations;
} Held;

// An allocator that has LITTLE_MEMORY, and none at all after ONE_ROUND allocations.
static void* limitedAlloc(void* user, void* memory, size_t oldSize, size_t newSize)
{
    Held* h = user;
    const size_t held = h->now - oldSize + newSize;
    h->most = held > h->most ? held : h->most;
    if (newSize == 0) {
        h->now = held;
        free(memory);
        return NULL;
    }
    if (held > LITTLE_MEMORY || ++h->allocations > ONE_ROUND) {
        return NULL;
    }
    h->now = held;
    return realloc(memory, newSize);
}

// The pictures are small. One of the usual size takes 40 MB with all that shading holds, and longer than all the time.
TEST_ALONE(MeasuringTakesLittleMemory)
{
    Held held = {0};
    vplContextDef def = vplDefaultContextDef();
    vplContext* context;
    vplSpeeds speeds;
    def.alloc = limitedAlloc;
    def.allocUser = &held;
    def.workerCount = 1;
    assert_int_equal(vplContext_Create(&def, &context), VPL_SUCCESS);
    const vplResult result = vplSpeeds_Measure(context, &speeds);
    assert_in_range(held.most, 1, LITTLE_MEMORY);
    // On a slow machine the time is up before all loads are rendered.
    assert_int_equal(result, held.allocations > ONE_ROUND ? VPL_OUT_OF_MEMORY : VPL_SUCCESS);
    vplContext_Destroy(context);
    assert_int_equal(held.now, 0);
}

TEST_ALONE(MeasuringWithoutMemoryFailsCleanly)
{
    static const long points[] = {1, 2, 5, 9, 20, 50, 100, 150};
    for (size_t i = 0; i < sizeof points / sizeof *points; i++) {
        Failing failing = {.failAt = points[i], .stayEmpty = i % 2};
        vplSpeeds speeds = slowerSpeeds(1), kept = speeds;
        vplContext* context = openFailing(&failing);
        assert_non_null(context);
        assert_int_equal(vplSpeeds_Measure(context, &speeds), VPL_OUT_OF_MEMORY);
        assert_memory_equal(&speeds, &kept, sizeof kept);
        assert_int_equal(failing.errors, 1);
        vplContext_Destroy(context);
        assert_int_equal(failing.held, 0);
    }
}

TEST(SpeedsThatAreNotPositiveAreRefused, 1)
{
    for (int i = 0; i < SPEEDS; i++) {
        const double wrong[] = {-1, NAN, INFINITY};
        for (int k = 0; k < 3; k++) {
            vplSpeeds speeds = slowerSpeeds(1);
            ((double*)&speeds)[i] = wrong[k];
            assert_int_equal(vplContext_SetSpeeds(context, &speeds), VPL_INVALID_ARGUMENT);
            assert_non_null(strstr(takeMessage(), "not positive"));
        }
    }
}

TEST_ALONE(SpeedsWithoutMemoryAreNotSet)
{
    Failing failing = {.failAt = 1};
    vplContext* context = openFailing(&failing);
    const vplSpeeds speeds = slowerSpeeds(2);
    assert_int_equal(vplContext_SetSpeeds(context, &speeds), VPL_OUT_OF_MEMORY);
    assert_int_equal(vplContext_SetSpeeds(context, &speeds), VPL_SUCCESS);
    assert_int_equal(vplContext_SetSpeeds(context, &speeds), VPL_SUCCESS);
    vplContext_Destroy(context);
    assert_int_equal(failing.held, 0);
}

// ---- predictions

TEST(PredictedTimeGrowsWithTheWork, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    static const struct {
        const char *method, *option, *less, *more;
        float least; // growth
    } rows[] = {{"keller", "particles", "1000", "16000", 2},
                {"instant-radiosity", "particles", "100", "10000", 2},
                {"path", "spp", "4", "64", 8},
                {"radiosity", "patches", "500", "4000", 8},
                {"ssvp", "max-clusters", "8", "512", 1.2f},
                {"keller", "size", "64x36", "640x360", 10},
                {"direct", "size", "64x36", "640x360", 10},
                {"path", "size", "64x36", "640x360", 10},
                {"keller", "supersample", "1", "4", 3},
                {"keller", "passes", "1", "10", 5},
                {"ssvp", "rsm-size", "64", "2048", 1}};
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const float less = timeOf(scene, rows[i].method, rows[i].option, rows[i].less),
                    more = timeOf(scene, rows[i].method, rows[i].option, rows[i].more);
        if (!(more >= rows[i].least * less)) {
            fail_msg("%s --%s: %g ms, then %g", rows[i].method, rows[i].option, (double)less, (double)more);
        }
    }
    vplScene_Destroy(scene);
}

TEST(PredictedTimeFollowsSpeedsAndThreads, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    const vplSpeeds slow = slowerSpeeds(10);
    for (int i = 0; i < METHOD_COUNT; i++) {
        const vplRenderOptions o = optionsOf(METHODS[i], NULL, NULL);
        const float one = predict(scene, &o, &(vplMachine){1, NULL}).x,
                    four = predict(scene, &o, &(vplMachine){4, NULL}).x,
                    ten = predict(scene, &o, &(vplMachine){1, &slow}).x;
        assert_true(four < 0.5f * one);
        assertNear((double)(ten / one), 10, 1e-3, METHODS[i], i);
        assert_int_equal(vplContext_SetSpeeds(context, &slow), VPL_SUCCESS);
        assertNear((double)predict(scene, &o, NULL).x, (double)ten, 1e-6, METHODS[i], i);
        assert_int_equal(vplContext_SetSpeeds(context, NULL), VPL_SUCCESS);
        assertNear((double)predict(scene, &o, NULL).x, (double)one, 1e-6, METHODS[i], i);
    }
    vplScene_Destroy(scene);
}

TEST(SpeedsChangeNoDecisionAndNoBit, 1)
{
    const vplSpeeds slow = slowerSpeeds(10);
    for (int i = 0; i < METHOD_COUNT + 1; i++) {
        uint64_t hashes[2];
        for (int k = 0; k < 2; k++) {
            vplScene* scene = openScene(context, "examples/scenes/room-area.json");
            vplRenderStats stats;
            const vplRenderOptions o = optionsOf(i < METHOD_COUNT ? METHODS[i] : "auto", "patches", "100");
            assert_int_equal(vplContext_SetSpeeds(context, k > 0 ? &slow : NULL), VPL_SUCCESS);
            vplImage_Destroy(renderScene(scene, &o, &stats));
            hashes[k] = stats.imageHash;
            vplScene_Destroy(scene);
        }
        assert_true(hashes[0] == hashes[1]);
    }
    vplContext_SetSpeeds(context, NULL);
}

TEST(PlanSaysWhichMachineItsTimeIsOf, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    const vplRenderOptions o = optionsOf("keller", NULL, NULL);
    const vplSpeeds speeds = slowerSpeeds(1);
    const struct {
        vplMachine machine;
        const char* words;
    } rows[] = {{{1, NULL}, "on the machine of our benchmarks"}, {{1, &speeds}, "on this machine"}};
    for (int i = 0; i < 2; i++) {
        char text[8192];
        vplPlan* plan;
        assert_int_equal(vplPlan_Create(scene, &o, &rows[i].machine, &plan), VPL_SUCCESS);
        assert_int_equal(plan->usualSpeeds, i == 0);
        vplPlan_Describe(plan, text, sizeof text);
        assert_non_null(strstr(text, rows[i].words));
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// A camera that sees nothing has times, too.
TEST(EmptyPicturesHaveTimes, 1)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = (vplVec3){0, 500, 0};
    camera.target = (vplVec3){0, 1000, 0};
    camera.up = (vplVec3){1, 0, 0};
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    for (int i = 0; i < METHOD_COUNT; i++) {
        const vplRenderOptions o = optionsOf(METHODS[i], "camera", "1");
        predict(scene, &o, NULL);
    }
    vplScene_Destroy(scene);
}
