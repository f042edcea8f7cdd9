// SPDX-License-Identifier: MIT
// Tests of interleaved shading against deferred shading and against its definition, evaluated pixel by pixel.
#include "stage.h"

#include "math/vec.h"

#include <stdlib.h>

enum { MAX_SIDE = VPL_MAX_INTERLEAVE };

static bool oneSurface(const PixelSample* a, const PixelSample* b)
{
    double cosine = 0, apart = 0;
    for (int k = 0; k < 3; k++) {
        cosine += a->n[k] * b->n[k];
        apart += a->n[k] * (b->p[k] - a->p[k]);
    }
    return b->w > 0 && cosine >= 0.9 && fabs(apart) <= 0.01 * a->w;
}

// The definition: for each class, renders a picture with the lights of that class alone. A pixel's own value
// comes from the picture of its own class.
static vplImage** classPictures(const vplGeometry* g, const vplView* view, const vplShadeLight* lights,
                                int count, int side)
{
    vplImage** pictures = malloc((size_t)(side * side) * sizeof *pictures);
    vplShadeLight* own = malloc((size_t)count * sizeof *own);
    for (int c = 0; c < side * side; c++) {
        int ownCount = 0;
        for (int i = c; i < count; i += side * side) {
            own[ownCount++] = lights[i];
        }
        const vplShadeDef def = stageDef(own, ownCount, 0);
        pictures[c] = shadeStage(g, view, &def);
    }
    free(own);
    return pictures;
}

// The filter's weights fall from K at the centre to 1 at K - 1 pixels from it. The filter is separable:
// within a row, pixels count that lie on the surface of the row's pixel in the centre column; rows count
// whose pixel in that column lies on the surface of the centre.
static double expected(vplImage** pictures, const PixelSample* samples, int x, int y, int side, int channel)
{
    const int width = pictures[0]->width, height = pictures[0]->height;
    const PixelSample* middle = &samples[y * width + x];
    double sum = 0, weights = 0;
    for (int v = y > side - 1 ? y - side + 1 : 0; v < y + side && v < height; v++) {
        const PixelSample* own = &samples[v * width + x];
        for (int u = x > side - 1 ? x - side + 1 : 0; u < x + side && u < width; u++) {
            if (oneSurface(middle, own) && oneSurface(own, &samples[v * width + u])) {
                const double weight = (double)((side - abs(u - x)) * (side - abs(v - y)));
                const vplImage* class = pictures[v % side * side + u % side];
                sum += weight * side * side * (double)class->pixels[3 * (v * width + u) + channel];
                weights += weight;
            }
        }
    }
    return weights > 0 ? sum / weights : 0;
}

static void checkDefinition(const vplGeometry* g, int width, int height, int side, int lightCount)
{
    const vplView view = stageView(vplVec(1, 2, 5), width, height);
    vplShadeLight* lights = rollLights(lightCount, (uint64_t)side);
    PixelSample* samples = samplePixels(g, &view);
    vplImage** pictures = classPictures(g, &view, lights, lightCount, side);
    const vplShadeDef def = stageDef(lights, lightCount, side);
    vplImage* image = shadeStage(g, &view, &def);
    int lit = 0;
    for (int i = 0; i < 3 * width * height; i++) {
        const double wanted = expected(pictures, samples, i / 3 % width, i / 3 / width, side, i % 3);
        assertNear((double)image->pixels[i], wanted, 2e-6 * wanted, "radiance", i);
        lit += wanted > 0;
    }
    assert_true(lit > width * height / 8);
    for (int c = 0; c < side * side; c++) {
        vplImage_Destroy(pictures[c]);
    }
    vplImage_Destroy(image);
    free(pictures);
    free(samples);
    free(lights);
}

// X112
// Covers sides and picture sizes that divide tiles and ones that do not, fewer lights than classes, and more
// lights than a group.
TEST(EveryPixelIsThatOfTheDefinition, 2, SLOW)
{
    vplGeometry* g = stage(context);
    static const int cases[][4] = {{128, 96, 2, 300}, {150, 70, 3, 100}, {130, 67, 4, 512}, {70, 131, 5, 60},
                                   {90, 60, 8, 130},  {67, 45, 16, 300}, {66, 65, 7, 20}};
    for (int i = 0; i < 7; i++) {
        checkDefinition(g, cases[i][0], cases[i][1], cases[i][2], cases[i][3]);
    }
    vplGeometry_Destroy(g);
}

