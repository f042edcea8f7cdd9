// SPDX-License-Identifier: MIT
// Tests of coverage antialiasing: pictures are near those of whole renders per sample, only pixels at edges
// and at rims of shadows change, and bits are the same everywhere.
#include "scenes.h"
#include "shapes.h"

#include "math/vec.h"
#include "shading/edges.h"
#include "shading/facet_cache.h"

#include <stdlib.h>

enum { WIDTH = 160, HEIGHT = 90 };

// ---- pictures

// Renders with options from a list of names and values that ends in NULL.
static vplImage* renderWith(const vplScene* scene, const char* const* words, const char* name,
                            const char* value)
{
    vplRenderOptions o = plainOptions();
    o.output.width = WIDTH;
    o.output.height = HEIGHT;
    for (; *words != NULL; words += 2) {
        assert_int_equal(vplRenderOptions_Set(&o, words[0], words[1]), VPL_SUCCESS);
    }
    assert_int_equal(vplRenderOptions_Set(&o, name, value), VPL_SUCCESS);
    return renderScene(scene, &o, NULL);
}

// Leaves out the bright spot above the lamp, which changes within a pixel without an edge.
static double rmseOf(const vplImage* a, const vplImage* b)
{
    enum { TOP = 24 };
    vplComparison c;
    vplImage* below[2];
    assert_int_equal(vplImage_Crop(a, 0, TOP, WIDTH, HEIGHT - TOP, &below[0]), VPL_SUCCESS);
    assert_int_equal(vplImage_Crop(b, 0, TOP, WIDTH, HEIGHT - TOP, &below[1]), VPL_SUCCESS);
    assert_int_equal(vplImage_Compare(below[0], below[1], &c), VPL_SUCCESS);
    vplImage_Destroy(below[0]);
    vplImage_Destroy(below[1]);
    return c.relativeRmse;
}

// Boxes and quads that emit, or reflect the light of an emitter in the camera, whose shadows the camera does
// not see.
static vplScene* cloudScene(vplContext* context, uint64_t seed, bool emits)
{
    vplScene* scene = sceneOf(context, 0);
    aim(scene, vplVec(0, 0, 6), vplVec(0, 0, 0));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0, 0, 6), vplVec(0, 0, -1), 30);
    for (int i = 0; i < 40; i++) {
        const uint64_t at = 16 * (uint64_t)i;
        const float level = 0.1f * (float)(1 + i % 7), rho = emits ? 0 : level;
        const int material = addMaterial(scene, (vplRgb){rho, rho, rho}, level - rho);
        const double thin = i % 3 == 0 ? 0.01 : 1;
        addThing(scene, i % 2 ? VPL_OBJECT_BOX : VPL_OBJECT_QUAD, material,
                 vplVec((float)(8 * uniformAt(seed, at) - 4), (float)(5 * uniformAt(seed, at + 1) - 2.5),
                        (float)(4 * uniformAt(seed, at + 2) - 2)),
                 6 * uniformAt(seed, at + 3), 6 * uniformAt(seed, at + 4),
                 vplVec((float)(0.2 + uniformAt(seed, at + 5)),
                        (float)(thin * (0.2 + uniformAt(seed, at + 6))),
                        (float)(0.2 + uniformAt(seed, at + 7))));
    }
    return scene;
}

static const char* const BARE[] = {"method",     "direct", "light-shadows", "ray", "lighting",
                                   "documented", NULL};

// Both see the same points of pixels; only corners are snapped to 1/256 pixel at other places.
TEST(CoverageIsThatOfWholePictures, 2)
{
    for (uint64_t seed = 0; seed < 3; seed++) {
        vplScene* scene = cloudScene(context, seed, false);
        vplImage* smooth = renderWith(scene, BARE, "antialias", "8");
        vplImage* whole = renderWith(scene, BARE, "supersample", "9"); // 8 samples and the centre
        vplImage* hard = renderWith(scene, BARE, "antialias", "1");
        int apart = 0, edges = 0;
        for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
            const double wanted = (double)whole->pixels[i], least = 0.03; // light varies within a pixel
            apart += fabs((double)smooth->pixels[i] - wanted) > least;
            edges += fabs((double)hard->pixels[i] - wanted) > least;
        }
        print_message("# %d values at edges, %d apart\n", edges, apart);
        assert_true(edges > 1000);
        assert_true(apart < edges / 100);
        vplImage_Destroy(smooth);
        vplImage_Destroy(whole);
        vplImage_Destroy(hard);
        vplScene_Destroy(scene);
    }
}

