// SPDX-License-Identifier: MIT
// End-to-end tests of radiosity: the parts of its pictures, convergence, moving lights, and extremes. The
// stages have suites of their own: patches, patchSides, formFactors, radiositySolve, links, patchMesh,
// drawPatches.
#include "radiosity_pictures.h"

// ---- parts of a picture

TEST(PictureIsDirectLightAndPatches, 2)
{
    for (int areaLight = 0; areaLight < 2; areaLight++) {
        vplScene* scene = boxRoom(context, 0.6f, areaLight);
        vplRenderOptions o = radiosityOptions(200), plain = o;
        plain.method = VPL_METHOD_DIRECT;
        vplImage *picture = showOf(scene, o, VPL_SHOW_PICTURE), *direct = showOf(scene, o, VPL_SHOW_DIRECT),
                 *indirect = showOf(scene, o, VPL_SHOW_INDIRECT),
                 *same = showOf(scene, plain, VPL_SHOW_PICTURE);
        assert_true(vplImage_Hash(direct) == vplImage_Hash(same));
        for (int i = 0; i < 3 * 40 * 30; i++) {
            assert_true(picture->pixels[i] == direct->pixels[i] + indirect->pixels[i]);
            assert_true(indirect->pixels[i] > 0);
        }
        vplImage_Destroy(picture);
        vplImage_Destroy(direct);
        vplImage_Destroy(indirect);
        vplImage_Destroy(same);
        vplScene_Destroy(scene);
    }
}

TEST(PicturesComeNearerToPathsAsPatchesShrink, 2, SLOW)
{
    for (int areaLight = 0; areaLight < 2; areaLight++) {
        vplScene* scene = boxRoom(context, 0.7f, areaLight);
        vplImage* truth = pathsOf(scene, VPL_SHOW_INDIRECT, 512);
        double last = 1, energy = 0;
        for (int patches = 100; patches <= 1600; patches *= 4) {
            vplImage* image = showOf(scene, radiosityOptions(patches), VPL_SHOW_INDIRECT);
            const vplComparison c = compare(image, truth);
            assert_true(c.relmse < 0.5 * last || c.relmse < 0.0003); // cut or uncut, 0.00024 at 1600
            last = c.relmse;
            energy = c.energyRatio;
            vplImage_Destroy(image);
        }
        assertNear(last, 0, 0.004, "relmse of 1600 patches", areaLight);
        assertNear(energy, 1, 0.03, "energy of 1600 patches", areaLight);
        vplImage_Destroy(truth);
        vplScene_Destroy(scene);
    }
}

// Measured: 0.00071 with 980 adaptive patches, 0.00092 with 1624 uniform ones (bench/radiosity_error measures
// more, also away from edges).
TEST(AdaptivePatchesAreBetterThanMoreUniformOnes, 2, SLOW)
{
    vplScene* scene = loadScene(context, "../../examples/scenes/room-area.json");
    vplImage* truth[2];
    vplRenderOptions o = radiosityOptions(1);
    o.method = VPL_METHOD_PATH;
    o.path.pixel = VPL_PIXEL_CENTRE;
    o.path.samples = 512;
    for (int i = 0; i < 2; i++) {
        o.seed = (uint64_t)i;
        truth[i] = showOf(scene, o, VPL_SHOW_INDIRECT);
    }
    double errors[2];
    int patches[2];
    for (int adaptive = 0; adaptive < 2; adaptive++) {
        vplRenderStats stats;
        o = radiosityOptions(adaptive ? 1000 : 1624);
        o.radiosity.placement = adaptive ? VPL_PATCHES_ADAPTIVE : VPL_PATCHES_UNIFORM;
        o.output.show = VPL_SHOW_INDIRECT;
        vplImage* image = renderScene(scene, &o, &stats);
        errors[adaptive] = commonError(image, truth);
        patches[adaptive] = stats.patches;
        vplImage_Destroy(image);
    }

    assert_true(patches[1] < 0.7 * patches[0] && errors[1] < 0.9 * errors[0]);
    vplImage_Destroy(truth[0]);
    vplImage_Destroy(truth[1]);
    vplScene_Destroy(scene);
}

