// SPDX-License-Identifier: MIT
// Tests of form factors between all pairs of patches: tests/data/incentre_estimator.csv, closed boxes,
// occlusion, X093-X095.
#include "patch_support.h"

#include "base/hash.h"

#include "math/vec.h"

#include <stdlib.h>

static void makeBox(vplContext* context, float x, float y, float z, int rounds, SidesFixture* f)
{
    vplVec3 corners[36];
    boxCorners(x, y, z, corners);
    *f = openFronts(context, corners, 12, 0, rounds);
}

static vplFormFactors* createFor(const vplPatchSides* sides, const vplFormFactorDef* def)
{
    vplFormFactors* factors = NULL;
    if (vplFormFactors_Create(sides, def, &factors) != VPL_SUCCESS) {
        fail_msg("%s", takeMessage());
    }
    return factors;
}

static vplFormFactors* create(const SidesFixture* f, const vplFormFactorDef* def)
{
    return createFor(f->sides, def);
}

static double factorAt(const vplFormFactors* f, int i, int j)
{
    return (double)f->rows[(size_t)i * (size_t)f->count + (size_t)j];
}

static double sumOf(const vplFormFactors* f, int i)
{
    double sum = 0;
    for (int j = 0; j < f->count; j++) {
        sum += factorAt(f, i, j);
    }
    return sum;
}

// Asserts reciprocity, A_i F_ij = A_j F_ji, and factors between 0 and 1.
static void assertReciprocal(const SidesFixture* s, const vplFormFactors* f)
{
    for (int i = 0; i < f->count; i++) {
        assert_true(factorAt(f, i, i) == 0);
        for (int j = 0; j < f->count; j++) {
            const double there = (double)s->sides->sides[i].area * factorAt(f, i, j),
                         back = (double)s->sides->sides[j].area * factorAt(f, j, i);
            assert_true(factorAt(f, i, j) >= 0 && factorAt(f, i, j) <= 1);
            assertNear(there, back, 1e-6 * there, "exchange", i);
        }
    }
}

// ---- one ray between incentres

// Returns the spectral radius by power iteration; adding a tenth of the vector prevents oscillation.
static double spectralRadius(const vplFormFactors* f)
{
    const size_t n = (size_t)f->count;
    double *x = malloc(n * sizeof *x), *y = malloc(n * sizeof *y), largest = 0;
    for (size_t i = 0; i < n; i++) {
        x[i] = 1;
    }
    for (int round = 0; round < 300; round++) {
        largest = 0;
        for (size_t i = 0; i < n; i++) {
            y[i] = 0.1 * x[i];
            for (size_t j = 0; j < n; j++) {
                y[i] += (double)f->rows[i * n + j] * x[j];
            }
            largest = fmax(largest, y[i]);
        }
        for (size_t i = 0; i < n; i++) {
            x[i] = y[i] / largest;
        }
    }
    free(x);
    free(y);
    return largest - 0.1;
}

typedef struct Summary {
    double min, mean, max, largest;
} Summary;

static Summary summarise(const vplPatchSides* sides, const vplFormFactors* f)
{
    Summary out = {.min = INFINITY};
    double area = 0;
    for (int i = 0; i < f->count; i++) {
        const double sum = (double)f->rowSums[i], a = (double)sides->sides[i].area;
        out.min = sum < out.min ? sum : out.min;
        out.max = sum > out.max ? sum : out.max;
        out.mean += a * sum;
        area += a;
    }
    for (size_t i = 0; i < (size_t)f->count * (size_t)f->count; i++) {
        out.largest = (double)f->rows[i] > out.largest ? (double)f->rows[i] : out.largest;
    }
    out.mean /= area;
    return out;
}

static void loadTriangles(const char* name, int count, vplVec3* corners)
{
    Table t = loadTable(name);
    assert_int_equal(t.rows, count);
    for (int i = 0; i < 3 * count; i++) {
        char prefix[8];
        snprintf(prefix, sizeof prefix, "v%d", i % 3);
        corners[i] = vectorOf(&t, i / 3, prefix);
    }
    freeTable(&t);
}

