// SPDX-License-Identifier: MIT
// Tests of --method auto, --max-error, --budget and --quality: what is chosen, what is kept, and what is said of errors.
#include "scenes.h"

#include "reference/sparse_paths.h"
#include "render/planner/ways.h"

#include <time.h>

static vplRenderOptions smallOptions(void)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.output.width = 64;
    o.output.height = 36;
    return o;
}

TEST(TheErrorThatIsAskedForIsKept, 2)
{
    static const char* const SCENES[] = {"room.json", "room-closed.json"};
    for (int i = 0; i < 4; i++) {
        vplScene* scene = loadScene(context, SCENES[i / 2]);
        vplRenderOptions o = smallOptions();
        o.stop.maxError = i % 2 ? 0.1 : 0.3;
        vplRenderStats stats;
        vplImage* image = renderScene(scene, &o, &stats);
        assert_true(errorAgainstPaths(scene, image) <= o.stop.maxError);
        assert_true(stats.relativeErrorEstimate > 0 && stats.relativeErrorEstimate <= o.stop.maxError);
        assert_true(stats.relativeErrorBound >= stats.relativeErrorEstimate &&
                    stats.relativeErrorBound <= o.stop.maxError);
        assert_true((stats.relativeNoise > 0) == (stats.passes > 1) && stats.relativeBias >= 0);
        const double noise = fmax(0, stats.relativeNoise); // unknown after one pass
        const double parts = noise * noise + stats.relativeBias * stats.relativeBias;
        assert_true(fabs(sqrt(parts) - stats.relativeErrorEstimate) <= 1e-6);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
}

TEST(ErrorsGiveTheSameBitsWithAnyNumberOfThreads, 1)
{
    uint64_t hashes[3];
    for (int i = 0; i < 3; i++) {
        vplContext* other = openTestContext(1 + i);
        vplScene* scene = loadScene(other, "room.json");
        vplRenderOptions o = smallOptions();
        vplRenderStats stats;
        o.stop.maxError = 0.06;
        vplImage_Destroy(renderScene(scene, &o, &stats));
        hashes[i] = stats.imageHash;
        vplScene_Destroy(scene);
        closeTestContext(other);
    }
    assert_true(hashes[0] == hashes[1] && hashes[0] == hashes[2]);
    assert_non_null(context);
}

TEST(EveryMethodHasAPictureInTime, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    for (int method = 0; method <= VPL_METHOD_AUTO; method++) {
        vplRenderOptions o = smallOptions();
        vplRenderStats stats;
        o.method = (vplMethod)method;
        o.stop.budgetMs = 100;
        vplImage* image = renderScene(scene, &o, &stats);
        assert_true(stats.passes >= 1 && stats.totalMs < 1000 * TEST_SLOWDOWN); // other programs may run, too
        double sum = 0;
        for (int k = 0; k < 3 * image->width * image->height; k++) {
            sum += (double)image->pixels[k];
        }
        assert_true(sum > 0);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

// A pass that the deadline ends leaves the picture of those before it; replaying their number gives the same bits.
TEST(AnInterruptedPassIsNoPartOfThePicture, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    vplRenderer* r;
    vplImage* image = NULL;
    vplRenderStats stats, again;
    o.method = VPL_METHOD_KELLER;
    o.stop.budgetMs = 120;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    stepToEnd(r);
    assert_int_equal(vplRenderer_GetImage(r, &image, &stats), VPL_SUCCESS);
    vplRenderOptions replay = vplRenderer_GetPlan(r)->options;
    replay.lights.minDistance = -1; // each pass has its own
    replay.stop.budgetMs = 0;
    replay.stop.passes = vplRenderer_GetPlan(r)->progressive ? stats.passes : 0;
    vplImage_Destroy(image);
    vplImage_Destroy(renderScene(scene, &replay, &again));
    assert_true(again.imageHash == stats.imageHash);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

static double secondsNow(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

// Waits in the second pass until a time.
typedef struct Waiting {
    vplRenderer* renderer;
    double until; // seconds
} Waiting;

static bool waitInPass(void* user, double fraction)
{
    const Waiting* w = user;
    (void)fraction;
    while (w->renderer != NULL && vplRenderer_GetPassCount(w->renderer) > 0 && secondsNow() < w->until) {
    }
    return true;
}

// Time is up within the second pass: the render ends there, and the first pass is its picture.
TEST(APassEndsWhereTheTimeIsUp, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    Waiting waiting = {.renderer = NULL};
    vplImage* image;
    vplRenderStats stats;
    o.method = VPL_METHOD_KELLER;
    o.stop.budgetMs = 300;
    o.progress = waitInPass;
    o.progressUser = &waiting;
    assert_int_equal(vplRenderer_Create(scene, &o, &waiting.renderer), VPL_SUCCESS);
    waiting.until = secondsNow() + 0.4;
    stepToEnd(waiting.renderer);
    assert_int_equal(vplRenderer_GetImage(waiting.renderer, &image, &stats), VPL_SUCCESS);
    assert_int_equal(stats.passes, 1);
    vplImage_Destroy(image);
    vplRenderer_Destroy(waiting.renderer);
    vplScene_Destroy(scene);
}

TEST(PassesThatGrowAreWeightedByTheirParticles, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    vplRenderStats stats;
    double sums[2] = {0, 0};
    o.method = VPL_METHOD_KELLER;
    o.particles.count = 400;
    o.pipeline.kind = VPL_ACCUMULATE_DEFERRED;
    o.stop.passes = 20;
    for (int i = 0; i < 2; i++) { // 50, 100 and 200 particles and 17 times 400, or 20 times 400
        o.stop.growFrom = i == 0 ? 50 : 0;
        vplImage* image = renderScene(scene, &o, &stats);
        assert_int_equal(stats.particlesPerStep[0], i == 0 ? 7150 : 8000);
        for (int k = 0; k < 3 * image->width * image->height; k++) {
            sums[i] += (double)image->pixels[k];
        }
        vplImage_Destroy(image);
    }
    assert_true(fabs(sums[0] / sums[1] - 1) < 0.02);
    vplScene_Destroy(scene);
}

TEST(OptionsOfOneMethodChooseIt, 1)
{
    static const struct {
        const char *name, *value;
        vplMethod method;
    } ROWS[] = {{"spp", "4", VPL_METHOD_PATH},
                {"clusters", "4", VPL_METHOD_SSVP},
                {"patches", "100", VPL_METHOD_RADIOSITY},
                {"particles", "50", VPL_METHOD_KELLER},
                {"show", "rsm", VPL_METHOD_SSVP},
                {"show", "patches", VPL_METHOD_RADIOSITY},
                {"max-bounces", "3", VPL_METHOD_PATH},
                {"lighting", "documented", VPL_METHOD_KELLER}};
    vplScene* scene = loadScene(context, "room.json");
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplRenderOptions o = smallOptions();
        vplPlan* plan;
        assert_int_equal(vplRenderOptions_Set(&o, ROWS[i].name, ROWS[i].value), VPL_SUCCESS);
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->options.method, ROWS[i].method);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// A look is taken at surfaces only: at none, all of it is 0.
TEST(ThePlannerLooksAtSurfaces, 1)
{
    for (int surfaces = 0; surfaces < 2; surfaces++) {
        vplScene* scene = surfaces > 0 ? loadScene(context, "room.json") : sceneOf(context, 0.5f);
        const vplRenderOptions o = smallOptions();
        vplPlan* plan;
        aim(scene, (vplVec3){0, 1, 3}, (vplVec3){0, 1, 0});
        addEmitter(scene, VPL_EMITTER_POINT, (vplVec3){0, 2, 0}, (vplVec3){0, -1, 0}, 1);
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        const vplLook* look = &plan->look;
        if (surfaces > 0) {
            assert_true(look->points > 0 && look->lights > 0 && look->rays > look->points);
            assert_true(look->background < 1 && look->open < 1 && look->reaching > 0 && look->worth > 0);
        } else {
            assert_true(look->points == 0 && look->lights == 0 && look->rays == 0);
            assert_true(look->background == 0 && look->open == 0 && look->reaching == 0 && look->worth == 0);
        }
        vplPlan_Destroy(plan);
        vplScene_Destroy(scene);
    }
}

TEST(WordsOfQualityStandForErrorsAndTimes, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    vplPlan* plan;
    o.stop.quality = VPL_QUALITY_DRAFT;
    assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
    assert_true(plan->options.stop.maxError == 0.2 && plan->options.stop.budgetMs == 1000);
    vplPlan_Destroy(plan);
    o.stop.maxError = 0.1; // beside it
    assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
    assert_true(plan->options.stop.maxError == 0.1 && plan->options.stop.budgetMs == 1000);
    vplPlan_Destroy(plan);
    vplScene_Destroy(scene);
}

static const char* savedFile(void)
{
    return temporaryName(".state");
}

// What was learnt of the error is saved, too: the render ends where it would have ended.
TEST(ARenderThatWasSavedEndsAtTheSamePass, 2)
{
    static const struct {
        const char* scene;
        vplMethod method;
        double error;
    } CASES[] = {
        {"tests/data/room.json", VPL_METHOD_AUTO, 0.05}, // after five passes another plan follows the first
        {"tests/data/room.json", VPL_METHOD_PATH, 0.15},
        {"examples/scenes/room-area.json", VPL_METHOD_AUTO, 0.1}, // paths through pixels at edges end it
        {"examples/scenes/room-area.json", VPL_METHOD_AUTO,
         0.12}, // they leave too much, and another plan follows
    };
    for (int i = 0; i < 4; i++) {
        vplScene* scene = openScene(context, CASES[i].scene);
        vplRenderOptions o = smallOptions();
        vplRenderStats whole, stats;
        bool ended = false;
        o.method = CASES[i].method;
        o.stop.maxError = CASES[i].error;
        vplImage_Destroy(renderScene(scene, &o, &whole));
        for (int steps = 1; !ended; steps += 2) {
            saveAfter(scene, &o, steps, savedFile(), &ended);
            finishSaved(scene, &o, savedFile(), &stats);
            assert_true(stats.passes == whole.passes && stats.imageHash == whole.imageHash);
        }
        vplScene_Destroy(scene);
    }
    remove(savedFile());
}

// Cancels at one call.
typedef struct Stop {
    int calls, at;
} Stop;

static bool stopOnce(void* user, double fraction)
{
    Stop* stop = user;
    (void)fraction;
    return ++stop->calls != stop->at;
}

// Renders with a stop at call `at`, then goes on, by a saved state if `saves`. Returns false if there were fewer calls.
static bool stopAt(const vplScene* scene, vplRenderOptions o, int at, bool saves, vplRenderStats* stats,
                   bool* midwayOut)
{
    Stop stop = {0, 0};
    vplRenderer* r;
    vplImage* image;
    bool done = false;
    int steps = 0, stops = 0;
    o.progress = stopOnce;
    o.progressUser = &stop;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    stop = (Stop){0, at};
    while (!done) {
        const vplResult result = vplRenderer_Step(r, &done);
        assert_true(result == VPL_SUCCESS || result == VPL_CANCELLED);
        steps += result == VPL_SUCCESS;
        if (result == VPL_CANCELLED) {
            stops++;
            *midwayOut = *midwayOut || vplRenderer_GetPassCount(r) > steps;
            if (saves && vplRenderer_GetPassCount(r) > 0) {
                assert_int_equal(vplRenderer_Save(r, savedFile()), VPL_SUCCESS);
                vplRenderer_Destroy(r);
                finishSaved(scene, &o, savedFile(), stats);
                return true;
            }
        }
    }
    assert_int_equal(vplRenderer_GetImage(r, &image, stats), VPL_SUCCESS);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
    return stops > 0;
}

// A cancelled search for the error goes on as if it had not been: its paths counted twice, and it was left out.
TEST(ARenderThatWasCancelledAnywhereEndsTheSame, 1)
{
    static const vplMethod METHODS[] = {VPL_METHOD_AUTO, VPL_METHOD_PATH};
    static const double ERRORS[] = {0.05, 0.15}; // 0.05: another plan follows the first
    vplScene* scene = loadScene(context, "room.json");
    for (int i = 0; i < 2; i++) {
        vplRenderOptions o = smallOptions();
        vplRenderStats whole, stats;
        int tried = 0;
        bool midway = false, more = true;
        o.method = METHODS[i];
        o.stop.maxError = ERRORS[i];
        vplImage_Destroy(renderScene(scene, &o, &whole));
        for (int at = 1; more; at += 1 + at / 6) {
            more = stopAt(scene, o, at, tried++ % 2 != 0, &stats, &midway);
            assert_true(stats.imageHash == whole.imageHash && stats.passes == whole.passes);
            assert_true(stats.relativeErrorEstimate == whole.relativeErrorEstimate);
        }
        assert_true(midway == (i == 0)); // paths are their own truth
    }
    remove(savedFile());
    vplScene_Destroy(scene);
}

// Where the error of a picture with traced edges is too uncertain, and more paths of the truth do not help, it gets more pixels, unless
// that costs more than the picture.
TEST(AnUncertainTruthBesideEdgesGetsMorePixels, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/loft.json");
    vplRenderOptions o = smallOptions();
    o.output.width = 120;
    o.output.height = 72;
    o.method = VPL_METHOD_KELLER;
    o.stop.maxError = 1e-3;
    for (int i = 0; i < 2; i++) {
        vplRenderer* r;
        bool more, done;
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        assert_int_equal(vplJudge(r, 1e-3, false, INFINITY), VPL_SUCCESS);
        assert_int_equal(vplRenderer_TraceEdges(r, 50, 32), VPL_SUCCESS);
        const int before = vplTruth_CountPixels(r->truth);
        vplErrorState s = vplErrorState_Of(r);
        s.stuck = true;
        s.square = 0;
        s.spread = r->judged.spread = 1e3;
        s.spent = i == 0 ? 2 * s.truth : 0;
        s.path = 0;
        assert_int_equal(vplProveEdges(r, &s, 0.1, &more), VPL_SUCCESS);
        assert_true(more);
        assert_true((vplTruth_CountPixels(r->truth) > 2 * before) == (i == 0));
        assert_true((r->edges != NULL) == (i == 0));
        assert_int_equal(r->edgeTries, i);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}

// One half of a picture is bright, the other dark, both without contrast: the truth has three times as many pixels of the bright half, and
// each has a third of the weight.
TEST(BrightPixelsAreComparedMoreOften, 2)
{
    enum { WIDTH = 240, HEIGHT = 100, COUNT = 600 };
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    vplRenderer* r;
    vplImage* image;
    vplTruth* truth;
    bool done;
    int bright = 0, dark = 0;
    double weights[2] = {0, 0};
    o.output.width = WIDTH;
    o.output.height = HEIGHT;
    o.method = VPL_METHOD_DIRECT;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    assert_int_equal(vplImage_Create(context, WIDTH, HEIGHT, &image), VPL_SUCCESS);
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        image->pixels[i] = i / 3 % WIDTH < WIDTH / 2 ? 1 : 1e-3f;
    }
    assert_int_equal(vplTruth_Create(&r->runner.run, image, COUNT, &truth), VPL_SUCCESS);
    const vplTruthState state = vplTruth_GetState(truth);
    for (int i = 0; i < state.count; i++) {
        const int x = state.pixels[i].x;
        if (x < WIDTH / 2 - 2 || x > WIDTH / 2 + 2) { // not at the edge between the halves
            bright += x < WIDTH / 2;
            dark += x > WIDTH / 2;
            weights[x < WIDTH / 2] += state.weights[i];
        }
    }
    assert_in_range(bright, COUNT / 4 - 10, COUNT / 4 + 2);
    assert_in_range(dark, COUNT / 12 - 5, COUNT / 12 + 2);
    assertNear(weights[0], 0.5, 0.07, "share of the dark half", 0);
    assertNear(weights[1], 0.5, 0.07, "share of the bright half", 1);
    vplTruth_Destroy(truth);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// Where the choice of pixels is most of what the truth does not know, or the error is near to what was asked, about four times as many
// confirm it; in a room lit by patches, noise of the truth's paths is most of it.
TEST(MorePixelsConfirmAnErrorBeforeItIsTaken, 2)
{
    static const struct {
        const char* scene;
        double error;
        bool confirmed;
    } ROWS[] = {{"garden", 0.05, true}, {"garden", 0.4, false}, {"room", 0.1, false}};
    for (int i = 0; i < 3; i++) {
        char path[64];
        snprintf(path, sizeof path, "examples/scenes/%s.json", ROWS[i].scene);
        vplScene* scene = openScene(context, path);
        vplRenderOptions o = smallOptions();
        vplRenderer* r;
        bool done = false;
        o.output.width = 120;
        o.output.height = 72;
        o.stop.maxError = ROWS[i].error;
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        while (!done) {
            assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        }
        assert_true((vplTruth_CountPixels(r->truth) > 2 * VPL_TRUTH_PIXELS) == ROWS[i].confirmed);
        assert_true(r->error.bound <= ROWS[i].error);
        vplRenderer_Destroy(r);
        vplScene_Destroy(scene);
    }
}

// Where hundreds of emitters light each sample of a pixel, pixels at edges have two samples if 10 % of error are allowed.
TEST(EdgesUnderManyLightsHaveFewSamples, 1)
{
    enum { MANY = 300 };
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = smallOptions();
    for (int i = 0; i < 3; i++) {
        vplEmitterDef emitter = vplDefaultEmitterDef();
        vplPlan* plan;
        o.stop.maxError = i == 2 ? 0.05 : 0.1;
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->options.output.antialias, i == 0 ? 8 : i == 1 ? 2 : 16);
        vplPlan_Destroy(plan);
        for (int k = 0; i == 0 && k < MANY; k++) {
            emitter.position = vplVec(0.01f * (float)k - 1.5f, 1, 0);
            assert_int_equal(vplScene_AddEmitter(scene, &emitter, NULL), VPL_SUCCESS);
        }
    }
    vplScene_Destroy(scene);
}

// 390 triangles are many for 144 pixels, and few for 576. What the user says is kept.
TEST(PassesOfManyTrianglesHaveMoreParticles, 1)
{
    static const struct {
        const char* words;
        int particles, growFrom;
    } CASES[] = {{"--size 16x9 --max-error 0.1", 4000, 1000},
                 {"--size 32x18 --max-error 0.1", 1000, 500},
                 {"--size 16x9 --budget 500", 4000, 500},
                 {"--size 16x9 --max-error 0.1 --particles 2000", 2000, 1000},
                 {"--size 16x9 --max-error 0.1 --grow-from 300", 4000, 300}};
    vplScene* scene = openScene(context, "examples/scenes/garden.json");
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        vplRenderOptions o = vplDefaultRenderOptions();
        vplPlan* plan;
        assert_int_equal(vplRenderOptions_SetAll(&o, CASES[i].words), VPL_SUCCESS);
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assertNear(plan->options.particles.count, CASES[i].particles, 0, "particles", (int)i);
        assertNear(plan->options.stop.growFrom, CASES[i].growFrom, 0, "first particles", (int)i);
        vplPlan_Destroy(plan);
    }
    vplScene_Destroy(scene);
}

// The mean square of the blocks' errors is that of the picture.
TEST(BlocksShareTheError, 2)
{
    static const vplMethod METHODS[] = {VPL_METHOD_AUTO, VPL_METHOD_PATH};
    vplScene* scene = loadScene(context, "room.json");
    for (int i = 0; i < 2; i++) {
        vplRenderOptions o = smallOptions();
        vplRenderer* r;
        vplImage *map, *image;
        vplRenderStats stats;
        double square = 0;
        o.method = METHODS[i];
        o.output.height = 40; // whole blocks
        o.stop.maxError = 0.1;
        assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
        stepToEnd(r);
        assert_int_equal(vplRenderer_GetErrorMap(r, &map), VPL_SUCCESS);
        assert_int_equal(vplRenderer_GetImage(r, &image, &stats), VPL_SUCCESS);
        assert_true(map->width == 8 && map->height == 5);
        for (int k = 0; k < 40; k++) {
            square += (double)map->pixels[3 * k] * (double)map->pixels[3 * k] / 40;
        }
        assert_true(fabs(sqrt(square) / stats.errorEstimate - 1) < 0.01);
        vplImage_Destroy(map);
        vplImage_Destroy(image);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
}
