// SPDX-License-Identifier: MIT
// Tests of the path-traced reference against analytic answers: furnaces, direct light, and bounces.
#include "path_scenes.h"

#include "reference/sparse_paths.h"

#include <string.h>

// ---- a furnace: if all walls reflect rho and emit E, radiance is E / (1 - rho) everywhere

TEST_ALONE(FurnaceGlowsEverywhereAlike, SLOW)
{
    static const struct {
        float rho;
        int samples;
        double pixel, mean; // relative bounds: six and five standard deviations, measured with twenty seeds
    } cases[] = {{0, 1, 1e-6, 1e-6},
                 {0.1f, 64, 0.033, 0.0034},
                 {0.5f, 64, 0.09, 0.009},
                 {0.9f, 64, 0.14, 0.015},
                 {0.99f, 64, 0.16, 0.017}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplContext* context = openTestContext(2);
        vplScene* scene = newScene(context);
        addRoom(scene, addGrey(scene, cases[i].rho, 2));
        addCamera(scene, (vplVec3){0.3f, 0.1f, 0.2f}, (vplVec3){-1, -0.4f, -0.8f}, 1.5);
        vplRenderOptions options = pathOptions(8, cases[i].samples);
        vplImage* image = renderScene(scene, &options, NULL);
        const double wanted = 2 / (1 - (double)cases[i].rho);
        for (int k = 0; k < 3 * 8 * 8; k++) {
            assertNear((double)image->pixels[k], wanted, cases[i].pixel * wanted, "pixel", (int)i);
        }
        assertNear(meanOfImage(image, 0), wanted, cases[i].mean * wanted, "mean", (int)i);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// A white body among walls that emit E must show E, or energy is lost or made. Interpolated normals may lose
// light that would be reflected into the surface, but never gain any.
TEST_ALONE(WhiteBodyInAFurnaceVanishes)
{
    for (int smooth = 0; smooth < 2; smooth++) {
        vplContext* context = openTestContext(2);
        vplScene* scene = newScene(context);
        int white = addGrey(scene, 1, 0);
        addRoom(scene, addGrey(scene, 0, 1));
        addSphere(scene, white, (vplVec3){0, 0, 0}, 0.5f, 3, smooth);
        addCamera(scene, (vplVec3){0, 0, 0.95f}, (vplVec3){0, 0, 0}, 0.8);
        vplRenderOptions options = pathOptions(32, 64);
        vplImage* image = renderScene(scene, &options, NULL);
        double mean = meanOfImage(image, 1);
        if (smooth) {
            assert_true(mean < 1 + 1e-4 && mean > 0.95);
        } else {
            assertNear(mean, 1, 1e-3, "mean", smooth);
        }
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
        closeTestContext(context);
    }
}

// ---- direct light with an analytic answer

static const double NARROW = 1e-7; // angle of view: a small pixel sees a single point

TEST(PointLightFollowsTheInverseSquare, 1)
{
    for (int i = 0; i < 5; i++) {
        const float x = 0.7f * (float)i;
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
        addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 2, 0}, 3);
        addCamera(scene, (vplVec3){x, 3, 0}, (vplVec3){x, 0, 0}, NARROW);
        vplRenderOptions options = pathOptions(1, 4);
        double d2 = 4 + (double)x * x, wanted = 0.5 / VPL_PI * 3 / d2 * (2 / sqrt(d2));
        assertNear(radianceOf(scene, &options, 0), wanted, 1e-6 * wanted, "red", i);
        assertNear(radianceOf(scene, &options, 1), 2 * wanted, 2e-6 * wanted, "green", i);
        assertNear(radianceOf(scene, &options, 2), 0, 0, "blue", i);
        vplScene_Destroy(scene);
    }
}

TEST(SpotFadesSmoothlyBetweenItsAngles, 1)
{
    static const struct {
        double angle, share; // degrees; the falloff 3x^2 - 2x^3 of the cosine
    } cases[] = {{0, 1}, {15, 1}, {19.9, 1}, {25, -1}, {28, -1}, {30.1, 0}, {45, 0}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        const double angle = cases[i].angle * VPL_PI / 180, inner = cos(VPL_PI / 9), outer = cos(VPL_PI / 6);
        const float x = (float)(2 * tan(angle));
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
        addWhite(scene, VPL_EMITTER_SPOT, (vplVec3){0, 2, 0}, 3); // shines down: 20 and 30 degrees
        addCamera(scene, (vplVec3){x, 3, 0}, (vplVec3){x, 0, 0}, NARROW);
        vplRenderOptions options = pathOptions(1, 4);
        double way = (cos(angle) - outer) / (inner - outer);
        double share = cases[i].share < 0 ? way * way * (3 - 2 * way) : cases[i].share;
        double d2 = 4 + (double)x * x, wanted = share * 0.5 / VPL_PI * 3 / d2 * (2 / sqrt(d2));
        assertNear(radianceOf(scene, &options, 0), wanted, 4e-6 * wanted, "red", (int)i);
        vplScene_Destroy(scene);
    }
}