// Reverses the winding: the lab's normals have the opposite sign; fronts are inside the room.
static void turnTriangle(vplVec3* corners)
{
    const vplVec3 swap = corners[1];
    corners[1] = corners[2];
    corners[2] = swap;
}

static void compareIncentres(const vplPatchSides* sides, const Table* t, int row, double tolerance)
{
    vplFormFactorDef def = vplDefaultFormFactorDef();
    def.kind = VPL_FORM_FACTORS_INCENTRE;
    assert_int_equal(sides->count, (int)number(t, row, "patches"));
    vplFormFactors* f = createFor(sides, &def);
    const Summary found = summarise(sides, f);
    assertNear(found.mean, number(t, row, "row_sum_area_mean"), tolerance, "mean", row);
    assertNear(found.min, number(t, row, "row_sum_min"), tolerance, "min", row);
    assertNear(found.max, number(t, row, "row_sum_max"), tolerance, "max", row);
    assertNear(found.largest, number(t, row, "largest_F"), tolerance, "largest", row);
    if (f->count <= 1000) {
        const double radius = number(t, row, "spectral_radius");
        assertNear(spectralRadius(f), radius, tolerance, "spectral radius", row);
    }
    vplFormFactors_Destroy(f);
}

TEST(IncentresOfACubeAreThoseOfTheTable, 2)
{
    vplVec3 corners[36];
    boxCorners(1, 1, 1, corners);
    Table t = loadTable("incentre_estimator.csv");
    for (int row = 0; row < 9; row++) {
        SidesFixture s = openFronts(context, corners, 12, 0, (int)number(&t, row, "iteration"));
        compareIncentres(s.sides, &t, row, 5e-6);
        closeFronts(&s);
    }
    freeTable(&t);
}

// Returns all sides of the report's box that face the room.
static vplPatchSides* sidesOfBox(const vplPatches* patches)
{
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplPatchSides* sides = NULL;
    emitter.position = vplVec(278, 416, 84);
    def.emitters = &emitter;
    def.emitterCount = 1;
    def.wholeTriangles = true;
    assert_int_equal(vplPatchSides_Create(patches, &def, &sides), VPL_SUCCESS);
    return sides;
}

// X094.
TEST(IncentresOfTheReportsBoxAreThoseOfTheTable, 2)
{
    vplGeometry* geometry = testModel(context, MODEL_LAB, 0.5f);
    Table t = loadTable("incentre_estimator.csv");
    for (int row = 9; row < t.rows; row++) {
        vplPatches* patches = openPatches(geometry, 125, (int)number(&t, row, "iteration"));
        vplPatchSides* sides = sidesOfBox(patches);
        compareIncentres(sides, &t, row, 5e-6);
        vplPatchSides_Destroy(sides);
        vplPatches_Destroy(patches);
    }
    freeTable(&t);
    vplGeometry_Destroy(geometry);
}

// ---- closed rooms

// Row sums err by at most 0.0025 as measured, with three points per side for pairs that are not near.
TEST(ClosedBoxesClose, 2)
{
    for (int rounds = 0; rounds <= 6; rounds++) {
        SidesFixture s;
        makeBox(context, 4, 2.5f, 5, rounds, &s);
        const vplFormFactorDef def = vplDefaultFormFactorDef();
        vplFormFactors* f = create(&s, &def);
        for (int i = 0; i < f->count; i++) {
            assertNear((double)f->rowSums[i], 1, 0.004, "row sum", i);
            assert_true(sumOf(f, i) <= 1 && sumOf(f, i) > 0.996);
        }
        assertReciprocal(&s, f);
        vplFormFactors_Destroy(f);
        closeFronts(&s);
    }
}

TEST(NormalisedRowsSumToOneAndStayReciprocal, 2)
{
    SidesFixture s;
    makeBox(context, 4, 2.5f, 5, 4, &s);
    vplFormFactorDef def = vplDefaultFormFactorDef();
    def.rowSums = VPL_ROW_SUMS_NORMALISE;
    for (int kind = 0; kind < 2; kind++) {
        def.kind = (vplFormFactorKind)kind;
        vplFormFactors* f = create(&s, &def);
        for (int i = 0; i < f->count; i++) {
            assertNear(sumOf(f, i), 1, 1e-5, "sum", i);
            assert_true(sumOf(f, i) <= 1);
        }
        assertReciprocal(&s, f);
        vplFormFactors_Destroy(f);
    }
    closeFronts(&s);
}

