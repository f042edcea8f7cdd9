// SPDX-License-Identifier: MIT
// Tests of environments: furnaces, distributions, pictures and their turn, the sky's formulas, and every method against
// path tracing.
#include "emitter_scenes.h"
#include "failing.h"
#include "path_scenes.h"

#include "scene/scene.h"
#include "scene/sky.h"

static vplEnvironmentDef constantOf(float r, float g, float b)
{
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    def.type = VPL_ENVIRONMENT_CONSTANT;
    def.radiance = (vplRgb){r, g, b};
    return def;
}

static vplEnvironmentDef skyOf(double degrees, double turbidity, double turn)
{
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    def.type = VPL_ENVIRONMENT_SKY;
    def.elevation = degrees * VPL_PI / 180;
    def.turbidity = turbidity;
    def.rotate = turn * VPL_PI / 180;
    return def;
}

static void setEnvironment(vplScene* scene, vplEnvironmentDef def)
{
    assert_int_equal(vplScene_SetEnvironment(scene, &def), VPL_SUCCESS);
}

// Uneven light: bright and dark pixels, and a dark row.
enum { WIDTH = 16, HEIGHT = 8 };

static vplEnvironmentDef unevenOf(float* pixels)
{
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    for (int i = 0; i < 3 * WIDTH * HEIGHT; i++) {
        const int pixel = i / 3, y = pixel / WIDTH;
        pixels[i] = y == 5 ? 0 : (float)((7 * pixel + 3 * (i % 3)) % 13) * 0.25f;
    }
    pixels[3 * (2 * WIDTH + 11)] = 200;
    def.type = VPL_ENVIRONMENT_PICTURE;
    def.pixels = pixels;
    def.width = WIDTH;
    def.height = HEIGHT;
    return def;
}

static vplEnvironment* openEnvironment(vplContext* context, vplEnvironmentDef def)
{
    vplScene* scene = newScene(context);
    vplEnvironment* e;
    setEnvironment(scene, def);
    assert_int_equal(vplEnvironment_Create(scene, &e), VPL_SUCCESS);
    vplScene_Destroy(scene);
    assert_non_null(e);
    return e;
}

// ---- furnaces

static const vplMethod METHODS[] = {VPL_METHOD_DIRECT, VPL_METHOD_INSTANT_RADIOSITY, VPL_METHOD_KELLER,
                                    VPL_METHOD_SSVP,   VPL_METHOD_RADIOSITY,         VPL_METHOD_PATH};
enum { METHOD_COUNT = sizeof METHODS / sizeof *METHODS };

static vplRenderOptions optionsOf(vplMethod method, int width, int height)
{
    vplRenderOptions o = vplDefaultRenderOptions();
    o.method = method;
    o.output.width = width;
    o.output.height = height;
    o.path.samples = 256;
    o.radiosity.patches = 500;
    return o;
}

// A convex body receives no light of its own: wherever it faces, it shows rho L. Methods sample directions, so that the
// largest error over its pixels is stated.
TEST(AConvexBodyInAConstantSkyShowsRhoL, 2)
{
    enum { SIZE = 24 };
    static const double errors[METHOD_COUNT] = {0.001, 0.001, 0.03, 0.001, 0.001, 0.03};
    vplScene* scene = sceneOf(context, 0.6f);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, 0, 0), 0.4, 0.7, vplVec(1, 1, 1));
    addCamera(scene, vplVec(0, 0, 2), vplVec(0, 0, 0), 0.25);
    setEnvironment(scene, constantOf(4, 2, 1));
    for (int m = 0; m < METHOD_COUNT; m++) {
        const vplRenderOptions o = optionsOf(METHODS[m], SIZE, SIZE);
        vplImage* image = renderScene(scene, &o, NULL);
        double worst = 0, sum = 0;
        for (int i = 0; i < SIZE * SIZE; i++) {
            worst = fmax(worst, fabs((double)image->pixels[3 * i] / 2.4 - 1));
            worst = fmax(worst, fabs((double)image->pixels[3 * i + 2] / 0.6 - 1));
            sum += (double)image->pixels[3 * i] / 2.4 / (SIZE * SIZE);
        }
        vplImage_Destroy(image);
        printf("# convex body, method %d: largest error %.2g, of the mean %.2g\n", METHODS[m], worst,
               sum - 1);
        assert_true(worst < errors[m]);
        assert_true(fabs(sum - 1) < 0.0015);
    }
    vplScene_Destroy(scene);
}