TEST(DirectionalLightGoesByTheCosine, 1)
{
    vplScene* scene = newScene(context);
    addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
    vplEmitterDef sun = vplDefaultEmitterDef();
    sun.type = VPL_EMITTER_DIRECTIONAL;
    sun.direction = (vplVec3){3, -4, 0};
    sun.intensity = (vplRgb){7, 7, 7};
    assert_int_equal(vplScene_AddEmitter(scene, &sun, NULL), VPL_SUCCESS);
    addCamera(scene, (vplVec3){1, 3, 0}, (vplVec3){1, 0, 0}, NARROW);
    vplRenderOptions options = pathOptions(1, 4);
    double wanted = 0.5 / VPL_PI * 7 * 0.8;
    assertNear(radianceOf(scene, &options, 0), wanted, 1e-6 * wanted, "red", 0);
    vplScene_Destroy(scene);
}

// Returns the form factor from a surface element to a parallel rectangle with a corner above it; a, b: sides
// relative to the distance.
static double cornerFactor(double a, double b)
{
    double p = sqrt(1 + a * a), q = sqrt(1 + b * b);
    return (a / p * atan(b / p) + b / q * atan(a / q)) / (2 * VPL_PI);
}

TEST(SquareAreaLightGivesItsFormFactor, 1)
{
    static const struct {
        float size, height;
        double bound;
    } cases[] = {{1, 1, 5e-4}, {1, 4, 5e-4}, {4, 0.25f, 2e-3}, {1, 0.01f, 2e-3}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, 0}, -1, 20);
        addQuad(scene, addGrey(scene, 0, 5), (vplVec3){0, cases[i].height, 0}, 1, cases[i].size);
        vplVec3 eye = {0.25f * cases[i].size, 0.5f * cases[i].height, 0}, target = eye;
        target.y = 0;
        addCamera(scene, eye, target, NARROW);
        vplRenderOptions options = pathOptions(1, 1 << 14);
        double far = 0.75 * (double)cases[i].size, near = 0.25 * (double)cases[i].size;
        double half = 0.5 * (double)cases[i].size, h = (double)cases[i].height;
        double factor = 2 * (cornerFactor(far / h, half / h) + cornerFactor(near / h, half / h));
        double wanted = 0.5 * 5 * factor;
        assertNear(radianceOf(scene, &options, 0), wanted, cases[i].bound * wanted, "radiance", (int)i);
        vplScene_Destroy(scene);
    }
}

TEST(OnlyTheFrontOfAnAreaLightEmits, 1)
{
    for (int behind = 0; behind < 2; behind++) {
        vplScene* scene = newScene(context);
        addQuad(scene, addGrey(scene, 0, 5), (vplVec3){0, 0, 0}, 0, 1);
        addQuad(scene, addGrey(scene, 0.5f, 0), (vplVec3){0, 0, -1}, 0, 4); // faces the back of the first
        addCamera(scene, (vplVec3){0, 0, behind ? -0.5f : 1}, (vplVec3){0, 0, 0}, NARROW);
        addCamera(scene, (vplVec3){0.3f, 0, -0.5f}, (vplVec3){0.3f, 0, -1}, NARROW);
        vplRenderOptions options = pathOptions(1, 16);
        assertNear(radianceOf(scene, &options, 0), behind ? 0 : 5, 0, "lamp", behind);
        options.output.camera = 1;
        assertNear(radianceOf(scene, &options, 0), 0, 0, "behind it", behind);
        vplScene_Destroy(scene);
    }
}

// ---- bounces with known answers

// Asserts that the mean of all pixels is within four of its standard deviations, and that the deviation is
// less than `share` of it.
static void assertMean(const vplScene* scene, const vplRenderOptions* options, double wanted, double share,
                       const char* what, int row)
{
    vplRenderStats stats;
    vplImage* image = renderScene(scene, options, &stats);
    double deviations = 4 * stats.errorEstimate / options->output.width;
    assert_true(deviations < share * wanted);
    assertNear(meanOfImage(image, 0), wanted, fmax(deviations, 1e-6 * wanted), what, row);
    vplImage_Destroy(image);
}

