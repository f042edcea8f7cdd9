// SPDX-License-Identifier: MIT
// Tests of particle counts and the particle simulation; test_totals.c has whole simulations by the hundred. Covers
// extremes X029 to X048.
#include "scenes.h"

#include "lights/particles.h"
#include "math/sampling.h"
#include "math/vec.h"

#include <stdlib.h>

// X032 to X035
TEST(EveryCountOfTheTableIsTheDecimalOne, 1)
{
    Table t = loadTable("counts.csv");
    static int counts[VPL_MAX_STEPS];
    for (int row = 0; row < t.rows; row++) {
        int n = (int)number(&t, row, "N"), k = (int)number(&t, row, "k");
        const vplParticlePass pass = {0, n, number(&t, row, "rho")};
        vplStepTotals totals;
        if (vplCountParticles(context, &pass, counts, VPL_MAX_STEPS, &totals) != VPL_SUCCESS) {
            fail_msg("row %d: %s", row, takeMessage());
        }
        int count = k < totals.stepCount ? counts[k] : 0;
        if (count != (int)number(&t, row, "dec")) {
            fail_msg("row %d: floor(%s^%d %d) is %d, wanted %s", row, cell(&t, row, "rho"), k, n, count,
                     cell(&t, row, "dec"));
        }
    }
    freeTable(&t);
}

// X036, X037: totals are exact below the documented limits and refused beyond them, and the call always ends.
TEST(ExtremeTotalsAreExactOrRefused, 1)
{
    Table t = loadTable("counts_extreme.csv");
    int exact = 0;
    for (int row = 0; row < t.rows; row++) {
        double wanted = number(&t, row, "total"), steps = number(&t, row, "steps");
        const vplParticlePass pass = {0, (int)number(&t, row, "N"), number(&t, row, "rho")};
        vplStepTotals totals;
        vplResult result = vplCountParticles(context, &pass, NULL, 0, &totals);
        if (wanted > VPL_MAX_LIGHTS || steps > VPL_MAX_STEPS) {
            assert_int_equal(result, VPL_LIMIT);
        } else {
            assert_int_equal(result, VPL_SUCCESS);
            assert_true((double)totals.lightCount == wanted && totals.stepCount == (int)steps);
            exact++;
        }
    }
    assert_true(exact >= 10);
    freeTable(&t);
}

// X036, X038 to X040: each row of counts_invalid.csv must give the result in its third column.
TEST(InvalidCountsAreRefused, 1)
{
    const struct {
        double rho;
        int n;
        vplResult result;
        int steps, total;
    } cases[] = {
        {0, 10, VPL_SUCCESS, 1, 10},
        {1, 10, VPL_INVALID_ARGUMENT, 0, 0},
        {1.5, 10, VPL_INVALID_ARGUMENT, 0, 0},
        {-0.5, 10, VPL_INVALID_ARGUMENT, 0, 0},
        {NAN, 10, VPL_INVALID_ARGUMENT, 0, 0},
        {INFINITY, 10, VPL_INVALID_ARGUMENT, 0, 0},
        {0.5, 0, VPL_SUCCESS, 0, 0},
        {0.5, -1, VPL_INVALID_ARGUMENT, 0, 0},
        {4.9e-324, 1000000, VPL_SUCCESS, 1, 1000000},
        {0.9999999999999999, 2, VPL_LIMIT, 0, 0},
        {0.5, INT32_MAX, VPL_INVALID_ARGUMENT, 0, 0},
    };
    Table t = loadTable("counts_invalid.csv");
    assert_int_equal(t.rows, sizeof cases / sizeof *cases);
    for (int i = 0; i < t.rows; i++) {
        const vplParticlePass pass = {0, cases[i].n, cases[i].rho};
        const double rho = strtod(cell(&t, i, "rho"), NULL), n = number(&t, i, "N");
        assert_true(rho == cases[i].rho || isnan(rho)); // X040's N is beyond an int: the largest int
        assert_true(n == cases[i].n || (n > INT32_MAX && cases[i].n == INT32_MAX));
        vplStepTotals totals = {-1, -1};
        vplResult result = vplCountParticles(context, &pass, NULL, 0, &totals);
        assert_int_equal(result, cases[i].result);
        assert_int_equal(totals.stepCount, result == VPL_SUCCESS ? cases[i].steps : -1);
        assert_int_equal(totals.lightCount, result == VPL_SUCCESS ? cases[i].total : -1);
    }
    freeTable(&t);
}

