// SPDX-License-Identifier: MIT
// Tests of direct light and of sums of lights against exact answers; test_kernel_values.c has single lights. Covers
// extremes X091, X092 and X112.
#include "kernel_points.h"
#include "scenes.h"

#include "math/vec.h"
#include "shading/shading.h"

#include <stdlib.h>

static double irradiance(const vplContext* context, vplLighting lighting, float minDistance, vplVec3 p,
                         vplVec3 n, const vplShadeLight* lights, int count)
{
    return irradianceAt(context, (vplLightFormula){lighting, minDistance}, p, n, lights, count);
}

// Returns the first directions of the tables: spherical Fibonacci points about y.
static vplVec3 fibonacci(int i, int count)
{
    double y = 1 - (2.0 * i + 1) / count, r = sqrt(1 - y * y),
           angle = 2 * VPL_PI * i / 1.61803398874989484820;
    return vplVec((float)(r * cos(angle)), (float)y, (float)(r * sin(angle)));
}

// In a sphere lit from its centre, G is 1/(4 R^2) between all points: the physical sum is exact for any
// lights.
TEST(FurnaceSphereIsExact, 1)
{
    Table t = loadTable("furnace_sphere.csv");
    for (int row = 0; row < t.rows; row++) {
        double radius = number(&t, row, "R"), rho = number(&t, row, "rho"), intensity = number(&t, row, "I");
        int n = (int)number(&t, row, "N");
        int counts[64];
        vplStepTotals totals;
        assert_int_equal(vplCountParticles(context, &(vplParticlePass){0, n, rho}, counts, 64, &totals),
                         VPL_SUCCESS);
        assert_int_equal(totals.stepCount, (int)number(&t, row, "steps"));
        vplVec3 at = vplScale((float)radius, vplNormalize(vplVec(0.3f, -0.5f, 0.8f))),
                normal = vplNormalize(vplNegate(at));
        double e = number(&t, row, "E_direct");
        for (int k = 0; k < totals.stepCount; k++) {
            double flux = 4 * VPL_PI * intensity * pow(rho, k + 1);
            for (int i = 0; i < counts[k]; i++) {
                vplVec3 d = fibonacci(i, n); // anywhere on the sphere
                vplShadeLight light = lightAt(vplScale((float)radius, d), vplNegate(vplNormalize(d)),
                                              (float)(flux / VPL_PI / counts[k]));
                e += irradiance(context, VPL_LIGHTING_PHYSICAL, 0, at, normal, &light, 1);
            }
        }
        double wanted = number(&t, row, "radiance_total_phys_truncated");
        assertNear(rho / VPL_PI * e, wanted, 2e-6 * wanted, "radiance", row);
    }
    freeTable(&t);
}

TEST(DocumentedFurnaceSphereIsThatOfTheTable, 1)
{
    Table t = loadTable("furnace_sphere_documented.csv");
    for (int row = 0; row < t.rows; row++) {
        double rho = number(&t, row, "rho"), radius = number(&t, row, "R"), sum = 0;
        int n = (int)number(&t, row, "N");
        int counts[64];
        vplStepTotals totals;
        assert_int_equal(vplCountParticles(context, &(vplParticlePass){0, n, rho}, counts, 64, &totals),
                         VPL_SUCCESS);
        vplVec3 direction = vplNormalize(vectorOf(&t, row, ""));
        vplVec3 at = vplScale((float)radius, direction);
        for (int k = 0; k < totals.stepCount; k++) {
            double carried = number(&t, row, "I") * pow(rho / VPL_PI, k + 1);
            for (int i = 0; i < counts[k]; i++) {
                vplVec3 d = vplScale(k % 2 ? -(float)radius : (float)radius, vplNormalize(fibonacci(i, n)));
                vplShadeLight light = lightAt(d, vplNormalize(vplNegate(d)), (float)(carried / counts[k]));
                sum += irradiance(context, VPL_LIGHTING_DOCUMENTED, 0, at, vplNegate(direction), &light, 1);
            }
        }
        double wanted = number(&t, row, "doc_indirect");
        assertNear(rho / VPL_PI * sum, wanted, 1e-5 * wanted, "documented radiance", row);
    }
    freeTable(&t);
}

