// SPDX-License-Identifier: MIT
// Tests of --pixel-size: pictures that are rendered with fewer pixels and enlarged, by choice or for want of time.
#include "shapes.h"

#include "base/clock.h"
#include "image/enlarge.h"
#include "render/planner/time_plan.h"
#include "render/renderer.h"

#include <vpl/imagetools.h>

#include <math.h>
#include <string.h>

// ---- enlarging

// A picture whose value is linear in the position, in pixels of a picture of 12 x 8.
static vplImage* ramp(vplContext* context, int width, int height)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, width, height, &image), VPL_SUCCESS);
    for (int y = 0; y < height; y++) {
        for (int x = 0; x < width; x++) {
            for (int k = 0; k < 3; k++) {
                image->pixels[3 * (y * width + x) + k] =
                    (float)(k + (x + 0.5) * 12 / width + 100 * (y + 0.5) * 8 / height);
            }
        }
    }
    return image;
}

TEST(AnEnlargedRampIsARamp, 2)
{
    vplImage *small = ramp(context, 4, 4), *wanted = ramp(context, 12, 8), *large, *same;
    assert_int_equal(vplImage_Enlarge(small, 12, 8, &large), VPL_SUCCESS);
    assert_int_equal(vplImage_Enlarge(small, 4, 4, &same), VPL_SUCCESS);
    assert_true(vplImage_Hash(same) == vplImage_Hash(small));
    for (int y = 0; y < 8; y++) {
        for (int x = 0; x < 12; x++) {
            // Beside the border the nearest pixel of the small picture is repeated.
            const int column = x < 1 ? 1 : x > 10 ? 10 : x, row = y < 1 ? -1 : y > 6 ? -2 : y;
            for (int k = 0; k < 3; k++) {
                const double across = wanted->pixels[3 * column + k] - wanted->pixels[k];
                const double down = row == -1 ? 100.0 : row == -2 ? 700.0 : 100 * (y + 0.5);
                assertNear(large->pixels[3 * (12 * y + x) + k], k + 0.5 + across + down, 1e-4, "value", x);
            }
        }
    }
    vplImage* images[] = {small, wanted, large, same};
    for (int i = 0; i < 4; i++) {
        vplImage_Destroy(images[i]);
    }
}

TEST(OnePixelFillsAPicture, 1)
{
    vplImage *small = ramp(context, 1, 1), *large;
    assert_int_equal(vplImage_Enlarge(small, 5, 3, &large), VPL_SUCCESS);
    for (int i = 0; i < 15; i++) {
        assert_true(memcmp(large->pixels + 3 * i, small->pixels, 3 * sizeof(float)) == 0);
    }
    vplImage_Destroy(small);
    vplImage_Destroy(large);
}

// ---- pictures

static const char* const METHODS[][8] = {
    {"method", "direct"},
    {"method", "instant-radiosity", "particles", "100"},
    {"method", "keller", "particles", "100", "passes", "2"},
    {"method", "keller", "particles", "100", "placement", "view", "pipeline", "deferred"},
    {"method", "ssvp", "first-bounce", "100", "second-bounce", "50", "clusters", "8"},
    {"method", "radiosity", "patches", "100"},
    {"method", "path", "spp", "4"},
};
enum { METHOD_COUNT = sizeof METHODS / sizeof *METHODS };

static vplRenderOptions optionsFor(int method, int width, int height, int pixelSize)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    for (int i = 0; i < 8 && METHODS[method][i] != NULL; i += 2) {
        assert_int_equal(vplRenderOptions_Set(&o, METHODS[method][i], METHODS[method][i + 1]), VPL_SUCCESS);
    }
    o.output.width = width;
    o.output.height = height;
    o.output.pixelSize = pixelSize;
    return o;
}

// The picture has the bits of one with fewer pixels that was enlarged.
TEST(LargePixelsAreThoseOfASmallPicture, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    for (int method = 0; method < METHOD_COUNT; method++) {
        const vplRenderOptions large = optionsFor(method, 64, 48, 4), small = optionsFor(method, 16, 12, 1);
        vplImage *shown = renderScene(scene, &large, NULL), *base = renderScene(scene, &small, NULL), *wanted;
        assert_int_equal(vplImage_Enlarge(base, 64, 48, &wanted), VPL_SUCCESS);
        if (vplImage_Hash(shown) != vplImage_Hash(wanted)) {
            fail_msg("%s", METHODS[method][1]);
        }
        vplImage_Destroy(shown);
        vplImage_Destroy(base);
        vplImage_Destroy(wanted);
    }
    vplScene_Destroy(scene);
}

