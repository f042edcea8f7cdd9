// SPDX-License-Identifier: MIT
// Tests of the path-traced reference against itself and the rasterizer's pixels: parts of the picture,
// errors, bits, and extremes.
#include "path_scenes.h"

// All outputs follow the same paths, so parts add up to the whole except for rounding.
TEST(PartsAddUpToThePicture, 2)
{
    static const char* const scenes[] = {ROOM, AREA_ROOM};
    for (int s = 0; s < 2; s++) {
        vplScene* scene = openScene(context, scenes[s]);
        vplImage* picture = renderShown(scene, VPL_SHOW_PICTURE, 0);
        vplImage* direct = renderShown(scene, VPL_SHOW_DIRECT, 0);
        vplImage* indirect = renderShown(scene, VPL_SHOW_INDIRECT, 0);
        vplImage* bounces[5];
        for (int k = 0; k < 5; k++) {
            bounces[k] = renderShown(scene, VPL_SHOW_BOUNCE, k);
        }
        double emitted = 0;
        for (int i = 0; i < 3 * 32 * 32; i++) {
            double whole = (double)picture->pixels[i], part = (double)indirect->pixels[i];
            assertNear((double)direct->pixels[i] + part, whole, 1e-6 * whole, "direct and indirect", i);
            double sum = 0;
            for (int k = 1; k < 4; k++) {
                sum += (double)bounces[k]->pixels[i];
            }
            assertNear(sum, part, 1e-6 * part, "bounces 1 to 3", i);
            assertNear((double)bounces[4]->pixels[i], 0, 0, "a bounce beyond the last", i);
            emitted += (double)direct->pixels[i] - (double)bounces[0]->pixels[i];
        }
        assert_true(s == 0 ? emitted == 0 : emitted > 100); // bounce 0 contains no emission
        vplImage_Destroy(picture);
        vplImage_Destroy(direct);
        vplImage_Destroy(indirect);
        for (int k = 0; k < 5; k++) {
            vplImage_Destroy(bounces[k]);
        }
        vplScene_Destroy(scene);
    }
}

// ---- error, bits, pixels

// A few bright pixels make most of the error, so a single pair of pictures proves little: the test takes
// twelve.
TEST(ErrorEstimatePredictsTheDifferenceOfSeeds, 2, SLOW)
{
    static const char* const scenes[] = {ROOM, AREA_ROOM};
    for (int s = 0; s < 2; s++) {
        vplScene* scene = openScene(context, scenes[s]);
        vplRenderOptions options = pathOptions(40, 15); // odd, so that the halves differ in size
        double found = 0, predicted = 0;
        for (int pair = 0; pair < 12; pair++) {
            vplImage* images[2];
            for (int i = 0; i < 2; i++) {
                vplRenderStats stats;
                images[i] = renderScene(scene, &options, &stats);
                predicted += stats.errorEstimate * stats.errorEstimate;
                double sum =
                    meanOfImage(images[i], 0) + meanOfImage(images[i], 1) + meanOfImage(images[i], 2);
                assertNear(stats.relativeErrorEstimate, stats.errorEstimate * 3 / sum,
                           1e-6 * stats.relativeErrorEstimate, "relative", s);
                assert_true(stats.rays > 40 * 40 * 15);
                options.seed++;
            }
            found += squaredDifference(images[0], images[1]);
            vplImage_Destroy(images[0]);
            vplImage_Destroy(images[1]);
        }
        assertNear(sqrt(found / predicted), 1, 0.15, "found / predicted", s);
        vplRenderStats stats;
        options.path.samples = 1;
        vplImage_Destroy(renderScene(scene, &options, &stats));
        assert_true(stats.errorEstimate < 0); // one sample has nothing to compare with
        vplScene_Destroy(scene);
    }
}