// Returns the irradiance of one step's lights at the floor point (u, -1, v) of the closed cube.
static double stepIrradiance(vplContext* context, const vplLightSet* set, vplLighting lighting, int step,
                             double u, double v)
{
    vplShadeLight* lights = malloc((size_t)set->lightCount * sizeof *lights);
    vplPrepareLights(set, lighting, lights);
    double sum = 0;
    for (int i = 0; i < set->lightCount; i++) {
        if (set->lights[i].step == step) {
            sum += irradiance(context, lighting, 0, vplVec((float)u, -1, (float)v), vplVec(0, 1, 0),
                              &lights[i], 1);
        }
    }
    free(lights);
    return sum;
}

static vplLightSet* cubeLights(const vplGeometry* cube, vplLighting lighting, int n, double rho,
                               uint64_t seed)
{
    vplParticleDef def = vplDefaultParticleDef();
    def.lighting = lighting;
    def.particleCount = n;
    def.reflectivity = rho;
    def.sampler = VPL_SAMPLER_HALTON;
    def.seed = seed;
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplLightSet* set;
    assert_int_equal(vplSimulateParticles(cube, &emitter, 1, &def, &set), VPL_SUCCESS);
    return set;
}

TEST(LightsInACubeConvergeToTheTable, 2, SLOW)
{
    Table t = loadTable("cube_physical.csv");
    vplGeometry* cube = closedCube(context, 0.9f);
    const char* const columns[3] = {"E1_over_rho", "E2_over_rho^2", "E3_over_rho^3"};
    enum { SEEDS = 24 };
    double sums[5][3] = {{0}}, squares[5][3] = {{0}};
    assert_int_equal(t.rows, 5);
    for (uint64_t seed = 1; seed <= SEEDS; seed++) {
        vplLightSet* set = cubeLights(cube, VPL_LIGHTING_PHYSICAL, 10000, 0.9, seed);
        for (int row = 0; row < t.rows; row++) {
            for (int k = 0; k < 3; k++) {
                double e = stepIrradiance(context, set, VPL_LIGHTING_PHYSICAL, k, number(&t, row, "u"),
                                          number(&t, row, "v")) /
                           pow(0.9, k + 1);
                sums[row][k] += e / SEEDS;
                squares[row][k] += e * e / SEEDS;
            }
        }
        vplLightSet_Destroy(set);
    }
    for (int row = 0; row < t.rows; row++) {
        for (int k = 0; k < 3; k++) {
            double mean = sums[row][k], error = sqrt((squares[row][k] - mean * mean) / (SEEDS - 1));
            assertNear(mean, number(&t, row, columns[k]), 3 * error + 3e-5, columns[k], row);
            // A tolerance of three standard errors is meaningful only if they are small. The point at (0.9,
            // 0.9) is 0.1 from two walls, where 1/d^2 of a few lights is noisy.
            assert_true(error < (number(&t, row, "u") > 0.8 ? 0.02 : 0.005) * mean);
        }
    }
    vplGeometry_Destroy(cube);
    freeTable(&t);
}

TEST(DocumentedLightsInACubeConvergeToTheTable, 2)
{
    Table t = loadTable("cube_documented.csv");
    vplGeometry* cube = closedCube(context, 0.9f);
    vplLightSet* set = cubeLights(cube, VPL_LIGHTING_DOCUMENTED, 60000, 0.9, 0);
    for (int row = 0; row < t.rows; row++) {
        for (int k = 0; k < 4; k++) {
            char column[8];
            snprintf(column, sizeof column, "Ecos_k%d", k);
            double e = stepIrradiance(context, set, VPL_LIGHTING_DOCUMENTED, k, number(&t, row, "u"),
                                      number(&t, row, "v"));
            double wanted = number(&t, row, column);
            assertNear(e / pow(0.9 / VPL_PI, k + 1), wanted, 0.003 * wanted, column, row);
        }
    }
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(cube);
    freeTable(&t);
}