// In a closed room whose walls all emit, radiance is Le / (1 - rho) everywhere, of which Le rho^2 / (1 - rho)
// has been reflected at least twice, including the last reflection towards the eye.
TEST(FurnaceIsUniform, 2)
{
    static const float rhos[] = {0, 0.1f, 0.5f, 0.9f, 0.99f};
    for (int k = 0; k < 5; k++) {
        vplScene* scene = closedCubeScene(context, rhos[k], 1);
        aim(scene, vplVec(0, 0, 0.9f), vplVec(0, -0.1f, -1));
        for (int incentre = 0; incentre < 2; incentre++) {
            vplRenderOptions o = radiosityOptions(300);
            o.radiosity.iterations = 3000;
            o.radiosity.residual = 1e-7;
            o.radiosity.rowSums = VPL_ROW_SUMS_NORMALISE;
            o.radiosity.formFactors = incentre ? VPL_FORM_FACTORS_INCENTRE : VPL_FORM_FACTORS_MONTE_CARLO;
            vplImage* image = showOf(scene, o, VPL_SHOW_INDIRECT);
            const double wanted = (double)rhos[k] * (double)rhos[k] / (1 - (double)rhos[k]);
            for (int i = 0; i < 40 * 30; i++) {
                assertNear((double)image->pixels[3 * i], wanted, 2e-3 * wanted, "radiance", k);
            }
            vplImage_Destroy(image);
        }
        vplScene_Destroy(scene);
    }
}

