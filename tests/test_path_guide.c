// SPDX-License-Identifier: MIT
// Tests of guided paths: any guide leaves the mean as it is, and the one of patches chooses as it says.
#include "path_scenes.h"

#include "base/arena.h"
#include "geometry/triangle.h"
#include "radiosity/sides/side.h"
#include "radiosity/solve/senders.h"
#include "render/renderer.h"
#include "render/stages/make.h"
#include "render/stages/results.h"

#include <string.h>

// ---- a guide that knows nothing: any point of any triangle sends light; each third place receives none, and each seventh triangle is no place

static int findTriangle(const void* data, const vplHit* hit, vplVec3 direction)
{
    const bool back =
        direction.x * hit->normal.x + direction.y * hit->normal.y + direction.z * hit->normal.z > 0;
    (void)data;
    return hit->triangle % 7 == 6 ? -1 : 2 * hit->triangle + back;
}

static bool receivesLight(const void* data, int place)
{
    (void)data;
    return place % 3 != 0;
}

static vplGuidePoint chooseAnywhere(const void* data, int place, const float u[3])
{
    const vplGeometry* g = data;
    const int sender = (int)((float)(2 * g->triangleCount) * u[0]);
    const vplHit hit = vplGeometry_SampleTriangle(g, sender / 2, u[1], u[2]);
    (void)place;
    return (vplGuidePoint){sender, sender / 2, hit.position};
}

static double densityAnywhere(const void* data, int place, int sender)
{
    const vplGeometry* g = data;
    (void)place;
    return 1 / (2.0 * g->triangleCount * vplGeometry_TriangleArea(g, sender / 2));
}

// Traces the same paths with and without such a guide.
static void compareMeans(const vplScene* scene, const vplPathDef* def, int row)
{
    vplGeometry* g;
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    const vplPathGuide guide = {findTriangle, receivesLight, chooseAnywhere, densityAnywhere, g};
    vplPathDef guided = *def;
    vplPathStats stats, other;
    guided.guide = &guide;
    guided.seed = 1;
    vplImage *plain = traceWith(scene, g, def, 256, &stats),
             *found = traceWith(scene, g, &guided, 512, &other);
    const double predicted =
        stats.errorEstimate * stats.errorEstimate + other.errorEstimate * other.errorEstimate;
    assert_true(other.relativeErrorEstimate < 0.04); // else the rest proves nothing
    assertNear(sqrt(squaredDifference(plain, found) / predicted), 1, 0.2, "found / predicted", row);
    for (int c = 0; c < 2; c++) { // mean of 576 pixels: three standard deviations
        assertNear(meanOfImage(found, c), meanOfImage(plain, c), 2 * 3 * sqrt(predicted) / 24, "mean", row);
    }
    vplImage_Destroy(plain);
    vplImage_Destroy(found);
    vplGeometry_Destroy(g);
}

TEST(AnyGuideFindsTheSameLight, 2, SLOW)
{
    static const int VERTICES[] = {0, 1, VPL_MOST_LIGHT_VERTICES};
    vplScene* scene = addAllLights(newScene(context), 2);
    for (size_t i = 0; i < sizeof VERTICES / sizeof *VERTICES; i++) {
        vplPathDef def = vplDefaultPathDef();
        def.emission = false; // aliasing at visible emitters would dominate the error
        def.lastBounce = def.mostBounces = 5;
        def.lightVertices = VERTICES[i];
        compareMeans(scene, &def, (int)i);
    }
    vplScene_Destroy(scene);
}

// Guided paths find light of the sky only where they are reflected.
TEST(AnyGuideFindsTheSameSky, 2, SLOW)
{
    vplScene* scene = newScene(context);
    vplEnvironmentDef sky = vplDefaultEnvironmentDef();
    sky.type = VPL_ENVIRONMENT_CONSTANT;
    sky.radiance = (vplRgb){0.2f, 0.3f, 0.5f};
    assert_int_equal(vplScene_SetEnvironment(scene, &sky), VPL_SUCCESS);
    addQuad(scene, addGrey(scene, 0.6f, 0), (vplVec3){0, -1, 0}, -1, 4);
    addQuad(scene, addGrey(scene, 0.3f, 4), (vplVec3){0.3f, 0.6f, 0}, 1, 0.5f);
    addSphere(scene, addGrey(scene, 0.8f, 0), (vplVec3){-0.4f, -0.5f, 0}, 0.4f, 2, true);
    addCamera(scene, (vplVec3){0, 0, 2}, (vplVec3){0, -0.4f, -1}, 1);
    vplPathDef def = vplDefaultPathDef();
    def.emission = false;
    def.lastBounce = def.mostBounces = 5;
    compareMeans(scene, &def, 0);
    def.lightVertices = 0;
    compareMeans(scene, &def, 1);
    vplScene_Destroy(scene);
}