// The mean emission of pixels at edges is found by more rays than there are samples.
TEST(EdgesOfLampsAreFinerThanSamples, 2)
{
    for (uint64_t seed = 0; seed < 3; seed++) {
        vplScene* scene = cloudScene(context, seed, true);
        vplImage* truth = renderWith(scene, BARE, "supersample", "1024");
        vplImage* smooth = renderWith(scene, BARE, "antialias", "8");
        vplImage* whole = renderWith(scene, BARE, "supersample", "9");
        const double error = rmseOf(smooth, truth), samples = rmseOf(whole, truth);
        print_message("# relative rmse %.4f, of 9 pictures %.4f\n", error, samples);
        assert_true(error < 0.8 * samples);
        vplImage_Destroy(truth);
        vplImage_Destroy(smooth);
        vplImage_Destroy(whole);
        vplScene_Destroy(scene);
    }
}

// ---- all methods

static const char* const WAYS[][9] = {
    {"method", "direct"},
    {"method", "instant-radiosity", "particles", "40"},
    {"method", "instant-radiosity", "particles", "64", "pipeline", "interleaved"},
    {"method", "keller", "particles", "24", "compensation", "none"},
    {"method", "instant-radiosity", "particles", "64", "pipeline", "lightcuts"},
    {"method", "ssvp", "first-bounce", "64", "second-bounce", "64"},
    {"method", "radiosity", "patches", "200"},
};
enum { WAY_COUNT = sizeof WAYS / sizeof *WAYS };

// The error of pictures at edges falls by more than the noise of lights lets remain.
TEST(EdgesComeNearTheTruth, 2, SLOW)
{
    vplScene* scene = openScene(context, "examples/scenes/room.json");
    for (int way = 0; way < WAY_COUNT; way++) {
        vplImage* truth = renderWith(scene, WAYS[way], "supersample", "64");
        vplImage* hard = renderWith(scene, WAYS[way], "antialias", "1");
        vplImage* smooth = renderWith(scene, WAYS[way], "antialias", "8");
        const double before = rmseOf(hard, truth), after = rmseOf(smooth, truth);
        print_message("# way %d: relative rmse %.4f, with 8 samples %.4f\n", way, before, after);
        assert_true(after < before / 2.5);
        vplImage_Destroy(truth);
        vplImage_Destroy(hard);
        vplImage_Destroy(smooth);
    }
    vplScene_Destroy(scene);
}

// A picture of one plane has no edges: not a bit changes.
TEST(WithoutEdgesNoBitChanges, 2)
{
    vplScene* scene = sceneOf(context, 0.5f);
    aim(scene, vplVec(0, 1, 0), vplVec(0.01f, 0, 0));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0.3f, 2, 0.2f), vplVec(0, -1, 0), 3);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), -VPL_PI / 2, 0, vplVec(100, 100, 1));
    for (int way = 0; way < WAY_COUNT - 1; way++) { // the patches of the last one are triangles of their own
        vplImage* hard = renderWith(scene, WAYS[way], "antialias", "1");
        vplImage* smooth = renderWith(scene, WAYS[way], "antialias", "16");
        assert_true(hard->pixels[0] > 0);
        assert_true(vplImage_Hash(hard) == vplImage_Hash(smooth));
        vplImage_Destroy(hard);
        vplImage_Destroy(smooth);
    }
    vplScene_Destroy(scene);
}