// Row sums above 1 come down, the others may only decrease; `keep` changes nothing.
TEST(ClampedRowsNeverSumToMoreThanOne, 1)
{
    SidesFixture s;
    makeBox(context, 4, 2.5f, 5, 3, &s);
    vplFormFactorDef def = vplDefaultFormFactorDef();
    def.kind = VPL_FORM_FACTORS_INCENTRE;
    def.rowSums = VPL_ROW_SUMS_CLAMP;
    vplFormFactors* clamped = create(&s, &def);
    def.rowSums = VPL_ROW_SUMS_KEEP;
    vplFormFactors* kept = create(&s, &def);
    int above = 0;
    for (int i = 0; i < kept->count; i++) {
        above += kept->rowSums[i] > 1;
        assert_true(sumOf(clamped, i) <= 1 && sumOf(clamped, i) < sumOf(kept, i) + 1e-6);
        assertNear(sumOf(kept, i), (double)kept->rowSums[i], 1e-6, "kept", i);
        assert_true(kept->rowSums[i] == clamped->rowSums[i]);
    }
    assert_true(above > kept->count / 2);
    assertReciprocal(&s, clamped);
    vplFormFactors_Destroy(kept);
    vplFormFactors_Destroy(clamped);
    closeFronts(&s);
}

// ---- the values of the estimators

// Returns the mean over seeds of the form factor from side 0 to side 1, and its standard error.
static double meanOfSeeds(const SidesFixture* s, vplFormFactorDef def, int seeds, double* errorOut)
{
    double sum = 0, squares = 0;
    def.rowSums = VPL_ROW_SUMS_KEEP;
    for (int seed = 0; seed < seeds; seed++) {
        def.seed = (uint64_t)seed;
        vplFormFactors* f = create(s, &def);
        const double value = factorAt(f, 0, 1);
        sum += value;
        squares += value * value;
        vplFormFactors_Destroy(f);
    }
    const double mean = sum / seeds;
    *errorOut = sqrt(fmax(squares / seeds - mean * mean, 0) / seeds) + 1e-6 * mean;
    return mean;
}

static const vplVec3 PARALLEL[6] = {{0, 0, 0},    {1, 0, 0},    {0, 1, 0},
                                    {0.2f, 0, 2}, {0.2f, 1, 2}, {1.2f, 0, 2}};

TEST(PairsOfPointsFindTheIntegralWhateverTheirNumber, 1)
{
    SidesFixture s = openFronts(context, PARALLEL, 2, 1, 0);
    const double wanted = vplTriangleFormFactor(PARALLEL, PARALLEL + 3);
    static const int samples[] = {1, 2, 3, 4, 16, 17, 50};
    for (int k = 0; k < 7; k++) {
        vplFormFactorDef def = vplDefaultFormFactorDef();
        def.analytic = false;
        def.samples = samples[k];
        double error;
        const double mean = meanOfSeeds(&s, def, 400, &error);
        assertNear(mean, wanted, 4 * error, "mean", samples[k]);
        assert_true(error < 0.02 * wanted);
    }
    vplFormFactorDef def = vplDefaultFormFactorDef();
    vplFormFactors* f = create(&s, &def);
    assert_int_equal(f->rays, 0); // no occluder
    // Midpoints of the quarters as sample points err by 0.4 % here.
    assertNear(factorAt(f, 0, 1), wanted, 0.01 * wanted, "known", 0);
    vplFormFactors_Destroy(f);
    closeFronts(&s);
}