// ---- which sides send light

enum { SIDES = 70, CHOICES = 4096 };

// More sides than a block has, of which some send nothing and one receives nothing.
TEST(SendersAreChosenByTheirLight, 2)
{
    static float rows[SIDES * SIDES];
    vplRgb sent[SIDES];
    for (int i = 0; i < SIDES; i++) {
        sent[i] = i % 5 == 0 ? (vplRgb){0, 0, 0} : (vplRgb){(float)(i % 4), 1, 0.5f};
        for (int j = 0; j < SIDES; j++) {
            rows[i * SIDES + j] = i == 3 || (i + j) % 3 == 0 ? 0 : (float)(1 + (i * j) % 11) / 1000;
        }
    }
    const vplFormFactors factors = {.count = SIDES, .rows = rows, .context = context};
    const vplPatchSides sides = {.count = SIDES, .context = context};
    const vplTransport transport = {&sides, &factors, NULL};
    vplArena* arena = vplArena_Create(context);
    vplSenders senders;
    assert_int_equal(vplSenders_Create(arena, &transport, sent, &senders), VPL_SUCCESS);
    assert_true(vplSenders_Total(&senders, 3) == 0);
    for (int i = 0; i < SIDES; i += 23) {
        int counts[SIDES] = {0};
        double light = 0;
        for (int k = 0; k < CHOICES; k++) {
            counts[vplSenders_Choose(&senders, i, (k + 0.5) / CHOICES)]++;
        }
        for (int j = 0; j < SIDES; j++) {
            const double from = (double)rows[i * SIDES + j] * ((double)sent[j].r + sent[j].g + sent[j].b) / 3;
            light += from;
            assertNear(vplSenders_Probability(&senders, i, j), from / vplSenders_Total(&senders, i), 1e-6,
                       "probability", j);
            assertNear(counts[j], CHOICES * vplSenders_Probability(&senders, i, j), 1.01, "choices", j);
        }
        assertNear(vplSenders_Total(&senders, i), light, 1e-6 * light, "total", i);
    }
    // Rounding at the end of a row chooses no side that sends nothing.
    assert_true(vplSenders_Probability(&senders, 4, vplSenders_Choose(&senders, 4, 1 - 0x1p-53)) > 0);
    vplArena_Destroy(arena);
}

// ---- patches as a guide

static vplRenderer* renderPatches(vplScene* scene, int patches, int width, vplPatchCuts cuts)
{
    vplRenderer* r;
    bool done;
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = VPL_METHOD_RADIOSITY;
    o.radiosity.patches = patches;
    o.radiosity.gather = 0;
    o.radiosity.groups = VPL_PATCH_GROUPS_OFF;
    o.radiosity.cuts = cuts;
    o.output.width = width;
    o.output.height = width;
    assert_int_equal(vplRenderer_Create(scene, &o, &r), VPL_SUCCESS);
    assert_int_equal(vplRenderer_Step(r, &done), VPL_SUCCESS);
    return r;
}

// The side that has the highest probability of receiving light from a side some of whose cells are closed.
static int findReceiver(const vplPatchSides* sides, const vplPathGuide* guide)
{
    double most = 0;
    int receiver = 0;
    for (int i = 0; i < sides->count; i++) {
        for (int j = 0; j < sides->count && guide->knows(guide->data, i); j++) {
            const double share = guide->density(guide->data, i, j) * (double)sides->sides[j].area;
            if (sides->sides[j].open != VPL_ALL_CELLS && share > most) {
                most = share;
                receiver = i;
            }
        }
    }
    return receiver;
}