// Simulates one set of room_particles.csv with the set's own first directions and compares every row.
static void checkSet(vplContext* context, const vplGeometry* room, const Table* t, const char* name)
{
    Table objects = loadTable("room_objects.csv");
    vplVec3 directions[64];
    vplParticleDef def = vplDefaultParticleDef();
    def.lighting = VPL_LIGHTING_DOCUMENTED;
    def.directions = directions;
    for (int row = 0; row < t->rows; row++) {
        if (strcmp(cell(t, row, "set"), name) == 0) {
            def.particleCount = (int)number(t, row, "N");
            def.reflectivity = number(t, row, "rho");
            directions[(int)number(t, row, "particle")] = vectorOf(t, row, "d0");
        }
    }
    vplEmitterDef emitter = vplDefaultEmitterDef();
    emitter.position = (vplVec3){0, 4.5f, 0};
    emitter.intensity = (vplRgb){10, 10, 10};
    vplLightSet* set;
    assert_int_equal(vplSimulateParticles(room, &emitter, 1, &def, &set), VPL_SUCCESS);
    int at = 0, escaped = 0;
    for (int row = 0; row < t->rows; row++) {
        const char* wanted = cell(t, row, "object");
        if (strcmp(cell(t, row, "set"), name) != 0) {
            continue;
        }
        escaped += strcmp(wanted, "escaped") == 0;
        if (strcmp(wanted, "escaped") == 0 || strcmp(wanted, "dead") == 0) {
            continue;
        }
        assert_true(at < set->lightCount);
        const vplVirtualLight* v = &set->lights[at++];
        assert_int_equal(v->step, (int)number(t, row, "step"));
        assert_int_equal(v->particle, (int)number(t, row, "particle"));
        assert_string_equal(cell(&objects, v->object, "name"), wanted);
        vplVec3 p = vectorOf(t, row, "p"), n = vectorOf(t, row, "n");
        assertNear((double)v->position.x, (double)p.x, 3.2e-6, "px", row);
        assertNear((double)v->position.y, (double)p.y, 3.2e-6, "py", row);
        assertNear((double)v->position.z, (double)p.z, 3.2e-6, "pz", row);
        assertNear((double)vplLength(vplSub(v->normal, n)), 0, 3e-7, "normal", row);
        assertNear((double)v->light.r, number(t, row, "Lr"), 1e-6, "Lr", row);
        assertNear((double)v->light.g, number(t, row, "Lg"), 1e-6, "Lg", row);
        assertNear((double)v->light.b, number(t, row, "Lb"), 1e-6, "Lb", row);
        double weight = number(t, row, "N") / number(t, row, "count_at_step");
        assertNear((double)v->weight, weight, 1e-7 * weight, "weight", row);
    }
    assert_int_equal(at, set->lightCount);
    assert_int_equal(escaped, set->escaped);
    vplLightSet_Destroy(set);
    freeTable(&objects);
    (void)context;
}

// X012, X030, X041
TEST(EveryParticleOfTheTableLandsWhereItSays, 2)
{
    Table t = loadTable("room_particles.csv");
    vplGeometry* room = tableRoom(context);
    const char* const sets[] = {"A", "B", "C", "D"};
    for (int i = 0; i < 4; i++) {
        checkSet(context, room, &t, sets[i]);
    }
    vplGeometry_Destroy(room);
    freeTable(&t);
}

static vplLightSet* simulate(const vplGeometry* g, vplParticleDef def)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplLightSet* set = NULL;
    assert_int_equal(vplSimulateParticles(g, &emitter, 1, &def, &set), VPL_SUCCESS);
    return set;
}

TEST(TenParticlesAtHalfMake18Lights, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplLightSet* set = simulate(cube, vplDefaultParticleDef());
    assert_int_equal(set->lightCount, 18);
    assert_int_equal(set->escaped, 0);
    assert_int_equal(set->rays, 18);
    assert_int_equal(set->rayObjectTests, 18 * 6);
    const int counts[] = {10, 5, 2, 1};
    for (int i = 0; i < 4; i++) {
        assert_int_equal(set->stepCounts[i], counts[i]);
        assert_int_equal(set->lightsInStep[i], counts[i]);
    }
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(cube);
}