// The scene has every emitter type, an area light and a smooth sphere; all sampling techniques must find the
// same light. Pictures, and their means, differ by no more than their error estimates allow.
TEST(AllWaysOfFindingLightAgree, 2, SLOW)
{
    vplScene* scene = addAllLights(newScene(context), 3);
    vplGeometry* geometry;
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    vplPathDef def = vplDefaultPathDef();
    def.emission = false; // aliasing at visible emitters would dominate the error
    def.lastBounce = 4;
    vplPathStats stats, other;
    vplImage* all = traceWith(scene, geometry, &def, 1024, &stats);
    static const int ways[] = {VPL_PATH_LIGHT_SAMPLING,
                               VPL_PATH_BSDF_SAMPLING,
                               VPL_PATH_LIGHT_SAMPLING | VPL_PATH_BSDF_SAMPLING,
                               VPL_PATH_BSDF_SAMPLING | VPL_PATH_PARTICLES,
                               VPL_PATH_ALL,
                               VPL_PATH_ALL};
    for (int i = 0; i < 6; i++) {
        def.seed = 1 + (uint64_t)i;
        def.techniques = ways[i];
        def.balanceHeuristic = i & 1;
        def.random = i == 4;
        vplImage* image = traceWith(scene, geometry, &def, 512, &other);
        double predicted =
            stats.errorEstimate * stats.errorEstimate + other.errorEstimate * other.errorEstimate;
        assertNear(sqrt(squaredDifference(all, image) / predicted), 1, 0.2, "found / predicted", i);
        for (int c = 0; c < 2; c++) { // mean of 576 pixels: three standard deviations; red is less noisy
            assertNear(meanOfImage(image, c), meanOfImage(all, c), 2 * 3 * sqrt(predicted) / 24, "mean", i);
        }
        vplImage_Destroy(image);
    }
    vplImage_Destroy(all);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

static uint64_t hashOf(vplContext* context, const char* path)
{
    vplRenderStats stats;
    vplRenderOptions options = pathOptions(40, 7);
    vplScene* scene = openScene(context, path);
    vplImage_Destroy(renderScene(scene, &options, &stats));
    vplScene_Destroy(scene);
    closeTestContext(context);
    return stats.imageHash;
}

TEST_ALONE(SameBitsForAllThreadsAndInstructionSets)
{
    static const char* const scenes[] = {ROOM, AREA_ROOM};
    for (int s = 0; s < 2; s++) {
        uint64_t wanted = hashOf(openTestContext(1), scenes[s]);
        static const int workers[] = {2, 3, 7};
        for (int i = 0; i < 3; i++) {
            assert_int_equal(hashOf(openTestContext(workers[i]), scenes[s]), wanted);
        }
        for (int isa = VPL_ISA_SCALAR; isa < VPL_ISA_COUNT; isa++) {
            vplContext* context = openIsaContext(2, (vplIsa)isa);
            if (context != NULL) {
                assert_int_equal(hashOf(context, scenes[s]), wanted);
            }
        }
    }
}

TEST(PassesOfAnySizeEndInTheSameBits, 2)
{
    static const int passes[3][4] = {{7}, {1, 6}, {3, 1, 2, 1}};
    vplScene* scene = openScene(context, AREA_ROOM);
    vplGeometry* geometry;
    uint64_t hashes[3];
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    for (int i = 0; i < 3; i++) {
        vplPathDef def = vplDefaultPathDef();
        def.camera = vplScene_GetCamera(scene, 0);
        def.width = 40;
        def.height = 24;
        vplPathTracer* tracer;
        vplImage* image;
        vplPathStats stats;
        assert_int_equal(vplPathTracer_Create(geometry, &def, &tracer), VPL_SUCCESS);
        for (int k = 0; k < 4 && passes[i][k] > 0; k++) {
            assert_int_equal(vplPathTracer_Pass(tracer, passes[i][k], NULL, NULL, 0, 1), VPL_SUCCESS);
        }
        assert_int_equal(vplImage_Create(context, 40, 24, &image), VPL_SUCCESS);
        vplPathTracer_Resolve(tracer, image, &stats);
        hashes[i] = vplImage_Hash(image);
        vplImage_Destroy(image);
        vplPathTracer_Destroy(tracer);
    }
    assert_int_equal(hashes[0], hashes[1]);
    assert_int_equal(hashes[0], hashes[2]);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}

// If all samples of a pixel see the same surface, the rasterizer must show that surface there; this must hold
// for most pixels.
TEST(PixelsAreTheRasterizersPixels, 2, SLOW)
{
    vplScene* scene = newScene(context);
    for (int i = 0; i < 40; i++) {
        vplObjectDef def = vplDefaultObjectDef();
        def.type = i & 1 ? VPL_OBJECT_BOX : VPL_OBJECT_QUAD;
        // Red is i and green i^2, so no mixture of two of these colours equals a third.
        vplMaterialDef material = vplDefaultMaterialDef();
        material.diffuse = (vplRgb){0, 0, 0};
        material.emission = (vplRgb){(float)(i + 1), (float)((i + 1) * (i + 1)), 0};
        assert_int_equal(vplScene_AddMaterial(scene, &material, &def.material), VPL_SUCCESS);
        float p[6];
        for (int k = 0; k < 6; k++) {
            p[k] = (float)uniformAt(5, (uint64_t)(6 * i + k));
        }
        def.transform = vplMat4_FromParts((vplVec3){4 * p[0] - 2, 4 * p[1] - 2, 4 * p[2] - 2},
                                          (double[3]){6 * (double)p[3], 6 * (double)p[4], 6 * (double)p[5]},
                                          (vplVec3){1, 0.7f, 0.5f});
        assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
    }
    vplCameraDef camera = vplDefaultCameraDef();
    camera.nearPlane = 3.2; // both planes cut through objects
    camera.farPlane = 6.5;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    vplRenderOptions options = pathOptions(96, 64);
    options.output.width = 128;
    vplImage* paths = renderScene(scene, &options, NULL);
    options.method = VPL_METHOD_DIRECT;
    vplImage* raster = renderScene(scene, &options, NULL);
    int pure = 0;
    for (int i = 0; i < 128 * 96; i++) {
        float value = paths->pixels[3 * i];
        if (paths->pixels[3 * i + 1] == value * value) {
            pure++;
            assertNear((double)raster->pixels[3 * i], (double)value, 0, "pixel", i);
        }
    }
    assert_true(pure > 128 * 96 * 8 / 10 && pure < 128 * 96);
    vplImage_Destroy(paths);
    vplImage_Destroy(raster);
    vplScene_Destroy(scene);
}

// ---- extremes

TEST(LightsOnSurfacesAndEdgesGiveNumbers, 2)
{
    vplScene* scene = newScene(context);
    int grey = addGrey(scene, 1, 0), areaLight = addGrey(scene, 0.5f, 1e15f);
    addRoom(scene, grey);
    addQuad(scene, areaLight, (vplVec3){0, -1, 0}, -1, 0.5f);        // coplanar with the floor
    addQuad(scene, areaLight, (vplVec3){0, 0, -1}, 0, 1e-6f);        // tiny, coplanar with a wall
    addQuad(scene, grey, (vplVec3){0, 0, 0}, -1, 1e-15f);            // a speck
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 1, 0}, 5e14f);   // in the ceiling's plane
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){1, 1, -1}, 1);      // in a corner
    addWhite(scene, VPL_EMITTER_SPOT, (vplVec3){0, -1, 0}, 1);       // on an area light
    addWhite(scene, VPL_EMITTER_DIRECTIONAL, (vplVec3){0, 0, 0}, 1); // along the walls
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){5, 5, 5}, 0);
    addCamera(scene, (vplVec3){0, 0, 0.99f}, (vplVec3){0.1f, -0.2f, -1}, 2.8);
    vplRenderOptions options = pathOptions(24, 8);
    options.maxBounces = 20;
    vplRenderStats stats;
    vplImage* image = renderScene(scene, &options, &stats);
    for (int i = 0; i < 3 * 24 * 24; i++) {
        assert_true(image->pixels[i] >= 0 && image->pixels[i] < INFINITY);
    }
    assert_true(isfinite(stats.errorEstimate) && isfinite(stats.relativeErrorEstimate));
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// Nothing absorbs light and no ray escapes; paths must end anyway.
TEST(PerfectMirrorRoomEnds, 1)
{
    vplScene* scene = newScene(context);
    addRoom(scene, addGrey(scene, 1, 0));
    addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 0, 0}, 1);
    addCamera(scene, (vplVec3){0, 0, 0.5f}, (vplVec3){0, 0, -1}, 1);
    vplRenderOptions options = pathOptions(1, 1);
    double mean = radianceOf(scene, &options, 0);
    assert_true(mean > 1e3 && mean < 1e5);
    vplScene_Destroy(scene);
}