// White bodies of any shape vanish before a constant sky: all radiance is L.
static vplScene* whiteCorner(vplContext* context, float rho)
{
    vplScene* scene = sceneOf(context, rho);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, -0.1f, 0), 0, 0, vplVec(3, 0.2f, 3));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(-1.3f, 0.7f, 0), 0, 0, vplVec(0.2f, 1.4f, 3));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.1f, 0.5f, -1.3f), 0, 0, vplVec(2.6f, 1, 0.2f));
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0.3f, 0.35f, 0.2f), 0, 0.5, vplVec(0.6f, 0.7f, 0.6f));
    addCamera(scene, vplVec(2.2f, 2.4f, 3.4f), vplVec(-0.2f, 0.3f, -0.2f), 0.75);
    return scene;
}

TEST(AWhiteSceneVanishesInAConstantSky, 2, SLOW)
{
    vplScene* scene = whiteCorner(context, 1);
    setEnvironment(scene, constantOf(2, 2, 2));
    vplRenderOptions o = optionsOf(VPL_METHOD_PATH, 32, 24);
    o.path.samples = 512;
    vplImage* image = renderScene(scene, &o, NULL);
    double worst = 0;
    for (int i = 0; i < 3 * 32 * 24; i++) {
        const double off = fabs((double)image->pixels[i] / 2 - 1);
        worst = off > worst ? off : worst; // gcc 12 for aarch64 fails to compile fmax in loops
    }
    const double mean = meanOfImage(image, 0) / 2;
    vplImage_Destroy(image);
    vplScene_Destroy(scene);
    printf("# white furnace: mean %.5f, largest error of a pixel %.3f\n", mean, worst);
    assert_true(fabs(mean - 1) < 0.001);
    assert_true(worst < 0.1);
}

// ---- the distribution

TEST(TheDensityOfDirectionsIntegratesToOne, 1)
{
    float pixels[3 * WIDTH * HEIGHT];
    vplEnvironmentDef def = unevenOf(pixels);
    def.rotate = 0.3;
    vplEnvironment* e = openEnvironment(context, def);
    enum { STEPS = 512 };
    double sum = 0, power = 0, seen = 0;
    for (int i = 0; i < STEPS; i++) {
        const double up = 1 - (2 * i + 1.0) / STEPS, flat = sqrt(1 - up * up);
        for (int k = 0; k < 2 * STEPS; k++) {
            const double turn = 2 * VPL_PI * (k + 0.5) / (2 * STEPS), angle = 2 * VPL_PI / STEPS / STEPS;
            const vplVec3 d = {(float)(flat * cos(turn)), (float)up, (float)(flat * sin(turn))};
            double density;
            power += angle * vplRgbMean(vplEnvironment_Light(e, d, &density));
            seen += angle * vplRgbMean(vplEnvironment_Radiance(e, d));
            sum += angle * density;
        }
    }
    assert_true(fabs(sum - 1) < 2e-3);
    assert_true(fabs(power / vplRgbMean(e->irradiance) - 1) < 2e-3);
    assert_true(fabs(seen / power - 1) < 0.02); // pixels are not as high at both ends
    vplEnvironment_Destroy(e);
}