// What a history keeps of one size of pixels is not used for another.
TEST(AHistoryKnowsTheSizeOfPixels, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/room-area.json");
    Shape sphere = icosphere(4); // many triangles per pixel: passes share a G-buffer
    placeShape(&sphere, 0.4f, (double[3]){0, 0, 0}, (vplVec3){0.3f, 1, 0.5f});
    addShape(scene, &sphere, true, NULL);
    freeShape(&sphere);
    for (int method = 0; method < METHOD_COUNT; method++) {
        vplHistory* history;
        assert_int_equal(vplHistory_Create(context, &history), VPL_SUCCESS);
        for (int pixelSize = 4; pixelSize > 0; pixelSize -= 3) {
            const vplRenderOptions fresh = optionsFor(method, 32, 24, pixelSize);
            vplRenderOptions kept = fresh;
            kept.sequence.history = history;
            kept.sequence.coherence = VPL_COHERENCE_OFF;
            vplImage *a = renderScene(scene, &fresh, NULL), *b = renderScene(scene, &kept, NULL);
            if (vplImage_Hash(a) != vplImage_Hash(b)) {
                fail_msg("%s, pixel size %d", METHODS[method][1], pixelSize);
            }
            vplImage_Destroy(a);
            vplImage_Destroy(b);
        }
        vplHistory_Destroy(history);
    }
    vplScene_Destroy(scene);
}

// In sizes that 4 does not divide, the picture shows the same as one of all pixels.
TEST(LargePixelsNeedNotDivideThePicture, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/room.json");
    for (int pixelSize = 2; pixelSize <= 64; pixelSize *= 2) {
        const vplRenderOptions coarse = optionsFor(1, 61, 43, pixelSize), fine = optionsFor(1, 61, 43, 1);
        vplImage *a = renderScene(scene, &coarse, NULL), *b = renderScene(scene, &fine, NULL);
        vplComparison c;
        double ssim;
        assert_true(a->width == 61 && a->height == 43);
        assert_int_equal(vplImage_Compare(a, b, &c), VPL_SUCCESS);
        assert_int_equal(vplImage_Ssim(a, b, &ssim, NULL), VPL_SUCCESS);
        const double least = pixelSize == 2 ? 0.85 : pixelSize == 4 ? 0.65 : 0.2;
        if (!(ssim > least && (pixelSize > 8 || fabs(c.energyRatio - 1) < 0.05))) {
            fail_msg("%d: SSIM %g, energy %g", pixelSize, ssim, c.energyRatio);
        }
        vplImage_Destroy(a);
        vplImage_Destroy(b);
    }
    vplScene_Destroy(scene);
}

TEST(WhatNeedsEachPixelRefusesLargeOnes, 1)
{
    static const char* const WITH[][6] = {
        {"method", "keller", "passes", "2", "edge-pixels", "9"},
        {"method", "instant-radiosity", "show", "shadow-map"},
        {"budget", "100"},
        {"max-error", "0.1"},
        {"quality", "draft"},
        {"pixel-size", "65"},
        {"pixel-size", "0"},
    };
    vplScene* scene = openScene(context, "examples/scenes/room.json");
    for (size_t i = 0; i < sizeof WITH / sizeof *WITH; i++) {
        vplRenderOptions o = optionsFor(0, 16, 16, 2);
        o.method = VPL_METHOD_AUTO;
        vplImage* image;
        vplResult result = VPL_SUCCESS;
        for (int k = 0; k < 6 && WITH[i][k] != NULL && result == VPL_SUCCESS; k += 2) {
            result = vplRenderOptions_Set(&o, WITH[i][k], WITH[i][k + 1]);
        }
        result = result == VPL_SUCCESS ? vplRender(scene, &o, &image, NULL) : result;
        if (result != VPL_INVALID_ARGUMENT) {
            fail_msg("%s %s: %s", WITH[i][0], WITH[i][1], vplResult_GetName(result));
        }
    }
    vplRenderOptions o = optionsFor(0, 16, 16, 2);
    vplLayers* layers;
    o.output.aovs = VPL_AOV_DEPTH;
    assert_int_equal(vplRenderLayers(scene, &o, &layers, NULL), VPL_INVALID_ARGUMENT);
    vplScene_Destroy(scene);
}

// ---- for want of time