// An occluder between the two sides hides all of the factor, or about half of it.
TEST(WhatStandsBetweenTakesItsShare, 1)
{
    vplVec3 corners[9];
    memcpy(corners, PARALLEL, sizeof PARALLEL);
    static const float edges[2] = {-5, 0.4f};
    double shares[2][2];
    for (int k = 0; k < 2; k++) {
        const vplVec3 screen[3] = {{edges[k], -50, 1}, {edges[k], 50, 1}, {100, 0, 1}};
        memcpy(corners + 6, screen, sizeof screen);
        SidesFixture s = openFronts(context, corners, 3, 1000, 0);
        for (int analytic = 0; analytic < 2; analytic++) {
            vplFormFactorDef def = vplDefaultFormFactorDef();
            def.analytic = analytic;
            def.samples = 64;
            double error;
            shares[k][analytic] =
                meanOfSeeds(&s, def, 50, &error) / vplTriangleFormFactor(PARALLEL, PARALLEL + 3);
            def.bruteForce = true;
            assertNear(meanOfSeeds(&s, def, 50, &error) / vplTriangleFormFactor(PARALLEL, PARALLEL + 3),
                       shares[k][analytic], 0, "all triangles", k);
        }
        closeFronts(&s);
    }
    assert_true(shares[0][0] == 0 && shares[0][1] == 0);
    assert_true(shares[1][0] > 0.3 && shares[1][0] < 0.7);
    assertNear(shares[1][1], shares[1][0], 0.005, "share", 1);
}

// Only the quarter at corner 0 has open cells, so only that quarter exchanges light.
TEST(ClosedCellsExchangeNothing, 1)
{
    for (int near = 0; near < 2; near++) {
        vplVec3 corners[6];
        memcpy(corners, PARALLEL, sizeof PARALLEL);
        for (int i = 3; i < 6; i++) {
            corners[i].z = near ? 0.25f : 3;
        }
        SidesFixture s = openFronts(context, corners, 2, 1000, 0);
        vplPatchSide* side = (vplPatchSide*)&s.sides->sides[1];
        side->open = 0x000f;
        side->area *= 0.25f;
        vplVec3 quarter[3] = {corners[3]};
        for (int i = 1; i < 3; i++) {
            const vplVec3 *p = &corners[3], *q = &corners[3 + i];
            quarter[i] = (vplVec3){0.5f * (p->x + q->x), 0.5f * (p->y + q->y), 0.5f * (p->z + q->z)};
        }
        const double wanted = vplTriangleFormFactor(corners, quarter);
        for (int analytic = 0; analytic < 2; analytic++) {
            vplFormFactorDef def = vplDefaultFormFactorDef();
            def.analytic = analytic;
            def.samples = 64;
            double error;
            const double mean = meanOfSeeds(&s, def, 50, &error);
            assertNear(mean, wanted, analytic ? 0.03 * wanted : 4 * error, "quarter", analytic);
        }
        closeFronts(&s);
    }
}

// ---- extremes

// X095: two triangles share an edge, at all angles and scales.
TEST(TouchingAndCoplanarSidesAreNumbers, 1)
{
    for (int degrees = 0; degrees <= 180; degrees += 10) {
        for (int power = -20; power <= 20; power += 20) {
            const float size = ldexpf(1, power), c = size * (float)cos(degrees * 3.14159265358979 / 180),
                        sine = size * (float)sin(degrees * 3.14159265358979 / 180);
            const vplVec3 corners[9] = {{0, 0, 0},    {size, 0, 0}, {0, size, 0}, {0, 0, 0},   {0, c, sine},
                                        {size, 0, 0}, {0, 0, 0},    {size, 0, 0}, {0, size, 0}};
            SidesFixture s = openFronts(context, corners, 3, 1e30, 0);
            for (int kind = 0; kind < 3; kind++) {
                vplFormFactorDef def = vplDefaultFormFactorDef();
                def.analytic = kind == 1;
                vplFormFactors* f = create(&s, &def);
                assertReciprocal(&s, f);
                assert_true(factorAt(f, 0, 2) == 0 && factorAt(f, 2, 0) == 0);
                assert_true(degrees % 180 != 0 || factorAt(f, 0, 1) == 0);
                vplFormFactors_Destroy(f);
            }
            closeFronts(&s);
        }
    }
}