// Samples of the environment estimate the integral of any function, and their density is that of their direction.
TEST(SamplesOfTheEnvironmentAreUnbiased, 1)
{
    enum { COUNT = 1 << 16 };
    float pixels[3 * WIDTH * HEIGHT];
    vplEnvironment* e = openEnvironment(context, unevenOf(pixels));
    double solidAngle = 0, upper = 0, irradiance = 0, exact = 0;
    int apart = 0;
    for (int i = 0; i < COUNT; i++) {
        const double v = i * 0.61803398874989485;
        const vplEnvironmentSample s = vplEnvironment_Sample(e, (i + 0.5) / COUNT, v - floor(v));
        const vplVec3 d = s.direction;
        double density;
        const vplRgb light = vplEnvironment_Light(e, d, &density);
        assert_true(fabs((double)vplLength(d) - 1) < 1e-6);
        apart += fabs(density / s.density - 1) > 1e-6 || light.g != s.light.g; // on edges of pixels
        assert_true(fabs(vplRgbMean(s.light) / s.density / vplRgbMean(e->irradiance) - 1) < 1e-6);
        solidAngle += 1 / s.density / COUNT;
        upper += d.y > 0 ? 1 / s.density / COUNT : 0;
        irradiance += (double)s.light.g / s.density * (d.y > 0 ? (double)d.y : 0) / COUNT;
    }
    for (int i = 0; i < 1024; i++) { // the same integral over a grid
        for (int k = 0; k < 1024; k++) {
            const double up = (i + 0.5) / 1024, flat = sqrt(1 - up * up),
                         turn = 2 * VPL_PI * (k + 0.5) / 1024;
            const vplVec3 d = {(float)(flat * cos(turn)), (float)up, (float)(flat * sin(turn))};
            double density;
            exact += (double)vplEnvironment_Light(e, d, &density).g * up * 2 * VPL_PI / 1024 / 1024;
        }
    }
    vplEnvironment_Destroy(e);
    printf("# solid angle %.4f of 4 pi, irradiance %.5f of %.5f\n", solidAngle / (4 * VPL_PI), irradiance,
           exact);
    assert_true(apart < COUNT / 1000);
    assert_true(fabs(upper / (2 * VPL_PI) - 1) < 0.01);
    assert_true(fabs(irradiance / exact - 1) < 0.01);
}

// The first number 0 is straight up, and nearly 1 nearly straight down, whatever shines there.
TEST(SamplesOfTheSkyReachBothPoles, 1)
{
    float pixels[3 * WIDTH * HEIGHT];
    const vplEnvironmentDef defs[2] = {constantOf(1, 1, 1), unevenOf(pixels)};
    for (int i = 0; i < 4; i++) {
        vplEnvironment* e = openEnvironment(context, defs[i / 2]);
        const vplVec3 d = vplEnvironment_Sample(e, i % 2 == 0 ? 0 : 1 - 0x1p-53, 0.3).direction;
        assertNear((double)vplLength(d), 1, 1e-6, "length", i);
        assertNear((double)d.y, i % 2 == 0 ? 1 : -1, 1e-6, "height", i);
        vplEnvironment_Destroy(e);
    }
}

TEST(APictureOfTheSkyLiesAsDescribed, 1)
{
    float pixels[3 * 8 * 4] = {0};
    const int row = 1, places[4] = {3, 5, 7, 1}; // just left of -z, right of it: +x, +z, -x
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    for (int i = 0; i < 4; i++) {
        for (int side = 0; side < 2; side++) { // two pixels, so that the direction is between their centres
            pixels[3 * (8 * row + (places[i] + side) % 8)] = (float)(i + 1);
            pixels[3 * (8 * (row + 1) + (places[i] + side) % 8)] = (float)(i + 1);
        }
    }
    def.type = VPL_ENVIRONMENT_PICTURE;
    def.pixels = pixels;
    def.width = 8;
    def.height = 4;
    static const vplVec3 axes[4] = {{0, 0, -1}, {1, 0, 0}, {0, 0, 1}, {-1, 0, 0}};
    for (int quarters = 0; quarters < 4; quarters++) {
        def.rotate = quarters * VPL_PI / 2;
        vplEnvironment* e = openEnvironment(context, def);
        for (int i = 0; i < 4; i++) { // a quarter turn brings +x to -z
            const float wanted = (float)((i + quarters) % 4 + 1);
            assert_true(fabsf(vplEnvironment_Radiance(e, axes[i]).r - wanted) < 1e-4f);
        }
        assert_true(vplEnvironment_Radiance(e, vplVec(0, 1, 0)).r == 0);
        vplEnvironment_Destroy(e);
    }
}

// ---- the sky