// Renders with machines that are foreseen to be so many times slower, and returns the size of the pixels of the first plan.
static int firstPixelSize(vplContext* context, const vplScene* scene, vplMethod method, double times,
                          vplRenderer** rendererOut)
{
    const vplSpeeds slow = slowerSpeeds(times);
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = method;
    o.output.width = 96;
    o.output.height = 54;
    o.stop.budgetMs = 1e7; // so that the time that planning takes does not count
    assert_int_equal(vplContext_SetSpeeds(context, &slow), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Create(scene, &o, rendererOut), VPL_SUCCESS);
    return (*rendererOut)->plan->options.output.pixelSize;
}

// What is foreseen is wrong here: much time is left after the coarse picture, and another one with all pixels follows.
TEST(LittleTimeMakesPixelsLarger, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    vplRenderer* r;
    bool done;
    assert_int_equal(firstPixelSize(context, scene, VPL_METHOD_AUTO, 1, &r), 1);
    vplRenderer_Destroy(r);
    assert_int_equal(firstPixelSize(context, scene, VPL_METHOD_AUTO, 1e10, &r), 8);
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    assert_false(done);
    for (int pixelSize = 8; pixelSize > 0; pixelSize = pixelSize == 8 ? 1 : 0) {
        vplImage *shown, *again;
        while (pixelSize == 1 && !done) {
            assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
        }
        const vplRenderOptions replay = vplRenderer_GetPlan(r)->options;
        assert_int_equal(replay.output.pixelSize, pixelSize);
        assert_int_equal(vplRenderer_GetImage(r, &shown, NULL), VPL_SUCCESS);
        assert_true(shown->width == 96 && shown->height == 54);
        again = renderScene(scene, &replay, NULL);
        assert_true(vplImage_Hash(shown) == vplImage_Hash(again));
        vplImage_Destroy(shown);
        vplImage_Destroy(again);
    }
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
    assert_int_equal(vplContext_SetSpeeds(context, NULL), VPL_SUCCESS);
}

// The methods that callers choose begin with large pixels, too, and SSVP without the bounces behind the second.
TEST(AllMethodsBeginWithLargePixels, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    for (vplMethod method = VPL_METHOD_INSTANT_RADIOSITY; method < VPL_METHOD_AUTO; method++) {
        vplRenderer* r;
        bool done;
        assert_int_equal(firstPixelSize(context, scene, method, 1, &r), 1);
        vplRenderer_Destroy(r);
        assert_int_equal(firstPixelSize(context, scene, method, 1e10, &r), 8);
        assert_true(r->coarse && r->plan->options.method == method);
        assert_true(method != VPL_METHOD_SSVP || r->plan->options.maxBounces == 2);
        assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS); // was quicker than foreseen
        assert_true(method != VPL_METHOD_SSVP || r->plan->options.maxBounces > 2);
        assert_false(done);
        assert_int_equal(r->plan->options.output.pixelSize, 1);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
    assert_int_equal(vplContext_SetSpeeds(context, NULL), VPL_SUCCESS);
}

// Pixels become as small as the time allows that the coarse picture took; if no smaller ones fit, they get more paths.
TEST(PathsFillTheTime, 2)
{
    static const struct {
        double left, took; // ms
        int pixelSize;
    } CASES[] = {{1e6, 1e3, 1}, {1e6, 1e5, 3}, {1e6, 7e5, 8}, {1e6, 1e9, 8}};
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    for (size_t i = 0; i < sizeof CASES / sizeof *CASES; i++) {
        vplRenderer* r;
        bool done;
        assert_int_equal(firstPixelSize(context, scene, VPL_METHOD_PATH, 1e10, &r), 8);
        assert_int_equal(vplRenderer_RunPass(r), VPL_SUCCESS);
        r->done = 1;
        r->passMs = CASES[i].took;
        r->deadline = vplClockMs() + CASES[i].left;
        assert_int_equal(vplFollowCoarse(r, &done), VPL_SUCCESS);
        const vplRenderOptions* o = &r->plan->options;
        if (o->output.pixelSize != CASES[i].pixelSize) {
            fail_msg("%zu: %d", i, o->output.pixelSize);
        }
        const bool more = CASES[i].pixelSize == 8; // in the same plan
        assert_int_equal(r->paths, more ? 1 : 0);
        assert_int_equal(o->path.samples, CASES[i].pixelSize == 3 ? 1 : VPL_MAX_SAMPLES);
        assert_int_equal(r->coarse, CASES[i].pixelSize == 3);
        vplRenderer_Destroy(r);
    }
    vplScene_Destroy(scene);
    assert_int_equal(vplContext_SetSpeeds(context, NULL), VPL_SUCCESS);
}