// X092
TEST(NothingToSeeIsBlack, 1)
{
    vplScene* scene = newScene(context);
    addCamera(scene, (vplVec3){0, 0, 1}, (vplVec3){0, 0, 0}, 1);
    vplRenderOptions options = pathOptions(8, 2);
    vplRenderStats stats;
    vplImage* image = renderScene(scene, &options, &stats);
    assertNear(meanOfImage(image, 0), 0, 0, "mean", 0);
    assertNear(stats.relativeErrorEstimate, 0, 0, "relative error", 0);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

TEST(WhatIsNotAskedOfPathsIsRefused, 1)
{
    static const vplShow shows[] = {VPL_SHOW_DEPTH,         VPL_SHOW_NORMALS, VPL_SHOW_SHADOW_MAP,
                                    VPL_SHOW_SHADOW_FACTOR, VPL_SHOW_LIGHT,   VPL_SHOW_OVERLAY};
    vplScene* scene = openScene(context, ROOM);
    vplImage* image = NULL;
    vplRenderOptions options = pathOptions(8, 1);
    options.lighting = VPL_LIGHTING_DOCUMENTED;
    assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "documented"));
    options.lighting = VPL_LIGHTING_PHYSICAL;
    for (size_t i = 0; i < sizeof shows / sizeof *shows; i++) {
        options.output.show = shows[i];
        assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "bounce:K"));
    }
    assert_null(image);
    vplScene_Destroy(scene);
}