// The sum of one over the density of chosen points of a patch, over their number times its probability, is its area, also where light
// does not reach all of its cells.
TEST(PatchesAreChosenWithTheirDensity, 2)
{
    vplScene* scene = openScene(context, ROOM);
    vplRenderer* r = renderPatches(scene, 100, 8, VPL_PATCH_CUTS_OFF);
    const vplPatchSides* sides = r->runner.run.results[VPL_STAGE_SIDES];
    vplArena* arena = vplArena_Create(context);
    const vplPathGuide* guide;
    assert_int_equal(vplMakePathGuide(&r->runner.run, arena, &guide), VPL_SUCCESS);
    assert_non_null(guide);
    int counts[256] = {0}, checked = 0, partly = 0;
    const int receiver = findReceiver(sides, guide);
    assert_true(sides->count <= 256);
    for (int k = 0; k < 1 << 18; k++) {
        const uint32_t bits = (uint32_t)k * 2654435761u;
        const float u[3] = {(float)k / (1 << 18), (float)(bits >> 8) * 0x1p-24f,
                            (float)(bits * 2246822519u >> 8) * 0x1p-24f};
        const vplGuidePoint p = guide->choose(guide->data, receiver, u);
        const vplPatchSide* s = &sides->sides[p.place];
        assert_int_equal(p.triangle, vplPatches_TriangleOf(sides->patches, s->patch));
        counts[p.place]++;
    }
    for (int i = 0; i < sides->count; i++) {
        const vplVec3* c = sides->sides[i].corners;
        const vplVec3 across = vplCross(vplSub(c[1], c[0]), vplSub(c[2], c[0]));
        const double area = 0.5 * (double)vplLength(across),
                     density = guide->density(guide->data, receiver, i);
        if (counts[i] > 1000) {
            assertNear(counts[i] / density / (1 << 18), area, 0.02 * area, "area", i);
            checked++;
            partly += sides->sides[i].open != VPL_ALL_CELLS;
        }
    }
    assert_true(checked > 10);
    assert_true(partly > 0);
    vplArena_Destroy(arena);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// The variance of the mean of a picture's pixels.
static double varianceOf(const vplRun* run, const vplPathGuide* guide, double* meanOut)
{
    enum { WIDTH = 16, EACH = 128 };
    static vplSparsePixel pixels[WIDTH * WIDTH];
    vplSparsePaths paths;
    vplPathDef def = vplDescribePaths(run, VPL_SHOW_PICTURE);
    double variance = 0;
    def.guide = guide;
    def.lastBounce = def.mostBounces = 16;
    def.lightVertices = 1;
    memset(pixels, 0, sizeof pixels);
    for (int i = 0; i < WIDTH * WIDTH; i++) {
        pixels[i].x = i % WIDTH;
        pixels[i].y = i / WIDTH;
    }
    assert_int_equal(
        vplSparsePaths_Init(&paths, run->results[VPL_STAGE_GEOMETRY], &def, pixels, WIDTH * WIDTH),
        VPL_SUCCESS);
    assert_int_equal(vplSparsePaths_Trace(&paths, EACH, (vplProgressRange){NULL, NULL, 0, 1}), VPL_SUCCESS);
    *meanOut = 0;
    for (int i = 0; i < WIDTH * WIDTH; i++) {
        variance += vplSparsePixel_Variance(&pixels[i], EACH) / (WIDTH * WIDTH);
        *meanOut += (pixels[i].sums[0].g + pixels[i].sums[1].g) / (2 * EACH * WIDTH * WIDTH);
    }
    vplSparsePaths_Free(&paths);
    return variance;
}

// A camera that looks into a dark room sees less noise, and the same light, by guided paths.
TEST(PatchesGuidePathsToTheLight, 2)
{
    vplScene* scene = openScene(context, "examples/scenes/flat.json");
    vplRenderer* r = renderPatches(scene, 1000, 16, VPL_PATCH_CUTS_AUTO);
    vplArena* arena = vplArena_Create(context);
    const vplPathGuide* guide;
    double means[2];
    assert_int_equal(vplMakePathGuide(&r->runner.run, arena, &guide), VPL_SUCCESS);
    const double plain = varianceOf(&r->runner.run, NULL, &means[0]),
                 guided = varianceOf(&r->runner.run, guide, &means[1]);
    assert_true(guided < 0.75 * plain);
    assertNear(means[1], means[0], 3 * sqrt((plain + guided) / 256), "mean", 0);
    vplArena_Destroy(arena);
    vplRenderer_Destroy(r);
    vplScene_Destroy(scene);
}

// Patches guide where what the picture shows is dark beside the rest, and only if all pairs have form factors.
TEST(PatchesGuideWhereThatIsAGain, 2)
{
    static const struct {
        const char* scene;
        bool pays;
    } ROWS[] = {{"examples/scenes/flat.json", true},
                {"examples/scenes/door-ajar.json", true},
                {"examples/scenes/room.json", false},
                {"examples/scenes/garden.json", false}};
    for (size_t i = 0; i < sizeof ROWS / sizeof *ROWS; i++) {
        vplScene* scene = openScene(context, ROWS[i].scene);
        vplRenderer* r = renderPatches(scene, 300, 16, VPL_PATCH_CUTS_AUTO);
        const vplRun* run = &r->runner.run;
        const vplPathDef def = vplDescribePaths(run, VPL_SHOW_PICTURE);
        vplPathScene paths;
        assert_int_equal(vplPathScene_Init(&paths, run->results[VPL_STAGE_GEOMETRY], &def), VPL_SUCCESS);
        assert_int_equal(vplGuidePays(run, &paths), ROWS[i].pays);
        vplPathScene_Free(&paths);
        vplRenderer_Destroy(r);
        vplScene_Destroy(scene);
    }
}