static uint64_t hashOf(vplContext* context)
{
    if (context == NULL) {
        return 0;
    }
    vplScene* scene = boxRoom(context, 0.7f, false);
    vplRenderOptions o = radiosityOptions(200);
    uint64_t hash = 0;
    for (int k = 0; k < 3; k++) {
        o.radiosity.hierarchy = k == 1 ? VPL_HIERARCHY_ON : VPL_HIERARCHY_AUTO;
        o.radiosity.placement = k == 2 ? VPL_PATCHES_ADAPTIVE : VPL_PATCHES_UNIFORM;
        vplImage* image = renderScene(scene, &o, NULL);
        hash = hash * 31 + vplImage_Hash(image);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(PicturesHaveTheSameBitsEverywhere)
{
    assertSameEverywhere(hashOf);
}

// ---- the report's saturation

// X094. With the document's estimator and few patches the picture is too bright, or there is no solution;
// with ours neither happens.
TEST(OneSampleFormFactorsSaturateAndOursDoNot, 2, SLOW)
{
    vplScene* scene = boxRoom(context, 0.75f, false);
    vplImage* truth = pathsOf(scene, VPL_SHOW_INDIRECT, 256);
    vplRenderOptions o = radiosityOptions(60);
    vplImage* ours = showOf(scene, o, VPL_SHOW_INDIRECT);
    o.radiosity.formFactors = VPL_FORM_FACTORS_INCENTRE;
    vplImage* theirs = showOf(scene, o, VPL_SHOW_INDIRECT);
    const double ourEnergy = compare(ours, truth).energyRatio, energy = compare(theirs, truth).energyRatio;
    assertNear(ourEnergy, 1, 0.1, "energy of 60 patches", 0);
    assert_true(energy > 1.5);
    vplImage_Destroy(ours);
    vplImage_Destroy(theirs);
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
}

// X094
TEST(DivergenceIsASentence, 2)
{
    vplScene* scene = closedCubeScene(context, 0.9f, 1);
    aim(scene, vplVec(0, 0, 0.9f), vplVec(0, -0.1f, -1));
    vplRenderOptions o = radiosityOptions(12); // the spectral radius is 1.55
    o.radiosity.formFactors = VPL_FORM_FACTORS_INCENTRE;
    vplImage* image = NULL;
    for (int solver = 0; solver <= VPL_SOLVER_SHOOTING; solver++) {
        o.radiosity.solver = (vplSolver)solver;
        takeMessage();
        assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_LIMIT);
        assert_null(image);
        assert_non_null(strstr(takeMessage(), "row-sums"));
    }
    o.radiosity.rowSums = VPL_ROW_SUMS_CLAMP;
    vplRenderStats stats;
    image = renderScene(scene, &o, &stats);
    assert_true(stats.solve.spectralRadius < 0.91 && stats.solve.rowSumMax <= 1);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// X096: a room without a solution ends after the requested number of sweeps, with a warning.
TEST(WhiteClosedRoomEndsWithAWarning, 2)
{
    vplScene* scene = boxRoom(context, 1, false);
    vplRenderOptions o = radiosityOptions(100);
    vplRenderStats stats;
    o.radiosity.rowSums = VPL_ROW_SUMS_NORMALISE;
    o.radiosity.iterations = 7;
    takeMessage();
    vplImage* image = renderScene(scene, &o, &stats);
    assert_non_null(strstr(takeMessage(), "residual"));
    assert_int_equal(stats.solve.iterations, 7);
    assert_true(isfinite(meanOf(image)) && stats.solve.residual > o.radiosity.residual);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// ---- extremes

// X092
TEST(NoLightIsBlack, 2)
{
    vplScene* scene = closedCubeScene(context, 0.5f, 0);
    aim(scene, vplVec(0, 0, 0.9f), vplVec(0, -0.1f, -1));
    vplRenderOptions o = radiosityOptions(100);
    vplImage* image = renderScene(scene, &o, NULL);
    assert_true(meanOf(image) == 0);
    vplImage_Destroy(image);
    for (int show = VPL_SHOW_PATCHES; show <= VPL_SHOW_RESIDUAL; show++) {
        image = showOf(scene, o, (vplShow)show);
        vplImage_Destroy(image);
    }
    vplScene_Destroy(scene);
}

TEST(OneTriangleReflectsNothingToItself, 2)
{
    vplScene* scene = sceneOf(context, 0.5f);
    Shape shape = {0};
    addTriangle(&shape, vplVec(-1, 0, 1), vplVec(1, 0, 1), vplVec(0, 0, -1));
    addShape(scene, &shape, false, NULL);
    freeShape(&shape);
    aim(scene, vplVec(0, 1.5f, 1.5f), vplVec(0, 0, 0));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0, 1, 0), vplVec(0, -1, 0), 1);
    vplRenderOptions o = radiosityOptions(50);
    vplRenderStats stats;
    o.output.show = VPL_SHOW_INDIRECT;
    vplImage* image = renderScene(scene, &o, &stats);
    assert_true(meanOf(image) == 0 && stats.patches >= 50);
    vplImage_Destroy(image);
    image = showOf(scene, o, VPL_SHOW_PATCH_RADIOSITY);
    assert_true(meanOf(image) > 0.001);
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
}

// Two walls coincide: each patch exists twice, but its light must not.
TEST(CoplanarDuplicatesDoNotDoubleLight, 2)
{
    double means[2];
    for (int twice = 0; twice < 2; twice++) {
        vplScene* scene = boxRoom(context, 0.6f, false);
        if (twice) {
            addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, -1, 0), -VPL_PI / 2, 0, vplVec(2, 2, 1));
        }
        vplRenderOptions o = radiosityOptions(300);
        o.radiosity.patchSize = 0.5f;
        vplImage* image = showOf(scene, o, VPL_SHOW_INDIRECT);
        means[twice] = meanOf(image);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
    assertNear(means[1], means[0], 0.05 * means[0], "light of a floor that is there twice", 0);
}

// The inside of another closed box is unlit and must not be divided into sides.
TEST(RoomsWithoutLightTakeNoPart, 2)
{
    vplRenderStats stats[2];
    for (int other = 0; other < 2; other++) {
        vplScene* scene = boxRoom(context, 0.6f, false);
        if (other) {
            addThing(scene, VPL_OBJECT_BOX, 0, vplVec(10, 0, 0), 0, 0, vplVec(2, 2, 2));
        }
        vplRenderOptions o = radiosityOptions(1);
        o.radiosity.patchSize = 0.5f;
        o.output.show = VPL_SHOW_INDIRECT; // shadow maps have the farthest corner's distance as unit
        vplImage_Destroy(renderScene(scene, &o, &stats[other]));
        vplScene_Destroy(scene);
    }
    assert_true(stats[1].patches > stats[0].patches);
    assert_int_equal(stats[1].patchSides, stats[0].patchSides);
    assert_true(stats[1].imageHash == stats[0].imageHash);
}