// The columns that sum over all steps up to k; fluxes are in units of that of the point light, 4 pi.
static void compareSums(const Table* t, int row, const vplLightSet* set)
{
    const double rho = number(t, row, "rho"), count = number(t, row, "N");
    const int k = (int)number(t, row, "k");
    double sum = 0, weight = 0;
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        sum += v->step <= k ? (double)v->light.r * (double)v->weight / count / (4 * VPL_PI) : 0;
        weight = v->step == k ? (double)v->weight : weight;
    }
    const double whole = rho / (1 - rho), missing = whole - sum;
    const struct {
        const char* column;
        double value, error;
    } columns[] = {{"total_weight_1/M_k", weight / count, 1e-6 * weight / count},
                   {"rho^k*N/M_k", pow(rho, k) * weight, 1e-6 * weight},
                   {"series_sum_to_k", sum, 1e-5 * sum},
                   {"series_missing_after_k", missing, 1e-5 * whole},
                   {"relative_missing", missing / whole, 1e-5}};
    for (int i = 0; i < 5; i++) {
        assertNear(columns[i].value, number(t, row, columns[i].column), columns[i].error, columns[i].column,
                   row);
    }
}

// vpl_weights.csv: in a closed room the lights of step k carry the flux 4 pi I rho^(k+1), whatever floor()
// cuts off the counts.
TEST(FluxOfEachStepIsThatOfTheTable, 2)
{
    Table t = loadTable("vpl_weights.csv");
    for (int row = 0; row < t.rows; row++) {
        double rho = number(&t, row, "rho");
        int k = (int)number(&t, row, "k");
        vplGeometry* cube = closedCube(context, (float)rho);
        vplParticleDef def = vplDefaultParticleDef();
        def.particleCount = (int)number(&t, row, "N");
        def.reflectivity = rho;
        vplLightSet* set = simulate(cube, def);
        double flux = 0;
        for (int i = 0; i < set->lightCount; i++) {
            if (set->lights[i].step == k) {
                flux += (double)set->lights[i].light.r * (double)set->lights[i].weight / def.particleCount;
                assertNear((double)set->lights[i].weight, number(&t, row, "N/M_k"),
                           1e-6 * number(&t, row, "N/M_k"), "weight", row);
            }
        }
        double wanted = 4 * VPL_PI * pow((double)(float)rho, k + 1);
        assertNear(flux, wanted, 1e-5 * wanted, "flux", row);
        assert_int_equal(set->lightsInStep[k], (int)number(&t, row, "M_k"));
        compareSums(&t, row, set);
        vplLightSet_Destroy(set);
        vplGeometry_Destroy(cube);
    }
    assert_int_equal(t.rows, 61);
    freeTable(&t);
}

static uint64_t hashLights(const vplLightSet* set)
{
    uint64_t hash = (uint64_t)set->lightCount;
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* v = &set->lights[i];
        uint64_t words[5] = {0};
        memcpy(words, &v->position, 12);
        memcpy((char*)words + 12, &v->light, 12);
        words[4] = (uint64_t)v->step << 32 | (uint32_t)v->particle;
        for (int k = 0; k < 5; k++) {
            hash = (hash ^ words[k]) * 0x9E3779B97F4A7C15u;
            hash ^= hash >> 29;
        }
    }
    return hash;
}

TEST_ALONE(LightsDoNotDependOnThreads)
{
    for (int sampler = VPL_SAMPLER_RANDOM; sampler <= VPL_SAMPLER_HAMMERSLEY; sampler++) {
        uint64_t wanted = 0;
        const int workers[] = {1, 2, 3, 7};
        for (int i = 0; i < 4; i++) {
            vplContext* context = openTestContext(workers[i]);
            vplGeometry* room = tableRoom(context);
            vplParticleDef def = vplDefaultParticleDef();
            def.particleCount = 3000;
            def.reflectivity = 0.8;
            def.sampler = (vplSampler)sampler;
            def.seed = 5;
            vplEmitterDef emitters[3] = {vplDefaultEmitterDef(), vplDefaultEmitterDef(),
                                         vplDefaultEmitterDef()};
            emitters[1].position = (vplVec3){1, 4, 1};
            emitters[2].intensity = (vplRgb){0, 0, 0};
            vplLightSet* set;
            assert_int_equal(vplSimulateParticles(room, emitters, 3, &def, &set), VPL_SUCCESS);
            wanted = i == 0 ? hashLights(set) : wanted;
            assert_true(hashLights(set) == wanted);
            vplLightSet_Destroy(set);
            vplGeometry_Destroy(room);
            closeTestContext(context);
        }
    }
}