// Stripes of two reflectances finer than a pixel, more than tiles keep for the filter of interleaved shading.
TEST(MoreEdgesThanATileKeepsAreLitAsWell, 2)
{
    vplScene* scene = sceneOf(context, 0.2f);
    const int bright = addMaterial(scene, (vplRgb){0.9f, 0.5f, 0.1f}, 0);
    aim(scene, vplVec(0, 2, 0), vplVec(0.01f, 0, 0));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0.3f, 1.5f, 0.2f), vplVec(0, -1, 0), 3);
    for (int i = 0; i < 240; i++) {
        addThing(scene, VPL_OBJECT_QUAD, i % 2 ? 0 : bright, vplVec(0.02f * (float)(i - 120), 0, 0),
                 -VPL_PI / 2, 0, vplVec(0.02f, 4, 1));
    }
    const char* const deferred[] = {"particles", "64", NULL};
    const char* const shared[] = {"particles", "64", "pipeline", "interleaved", NULL};
    vplImage* wanted = renderWith(scene, deferred, "antialias", "8");
    vplImage* found = renderWith(scene, shared, "antialias", "8");
    assert_true(rmseOf(found, wanted) < 0.02);
    vplImage_Destroy(wanted);
    vplImage_Destroy(found);
    vplScene_Destroy(scene);
}

// ---- rims of shadows

// A plane under an emitter, and things above the picture that throw shadows on it: a large one at an angle,
// and bars whose shadows are thinner than a pixel, along an axis and at an angle.
static vplScene* shadowScene(vplContext* context, vplEmitterType type)
{
    vplScene* scene = sceneOf(context, 0.5f);
    aim(scene, vplVec(0, 3, 0), vplVec(0.01f, 0, 0));
    addEmitter(scene, type, vplVec(0, 8, 0), vplVec(0, -1, 0), type == VPL_EMITTER_DIRECTIONAL ? 2 : 100);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), -VPL_PI / 2, 0, vplVec(100, 100, 1));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(-0.6f, 6, 0.2f), 0, 0.7, vplVec(0.4f, 0.02f, 0.3f));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.4f, 6, 0.331f), 0, 0, vplVec(0.9f, 0.02f, 0.004f));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.5f, 6, -0.4f), 0, 0.3, vplVec(0.7f, 0.02f, 0.003f));
    return scene;
}

static const char* const HARD[] = {"method", "direct", "light-shadows", "ray", NULL};

TEST(RimsOfShadowsComeNearTheTruth, 2, SLOW)
{
    const vplEmitterType types[] = {VPL_EMITTER_POINT, VPL_EMITTER_DIRECTIONAL};
    for (int i = 0; i < 2; i++) {
        vplScene* scene = shadowScene(context, types[i]);
        vplImage* truth = renderWith(scene, HARD, "supersample", "256");
        vplImage* hard = renderWith(scene, HARD, "antialias", "1");
        vplImage* smooth = renderWith(scene, HARD, "antialias", "8");
        vplImage* whole = renderWith(scene, HARD, "supersample", "9");
        const double before = rmseOf(hard, truth), after = rmseOf(smooth, truth),
                     least = rmseOf(whole, truth);
        print_message("# relative rmse %.4f, smooth %.4f, 9 pictures %.4f\n", before, after, least);
        assert_true(least < before / 3);
        assert_true(after < 1.3 * least);
        vplImage_Destroy(truth);
        vplImage_Destroy(hard);
        vplImage_Destroy(smooth);
        vplImage_Destroy(whole);
        vplScene_Destroy(scene);
    }
}

// Both see the same points of pixels, and the plane is one surface.
TEST(SmoothRimsAreThoseOfWholePictures, 2)
{
    vplScene* scene = shadowScene(context, VPL_EMITTER_POINT);
    vplImage* smooth = renderWith(scene, HARD, "antialias", "8");
    vplImage* whole = renderWith(scene, HARD, "supersample", "9");
    int apart = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        apart += fabs((double)smooth->pixels[3 * i] / (double)whole->pixels[3 * i] - 1) > 1e-3;
    }
    print_message("# %d pixels apart\n", apart);
    assert_int_equal(apart, 0);
    vplImage_Destroy(smooth);
    vplImage_Destroy(whole);
    vplScene_Destroy(scene);
}