TEST(CubeMatchesTheTableBounceByBounce, 2, SLOW)
{
    static const char* const columns[] = {"E_direct", "E1_over_rho", "E2_over_rho^2", "E3_over_rho^3"};
    const float rho = 0.5f;
    Table t = loadTable("cube_physical.csv");
    for (int row = 0; row < t.rows; row++) {
        const float u = (float)number(&t, row, "u"), v = (float)number(&t, row, "v");
        vplScene* scene = newScene(context);
        addRoom(scene, addGrey(scene, rho, 0));
        addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 0, 0}, 1);
        addCamera(scene, (vplVec3){u, 0, v}, (vplVec3){u, -1, v}, NARROW);
        vplRenderOptions options = pathOptions(8, 512);
        options.output.show = VPL_SHOW_BOUNCE;
        for (int k = 0; k < 4; k++) {
            options.output.showIndex = k;
            double wanted = pow((double)rho, k + 1) / VPL_PI * number(&t, row, columns[k]);
            assertMean(scene, &options, wanted, k == 0 ? 1e-6 : k == 1 ? 0.01 : 0.025, columns[k], row);
        }
        options.output.show = VPL_SHOW_INDIRECT;
        double wanted = (double)rho / VPL_PI * number(&t, row, "E_indirect_total_rho0.5");
        assertMean(scene, &options, wanted, 0.015, "all bounces", row);
        vplScene_Destroy(scene);
    }
    freeTable(&t);
}

// A light in the centre of a sphere gives radiance rho/pi I/R^2 / (1 - rho) everywhere. The mesh lies inside
// the sphere by up to 1 - cos(half the angle of its edges), 0.05 %, which changes R^2 by twice as much.
TEST(SphereMatchesTheTable, 2, SLOW)
{
    Table t = loadTable("furnace_sphere.csv");
    for (int row = 0; row < t.rows; row++) {
        const float radius = (float)number(&t, row, "R"), rho = (float)number(&t, row, "rho");
        vplScene* scene = newScene(context);
        addSphere(scene, addGrey(scene, rho, 0), (vplVec3){0, 0, 0}, radius, 32, row & 1);
        addWhite(scene, VPL_EMITTER_POINT, (vplVec3){0, 0, 0}, (float)number(&t, row, "I"));
        vplCameraDef camera = vplDefaultCameraDef();
        camera.eye = (vplVec3){0.1f * radius, 0.2f * radius, 0.3f * radius};
        camera.nearPlane = 0.01 * (double)radius;
        camera.farPlane = 3 * (double)radius;
        camera.target = (vplVec3){-radius, 0, 0};
        camera.fovY = 1.5;
        assert_int_equal(vplScene_AddCamera(scene, &camera, NULL), VPL_SUCCESS);
        vplRenderOptions options = pathOptions(16, 64);
        double total = number(&t, row, "radiance_total_phys");
        assertNear(radianceOf(scene, &options, 0), total, 5e-3 * total, "total", row);
        options.output.show = VPL_SHOW_DIRECT;
        double direct = number(&t, row, "radiance_direct_phys");
        assertNear(radianceOf(scene, &options, 0), direct, 2e-3 * direct, "direct", row);
        vplScene_Destroy(scene);
    }
    freeTable(&t);
}

// ---- what paths keep

// A render's plan owns the camera and the emitters, and another plan may follow while the same pixels are traced further.
TEST(PathsGoOnWithoutTheCameraThatTheyBeganWith, 2)
{
    vplScene* scene = newScene(context);
    vplGeometry* geometry;
    vplSparsePixel pixels[2][4] = {{{0}}};
    addRoom(scene, addGrey(scene, 0.5f, 0));
    assert_int_equal(vplGeometry_Create(scene, &geometry), VPL_SUCCESS);
    for (int run = 0; run < 2; run++) {
        vplCameraDef camera = vplDefaultCameraDef();
        vplEmitterDef lamp = vplDefaultEmitterDef();
        camera.eye = (vplVec3){0.3f, 0.1f, 0.2f};
        camera.target = (vplVec3){-1, -0.4f, -0.8f};
        vplPathDef def = vplDefaultPathDef();
        def.camera = &camera;
        def.emitters = &lamp;
        def.emitterCount = 1;
        def.width = def.height = 4;
        for (int i = 0; i < 4; i++) {
            pixels[run][i].x = pixels[run][i].y = i;
        }
        vplSparsePaths paths;
        assert_int_equal(vplSparsePaths_Init(&paths, geometry, &def, pixels[run], 4), VPL_SUCCESS);
        if (run == 1) {
            memset(&camera, 0xff, sizeof camera);
            memset(&lamp, 0xff, sizeof lamp);
        }
        assert_int_equal(vplSparsePaths_Trace(&paths, 8, (vplProgressRange){NULL, NULL, 0, 1}), VPL_SUCCESS);
        vplSparsePaths_Free(&paths);
    }
    assert_true(pixels[0][1].sums[0].r > 0);
    assert_memory_equal(pixels[0], pixels[1], sizeof pixels[0]);
    vplGeometry_Destroy(geometry);
    vplScene_Destroy(scene);
}