static bool stopAtOnce(void* user, double fraction)
{
    int* calls = user;
    assert_true(fraction >= 0 && fraction <= 1);
    return --*calls > 0;
}

TEST(ProgressCanCancel, 1)
{
    vplScene* scene = openScene(context, ROOM);
    vplImage* image = NULL;
    vplRenderOptions options = pathOptions(64, 1 << 24); // would take hours
    int calls = 5;
    options.progress = stopAtOnce;
    options.progressUser = &calls;
    assert_int_equal(vplRender(scene, &options, &image, NULL), VPL_CANCELLED);
    assert_null(image);
    assert_int_equal(calls, 0);
    vplScene_Destroy(scene);
}

// Adds a square of the floor of tiltedScene, turned in its plane, so that it lies in the floor.
static void addRug(vplScene* scene, float x, float y)
{
    vplObjectDef def = *vplScene_GetObject(scene, 0);
    const vplMat4 within =
        vplMat4_FromParts((vplVec3){x, y, 0}, (double[3]){0, 0, 0.3}, (vplVec3){0.17f, 0.17f, 1});
    def.transform = vplMat4_Multiply(&def.transform, &within);
    assert_int_equal(vplScene_AddObject(scene, &def, NULL), VPL_SUCCESS);
}

// A tilted floor, a wall and a box, each `copies` times, and rugs apart on the floor, at most 9.
static vplScene* tiltedScene(vplContext* context, int copies, int rugs)
{
    vplScene* scene = sceneOf(context, 0.8f);
    for (int i = 0; i < copies; i++) {
        addThing(scene, VPL_OBJECT_QUAD, 0, (vplVec3){0.137f, 0.291f, 0.113f}, -1.279, 0.204,
                 (vplVec3){5.1f, 5.3f, 1});
        addThing(scene, VPL_OBJECT_QUAD, 0, (vplVec3){0.37f, 1.1f, -2.3f}, 0.302, -0.122, (vplVec3){5, 5, 1});
        addThing(scene, VPL_OBJECT_BOX, 0, (vplVec3){0.3f, 1.3f, 0.3f}, 0.302, 0.541, (vplVec3){1, 1, 1});
    }
    for (int i = 0; i < rugs; i++) {
        addRug(scene, 0.3f * (float)(i % 3) - 0.3f, 0.3f * (float)(i / 3) - 0.3f);
    }
    addEmitter(scene, VPL_EMITTER_POINT, (vplVec3){1.5f, 4.5f, 2}, (vplVec3){0, -1, 0}, 10);
    aim(scene, (vplVec3){0, 3.5f, 6}, (vplVec3){0, 1, 0});
    return scene;
}

// Two objects in one plane are one surface: light that leaves it does not meet the other. Before rays left all objects
// from a point above them, half of the light of paths was lost (relative rmse 1.08; virtual lights 0.47, patches 0.16).
TEST(ObjectsInOnePlaneAreOneSurface, 2)
{
    static const vplMethod methods[] = {VPL_METHOD_PATH, VPL_METHOD_KELLER, VPL_METHOD_RADIOSITY};
    static const double most[] = {0.002, 0.02, 0.03};
    vplScene *plain = tiltedScene(context, 1, 0), *twice = tiltedScene(context, 2, 0),
             *rugs = tiltedScene(context, 1, 9);
    for (int m = 0; m < 5; m++) {
        vplRenderOptions options = plainOptions();
        options.method = methods[m % 3]; // not radiosity with rugs, whose patches are others
        options.output.width = 40;
        options.output.height = 30;
        options.path.samples = 8;
        options.particles.count = 60;
        options.radiosity.patchSize = 0.4f; // a number of patches would be shared by both surfaces
        options.radiosity.cuts = VPL_PATCH_CUTS_ON;
        vplImage *a = renderScene(plain, &options, NULL),
                 *b = renderScene(m < 3 ? twice : rugs, &options, NULL);
        vplComparison c;
        assert_int_equal(vplImage_Compare(a, b, &c), VPL_SUCCESS);
        printf("# %d: relative rmse %.5f\n", m, c.relativeRmse);
        assert_true(c.relativeRmse < most[m % 3]);
        vplImage_Destroy(a);
        vplImage_Destroy(b);
    }
    vplScene_Destroy(plain);
    vplScene_Destroy(twice);
    vplScene_Destroy(rugs);
}