// The first floor(rho^k N) particles alone must cover all directions: their mean direction is short.
TEST(AnyFirstParticlesCoverTheSphere, 2)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    // Random points: 3 standard deviations of the mean of n unit vectors; the other samplers are much better.
    const double allowed[] = {
        [VPL_SAMPLER_RANDOM] = 3, [VPL_SAMPLER_HALTON] = 0.7, [VPL_SAMPLER_HAMMERSLEY] = 0.7};
    for (int sampler = VPL_SAMPLER_RANDOM; sampler <= VPL_SAMPLER_HAMMERSLEY; sampler++) {
        vplParticleDef def = vplDefaultParticleDef();
        def.particleCount = 1024;
        def.sampler = (vplSampler)sampler;
        vplLightSet* set = simulate(cube, def);
        for (int n = 16; n <= 1024; n *= 2) {
            vplVec3 sum = {0, 0, 0};
            for (int i = 0; i < n; i++) {
                sum = vplAdd(sum, vplNormalize(set->lights[i].position)); // the light is at the origin
            }
            assertNear((double)vplLength(sum) / n, 0, allowed[sampler] / sqrt(n), "mean direction", sampler);
        }
        vplLightSet_Destroy(set);
    }
    vplGeometry_Destroy(cube);
}

TEST(DoublingTheEmitterDoublesEveryBit, 1)
{
    vplGeometry* room = tableRoom(context);
    vplParticleDef def = vplDefaultParticleDef();
    def.particleCount = 100;
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplLightSet *one, *two;
    assert_int_equal(vplSimulateParticles(room, &emitter, 1, &def, &one), VPL_SUCCESS);
    emitter.intensity = vplRgbScale(2, emitter.intensity);
    assert_int_equal(vplSimulateParticles(room, &emitter, 1, &def, &two), VPL_SUCCESS);
    assert_int_equal(one->lightCount, two->lightCount);
    for (int i = 0; i < one->lightCount; i++) {
        assert_true(2 * one->lights[i].light.g == two->lights[i].light.g);
        assert_memory_equal(&one->lights[i].position, &two->lights[i].position, sizeof(vplVec3));
    }
    vplLightSet_Destroy(one);
    vplLightSet_Destroy(two);
    vplGeometry_Destroy(room);
}

// Two emitters of 1 and 3 W/sr share the particles one to three, and the total flux is the sum of both.
TEST(EmittersShareParticlesByPower, 1)
{
    vplGeometry* cube = closedCube(context, 1);
    for (int sampler = VPL_SAMPLER_RANDOM; sampler <= VPL_SAMPLER_HAMMERSLEY; sampler++) {
        vplParticleDef def = vplDefaultParticleDef();
        def.particleCount = 4000;
        def.reflectivity = 0;
        def.sampler = (vplSampler)sampler;
        vplEmitterDef emitters[2] = {vplDefaultEmitterDef(), vplDefaultEmitterDef()};
        emitters[0].intensity = (vplRgb){1, 0, 0};
        emitters[1].intensity = (vplRgb){0, 3, 0};
        vplLightSet* set;
        assert_int_equal(vplSimulateParticles(cube, emitters, 2, &def, &set), VPL_SUCCESS);
        double red = 0, green = 0;
        for (int i = 0; i < set->lightCount; i++) {
            red += (double)set->lights[i].light.r / def.particleCount;
            green += (double)set->lights[i].light.g / def.particleCount;
        }
        double slack = sampler == VPL_SAMPLER_RANDOM ? 0.07 : 0.002;
        assertNear(red, 4 * VPL_PI, slack * 4 * VPL_PI, "red flux", sampler);
        assertNear(green, 12 * VPL_PI, slack * 12 * VPL_PI, "green flux", sampler);
        vplLightSet_Destroy(set);
    }
    vplGeometry_Destroy(cube);
}