// X101. Floor patches under the box have unlit corners, which must not darken anything near the box. The test
// compares patches beside the box: none may be much darker than the path tracer's result.
TEST(NothingIsDarkBecauseItTouchesABox, 2, SLOW)
{
    vplScene* scene = closedCubeScene(context, 0.7f, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, -0.8f, 0), 0, 0.6, vplVec(0.7f, 0.4f, 0.7f));
    aim(scene, vplVec(0, 0.95f, 0.01f), vplVec(0, -1, 0)); // straight down
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0, 0.6f, 0), vplVec(0, -1, 0), 3);
    vplImage* truth = pathsOf(scene, VPL_SHOW_INDIRECT, 512);
    vplRenderOptions o = radiosityOptions(204);
    double least[2];
    for (int equal = 0; equal < 2; equal++) {
        o.radiosity.vertexWeight = equal ? VPL_VERTEX_WEIGHT_EQUAL : VPL_VERTEX_WEIGHT_ANGLE;
        o.radiosity.formFactors = equal ? VPL_FORM_FACTORS_INCENTRE : VPL_FORM_FACTORS_MONTE_CARLO;
        vplImage* image = showOf(scene, o, VPL_SHOW_INDIRECT);
        const double energy = compare(image, truth).energyRatio; // the document's is too bright overall
        least[equal] = 10;
        for (int i = 0; i < 40 * 30; i++) {
            const double ratio = (double)image->pixels[3 * i] / (double)truth->pixels[3 * i];
            least[equal] = ratio / energy < least[equal] ? ratio / energy : least[equal];
        }
        vplImage_Destroy(image);
    }
    assert_true(least[0] > 0.8); // measured: 0.9
    assert_true(least[1] < 0.7); // as in the document's figure 7
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
}

// ---- refusals

TEST(WhatIsNotPossibleIsASentence, 1, SLOW)
{
    vplScene* scene = boxRoom(context, 0.5f, false);
    const vplRenderOptions good = radiosityOptions(100);
    vplRenderOptions o[11];
    static const char* const words[11] = {
        "patches is 0",      "patchSize", "iterations",  "residual",       "linkError", "physical",
        "no virtual lights", "adaptive",  "formSamples", "only radiosity", "bytes"};
    for (int i = 0; i < 11; i++) {
        o[i] = good;
    }
    o[0].radiosity.patches = 0;
    o[1].radiosity.patchSize = -1;
    o[2].radiosity.iterations = -1;
    o[3].radiosity.residual = 2;
    o[4].radiosity.linkError = 0;
    o[5].lighting = VPL_LIGHTING_DOCUMENTED;
    o[6].output.show = VPL_SHOW_OVERLAY;
    o[7].radiosity.placement = VPL_PATCHES_ADAPTIVE;
    o[7].radiosity.patchSize = 0.1f;
    o[8].radiosity.formSamples = 0;
    o[9].method = VPL_METHOD_DIRECT;
    o[9].output.show = VPL_SHOW_PATCHES;
    o[10].radiosity.patches = 40000;
    o[10].radiosity.hierarchy = VPL_HIERARCHY_OFF;
    for (int i = 0; i < 11; i++) {
        vplImage* image = NULL;
        takeMessage();
        assert_int_equal(vplRender(scene, &o[i], &image, NULL), i == 10 ? VPL_LIMIT : VPL_INVALID_ARGUMENT);
        assert_null(image);
        assert_non_null(strstr(takeMessage(), words[i]));
    }
    vplScene_Destroy(scene);
}

// A floor, a wall, a box and a lamp, all of them `size` times as large, and a thin box `far` sizes away.
static vplImage* sizedPicture(vplContext* context, float size, float far, float emission,
                              const vplRenderOptions* options)
{
    vplScene* scene = sceneOf(context, 0.7f);
    const int lamp = addMaterial(scene, (vplRgb){0.5f, 0.5f, 0.5f}, emission);
    const double quarter = VPL_PI / 2;
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 2 * size, 6 * size);
    camera.target = vplVec(0, size, 0);
    camera.nearPlane = 0.125 * (double)size;
    camera.farPlane = 64 * (double)size;
    assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 0, 0), -quarter, 0, vplVec(5 * size, 5 * size, size));
    addThing(scene, VPL_OBJECT_QUAD, 0, vplVec(0, 2.5f * size, -2.5f * size), 0, 0,
             vplVec(5 * size, 5 * size, size));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.5f * size, 0.5f * size, 0.25f * size), 0, 0.5,
             vplVec(size, size, size));
    addThing(scene, VPL_OBJECT_QUAD, lamp, vplVec(0, 4 * size, 0), quarter, 0, vplVec(size, size, size));
    if (far > 0) {
        addThing(scene, VPL_OBJECT_BOX, 0, vplVec(far * size, size, 0), 0, 0,
                 vplVec(size, size, 1e-6f * size));
    }
    vplRenderStats stats;
    vplImage* image = renderScene(scene, options, &stats);
    assert_true(isfinite(stats.solve.spectralRadius) && stats.solve.spectralRadius > 0.01);
    vplScene_Destroy(scene);
    return image;
}