static uint64_t hashAll(vplContext* context)
{
    vplScene* scene = shadowScene(context, VPL_EMITTER_DIRECTIONAL);
    vplImage* rims = renderWith(scene, HARD, "antialias", "8");
    uint64_t hash = vplImage_Hash(rims);
    vplImage_Destroy(rims);
    vplScene_Destroy(scene);
    scene = openScene(context, "examples/scenes/room.json");
    for (int way = 1; way < WAY_COUNT; way++) {
        vplImage* image = renderWith(scene, WAYS[way], "antialias", "5");
        hash = hash * 31 + vplImage_Hash(image);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(SmoothEdgesAreTheSameEverywhere, SLOW)
{
    assertSameEverywhere(hashAll);
}

// ---- the plan

TEST(StagesAndPassesAreNotSmoothed, 1)
{
    const char* const without[][2] = {
        {"show", "normals"}, {"pipeline", "multipass"}, {"pipeline", "batched"}, {"supersample", "2"}};
    vplScene* scene = openScene(context, "examples/scenes/room.json");
    for (int i = 0; i < 4; i++) {
        vplRenderOptions o = plainOptions();
        vplPlan* plan;
        assert_int_equal(vplRenderOptions_Set(&o, "antialias", "8"), VPL_SUCCESS);
        assert_int_equal(vplRenderOptions_Set(&o, without[i][0], without[i][1]), VPL_SUCCESS);
        assert_int_equal(vplPlan_Create(scene, &o, NULL, &plan), VPL_SUCCESS);
        assert_int_equal(plan->options.output.antialias, 1);
        vplPlan_Destroy(plan);
    }
    vplRenderOptions o = plainOptions();
    o.output.antialias = VPL_MAX_SAMPLES_PER_PIXEL + 1;
    assert_int_equal(vplRender(scene, &o, &(vplImage*){NULL}, NULL), VPL_INVALID_ARGUMENT);
    vplScene_Destroy(scene);
}

// Whichever samples show a surface, it is lit at the one of them that is nearest to the mean of all.
TEST(SurfacesAreLitAtTheMiddleOfTheirSamples, 1)
{
    enum { COUNT = 8 };
    vplGeometry* g = clutter(context, 0);
    const vplView view = {.width = 1, .height = 1, .scaleX = 1, .scaleY = 1, .forward = vplVec(0, 0, -1)};
    const vplShadeDef def = vplDefaultShadeDef();
    const vplShading shading = vplShading_Make(g, &view, &def);
    vplFacetCache cache;
    vplFacetCache_Clear(&cache);
    int32_t shown[COUNT];
    vplTile tile = {.sampleCount = COUNT};
    for (uint32_t set = 1; set < 1u << COUNT; set++) {
        double x = 0, y = 0, least = INFINITY;
        for (int i = 0; i < COUNT; i++) {
            tile.samples[i] = &shown[i];
            shown[i] = set >> i & 1 ? 0 : -1;
            x += (set >> i & 1) * (double)vplSubPixel_OfSample(i, COUNT).x / __builtin_popcount(set);
            y += (set >> i & 1) * (double)vplSubPixel_OfSample(i, COUNT).y / __builtin_popcount(set);
        }
        vplEdgePixel pixel = {.triangle = -1};
        vplFindEdges(&shading, &tile, 0, &cache, &pixel);
        assert_int_equal(pixel.count, 1);
        const int named = pixel.others[0].sample;
        assert_true(set >> named & 1);
        double away[COUNT];
        for (int i = 0; i < COUNT; i++) {
            const vplSubPixel at = vplSubPixel_OfSample(i, COUNT);
            away[i] = hypot(at.x - x, at.y - y);
            least = set >> i & 1 ? fmin(least, away[i]) : least;
        }
        assert_true(away[named] <= least + 1e-9);
    }
    vplGeometry_Destroy(g);
}