// The sum of all documented lights of the first step, for N particles.
static double firstStep(const vplGeometry* cube, int particles)
{
    vplLightSet* set = cubeLights(cube, VPL_LIGHTING_DOCUMENTED, particles, 0.6, 0);
    vplShadeLight* lights = malloc((size_t)set->lightCount * sizeof *lights);
    double sum = 0;
    vplPrepareLights(set, VPL_LIGHTING_DOCUMENTED, lights);
    for (int i = 0; i < set->lightCount; i++) {
        sum += set->lights[i].step == 0 ? (double)lights[i].r : 0;
    }
    free(lights);
    vplLightSet_Destroy(set);
    return sum;
}

// The red irradiance below a point light at height d.
static double directBelow(vplContext* context, vplLighting lighting, float d, int particles)
{
    vplGeometry* floor = floorQuad(context, vplVec(0, 0, 0), 2, 0.5f);
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = vplVec(0, d, 0);
    vplShadow shadow = {0};
    vplShadeDef def = vplDefaultShadeDef();
    def.lighting = lighting;
    def.emitters = &emitter;
    def.shadows = &shadow;
    def.emitterCount = 1;
    def.particleCount = particles;
    const vplSurfacePoint point = {{0, 0, 0}, {0, 1, 0}, 0};
    vplRgb e;
    int64_t rays = 0;
    assert_int_equal(vplShadePoints(floor, &def, &point, 1, &e, &rays), VPL_SUCCESS);
    vplGeometry_Destroy(floor);
    return (double)e.r;
}

// X059: l / |l| and 1 / d^2 are not defined at the light itself, which adds nothing there: on either side of a surface, in
// both lightings, with and without a shadow map.
TEST(APointAtTheLightGetsNothing, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = vplVec(0.25f, -1, 0.5f); // on the floor
    const vplSurfacePoint points[2] = {{emitter.position, {0, 1, 0}, 0}, {emitter.position, {0, -1, 0}, 0}};
    vplShadowDef shadowDef = vplDefaultShadowDef();
    vplCubeMap* map;
    vplShadow shadows[2] = {{0}};
    vplCubeMapDef mapDef = vplDefaultCubeMapDef();
    mapDef.position = emitter.position;
    mapDef.size = 16;
    assert_int_equal(vplCubeMap_Create(cube, &mapDef, NULL, NULL, &map), VPL_SUCCESS);
    assert_int_equal(vplShadow_Create(map, &shadowDef, &shadows[1]), VPL_SUCCESS);
    for (int i = 0; i < 4; i++) {
        vplShadeDef def = vplDefaultShadeDef();
        def.lighting = (vplLighting)(i % 2);
        def.emitters = &emitter;
        def.shadows = &shadows[i / 2];
        def.emitterCount = 1;
        vplRgb e[2] = {{-1, -1, -1}, {-1, -1, -1}};
        assert_int_equal(vplShadePoints(cube, &def, points, 2, e, NULL), VPL_SUCCESS);
        for (int k = 0; k < 2; k++) {
            assert_true(e[k].r == 0 && e[k].g == 0 && e[k].b == 0);
        }
    }
    vplCubeMap_Destroy(map);
    vplGeometry_Destroy(cube);
}