// Form factors of a box scaled by 2^20 or 2^-20 have the same bits.
TEST(FactorsDoNotDependOnTheSizeOfTheScene, 1)
{
    uint64_t hashes[3];
    for (int k = 0; k < 3; k++) {
        const float size = ldexpf(1, 20 * (k - 1));
        SidesFixture s;
        makeBox(context, 4 * size, 2.5f * size, 5 * size, 3, &s);
        const vplFormFactorDef def = vplDefaultFormFactorDef();
        vplFormFactors* f = create(&s, &def);
        hashes[k] = vplHashFloats(0, f->rows, (size_t)f->count * (size_t)f->count);
        vplFormFactors_Destroy(f);
        closeFronts(&s);
    }
    assert_true(hashes[0] == hashes[1] && hashes[2] == hashes[1]);
}

// ---- determinism, refusals

static uint64_t hashOfBox(vplContext* context)
{
    vplVec3 corners[90];
    loadTriangles("cornell_testmodel.csv", 30, corners);
    for (int i = 0; i < 30; i++) {
        turnTriangle(corners + 3 * i);
    }
    SidesFixture s = openFronts(context, corners, 30, 0.45 * 555 / 2, 3);
    uint64_t hash = 0;
    for (int k = 0; k < 4; k++) {
        vplFormFactorDef def = vplDefaultFormFactorDef();
        def.kind = k == 0 ? VPL_FORM_FACTORS_INCENTRE : VPL_FORM_FACTORS_MONTE_CARLO;
        def.analytic = k != 2;
        def.samples = k == 3 ? 20 : 4;
        def.rowSums = k == 1 ? VPL_ROW_SUMS_NORMALISE : VPL_ROW_SUMS_USUAL;
        vplFormFactors* f = create(&s, &def);
        hash = vplHashFloats(hash, f->rows, (size_t)f->count * (size_t)f->count);
        hash = vplHashFloats(hash, f->rowSums, (size_t)f->count);
        hash += (uint64_t)(f->rays + f->analyticPairs);
        vplFormFactors_Destroy(f);
    }
    closeFronts(&s);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(FactorsAreTheSameEverywhere)
{
    assertSameEverywhere(hashOfBox);
}

TEST(DefsOutOfRangeAreRefusedByName, 1)
{
    SidesFixture s;
    makeBox(context, 1, 1, 1, 0, &s);
    vplFormFactors* untouched = NULL;
    for (int k = 0; k < 6; k++) {
        static const char* const words[6] = {"vplDefaultFormFactorDef",
                                             "samples is 0",
                                             "samples is 1025",
                                             "kind is 2",
                                             "rowSums is 4",
                                             "16385 sides take 1073872900 bytes"};
        vplFormFactorDef def = vplDefaultFormFactorDef();
        def.cookie = k == 0 ? 0 : def.cookie;
        def.samples = k == 1 ? 0 : k == 2 ? 1025 : 4;
        def.kind = (vplFormFactorKind)(k == 3 ? 2 : 0);
        def.rowSums = (vplRowSums)(k == 4 ? 4 : 0);
        s.sides->count = k == 5 ? 16385 : 12;
        assert_int_equal(vplFormFactors_Create(s.sides, &def, &untouched),
                         k == 5 ? VPL_LIMIT : VPL_INVALID_ARGUMENT);
        const char* message = takeMessage();
        if (strstr(message, words[k]) == NULL) {
            fail_msg("%s: %s", words[k], message);
        }
    }
    assert_null(untouched);
    s.sides->count = 0;
    const vplFormFactorDef def = vplDefaultFormFactorDef();
    vplFormFactors* none = create(&s, &def);
    assert_int_equal(none->count, 0);
    vplFormFactors_Destroy(none);
    vplFormFactors_Destroy(NULL);
    closeFronts(&s);
}

TEST(FactorsCanBeCancelled, 1)
{
    SidesFixture s;
    makeBox(context, 1, 1, 1, 4, &s);
    vplFormFactorDef def = vplDefaultFormFactorDef();
    vplFormFactors* untouched = NULL;
    int asked = 0;
    def.progress = refuseThird;
    def.progressUser = &asked;
    assert_int_equal(vplFormFactors_Create(s.sides, &def, &untouched), VPL_CANCELLED);
    assert_null(untouched);
    closeFronts(&s);
}