// X047: a direction that grazes a surface is mirrored to the side that it comes from, whatever is rounded.
TEST_ALONE(GrazingDirectionsAreMirroredToTheirOwnSide)
{
    for (uint64_t i = 0; i < 200000; i++) {
        const vplVec3 n = vplSampleSphere((float)uniformAt(1, i), (float)uniformAt(2, i));
        const vplVec3 any = vplSampleSphere((float)uniformAt(3, i), (float)uniformAt(4, i));
        const double heights[4] = {0, 1e-8, 1e-7, 1}, height = heights[i % 4] * (2 * uniformAt(5, i) - 1);
        const vplVec3 d = vplNormalize(vplAdd(vplNormalize(vplCross(any, n)), vplScale((float)height, n)));
        const vplVec3 r = vplMirror(d, n);
        const float side = vplDot(d, n) > 0 ? -1.0f : 1.0f;
        const vplVec3 wanted = vplSub(d, vplScale(2 * vplDot(d, n), n));
        const double out = (double)r.x * (double)n.x + (double)r.y * (double)n.y + (double)r.z * (double)n.z;
        assert_true(side * vplDot(r, n) > 0 && (double)side * out > 0);
        assertNear((double)vplLength(r), 1, 2e-7, "length", (int)i);
        assertNear((double)vplLength(vplSub(r, wanted)), 0, 6e-7, "mirrored", (int)i);
    }
}

// X048: after a thousand specular or diffuse bounces in a closed cube, particles still land on its walls.
TEST(AThousandBouncesStayOnTheWalls, 2)
{
    vplGeometry* cube = closedCube(context, 1);
    for (int bounce = VPL_BOUNCE_REFLECT; bounce <= VPL_BOUNCE_DIFFUSE; bounce++) {
        vplParticleDef def = vplDefaultParticleDef();
        def.particleCount = 40;
        def.reflectivity = 0.997;
        def.bounce = (vplBounce)bounce;
        vplLightSet* set = simulate(cube, def);
        assert_true(set->stepCount > 1000);
        assert_int_equal(set->escaped, 0);
        for (int i = 0; i < set->lightCount; i++) {
            vplVec3 p = set->lights[i].position;
            float largest = fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z)));
            assertNear((double)largest, 1, 1e-6, "distance of the wall", i);
        }
        vplLightSet_Destroy(set);
    }
    vplGeometry_Destroy(cube);
}

TEST(SimulationRefusesWhatItCannotShoot, 1)
{
    vplGeometry* cube = closedCube(context, 0.5f);
    vplParticleDef def = vplDefaultParticleDef();
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplLightSet* set = NULL;
    assert_int_equal(vplSimulateParticles(cube, &emitter, 0, &def, &set), VPL_INVALID_ARGUMENT);
    def.reflectivity = 1;
    assert_int_equal(vplSimulateParticles(cube, &emitter, 1, &def, &set), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "reflectivity is 1"));
    def = (vplParticleDef){0};
    assert_int_equal(vplSimulateParticles(cube, &emitter, 1, &def, &set), VPL_INVALID_ARGUMENT);
    assert_null(set);
    def = vplDefaultParticleDef();
    def.particleCount = 0; // X040: no particles, no lights, no error
    assert_int_equal(vplSimulateParticles(cube, &emitter, 1, &def, &set), VPL_SUCCESS);
    assert_int_equal(set->lightCount, 0);
    vplLightSet_Destroy(set);
    vplGeometry_Destroy(cube);
}

// A seed shifts all values of one dimension by the same amount, and each dimension by another one.
TEST_ALONE(EveryDimensionOfAParticleHasAShiftOfItsOwn)
{
    enum { STEPS = 8 };
    vplParticleDef def = vplDefaultParticleDef();
    def.sampler = VPL_SAMPLER_HALTON;
    const vplSampleSource plain = vplSampleSource_Make(&def);
    def.seed = 7;
    const vplSampleSource seeded = vplSampleSource_Make(&def);
    double shift[2 * STEPS];
    for (int step = 0; step < STEPS; step++) {
        for (int particle = 0; particle < 3; particle++) {
            float a[2], b[2];
            vplSampleSource_Direction(&plain, particle, step, &a[0], &a[1]);
            vplSampleSource_Direction(&seeded, particle, step, &b[0], &b[1]);
            for (int k = 0; k < 2; k++) {
                const double by = (double)b[k] - (double)a[k], turned = by < 0 ? by + 1 : by;
                shift[2 * step + k] = particle == 0 ? turned : shift[2 * step + k];
                assertNear(turned, shift[2 * step + k], 1e-5, "shift of a particle", particle);
            }
        }
        for (int d = 0; d < 2 * step + 2; d++) {
            for (int other = 0; other < d; other++) {
                assert_true(fabs(shift[d] - shift[other]) > 1e-5);
            }
        }
    }
}