// The rows on Franchi and Ferrante in estimator_factors.csv that are about single terms. "FF bounce direction"
// has no factor, "units" is no formula, and "FF light of step k" and "FF series" follow below.
TEST(TermsOfBothLightingsDifferByTheFactorsOfTheTable, 1)
{
    Table t = loadTable("estimator_factors.csv");
    vplGeometry* cube = closedCube(context, 0.7f);
    int rows = 0;
    for (int row = 0; row < t.rows; row++) {
        const char *term = cell(&t, row, "term"), *factor = cell(&t, row, "physical/documented");
        if (strcmp(term, "FF direct") == 0) {
            assert_non_null(strstr(factor, "N / d^2"));
            for (int n = 1; n < 100; n *= 3) {
                const float d = 0.5f * (float)n;
                const double physical = directBelow(context, VPL_LIGHTING_PHYSICAL, d, n);
                const double documented = directBelow(context, VPL_LIGHTING_DOCUMENTED, d, n);
                assertNear(physical / documented / (n / (double)d / (double)d), 1, 1e-6, term, row);
            }
        } else if (strcmp(term, "FF kernel at x") == 0) {
            assert_string_equal(factor, "V / r^2");
            for (float r = 0.25f; r < 20; r *= 3) {
                const vplVec3 x = {0, 0, 0}, up = {0, 1, 0};
                const vplShadeLight light =
                    lightAt(vplVec(0.6f * r, 0.8f * r, 0), vplVec(-0.6f, -0.8f, 0), 1);
                const double physical = irradiance(context, VPL_LIGHTING_PHYSICAL, 0, x, up, &light, 1);
                const double documented = irradiance(context, VPL_LIGHTING_DOCUMENTED, 0, x, up, &light, 1);
                assertNear(physical / documented * (double)r * (double)r, 1, 1e-6, term, row);
            }
        } else if (strcmp(term, "FF dependence on N") == 0) { // direct ~ 1/N, indirect ~ const
            const double one = directBelow(context, VPL_LIGHTING_DOCUMENTED, 1, 10);
            assertNear(one / directBelow(context, VPL_LIGHTING_DOCUMENTED, 1, 40), 4, 1e-5, term, row);
            assertNear(directBelow(context, VPL_LIGHTING_PHYSICAL, 1, 40) /
                           directBelow(context, VPL_LIGHTING_PHYSICAL, 1, 10),
                       1, 1e-7, term, row);
            assertNear(firstStep(cube, 10) / firstStep(cube, 40), 1, 1e-5, term, row);
        } else {
            continue;
        }
        rows++;
    }
    assert_int_equal(rows, 3);
    assert_int_equal(t.rows, 3 + 3 + 4); // three more on Keller's light, in another suite
    vplGeometry_Destroy(cube);
    freeTable(&t);
}

// "FF light of step k": results of the two lightings for the same particles differ by 4 pi^(k+1); "FF series":
// so do all terms of a step, by pi for each.
TEST(LightsOfBothLightingsDifferByTheFactorsOfTheTable, 1)
{
    vplGeometry* cube = closedCube(context, 0.7f);
    vplLightSet* documented = cubeLights(cube, VPL_LIGHTING_DOCUMENTED, 50, 0.6, 0);
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 50;
    def.reflectivity = 0.6;
    def.sampler = VPL_SAMPLER_HALTON;
    def.bounce = VPL_BOUNCE_REFLECT; // the same hit points for both lightings
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplLightSet* physical;
    assert_int_equal(vplSimulateParticles(cube, &emitter, 1, &def, &physical), VPL_SUCCESS);
    assert_int_equal(documented->lightCount, physical->lightCount);
    vplShadeLight *d = malloc(500 * sizeof *d), *p = malloc(500 * sizeof *p);
    int steps = 0;
    vplPrepareLights(documented, VPL_LIGHTING_DOCUMENTED, d);
    vplPrepareLights(physical, VPL_LIGHTING_PHYSICAL, p);
    for (int i = 0; i < documented->lightCount; i++) {
        double factor = 4 * pow(VPL_PI, documented->lights[i].step + 1); // 4 pi^(k+1) (n.w)+
        assertNear((double)p[i].r, factor * (double)d[i].r, 1e-5 * factor * (double)d[i].r, "factor", i);
        steps = documented->lights[i].step > steps ? documented->lights[i].step : steps;
    }
    assert_true(steps >= 5);
    free(d);
    free(p);
    vplLightSet_Destroy(documented);
    vplLightSet_Destroy(physical);
    vplGeometry_Destroy(cube);
}

// Renders a floor from above, lit by `lights`.
static vplImage* shadeFloor(vplContext* context, vplShadeDef def, int width, int height)
{
    vplGeometry* g = floorQuad(context, vplVec(0, 0, 0), 10, 0.5f);
    vplCameraDef camera = vplDefaultCameraDef();
    camera.eye = vplVec(0, 3, 0.01f);
    vplView view = vplView_Create(&camera, width, height);
    vplImage* image;
    assert_int_equal(vplImage_Create(context, width, height, &image), VPL_SUCCESS);
    assert_int_equal(vplShadeView(g, &view, &def, image, NULL), VPL_SUCCESS);
    vplGeometry_Destroy(g);
    return image;
}