// Away from the picture's border every light counts exactly once, and the filter preserves values that are
// linear over the window, as those of lights 2 km above a floor are, to float precision.
TEST(FarLightsOnAFloorAreThoseOfDeferredShading, 2)
{
    enum { COUNT = 9 * 256, WIDTH = 100, HEIGHT = 80 };
    vplGeometry* g = floorQuad(context, vplVec(0, 0, 0), 100, 0.5f);
    const vplView view = stageView(vplVec(0, 3, 0.5f), WIDTH, HEIGHT);
    vplShadeLight* lights = rollLights(COUNT, 1);
    for (int i = 0; i < COUNT; i++) {
        lights[i].py = 2000 + 100 * lights[i].py;
        lights[i].r *= 1e6f;
    }
    vplShadeDef def = stageDef(lights, COUNT, 0);
    vplImage* deferred = shadeStage(g, &view, &def);
    static const int sides[] = {2, 3, 4, 8, 16};
    for (int k = 0; k < 5; k++) {
        def = stageDef(lights, COUNT, sides[k]);
        vplImage* image = shadeStage(g, &view, &def);
        for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
            const int x = i / 3 % WIDTH, y = i / 3 / WIDTH, border = sides[k] - 1;
            if (x >= border && y >= border && x < WIDTH - border && y < HEIGHT - border) {
                const double wanted = (double)deferred->pixels[i];
                assert_true(wanted > 0);
                assertNear((double)image->pixels[i], wanted, 1e-6 * wanted, "radiance", sides[k]);
            }
        }
        vplImage_Destroy(image);
    }
    vplImage_Destroy(deferred);
    free(lights);
    vplGeometry_Destroy(g);
}

// All lights lie in the plane of a wall, which therefore gets exactly no light, however bright the floor
// below it is.
TEST(NoLightLeaksOverAnEdge, 2)
{
    enum { SIZE = 96, COUNT = 300 }; // one or two lights in each of 256 classes
    vplGeometry* g = stage(context);
    const vplView view = stageView(vplVec(0, 2, 5), SIZE, SIZE);
    vplShadeLight* lights = rollLights(COUNT, 3);
    for (int i = 0; i < COUNT; i++) {
        lights[i].pz = -2.5f; // in the wall's plane, above the floor
    }
    vplShadeDef def = stageDef(lights, COUNT, 0);
    def.output = VPL_OUTPUT_NORMALS;
    vplImage* normals = shadeStage(g, &view, &def);
    for (int side = 2; side <= MAX_SIDE; side *= 2) {
        def = stageDef(lights, COUNT, side);
        vplImage* image = shadeStage(g, &view, &def);
        int walls = 0, floors = 0;
        for (int i = 0; i < SIZE * SIZE; i++) {
            const float* e = image->pixels + 3 * i;
            const float* n = normals->pixels + 3 * i;
            assert_true(n[1] > 0.5f ? e[0] > 0 : e[0] == 0 && e[1] == 0 && e[2] == 0);
            walls += n[2] > 0.5f;
            floors += n[1] > 0.5f;
        }
        assert_true(walls > 100 && floors > 100);
        vplImage_Destroy(image);
    }
    vplImage_Destroy(normals);
    free(lights);
    vplGeometry_Destroy(g);
}

// ---- whole renders

static vplRenderOptions optionsOf(int side)
{
    vplRenderOptions o = plainOptions();
    o.output.width = 131;
    o.output.height = 75;
    o.particles.count = 150;
    o.particles.sampler = VPL_SAMPLER_HALTON;
    o.shadow.mapSize = 32;
    o.lights.mapSize = 8;
    o.lights.areaLightSamples = 4;
    o.pipeline.kind = side > 0 ? VPL_ACCUMULATE_INTERLEAVED : VPL_ACCUMULATE_DEFERRED;
    o.pipeline.interleave = side > 0 ? side : 4;
    return o;
}

// Makes a room with a smooth sphere, whose shading normals differ from its geometric normals.
static vplScene* ballRoom(vplContext* context)
{
    vplScene* scene = loadScene(context, "room.json");
    Shape ball = icosphere(2);
    placeShape(&ball, 0.7f, (double[3]){0, 0, 0}, vplVec(0.2f, 2.2f, 0.8f));
    addShape(scene, &ball, true, NULL);
    freeShape(&ball);
    return scene;
}