// Values of the paper's formulas, computed apart from the library: luminances in kcd/m^2.
TEST(TheSkyHasTheLuminancesOfThePaper, 1)
{
    (void)context;
    static const struct {
        double turbidity, degrees, zenith, x, y, opposite, towards;
    } rows[] = {
        {2, 60, 5.88674324931, 0.25142146237, 0.255923838154, 4.2272277492, 13.1225903923},
        {3, 45, 7.32035831671, 0.245678337977, 0.251476439702, 5.18130267411, 21.7223603165},
        {4, 20, 4.86599246038, 0.257650585886, 0.271230260705, 4.25188107893, 20.164370698},
        {6, 30, 9.58526980971, 0.265467947248, 0.281788813947, 6.71571195187, 36.103113368},
    };
    for (int i = 0; i < (int)(sizeof rows / sizeof *rows); i++) {
        const double theta = (90 - rows[i].degrees) * VPL_PI / 180, s = sqrt(0.5);
        const vplSky sky = vplSky_Make(rows[i].degrees * VPL_PI / 180, rows[i].turbidity);
        const double places[3][3] = {{0, 1, 0}, {-s, s, 0}, {sin(VPL_PI / 3), 0.5, 0}};
        const double wanted[3] = {rows[i].zenith, rows[i].opposite, rows[i].towards};
        assert_true(fabs(sky.sunTheta - theta) < 1e-12);
        assert_true(fabs(sky.zenith[0] / rows[i].zenith - 1) < 1e-9);
        assert_true(fabs(sky.zenith[1] / rows[i].x - 1) < 1e-9);
        assert_true(fabs(sky.zenith[2] / rows[i].y - 1) < 1e-9);
        for (int k = 0; k < 3; k++) {
            const vplRgb l = vplSky_Radiance(&sky, places[k]);
            const double luminance = 0.2126729 * l.r + 0.7151522 * l.g + 0.0721750 * l.b;
            assert_true(l.b > l.r || k > 0);
            assert_true(fabs(luminance * 0.683 / wanted[k] - 1) < 1e-4);
        }
    }
}

// Illuminance of the sun, klx: 128 outside the atmosphere; about 100 below a clear one.
TEST(TheSunFadesAndReddensTowardsTheHorizon, 1)
{
    (void)context;
    double before = 1000, colour = 0;
    for (int degrees = 90; degrees >= 5; degrees -= 17) {
        const vplSky sky = vplSky_Make(degrees * VPL_PI / 180, 2.5);
        const vplSky haze = vplSky_Make(degrees * VPL_PI / 180, 6);
        const vplRgb e = vplSky_SunIrradiance(&sky), dim = vplSky_SunIrradiance(&haze);
        const double lux = 0.683 * (0.2126729 * e.r + 0.7151522 * e.g + 0.0721750 * e.b);
        printf("# sun at %d degrees: %.1f klx, (%.1f, %.1f, %.1f) W/m^2\n", degrees, lux, (double)e.r,
               (double)e.g, (double)e.b);
        assert_true(lux < before && dim.g < e.g);
        assert_true((double)e.r / (double)(e.b + 1e-3f) > colour);
        assert_true(degrees < 90 || (lux > 90 && lux < 115));
        before = lux;
        colour = (double)e.r / (double)(e.b + 1e-3f);
    }
}

TEST(TheSunIsTheLastEmitterAndGoesWithItsSky, 1)
{
    vplScene* scene = newScene(context);
    assert_int_equal(vplScene_GetSun(scene), -1);
    setEnvironment(scene, skyOf(30, 3, 90)); // a quarter turn brings the sun from +x to -z
    assert_int_equal(vplScene_GetSun(scene), 0);
    const vplEmitterDef* sun = vplScene_GetEmitter(scene, 0);
    assert_int_equal(sun->type, VPL_EMITTER_DIRECTIONAL);
    assert_true(fabsf(sun->direction.y + 0.5f) < 1e-6f && sun->direction.z > 0.866f &&
                fabsf(sun->direction.x) < 1e-6f);
    setEnvironment(scene, skyOf(60, 3, 0));
    assert_int_equal(vplScene_GetEmitterCount(scene), 1);
    setEnvironment(scene, constantOf(1, 1, 1));
    assert_int_equal(vplScene_GetEmitterCount(scene), 0);
    setEnvironment(scene, skyOf(60, 3, 0));
    addEmitter(scene, VPL_EMITTER_POINT, vplVec(0, 1, 0), vplVec(0, -1, 0), 1);
    setEnvironment(scene, vplDefaultEnvironmentDef());
    assert_int_equal(vplScene_GetEmitterCount(scene), 2);
    assert_true(vplScene_GetEmitter(scene, 0)->intensity.g == 0);
    assert_int_equal(vplScene_GetSun(scene), -1);
    vplScene_Destroy(scene);
}

// ---- pictures