// X091: a million equal lights give a million times one light; a float sum would stop growing.
TEST(AMillionEqualLightsAddUp, 2)
{
    enum { COUNT = 1000000 };
    vplShadeLight* lights = malloc(COUNT * sizeof *lights);
    for (int i = 0; i < COUNT; i++) {
        lights[i] = lightAt(vplVec(0.3f, 2, 0.1f), vplVec(0, -1, 0), 0.1f);
    }
    vplShadeDef def = vplDefaultShadeDef();
    def.accumulation = VPL_ACCUMULATE_DEFERRED;
    def.lights = lights;
    def.lightCount = 1;
    vplImage* one = shadeFloor(context, def, 4, 4);
    def.lightCount = COUNT;
    vplImage* many = shadeFloor(context, def, 4, 4);
    for (int i = 0; i < 3 * 16; i++) {
        double wanted = COUNT * (double)one->pixels[i];
        assertNear((double)many->pixels[i], wanted, 4e-6 * wanted, "sum", i);
    }
    vplImage_Destroy(one);
    vplImage_Destroy(many);
    free(lights);
}

static const int ODD_SIZES[][2] = {{1, 1}, {3, 5}, {64, 64}, {65, 63}, {130, 67}};

// X112, X092: picture sizes that are no multiple of a tile or block, and no light at all.
TEST(EveryPixelOfAnySizeIsShadedOnce, 2)
{
    vplShadeLight light = lightAt(vplVec(0, 5, 0), vplVec(0, -1, 0), 1);
    const int(*sizes)[2] = ODD_SIZES;
    for (int i = 0; i < 5; i++) {
        vplShadeDef def = vplDefaultShadeDef();
        def.lighting = VPL_LIGHTING_DOCUMENTED;
        def.lights = &light;
        def.lightCount = 1;
        def.batch = 1;
        vplImage* images[3];
        for (int k = 0; k < 3; k++) {
            def.accumulation = (vplAccumulation)k;
            images[k] = shadeFloor(context, def, sizes[i][0], sizes[i][1]);
            assert_true(vplImage_Hash(images[k]) == vplImage_Hash(images[0]));
        }
        for (int p = 0; p < 3 * sizes[i][0] * sizes[i][1]; p++) {
            assert_true(images[0]->pixels[p] > 0.1f && images[0]->pixels[p] < 0.5f);
        }
        for (int k = 0; k < 3; k++) {
            vplImage_Destroy(images[k]);
        }
        def.lightCount = 0;
        vplImage* dark = shadeFloor(context, def, sizes[i][0], sizes[i][1]);
        for (int p = 0; p < 3 * sizes[i][0] * sizes[i][1]; p++) {
            assert_true(dark->pixels[p] == 0);
        }
        vplImage_Destroy(dark);
    }
}

// X112: picture sizes that are no multiple of the square of pixels that share the lights. K^2 equal lights straight above,
// one for each pixel of the square, light every pixel as all of them do.
TEST(EveryPixelOfAnySizeIsInterleavedOnce, 2)
{
    enum { MOST_LIGHTS = VPL_MAX_INTERLEAVE * VPL_MAX_INTERLEAVE };
    vplShadeLight lights[MOST_LIGHTS];
    for (int i = 0; i < MOST_LIGHTS; i++) {
        lights[i] = lightAt(vplVec(0, 1e7f, 0), vplVec(0, -1, 0), 1);
    }
    for (int i = 0; i < 5; i++) {
        const int width = ODD_SIZES[i][0], height = ODD_SIZES[i][1];
        for (int side = 2; side <= VPL_MAX_INTERLEAVE; side++) {
            vplShadeDef def = vplDefaultShadeDef();
            def.lighting = VPL_LIGHTING_DOCUMENTED;
            def.accumulation = VPL_ACCUMULATE_INTERLEAVED;
            def.interleave = side;
            def.lights = lights;
            def.lightCount = side * side;
            vplImage* image = shadeFloor(context, def, width, height);
            const double wanted = 0.5 / VPL_PI * side * side; // a floor that reflects 0.5
            for (int p = 0; p < 3 * width * height; p++) {
                assertNear((double)image->pixels[p], wanted, 2e-6 * wanted, "radiance", side);
            }
            vplImage_Destroy(image);
        }
    }
}
