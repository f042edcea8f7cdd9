// SPDX-License-Identifier: MIT
// Tests of rendering step by step: the same bits as one call, pictures at any time, and three stop criteria.
#include "scenes.h"

static vplRenderOptions progressiveOptions(void)
{
    vplRenderOptions o = plainOptions();
    o.method = VPL_METHOD_KELLER;
    o.output.width = 41;
    o.output.height = 31;
    o.shadow.mapSize = 64;
    o.particles.count = 20;
    o.lights.compensation = VPL_COMPENSATION_NONE;
    return o;
}

// Steps until done and gets the picture after every `look`-th step.
static uint64_t hashOfSteps(const vplScene* scene, const vplRenderOptions* o, int look, int* stepsOut)
{
    vplRenderer* r;
    assert_int_equal(vplRenderer_Create(scene, o, &r), VPL_SUCCESS);
    vplImage* image = NULL;
    int steps = 0;
    for (bool done = false; !done;) {
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        if (++steps % look == 0) {
            vplImage_Destroy(image);
            assert_int_equal(vplRenderer_GetImage(r, &image, NULL), VPL_SUCCESS);
            for (int k = 0; k < 3 * image->width * image->height; k++) {
                assert_true(isfinite(image->pixels[k]));
            }
        }
    }
    vplImage_Destroy(image);
    vplRenderStats stats;
    assert_int_equal(vplRenderer_GetImage(r, &image, &stats), VPL_SUCCESS);
    assert_int_equal(stats.passes, steps);
    uint64_t hash = vplImage_Hash(image);
    assert_true(hash == stats.imageHash);
    vplImage_Destroy(image);
    vplRenderer_Destroy(r);
    *stepsOut = steps;
    return hash;
}

// Covers every method, with one pass and with several; getting pictures between steps changes nothing.
TEST_ALONE(StepsGiveTheBitsOfOneCall, SLOW)
{
    static const vplMethod methods[] = {VPL_METHOD_INSTANT_RADIOSITY, VPL_METHOD_KELLER, VPL_METHOD_PATH,
                                        VPL_METHOD_DIRECT};
    for (int i = 0; i < 16; i++) {
        vplContext* context = openTestContext(1 + i % 3);
        vplScene* scene = loadScene(context, "room.json");
        vplRenderOptions o = progressiveOptions();
        o.method = methods[i % 4];
        o.stop.passes = i / 4 % 2 ? 5 : 0;
        o.path.samples = i / 4 % 2 ? 70 : 20;
        vplRenderStats stats;
        vplImage_Destroy(renderScene(scene, &o, &stats));
        int steps;
        assert_true(hashOfSteps(scene, &o, i / 8 ? 1 : 100, &steps) == stats.imageHash);
        const int several = o.method == VPL_METHOD_PATH ? 3 : o.method == VPL_METHOD_DIRECT ? 1 : 5;
        assert_int_equal(steps, i / 4 % 2 ? several : 1);
        assert_int_equal(stats.passes, steps);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

static vplImage* truthOf(const vplScene* scene, const vplRenderOptions* like)
{
    vplRenderOptions o = *like;
    o.method = VPL_METHOD_PATH;
    o.path.pixel = VPL_PIXEL_CENTRE;
    o.path.samples = 1024;
    o.stop.passes = 0;
    return renderScene(scene, &o, NULL);
}

// The error decreases with passes, and the estimate from the passes' two halves is of the same size.
TEST(MorePassesAreBetterAndSaySo, 2, SLOW)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = progressiveOptions();
    o.lights.shadows = VPL_LIGHT_SHADOWS_RAY;
    o.particles.reflectivity = -1;
    vplImage* truth = truthOf(scene, &o);
    double before = INFINITY;
    for (o.stop.passes = 2; o.stop.passes <= 128; o.stop.passes *= 8) {
        vplRenderStats stats;
        vplComparison m;
        vplImage* image = renderScene(scene, &o, &stats);
        assert_int_equal(vplImage_Compare(image, truth, &m), VPL_SUCCESS);
        assert_true(m.rmse < 0.7 * before); // clamped light near surfaces keeps the ratio above 0.35
        before = m.rmse;
        // Low-discrepancy halves differ by more than the error of their mean; the estimate does not include
        // light lost by clamping and by omitted steps.
        assert_true(stats.errorEstimate > 0.3 * m.rmse && stats.errorEstimate < 3 * m.rmse);
        vplImage_Destroy(image);
    }
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
}

TEST(AnErrorOrATimeEndsIt, 2, SLOW)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = progressiveOptions();
    vplRenderStats stats;
    o.stop.maxError = 0.08; // lights without shadows are no way to it
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_true(stats.relativeErrorEstimate > 0.08 && stats.relativeBias > stats.relativeNoise);
    assert_non_null(strstr(takeMessage(), "which more passes do not mend"));
    o.stop.passes = 3; // the first criterion that holds ends the render
    o.stop.growFrom = o.particles.count;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_int_equal(stats.passes, 3);
    assert_non_null(strstr(takeMessage(), "--passes or --spp ended the render"));
    o.stop.maxError = o.stop.passes = 0;
    o.stop.budgetMs = 1e-6; // the first picture is always done
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_int_equal(stats.passes, 1);
    o.stop.budgetMs = 300 * TEST_SLOWDOWN;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    assert_true(stats.passes > 1);
    vplScene_Destroy(scene);
}

// Path tracing stops at its error threshold, too.
TEST(PathsEndByTheirError, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = progressiveOptions();
    o.method = VPL_METHOD_PATH;
    o.stop.maxError = 0.05;
    vplRenderStats stats;
    vplImage_Destroy(renderScene(scene, &o, &stats));
    print_message("# %d passes, error %.4f\n", stats.passes, stats.relativeErrorEstimate);
    assert_true(stats.relativeErrorEstimate <= 0.05 && stats.passes > 2 &&
                stats.passes < 128); // not 64 paths
    vplScene_Destroy(scene);
}

static bool stopAtHalf(void* user, double fraction)
{
    *(double*)user = fraction;
    return fraction < 0.5;
}

TEST(StepsAreCancelledAndNeedAFirst, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    vplRenderOptions o = progressiveOptions();
    vplRenderer* r;
    vplImage* image = NULL;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_GetImage(r, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "before its first step"));
    vplRenderer_Destroy(r);
    vplRenderer_Destroy(NULL);
    double last = 0;
    o.stop.passes = 10;
    o.progress = stopAtHalf;
    o.progressUser = &last;
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_CANCELLED);
    assert_true(last >= 0.5 && last < 0.62);
    assert_null(image);
    o.stop.passes = VPL_MAX_PASSES + 1;
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
    o.stop.passes = 0;
    o.stop.budgetMs = NAN;
    assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
    vplScene_Destroy(scene);
}
