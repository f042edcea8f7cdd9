// SPDX-License-Identifier: MIT
// Tests of passes that are cancelled: the picture of the passes before is still there, and what follows has
// the bits of a render that was never stopped.
#include "base/context.h"
#include "pass_cases.h"

#include <unistd.h>

// Cancels at one call.
typedef struct Stop {
    int calls, at;
} Stop;

static bool stopOnce(void* user, double fraction)
{
    Stop* stop = user;
    assert_true(fraction >= 0 && fraction <= 1);
    return ++stop->calls != stop->at;
}

static void doNothing(void* data, int index, int worker)
{
    (void)data;
    (void)index;
    (void)worker;
}

TEST_ALONE(ProgressEndsWithItsRange)
{
    vplContext* context = openTestContext(1);
    Progressed p = {0, 0};
    assert_int_equal(
        vplParallelForProgress(context, 10, doNothing, NULL, (vplProgressRange){noteProgress, &p, 0.25, 0.5}),
        VPL_SUCCESS);
    assert_true(p.calls >= 10 && p.last == 0.5);
    closeTestContext(context);
}

// Renders with a stop at call `at`. Returns false if there were fewer calls.
static bool stopAt(const vplScene* scene, vplRenderOptions o, int at, const Seen* passes,
                   const vplRenderStats* whole)
{
    Stop stop = {0, 0};
    vplRenderer* r;
    vplRenderStats stats;
    int done = 0, stops = 0;
    o.progress = stopOnce;
    o.progressUser = &stop;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    stop = (Stop){0, at}; // plans call it, too
    for (bool ended = false; !ended;) {
        const vplResult result = vplRenderer_Step(r, &ended);
        done += result == VPL_SUCCESS;
        stops += result == VPL_CANCELLED;
        assert_true(result == VPL_SUCCESS || result == VPL_CANCELLED);
        if (result == VPL_CANCELLED && done > 0) {
            const Seen seen = look(r, &stats);
            assertSeenSame(&seen, &passes[done]);
            assert_int_equal(stats.passes, done);
        }
    }
    const Seen seen = look(r, &stats);
    assertSeenSame(&seen, &passes[MOST_PASSES]);
    assert_int_equal(stats.virtualLights, whole->virtualLights);
    assert_true(stats.rays <= whole->rays &&
                stats.drawCalls <= whole->drawCalls); // work of cancelled passes is left out
    assert_true(stats.clampLoss == whole->clampLoss && stats.errorEstimate == whole->errorEstimate);
    vplRenderer_Destroy(r);
    return stops > 0;
}

TEST_ALONE(ACancelledPassLeavesThoseBefore, SLOW)
{
    for (int i = 0; i < PASS_CASES; i++) {
        vplContext* context = openTestContext(1); // it calls `progress` after each task
        vplScene* scene;
        Seen passes[MOST_PASSES + 1];
        vplRenderStats whole;
        const vplRenderOptions o = passCase(context, i, &scene);
        renderPasses(scene, &o, passes, &whole);
        int at = 1, tried = 0;
        while (stopAt(scene, o, at, passes, &whole)) {
            at += 1 + at / 6;
            tried++;
        }
        assert_true(tried >= 4);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// Loads a state with a stop at call `at`, and then again. Returns false if there were fewer calls.
static bool stopLoadingAt(const vplScene* scene, vplRenderOptions o, int at, const Seen* loaded,
                          const Seen* last, const char* path)
{
    Stop stop = {0, 0};
    vplRenderer* r;
    bool done;
    o.progress = stopOnce;
    o.progressUser = &stop;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    stop = (Stop){0, at};
    const vplResult result = vplRenderer_Load(r, path, &done);
    const bool stopped = stop.calls >= at;
    assert_int_equal(result, stopped ? VPL_CANCELLED : VPL_SUCCESS);
    if (stopped) {
        assert_int_equal(stop.calls, at);
        assert_int_equal(vplRenderer_Load(r, path, &done), VPL_SUCCESS);
    }
    stop.at = 0; // the rest is not stopped
    const Seen first = look(r, NULL);
    assertSeenSame(&first, loaded);
    while (!done) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    }
    const Seen end = look(r, NULL);
    assertSeenSame(&end, last);
    vplRenderer_Destroy(r);
    return stopped;
}

// Saves a render after so many passes, and stops its loading at the first calls and at growing distances after them.
static void stopLoading(const vplScene* scene, const vplRenderOptions* o, int saved)
{
    char path[128];
    Seen passes[MOST_PASSES + 1];
    vplRenderStats stats;
    bool ended;
    int at = 1;
    renderPasses(scene, o, passes, &stats);
    snprintf(path, sizeof path, "%s", temporaryName(".state"));
    saveAfter(scene, o, saved, path, &ended);
    while (stopLoadingAt(scene, *o, at, &passes[saved], &passes[MOST_PASSES], path)) {
        at += 1 + at / 6;
    }
    assert_true(at > 2);
    unlink(path);
}

TEST_ALONE(AStateWhoseReadingIsCancelledIsReadAgain)
{
    for (int i = 0; i < PASS_CASES; i++) {
        vplContext* context = openTestContext(1);
        vplScene* scene;
        const vplRenderOptions o = passCase(context, i, &scene);
        stopLoading(scene, &o, 2);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// They are traced again after all else was loaded.
TEST_ALONE(AStateWhosePixelsAtEdgesAreCancelledIsReadAgain)
{
    vplContext* context = openTestContext(1);
    vplScene* scene;
    vplRenderOptions o = passCase(context, 2, &scene);
    assert_int_equal(vplRenderOptions_SetAll(&o, "--edge-pixels 60 --spp 8"), VPL_SUCCESS);
    stopLoading(scene, &o, MOST_PASSES);
    vplScene_Destroy(scene);
    closeTestContext(context);
}

// A host's tasks cannot be stopped: all of a pass is done before it is cancelled.
TEST_ALONE(APassOfAHostsTasksIsTakenBack, SLOW)
{
    vplContextDef def = vplDefaultContextDef();
    vplContext* context;
    vplScene* scene;
    Seen passes[MOST_PASSES + 1];
    vplRenderStats whole;
    def.workerCount = 2;
    def.parallelFor = threadedFor;
    assert_int_equal(vplContext_Create(&def, &context), VPL_SUCCESS);
    const vplRenderOptions o = passCase(context, 0, &scene);
    renderPasses(scene, &o, passes, &whole);
    for (int at = 1; stopAt(scene, o, at, passes, &whole); at += 1 + at / 6) {
    }
    vplScene_Destroy(scene);
    vplContext_Destroy(context);
}

// A cancelled pass holds a copy of the path tracer's sums, and only where it can be cancelled.
TEST(PathsKeepACopyWhereTheyCanBeCancelled, 1)
{
    vplScene* scene;
    vplRenderOptions o = passCase(context, 0, &scene);
    vplRenderStats without, with;
    o.output.width = 160;
    o.output.height = 120;
    o.path.samples = 33;
    vplImage_Destroy(renderScene(scene, &o, &without));
    Stop never = {0, 0};
    o.progress = stopOnce;
    o.progressUser = &never;
    vplPlan* plan;
    assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
    vplImage_Destroy(renderScene(scene, &o, &with));
    assertNear((double)(with.peakBytes - without.peakBytes), 48.0 * 160 * 120, 65536, "bytes", 0);
    assertNear((double)with.peakBytes / (double)plan->peakBytes, 1, 0.15, "share of the plan", 0);
    vplPlan_Destroy(plan);
    vplScene_Destroy(scene);
}