static double sumOf(const vplImage* image)
{
    return meanOfImage(image, 0) + meanOfImage(image, 1) + meanOfImage(image, 2);
}

// Reflected light of the corner, by each method over paths. Where light is reflected once only the sampled directions
// matter; reflected light shows what particles and patches receive.
TEST(EveryMethodHasTheEnergyOfPaths, 2, SLOW)
{
    static const struct {
        vplMethod method;
        double all, indirect; // largest relative error
    } rows[] = {{VPL_METHOD_KELLER, 0.005, 0.01},
                {VPL_METHOD_RADIOSITY, 0.005, 0.01},
                {VPL_METHOD_SSVP, 0.015, 0.05}};
    float pixels[3 * WIDTH * HEIGHT];
    const vplEnvironmentDef skies[3] = {constantOf(1, 2, 3), unevenOf(pixels), skyOf(40, 3, 150)};
    for (int sky = 0; sky < 3; sky++) {
        vplScene* scene = whiteCorner(context, 0.7f);
        setEnvironment(scene, skies[sky]);
        for (int show = 0; show < 2; show++) {
            vplRenderOptions o = optionsOf(VPL_METHOD_PATH, 48, 36);
            o.output.show = show > 0 ? VPL_SHOW_INDIRECT : VPL_SHOW_PICTURE;
            o.path.samples = sky == 2 ? 1024 : 256; // the sun leaves more noise
            vplImage* truth = renderScene(scene, &o, NULL);
            for (int i = 0; i < 3; i++) {
                o.method = rows[i].method;
                o.radiosity.patches = 3000;
                // Four passes: 16,000 particles leave 1 % of noise in the sum of the reflected light.
                o.particles.count = o.method == VPL_METHOD_KELLER ? 16000 : -1;
                o.stop.passes = o.method == VPL_METHOD_KELLER ? 4 : 0;
                o.pipeline.interleave = o.method == VPL_METHOD_KELLER ? 4 : -1;
                vplImage* image = renderScene(scene, &o, NULL);
                const double ratio = sumOf(image) / sumOf(truth);
                printf("# sky %d, %s, method %d: %.4f of the energy of paths\n", sky,
                       show > 0 ? "indirect" : "all", rows[i].method, ratio);
                vplImage_Destroy(image);
                assert_true(fabs(ratio - 1) < (show > 0 ? rows[i].indirect : rows[i].all));
            }
            vplImage_Destroy(truth);
        }
        vplScene_Destroy(scene);
    }
}

// A black body hides its share of each pixel at its edges.
TEST(TheBackgroundFillsWhatSurfacesLeaveFree, 2)
{
    vplScene* scene = sceneOf(context, 0);
    addThing(scene, VPL_OBJECT_BOX, 0, vplVec(0, 0, 0), 0.4, 0.7, vplVec(1, 1, 1));
    addCamera(scene, vplVec(0, 0, 3), vplVec(0, 0, 0), 0.8);
    setEnvironment(scene, constantOf(1, 1, 1));
    vplRenderOptions o = optionsOf(VPL_METHOD_PATH, 40, 30);
    o.path.samples = 512;
    vplImage* truth = renderScene(scene, &o, NULL);
    static const vplAccumulation kinds[] = {VPL_ACCUMULATE_MULTIPASS, VPL_ACCUMULATE_BATCHED,
                                            VPL_ACCUMULATE_DEFERRED, VPL_ACCUMULATE_INTERLEAVED,
                                            VPL_ACCUMULATE_LIGHTCUTS};
    for (int i = 0; i < 5; i++) {
        o.method = VPL_METHOD_KELLER;
        o.pipeline.kind = kinds[i];
        o.particles.count = 50;
        vplImage* image = renderScene(scene, &o, NULL);
        double worst = 0;
        for (int k = 0; k < 3 * 40 * 30; k++) {
            const double off = fabs((double)image->pixels[k] - (double)truth->pixels[k]);
            worst = off > worst ? off : worst;
        }
        vplImage_Destroy(image);
        printf("# background, pipeline %d: %.3f\n", kinds[i], worst);
        // A sample of nine, and what the path tracer leaves; one sample in passes.
        assert_true(kinds[i] < VPL_ACCUMULATE_DEFERRED ? worst < 0.6 : worst < 0.14);
    }
    assert_true(meanOfImage(truth, 0) > 0.5 && meanOfImage(truth, 0) < 0.95);
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
}

