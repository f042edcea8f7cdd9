// SPDX-License-Identifier: MIT
// Tests of renders that have a time: how they fill it.
#include "shapes.h"

#include "base/clock.h"
#include "reference/sparse_paths.h"
#include "render/planner/patch_plan.h"
#include "render/planner/time_plan.h"

static vplRenderOptions optionsFor(double budgetMs)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = 64;
    o.output.height = 36;
    o.stop.budgetMs = budgetMs;
    return o;
}

// A renderer whose time is practically endless, after so many passes of the plan that follows the coarse one.
static vplRenderer* rendererAfter(const vplScene* scene, const vplRenderOptions* o, int passes)
{
    vplRenderer* r;
    bool done;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    r->deadline = vplClockMs() + 1e7;
    do {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    } while (r->coarse || r->done < passes);
    return r;
}

static vplImage* imageOf(vplRenderer* r)
{
    vplImage* image;
    assert_int_equal(vplRenderer_GetImage(r, &image, NULL), VPL_SUCCESS);
    return image;
}

static void assertSameBits(const vplImage* a, const vplImage* b)
{
    assert_true(vplImage_Hash(a) == vplImage_Hash(b));
}

// In a scene with textures virtual lights are chosen. After passes of 125 and 250 particles they stay at 250.
TEST(PassesThatStopGrowingKeepTheirPicture, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/textured-room.json");
    vplRenderOptions o = optionsFor(1e7);
    o.method = VPL_METHOD_KELLER;
    o.particles.count = -1;
    o.stop.growFrom = 500;
    vplRenderer* r = rendererAfter(scene, &o, 2);
    vplImage* before = imageOf(r);
    assert_int_equal(r->plan->options.particles.count, 4000);
    assert_true(vplStopGrowth(r));
    assert_int_equal(r->plan->options.particles.count, 1000);
    assert_false(vplStopGrowth(r)); // it has stopped
    vplImage* after = imageOf(r);
    assertSameBits(before, after);
    bool done;
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    vplImage* third = imageOf(r);
    vplRenderOptions replay = r->plan->options;
    replay.stop.passes = 3;
    replay.stop.budgetMs = 0;
    vplImage* again = renderScene(scene, &replay, NULL);
    assertSameBits(third, again);
    vplImage* images[] = {before, after, third, again};
    for (int i = 0; i < 4; i++) {
        vplImage_Destroy(images[i]);
    }
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

TEST(GrowthStopsOnlyWhereItIsExactAndInTime, 2)
{
    static const struct {
        int particles, growFrom;
        double lastMs;
        bool stops;
    } ROWS[] = {
        {-1, 500, 0, true},
        {-1, 500, 1e9, false}, // another such pass would be too late
        {-1, 300, 0, false},   // 4000 is not 300 times a power of two
        {4000, 500, 0, false}, // the caller's number
    };
    vplScene* scene = loadScene(context, "room.json");
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplRenderOptions o = optionsFor(1e7);
        o.method = VPL_METHOD_KELLER;
        o.particles.count = ROWS[i].particles;
        o.stop.growFrom = ROWS[i].growFrom;
        vplRenderer* r = rendererAfter(scene, &o, 1);
        r->lastMs = ROWS[i].lastMs;
        if (vplStopGrowth(r) != ROWS[i].stops) {
            fail_msg("row %zu", i);
        }
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// Plans become smaller as the machine is slower, but only in what the caller leaves open.
TEST(PlansShrinkUntilTheyFit, 2)
{
    static const struct {
        double pace;
        bool open;
        int antialias, particles;
        vplCompensation compensation;
        bool tooLate;
    } ROWS[] = {
        {1e-6, true, 8, 4000, VPL_COMPENSATION_RAYS, false},
        {1e6, true, 1, 250, VPL_COMPENSATION_NONE, true},
        {1e6, false, 2, 640, VPL_COMPENSATION_RAYS, true},
    };
    vplScene* scene = openScene(context, "examples/scenes/textured-room.json");
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplRenderOptions o = optionsFor(1000);
        o.method = VPL_METHOD_KELLER;
        if (!ROWS[i].open) {
            o.output.antialias = ROWS[i].antialias;
            o.particles.count = ROWS[i].particles;
            o.lights.compensation = ROWS[i].compensation;
        }
        vplRenderer* r;
        bool tooLate;
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        assert_int_equal(vplRenderer_Plan(r, &o, false), VPL_SUCCESS);
        r->deadline = vplClockMs() + 1000;
        r->pace = ROWS[i].pace;
        assert_int_equal(vplFitPlan(r, &tooLate), VPL_SUCCESS);
        const vplRenderOptions* planned = &r->plan->options;
        assert_int_equal(planned->output.antialias, ROWS[i].antialias);
        assert_int_equal(planned->particles.count, ROWS[i].particles);
        assert_int_equal(planned->lights.compensation, ROWS[i].compensation);
        assert_true(tooLate == ROWS[i].tooLate);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// The time foreseen for a plan does not count the geometry, which planning has made.
TEST(TheTimeOfAPlanIsWithoutWhatIsDone, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    const vplRenderOptions o = optionsFor(1000);
    vplRenderer* r;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    double geometry = 0;
    for (int i = 0; i < r->plan->stageCount; i++) {
        geometry += strcmp(r->plan->stages[i].name, "geometry") == 0 ? r->plan->stages[i].ms : 0;
    }
    assert_true(geometry > 0);
    assert_true(fabs(vplTimeOfFirst(r) - (r->plan->firstMs - geometry)) < 1e-9 * r->plan->firstMs);
    r->pace = 3;
    assert_true(fabs(vplTimeOfFirst(r) - 3 * (r->plan->firstMs - geometry)) < 1e-8 * r->plan->firstMs);
    vplRenderer_Destroy(r);
    // Patches and their sides are made while a plan of radiosity is.
    vplRenderOptions patches = o;
    patches.method = VPL_METHOD_RADIOSITY;
    patches.stop.budgetMs = 0;
    assert_int_equal(vplRenderer_Create(scene, &patches, &r), VPL_SUCCESS);
    double made = 0;
    for (int i = 0; i < r->plan->stageCount; i++) {
        const char* name = r->plan->stages[i].name;
        const bool is = strcmp(name, "geometry") == 0 || strcmp(name, "patches") == 0 ||
                        strcmp(name, "reachable sides") == 0;
        made += is ? r->plan->stages[i].ms : 0;
    }
    assert_true(made > geometry);
    assert_true(fabs(vplTimeOfFirst(r) - (r->plan->firstMs - made)) < 1e-9 * r->plan->firstMs);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

static vplMethod methodInTime(vplContext* context, const char* path, const vplRenderOptions* o)
{
    vplScene* scene = openScene(context, path);
    vplRenderer* r;
    bool done = false;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    while (r->coarse && !done) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    }
    const vplMethod method = r->plan->options.method;
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
    return method;
}

// After the coarse picture patches follow in rooms of few triangles and where doors hide the lights, if there is time for them.
TEST(PatchesFillTheTimeWhereTheySuit, 2)
{
    static const struct {
        const char* scene;
        double ms;
        vplMethod method;
    } ROWS[] = {
        {"closed-room", 1e6, VPL_METHOD_RADIOSITY}, {"flat", 1e6, VPL_METHOD_RADIOSITY},
        {"closed-room", 1, VPL_METHOD_KELLER},      {"flat", 1, VPL_METHOD_KELLER},
        {"loft", 1e6, VPL_METHOD_KELLER},           {"textured-room", 1e6, VPL_METHOD_KELLER},
        {"door-ajar", 1e6, VPL_METHOD_KELLER},
    };
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        char path[64];
        snprintf(path, sizeof path, "examples/scenes/%s.json", ROWS[i].scene);
        const vplRenderOptions o = optionsFor(ROWS[i].ms);
        if (methodInTime(context, path, &o) != ROWS[i].method) {
            fail_msg("%s in %g ms", ROWS[i].scene, ROWS[i].ms);
        }
    }
    vplRenderOptions o = optionsFor(1e6);
    o.lights.compensation = VPL_COMPENSATION_RAYS; // of virtual lights
    assert_int_equal(methodInTime(context, "examples/scenes/closed-room.json", &o), VPL_METHOD_KELLER);
}

// 5,120 triangles, which are grouped into patches.
static void addSphere(vplScene* scene)
{
    Shape shape = icosphere(4);
    placeShape(&shape, 0.1f, (double[3]){0, 0, 0}, (vplVec3){1.5f, 0.5f, 2});
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
}

// Where doors hide the lights, patches have no gather if its rays would come too late, unless triangles are grouped into patches.
TEST(PatchesGoWithoutAGatherInAShortTime, 2)
{
    static const struct {
        double ms;
        int width;
        bool grouped;
        vplMethod method;
        int gather;
    } ROWS[] = {{2e7, 160, false, VPL_METHOD_RADIOSITY, 16},
                {3e6, 160, false, VPL_METHOD_RADIOSITY, 0},
                {1e6, 160, false, VPL_METHOD_RADIOSITY, 0},
                {9e5, 160, false, VPL_METHOD_RADIOSITY, 0}, // foreseen to be a little late
                {2e5, 160, false, VPL_METHOD_KELLER, -1},
                {6e6, 320, true, VPL_METHOD_RADIOSITY, 6},
                {3e6, 320, true, VPL_METHOD_KELLER, -1},
                {3e6, 160, true, VPL_METHOD_RADIOSITY,
                 11}};                          // making 672 patches anew would take longer than 1,000 save
    const vplSpeeds slow = slowerSpeeds(10000); // so that the time that this test itself takes does not count
    assert_int_equal(vplContext_SetSpeeds(context, &slow), VPL_SUCCESS);
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        if (ROWS[i].grouped && !ROWS[i - 1].grouped) {
            addSphere(scene);
        }
        vplRenderOptions o = optionsFor(ROWS[i].ms);
        o.output.width = ROWS[i].width;
        o.output.height = ROWS[i].width * 9 / 16;
        vplRenderer* r;
        bool done = false;
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        assert_true(r->coarse);
        while (r->coarse && !done) {
            assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        }
        assert_int_equal(r->plan->options.method, ROWS[i].method);
        assert_int_equal(r->plan->options.radiosity.gather, ROWS[i].gather);
        if (ROWS[i].method == VPL_METHOD_RADIOSITY) {
            assert_true(ROWS[i].grouped == (r->plan->patchGroups > 0));
            assert_true(!ROWS[i].grouped || r->plan->options.radiosity.patches == VPL_FIRST_PATCHES);
        }
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
    assert_int_equal(vplContext_SetSpeeds(context, NULL), VPL_SUCCESS);
}

// Groups of triangles take long to make, so they must be foreseen to take at most 0.8 of the time; other patches may take all of it.
TEST(GroupsAreMadeOnlyWhereThereIsTime, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    const vplRenderOptions o = optionsFor(1e7);
    const double pixels = 64.0 * 36, lamps = vplScene_GetEmitterCount(scene);
    for (int grouped = 0; grouped < 2; grouped++) {
        vplRenderer* r;
        int gather;
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        const vplGeometry* g = r->runner.run.results[VPL_STAGE_GEOMETRY];
        const double exchange = 1.2e6 + 60.0 * g->triangleCount, picture = 2 * pixels * lamps;
        const double needs = exchange + picture + (grouped ? 1.6 * 4 * pixels : 0);
        const double least = grouped ? needs / 0.8 : needs;
        assert_true(vplPatchesSuitTime(&r->runner, r->plan, &o, 1.001 * least, &gather));
        assert_false(vplPatchesSuitTime(&r->runner, r->plan, &o, 0.999 * least, &gather));
        vplRenderer_Destroy(r);
        addSphere(scene);
    }
    vplScene_Destroy(scene);
}

// Patches, and rays that gather their light, are as many as the caller asks for, however much time is left.
TEST(ATimeDoesNotChangeWhatIsAskedFor, 2)
{
    static const int GATHERS[] = {-1, 3};
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    for (int i = 0; i < 2; i++) {
        vplRenderOptions o = optionsFor(10000);
        vplRenderer* r;
        bool done = false;
        o.radiosity.patches = 500;
        o.radiosity.gather = GATHERS[i];
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        while (!done) {
            assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        }
        const vplPlan* plan = vplRenderer_GetPlan(r);
        assert_int_equal(plan->options.method, VPL_METHOD_RADIOSITY);
        assert_int_equal(plan->options.radiosity.patches, 500);
        assert_int_equal(plan->options.radiosity.gather, i == 0 ? 0 : 3);
        assert_int_equal(r->edgePixels, 0);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// Paths that follow others give the bits of all at once, and are counted once.
TEST(TracedEdgesGoOn, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = optionsFor(1e7);
    o.method = VPL_METHOD_KELLER;
    o.particles.count = 100;
    vplRenderer* r = rendererAfter(scene, &o, 2);
    const int64_t before = r->otherRays;
    assert_int_equal(vplRenderer_TraceEdges(r, 100, 16), VPL_SUCCESS);
    assert_int_equal(vplRenderer_TraceEdges(r, 100, 48), VPL_SUCCESS);
    const int64_t rays = r->otherRays - before;
    vplImage* first = imageOf(r);
    vplRenderer_ForgetEdges(r);
    assert_int_equal(vplRenderer_TraceEdges(r, 100, 48), VPL_SUCCESS);
    vplImage* second = imageOf(r);
    assertSameBits(first, second);
    assert_true(r->otherRays - before == 2 * rays);
    assert_int_equal(vplRenderer_TraceEdges(r, 50, 48), VPL_SUCCESS); // others, not more
    assert_int_equal(r->edgePixels, 50);
    vplImage* third = imageOf(r);
    assert_true(vplImage_Hash(third) != vplImage_Hash(second));
    vplImage_Destroy(first);
    vplImage_Destroy(second);
    vplImage_Destroy(third);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

static void setTime(vplRenderer* r, double ms)
{
    r->asked.stop.budgetMs = ms;
    r->deadline = vplClockMs() + ms;
}

// Paths at edges fill the time that is left, and make the picture better. It can be replayed.
TEST(PathsAtEdgesFillTheRest, 2, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/loft.json");
    vplRenderOptions o = optionsFor(1e7), replay;
    vplRenderer* r = rendererAfter(scene, &o, 5);
    vplImage* before = imageOf(r);
    setTime(r, 2000);
    assert_int_equal(vplSpendRest(r), VPL_SUCCESS);
    vplImage* after = imageOf(r);
    assert_true(r->edgePaths >= 16);
    assert_true(vplTimeLeft(r) > -0.3 * 2000);
    assert_true(errorAgainstPaths(scene, after) < 0.9 * errorAgainstPaths(scene, before));
    replay = r->plan->options;
    replay.stop.budgetMs = 0;
    replay.stop.passes = 5;
    replay.path.edgePixels = r->edgePixels;
    replay.path.edgePaths = r->edgePaths;
    vplImage* again = renderScene(scene, &replay, NULL);
    assertSameBits(after, again);
    vplImage_Destroy(before);
    vplImage_Destroy(after);
    vplImage_Destroy(again);
    setTime(r, 100); // too short
    vplRenderer_ForgetEdges(r);
    assert_int_equal(vplSpendRest(r), VPL_SUCCESS);
    assert_null(r->edges);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// A renderer whose first picture is made of so many patches, after a coarse one.
static vplRenderer* rendererWithPatches(const vplScene* scene, int patches)
{
    const vplRenderOptions o = optionsFor(1e7);
    vplRenderer* r;
    bool done;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    r->deadline = vplClockMs() + 1e7;
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS); // the coarse picture
    vplRenderOptions few = r->plan->options;
    few.radiosity.patches = patches;
    assert_int_equal(vplRenderer_Plan(r, &few, false), VPL_SUCCESS);
    assert_int_equal(few.method, VPL_METHOD_RADIOSITY);
    setTime(r, 1e6); // until the picture is there
    assert_int_equal(vplRenderer_RunPass(r), VPL_SUCCESS);
    r->done = 1;
    return r;
}

// Where a first number of patches took little of the time, more follow; else paths at edges.
TEST(MorePatchesFollowWhileThereIsTime, 2, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    int busy = 0; // other programs took so much of the time that the paths did not end
    for (int i = 0; i < 2; i++) {
        vplRenderer* r = rendererWithPatches(scene, 500);
        bool done = true;
        r->passMs = i == 0 ? 10 : 1500;
        setTime(r, 2000);
        const vplResult result = vplSpendTime(r, &done);
        if (result == VPL_CANCELLED && r->late && busy++ < 5) {
            vplRenderer_Destroy(r);
            i--;
            continue;
        }
        assert_int_equal(result, VPL_SUCCESS);
        assert_true(done == (i == 1));
        assert_true((r->plan->options.radiosity.patches > 700) == (i == 0));
        assert_true((r->edgePaths >= 16) == (i == 1));
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// Judges a picture by patches with the first paths of the truth. Returns a time, ms, in which many more of them fit, but no other patches.
static double judgeOnce(vplRenderer* r)
{
    const double start = vplClockMs();
    assert_int_equal(vplJudge(r, 0, true, 1), VPL_SUCCESS);
    const double ms = fmax(500, 40 * (vplClockMs() - start));
    r->passMs = 3 * ms; // too long for more patches
    return ms;
}

// Paths of the truth whose halves contradict each other tell no error. More of them take what is left of the time.
TEST(WhatIsLeftOfTheTimeTellsAnUnknownError, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    vplResult result = VPL_CANCELLED; // other programs took so much of the time that the paths did not end
    for (int i = 0; i < 6 && result == VPL_CANCELLED; i++) {
        vplRenderer* r = rendererWithPatches(scene, 100);
        bool done = true;
        const double ms = judgeOnce(r);
        assert_true((double)r->judged.rays * VPL_PATH_RAY >
                    0.25 * vplRaysOfPlan(r)); // no judgement refines it by itself
        const vplTruthState state = vplTruth_GetState(r->truth);
        for (int k = 0; k < state.count; k++) {
            state.pixels[k].sums[0].g += (k % 2 == 0 ? 1e6 : -1e6) * r->judged.mean;
        }
        const int before = vplTruth_Paths(r->truth);
        setTime(r, ms);
        result = vplSpendTime(r, &done);
        if (result == VPL_SUCCESS) {
            assert_true(done && vplTruth_Paths(r->truth) >= 4 * before);
            assert_null(r->edges);
        } else {
            assert_true(r->late);
        }
        vplRenderer_Destroy(r);
    }
    assert_int_equal(result, VPL_SUCCESS);
    vplScene_Destroy(scene);
}

// Where no edges are traced, paths of the truth take what is left of the time, until the bound is near to the error.
TEST(WhatIsLeftOfTheTimeLowersTheBound, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/closed-room.json");
    vplResult result = VPL_CANCELLED; // other programs took so much of the time that the paths did not end
    for (int i = 0; i < 6 && result == VPL_CANCELLED; i++) {
        vplRenderer* r = rendererWithPatches(scene, 100);
        bool done = true;
        const double ms = judgeOnce(r);
        const int before = vplTruth_Paths(r->truth);
        assert_true(r->error.bound > 1.2 * r->error.total); // a few paths tell little
        r->edgeTries = 100;                                 // no edges
        setTime(r, ms);
        result = vplSpendTime(r, &done);
        if (result == VPL_SUCCESS) {
            assert_true(done && r->edges == NULL);
            assert_true(vplTruth_Paths(r->truth) >= 4 * before);
            assert_true(r->error.bound <= 1.1 * r->error.total || vplTimeLeft(r) < 0.3 * ms);
        }
        vplRenderer_Destroy(r);
    }
    assert_int_equal(result, VPL_SUCCESS);
    vplScene_Destroy(scene);
}

// The lamp is above a plate that shades all that the camera sees; other light finds its way around the plate. The error of a black
// picture is not relative to anything, and the plan can be written.
TEST(ABlackPictureHasNoRelativeError, 2)
{
    const char* path = temporaryName(".black");
    vplScene* scene = closedCubeScene(context, 0.8f, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, (vplVec3){0, 0, 0}, 0, 0, (vplVec3){1.9f, 0.1f, 1.9f});
    addEmitter(scene, VPL_EMITTER_POINT, (vplVec3){0, 0.5f, 0}, (vplVec3){0, -1, 0}, 1);
    aim(scene, (vplVec3){0, -0.3f, 0}, (vplVec3){0.1f, -1, 0.05f});
    vplRenderOptions o = optionsFor(0);
    o.method = VPL_METHOD_DIRECT;
    o.stop.maxError = 0.1;
    vplRenderer* r;
    vplImage* image;
    vplRenderStats stats;
    bool done;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    assert_true(done && isinf(r->error.total));
    assert_int_equal(vplRenderer_GetImage(r, &image, &stats), VPL_SUCCESS);
    assert_true(stats.relativeErrorEstimate < 0 && stats.errorEstimate < 0 && stats.relativeBias < 0 &&
                stats.relativeErrorBound < 0);
    assert_int_equal(vplRenderer_WritePlan(r, path), VPL_SUCCESS);
    remove(path);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}