static uint64_t sizedHash(vplContext* context, float size, float far, const vplRenderOptions* options)
{
    vplImage* image = sizedPicture(context, size, far, 10, options);
    const uint64_t hash = vplImage_Hash(image);
    vplImage_Destroy(image);
    return hash;
}

// The settings of a test of sizes: links or form factors of either kind.
static vplRenderOptions sizedOptions(int which)
{
    vplRenderOptions options = plainOptions();
    options.method = VPL_METHOD_RADIOSITY;
    options.output.width = 40;
    options.output.height = 30;
    options.radiosity.patches = 200;
    options.radiosity.hierarchy = which == 1 ? VPL_HIERARCHY_ON : VPL_HIERARCHY_OFF;
    // Links between the slivers that cuts leave keep their bits from 2^-20 m to 2^30 m only.
    options.radiosity.cuts = which == 1 ? VPL_PATCH_CUTS_OFF : VPL_PATCH_CUTS_AUTO;
    options.radiosity.formFactors = which == 2 ? VPL_FORM_FACTORS_INCENTRE : VPL_FORM_FACTORS_MONTE_CARLO;
    return options;
}

// Light of surfaces does not depend on the unit of length: powers of two leave every bit. A thin box far away
// takes nothing from the light here.
TEST(RadiosityIsTheSameAtAnySize, 1)
{
    static const int exponents[] = {-36, -20, -10, 10, 20, 30, 36, 42};
    for (int which = 0; which < 3; which++) {
        const vplRenderOptions options = sizedOptions(which);
        const uint64_t wanted = sizedHash(context, 1, 0, &options);
        for (int i = 0; i < 8; i++) {
            assert_true(sizedHash(context, ldexpf(1, exponents[i]), 0, &options) == wanted);
        }
        for (int i = 0; i < 4; i++) {
            sizedHash(context, 1, (float)pow(10, 4 + i), &options);
        }
    }
}

// A scene of 1e6 m whose lamp emits 1e15 W/(m^2 sr) is that of 1 m and 1 W/(m^2 sr), 1e15 times as bright. With powers of two no
// bit differs. With others rounding decides whether a ray between patches passes an edge, and which patches are linked.
TEST(RadiosityOfAHugeBrightSceneIsThatOfASmallDimOne, 1)
{
    static const struct {
        float size, bright;
        double most[3]; // rmse over the mean: form factors by rays, links, the document's form factors
    } cases[] = {{0x1p19f, 0x1p49f, {0, 0, 0}},
                 {1e6f, 1e15f, {1e-2, 1e-2, 1e-6}},
                 {1e6f, 1e-30f, {1e-2, 1e-2, 1e-6}},
                 {1.1f, 1e15f, {1e-2, 1e-2, 1e-6}}};
    for (int which = 0; which < 3; which++) {
        const vplRenderOptions options = sizedOptions(which);
        vplImage* small = sizedPicture(context, 1, 0, 1, &options);
        for (int i = 0; i < 4; i++) {
            vplComparison c;
            vplImage* huge = sizedPicture(context, cases[i].size, 0, cases[i].bright, &options);
            for (int k = 0; k < 3 * 40 * 30; k++) {
                huge->pixels[k] /= cases[i].bright;
            }
            assert_int_equal(vplImage_Compare(huge, small, &c), VPL_SUCCESS); // all are finite
            assertNear(c.relativeRmse, 0, cases[i].most[which], "rmse", i);
            vplImage_Destroy(huge);
        }
        vplImage_Destroy(small);
    }
}