static uint64_t hashOfSkies(vplContext* context)
{
    uint64_t hash = 0;
    for (int m = 0; m < METHOD_COUNT; m++) {
        vplScene* scene = whiteCorner(context, 0.5f);
        setEnvironment(scene, skyOf(35, 3, 60));
        vplRenderOptions o = optionsOf(METHODS[m], 24, 20);
        o.path.samples = 4;
        o.radiosity.patches = 100;
        o.particles.count = METHODS[m] == VPL_METHOD_KELLER ? 200 : 20;
        vplImage* image = renderScene(scene, &o, NULL);
        hash = hash * 31 + vplImage_Hash(image);
        vplImage_Destroy(image);
        vplScene_Destroy(scene);
    }
    closeTestContext(context);
    return hash;
}

TEST_ALONE(SkiesHaveTheSameBitsEverywhere)
{
    assertSameEverywhere(hashOfSkies);
}

// Passes of Keller's method each bring their own directions; their mean has less noise.
TEST(PassesSampleTheSkyAnew, 2, SLOW)
{
    vplScene* scene = whiteCorner(context, 0.5f);
    setEnvironment(scene, constantOf(1, 1, 1));
    vplRenderOptions o = optionsOf(VPL_METHOD_KELLER, 32, 24);
    o.particles.count = 100;
    vplImage* truth;
    double errors[2];
    vplRenderOptions paths = optionsOf(VPL_METHOD_PATH, 32, 24);
    paths.path.samples = 1024;
    truth = renderScene(scene, &paths, NULL);
    for (int i = 0; i < 2; i++) {
        o.stop.passes = i == 0 ? 1 : 16;
        vplImage* image = renderScene(scene, &o, NULL);
        errors[i] = 0;
        for (int k = 0; k < 3 * 32 * 24; k++) {
            const double d = (double)image->pixels[k] - (double)truth->pixels[k];
            errors[i] += d * d;
        }
        vplImage_Destroy(image);
    }
    vplImage_Destroy(truth);
    vplScene_Destroy(scene);
    printf("# squared error of 16 passes over that of one: %.3f\n", errors[1] / errors[0]);
    assert_true(errors[1] < 0.4 * errors[0]);
}

// ---- declarations

TEST(EnvironmentsChangeTheHashOfAScene, 1)
{
    float pixels[3 * WIDTH * HEIGHT];
    vplScene* scene = newScene(context);
    const uint64_t plain = vplScene_GetHash(scene);
    uint64_t hashes[6];
    vplEnvironmentDef turned = unevenOf(pixels), scaled = turned;
    turned.rotate = 0.1;
    scaled.scale = 2;
    const vplEnvironmentDef defs[6] = {
        constantOf(1, 1, 1), constantOf(1, 1, 2), unevenOf(pixels), turned, scaled, skyOf(30, 3, 0)};
    for (int i = 0; i < 6; i++) {
        setEnvironment(scene, defs[i]);
        hashes[i] = vplScene_GetHash(scene);
        assert_true(hashes[i] != plain);
        for (int k = 0; k < i; k++) {
            assert_true(hashes[i] != hashes[k]);
        }
    }
    setEnvironment(scene, vplDefaultEnvironmentDef());
    assert_true(vplScene_GetHash(scene) == plain);
    vplScene_Destroy(scene);
}

TEST(WrongEnvironmentsAreRefusedByName, 1)
{
    float pixels[3 * WIDTH * HEIGHT];
    vplScene* scene = newScene(context);
    vplEnvironmentDef defs[9];
    for (int i = 0; i < 9; i++) {
        defs[i] = unevenOf(pixels);
    }
    defs[0].cookie = 0;
    defs[1].type = (vplEnvironmentType)7;
    defs[2].radiance.g = -1;
    defs[3].scale = -1;
    defs[4].rotate = NAN;
    defs[5].elevation = 2;
    defs[6].turbidity = 1;
    defs[7].width = 0;
    defs[8].pixels = NULL;
    static const char* const fields[9] = {"was not made by", "type is 7",     "radiance[1] is -1",
                                          "scale is -1",     "rotate is nan", "elevation is 2",
                                          "turbidity is 1",  "width is 0",    "pixels must not be NULL"};
    for (int i = 0; i < 9; i++) {
        assert_int_equal(vplScene_SetEnvironment(scene, &defs[i]), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), fields[i]));
    }
    vplEnvironmentDef bad = unevenOf(pixels);
    pixels[5] = -2;
    assert_int_equal(vplScene_SetEnvironment(scene, &bad), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "pixels[5] is -2"));
    assert_int_equal(vplScene_GetEnvironment(scene)->type, VPL_ENVIRONMENT_NONE);
    assert_int_equal(vplScene_LoadEnvironment(scene, "nowhere.hdr", &bad), VPL_FILE_ERROR);
    vplScene_Destroy(scene);
}