static uint64_t hashOf(vplContext* context, const vplRenderOptions* o)
{
    vplRenderStats stats;
    vplScene* scene = ballRoom(context);
    vplImage_Destroy(renderScene(scene, o, &stats));
    vplScene_Destroy(scene);
    closeTestContext(context);
    return stats.imageHash;
}

TEST_ALONE(BlocksOfOnePixelAreDeferredBitForBit)
{
    for (int i = 0; i < 6; i++) {
        vplRenderOptions one = optionsOf(1), deferred = optionsOf(0);
        one.lighting = deferred.lighting = (vplLighting)(i % 2);
        one.lights.shadows = deferred.lights.shadows = (vplLightShadows)(i / 2);
        one.particles.count = deferred.particles.count = 40;
        assert_true(hashOf(openTestContext(2), &one) == hashOf(openTestContext(2), &deferred));
    }
}

TEST_ALONE(ThreadsAndInstructionSetsChangeNoBit)
{
    static const int workers[] = {2, 3, 7}, sides[] = {4, 3, 16};
    for (int i = 0; i < 5; i++) {
        vplRenderOptions o = optionsOf(sides[i % 3]);
        o.lights.shadows = (vplLightShadows)(i < 3 ? 0 : i - 2);
        o.particles.count = i < 3 ? 150 : 20;
        o.output.supersample = i == 0 ? 2 : 1;
        o.lighting = i == 1 ? VPL_LIGHTING_DOCUMENTED : VPL_LIGHTING_PHYSICAL;
        const uint64_t wanted = hashOf(openTestContext(1), &o);
        for (int k = 0; k < 3; k++) {
            assert_true(hashOf(openTestContext(workers[k]), &o) == wanted);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            assert_true(context == NULL || hashOf(context, &o) == wanted);
        }
    }
}

// Tests 512 lights or more in the room, fewer with each kind of shadow: the energy must be the same, and the
// error bounded. Without shadows the error is 6, 10 and 14 %, at 1920 x 1080 0.9, 2.1 and 4.4 % (edges are a
// smaller part there).
TEST(IndirectLightKeepsItsEnergy, 2)
{
    vplScene* scene = loadScene(context, "room.json");
    for (int shadows = 0; shadows < 3; shadows++) {
        for (int side = shadows ? 4 : 2; side <= (shadows ? 4 : 8); side *= 2) {
            vplRenderOptions o = optionsOf(0);
            o.output.width = 384;
            o.output.height = 216;
            o.output.show = VPL_SHOW_INDIRECT;
            o.particles.count = shadows ? 20 : 345;
            o.lights.shadows = (vplLightShadows)shadows;
            vplImage* deferred = renderScene(scene, &o, NULL);
            o.pipeline.kind = VPL_ACCUMULATE_INTERLEAVED;
            o.pipeline.interleave = side;
            vplImage* image = renderScene(scene, &o, NULL);
            vplComparison c;
            assert_int_equal(vplImage_Compare(image, deferred, &c), VPL_SUCCESS);
            assertNear(c.energyRatio, 1, 0.01, "energy", side);
            assert_true(c.relativeRmse > 0 && c.relativeRmse < 0.03 * side);
            vplImage_Destroy(image);
            vplImage_Destroy(deferred);
        }
    }
    vplScene_Destroy(scene);
}

TEST(SizesOfBlocksOutOfRangeAreRefused, 1)
{
    vplScene* scene = loadScene(context, "room.json");
    static const int wrong[] = {-2, 0, 17};
    vplImage* image = NULL;
    for (int i = 0; i < 3; i++) {
        vplRenderOptions o = optionsOf(4);
        o.pipeline.interleave = wrong[i];
        assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
        assert_true(image == NULL &&
                    strstr(takeMessage(), "vplRenderOptions.pipeline.interleave is ") != NULL);
    }
    vplGeometry* g = stage(context);
    const vplView view = stageView(vplVec(0, 2, 5), 4, 4);
    assert_int_equal(vplImage_Create(context, 4, 4, &image), VPL_SUCCESS);
    for (int i = 0; i < 3; i++) {
        vplShadeDef def = stageDef(NULL, 0, 4);
        def.interleave = wrong[i];
        assert_int_equal(vplShadeView(g, &view, &def, image, NULL), VPL_INVALID_ARGUMENT);
        assert_true(strstr(takeMessage(), "vplShadeDef.interleave is ") != NULL);
    }
    vplImage_Destroy(image);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}