TEST(WhatMethodsCannotDoWithASkyIsSaid, 1)
{
    static const struct {
        vplMethod method;
        vplLighting lighting;
        vplLightShadows shadows;
        const char* sentence;
    } rows[] = {
        {VPL_METHOD_KELLER, VPL_LIGHTING_PHYSICAL, VPL_LIGHT_SHADOWS_MAP, "too far away for shadow maps"},
        {VPL_METHOD_KELLER, VPL_LIGHTING_DOCUMENTED, VPL_LIGHT_SHADOWS_RAY, "knows no environment"},
        {VPL_METHOD_DIRECT, VPL_LIGHTING_DOCUMENTED, VPL_LIGHT_SHADOWS_USUAL, "knows no environment"}};
    vplScene* scene = whiteCorner(context, 0.5f);
    setEnvironment(scene, constantOf(1, 1, 1));
    for (int i = 0; i < 3; i++) {
        vplImage* image = NULL;
        vplRenderOptions o = optionsOf(rows[i].method, 8, 8);
        o.lighting = rows[i].lighting;
        o.lights.shadows = rows[i].shadows;
        assert_int_equal(vplRender(scene, &o, &image, NULL), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), rows[i].sentence));
    }
    vplScene_Destroy(scene);
}

static vplResult makeSky(Attempt* a)
{
    vplEnvironmentDef def = a->variant == 0 ? skyOf(30, 3, 0) : constantOf(1, 1, 1);
    TRY(vplScene_Create(a->context, &a->scene));
    TRY(a->variant == 2 ? vplScene_LoadEnvironment(a->scene, "tests/fuzz/corpus/image/small.hdr", &def)
                        : vplScene_SetEnvironment(a->scene, &def));
    return vplGeometry_Create(a->scene, &a->geometry);
}

static bool stopAtCall(void* user, double fraction)
{
    int* left = user;
    return fraction >= 0 && --*left != 0;
}

// A picture of 2^19 pixels is copied to the scene, copied to the geometry and summed up: each asks twice.
TEST(LargePicturesOfTheSkyCanBeCancelled, 1)
{
    enum { LARGE = 1024, HIGH = 512 };
    float* pixels = calloc(LARGE * HIGH, 3 * sizeof *pixels);
    vplEnvironmentDef def = vplDefaultEnvironmentDef();
    def.type = VPL_ENVIRONMENT_PICTURE;
    def.pixels = pixels;
    def.width = LARGE;
    def.height = HIGH;
    pixels[0] = 1;
    for (int stop = 1; stop <= 6; stop++) {
        vplScene* scene = newScene(context);
        vplEnvironment* e = NULL;
        int left = stop;
        vplContext_SetProgress(context, stopAtCall, &left);
        vplResult result = vplScene_SetEnvironment(scene, &def);
        assert_int_equal(result, stop <= 2 ? VPL_CANCELLED : VPL_SUCCESS);
        assert_int_equal(vplScene_GetEnvironment(scene)->type,
                         stop <= 2 ? VPL_ENVIRONMENT_NONE : VPL_ENVIRONMENT_PICTURE);
        result = stop <= 2 ? result : vplEnvironment_Create(scene, &e);
        assert_true(result == VPL_CANCELLED && e == NULL && left == 0);
        vplContext_SetProgress(context, NULL, NULL);
        vplScene_Destroy(scene);
    }
    free(pixels);
}

TEST_ALONE(FailedAllocationsOfSkiesAreReported)
{
    failEveryAllocation("sky", makeSky, "", 3);
}

TEST_ALONE(NoSceneHasNoSun)
{
    assert_int_equal(vplScene_GetSun(NULL), -1);
}
