// SPDX-License-Identifier: MIT
// Tests of elementary functions, random numbers, sequences and warps. Covers extremes X043 to X046.
#include "test.h"

#include "base/hash.h"
#include "base/rng.h"
#include "math/matrix.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/sobol.h"
#include "math/vec.h"

#include <float.h>

TEST_ALONE(ElementaryFunctionsAgreeWithLibm)
{
    for (uint64_t i = 0; i < 100000; i++) {
        double u = uniformAt(1, i), x = 40 * u - 20, s, c;
        vplSinCos(x, &s, &c);
        assertNear(s, sin(x), 4e-15, "sin", (int)i); // 2 ulp of x / (pi/2), times the slope
        assertNear(c, cos(x), 4e-15, "cos", (int)i);
        double e = exp(30 * x);
        assertNear(vplExp(30 * x), e, 8e-16 * e, "exp", (int)i);
        double positive = exp(x * 20), l = log(positive);
        assertNear(vplLn(positive), l, 4e-16 * fabs(l) + 2e-16, "log", (int)i);
        double p = pow(u, 1 / 2.4);
        assertNear(vplPow(u, 1 / 2.4), p, 4e-15 * p, "pow", (int)i);
        double root = cbrt(positive);
        assertNear(vplCbrt(positive), root, 8e-16 * root, "cbrt", (int)i); // 5 roundings of ours, libm's own
        double y = uniformAt(2, i) - 0.5, z = uniformAt(3, i) - 0.5;
        assertNear(vplAtan2(y, z), atan2(y, z), 1e-15, "atan2", (int)i);
        assertNear(vplAcos(2 * u - 1), acos(2 * u - 1), 2e-15, "acos", (int)i);
    }
}

TEST_ALONE(ElementaryFunctionsAreDefinedAtTheirEnds)
{
    double s, c;
    for (int quarter = -8; quarter <= 8; quarter++) {
        vplSinCos(quarter * (VPL_PI / 2), &s, &c);
        const double wanted[4] = {0, 1, 0, -1};
        assertNear(s, wanted[quarter & 3], 0, "sin", quarter);
        assertNear(c, wanted[(quarter + 1) & 3], 0, "cos", quarter);
        assert_false(signbit(s) && s == 0);
    }
    assert_true(vplExp(-INFINITY) == 0 && vplExp(-746) == 0 && isinf(vplExp(710)) && isnan(vplExp(NAN)));
    assert_true(vplExp(0) == 1 && vplLn(1) == 0 && isinf(vplLn(0)) && isnan(vplLn(-1)));
    assert_true(isinf(vplLn(INFINITY)));
    assertNear(vplLn(5e-324), -744.4400719213812, 1e-12, "log of the smallest double", 0);
    assertNear(vplLn(DBL_MAX), 709.782712893384, 1e-12, "log of the largest double", 0);
    assert_true(vplPow(0, 2) == 0 && vplPow(-1, 2) == 0 && vplPow(1, 5) == 1);
    assert_true(vplCbrt(0) == 0 && vplCbrt(-8) == 0 && vplCbrt(1) == 1);
    assert_true(isinf(vplCbrt(INFINITY)) && vplCbrt(NAN) == 0);
    for (int i = 0; i < 3; i++) {
        double x = (const double[]){4e-320, DBL_MIN, DBL_MAX}[i], root = cbrt(x);
        assertNear(vplCbrt(x), root, 8e-16 * root, "cbrt at the ends", i);
    }
    assert_true(vplAtan2(0, 0) == 0);
    assertNear(vplAtan2(0, -1), VPL_PI, 0, "atan2", 0);
    assertNear(vplAcos(2), 0, 0, "acos", 0);
}

// Philox 4x32-10 must give the published known-answer vectors (Random123, kat_vectors).
TEST_ALONE(PhiloxGivesThePublishedNumbers)
{
    const uint32_t zeros[4] = {0, 0, 0, 0}, ones[4] = {~0u, ~0u, ~0u, ~0u};
    const uint32_t wanted[2][4] = {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8},
                                   {0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}};
    assert_memory_equal(vplPhilox(zeros, 0, 0).v, wanted[0], 16);
    assert_memory_equal(vplPhilox(ones, ~0u, ~0u).v, wanted[1], 16);
    assert_true(vplUnitFloat(~0u) < 1 && vplUnitFloat(0) == 0);
}

TEST_ALONE(RadicalInversesAreThoseOfTheTables)
{
    Table t = loadTable("vdcorput.csv");
    for (int row = 0; row < t.rows; row++) {
        uint32_t k = (uint32_t)number(&t, row, "k");
        double base2 = number(&t, row, "base2"), base3 = number(&t, row, "base3");
        float v = vplVanDerCorput(k), h2 = vplHalton(k, 0), h3 = vplHalton(k, 1);
        assert_true(v < 1 && h2 < 1 && h3 < 1); // X044: rounding to float would reach 1
        assertNear((double)v, base2, 0x1p-24, "base 2", row);
        assertNear((double)h2, base2, 0x1p-24, "Halton base 2", row);
        assertNear((double)h3, base3, 0x1p-24, "Halton base 3", row);
    }
    freeTable(&t);
    t = loadTable("hammersley.csv");
    for (int row = 0; row < t.rows; row++) {
        assertNear((double)vplVanDerCorput((uint32_t)number(&t, row, "k")), number(&t, row, "vdc"), 0x1p-24,
                   "vdc", row);
    }
    freeTable(&t);
}

// X043, X045
TEST_ALONE(WarpsAreThoseOfTheTable)
{
    Table t = loadTable("disk_maps.csv");
    for (int row = 0; row < t.rows; row++) {
        float u = (float)number(&t, row, "u"), v = (float)number(&t, row, "v"), x, y;
        vplSamplePolarDisc(u, v, &x, &y);
        assertNear((double)x, number(&t, row, "polar_x"), 1e-7, "polar x", row);
        assertNear((double)y, number(&t, row, "polar_y"), 1e-7, "polar y", row);
        vplSampleConcentricDisc(u, v, &x, &y);
        assertNear((double)x, number(&t, row, "concentric_x"), 1e-7, "concentric x", row);
        assertNear((double)y, number(&t, row, "concentric_y"), 1e-7, "concentric y", row);
        vplVec3 d = vplSampleSphere(u, v), wanted = vectorOf(&t, row, "sphere_");
        assertNear((double)vplLength(vplSub(d, wanted)), 0, 2e-7, "sphere", row);
        assertNear((double)vplLength(d), 1, 2e-7, "|sphere|", row);
        d = vplSampleCosine(u, v);
        wanted = vectorOf(&t, row, "cosine_");
        assertNear((double)vplLength(vplSub(d, wanted)), 0, 2e-7, "cosine", row);
        assertNear((double)vplLength(d), 1, 2e-7, "|cosine|", row);
    }
    freeTable(&t);
}

// X046: frames are orthonormal and right-handed for every normal, including the poles.
TEST_ALONE(FramesAreOrthonormalForEveryNormal)
{
    for (uint64_t i = 0; i < 20000; i++) {
        vplVec3 n = vplSampleSphere((float)uniformAt(1, i), (float)uniformAt(2, i)), t, b;
        const vplVec3 poles[6] = {{0, 0, -1}, {0, 0, 1},       {0, -1, 0},
                                  {0, 1, 0},  {1e-20f, 0, -1}, {1, 0, -0.0f}};
        n = i < 6 ? poles[i] : n;
        vplTangentFrame(n, &t, &b);
        assertNear((double)vplDot(t, b), 0, 1e-6, "t.b", (int)i);
        assertNear((double)vplDot(t, n), 0, 1e-6, "t.n", (int)i);
        assertNear((double)vplDot(b, n), 0, 1e-6, "b.n", (int)i);
        assertNear((double)vplLength(t), 1, 1e-6, "|t|", (int)i);
        assertNear((double)vplDot(vplCross(t, b), n), 1, 1e-6, "hand", (int)i);
    }
}

TEST_ALONE(NormalizeKeepsTheDirectionOfAnyLength)
{
    const float lengths[] = {1e-42f, 1e-30f, 1, 1e30f, 3e38f};
    for (int i = 0; i < 5; i++) {
        vplVec3 n = vplNormalize(vplVec(0.6f * lengths[i], 0, -0.8f * lengths[i]));
        assertNear((double)n.x, 0.6, i == 0 ? 1e-2 : 2e-7, "x", i); // a denormal has few significant bits
        assertNear((double)n.z, -0.8, i == 0 ? 1e-2 : 2e-7, "z", i);
    }
    vplVec3 zero = vplNormalize(vplVec(0, 0, 0));
    assert_true(zero.x == 0 && zero.y == 0 && zero.z == 0);
}

TEST_ALONE(MatricesMoveAsTheyShould)
{
    vplMat4 m = vplMat4_FromParts((vplVec3){1, 2, 3}, (double[3]){VPL_PI / 2, 0, 0}, (vplVec3){2, 2, 2});
    vplVec3 p = vplMat4_TransformPoint(&m, (vplVec3){0, 1, 0}); // the rotation takes y to z
    assert_true(p.x == 1 && p.y == 2 && p.z == 5);
    vplVec3 d = vplMat4_TransformDirection(&m, (vplVec3){0, 1, 0});
    assert_true(d.x == 0 && d.y == 0 && d.z == 2);
    vplMat4 turn = vplMat4_FromParts((vplVec3){0, 0, -5}, (double[3]){0, 0.5, 1}, (vplVec3){1, 2, 3});
    vplMat4 both = vplMat4_Multiply(&turn, &m);
    vplVec3 once = vplMat4_TransformPoint(&both, (vplVec3){0.5f, 1, -1});
    vplVec3 twice = vplMat4_TransformPoint(&turn, vplMat4_TransformPoint(&m, (vplVec3){0.5f, 1, -1}));
    assertNear((double)vplLength(vplSub(once, twice)), 0, 1e-6, "product", 0);
}

// The first eight points, derived by hand from the primitive polynomials and direction numbers of Joe and
// Kuo.
TEST_ALONE(SobolPointsAreThePublishedOnes)
{
    static const double wanted[8][VPL_SOBOL_DIMENSIONS] = {
        {0, 0, 0, 0},
        {0.5, 0.5, 0.5, 0.5},
        {0.25, 0.75, 0.75, 0.75},
        {0.75, 0.25, 0.25, 0.25},
        {0.125, 0.625, 0.375, 0.125},
        {0.625, 0.125, 0.875, 0.625},
        {0.375, 0.375, 0.625, 0.875},
        {0.875, 0.875, 0.125, 0.375},
    };
    const vplSobol sobol = vplSobol_Make();
    for (uint32_t i = 0; i < 8; i++) {
        uint32_t fractions[VPL_SOBOL_DIMENSIONS];
        vplSobol_Point(&sobol, i, fractions);
        for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
            assertNear(fractions[d] * 0x1p-32, wanted[i][d], 0, "fraction", (int)i);
        }
    }
}

// After scrambling and shuffling, the first 2^k points still have one point in each stratum of every
// dimension, and one in each elementary interval of the first two dimensions, of all shapes with area 2^-k.
TEST_ALONE(ScrambledPointsKeepTheirStrata)
{
    enum { K = 8, COUNT = 1 << K };
    const vplSobol sobol = vplSobol_Make();
    for (uint32_t stream = 0; stream < 50; stream++) {
        float p[COUNT][VPL_SOBOL_DIMENSIONS];
        for (uint32_t i = 0; i < COUNT; i++) {
            vplSobol_Sample(&sobol, 9, stream, stream % 3, i, p[i]);
        }
        for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
            bool taken[COUNT] = {false};
            for (int i = 0; i < COUNT; i++) {
                bool* cell = &taken[(int)(p[i][d] * COUNT)];
                assert_false(*cell);
                *cell = true;
            }
        }
        for (int k = 0; k <= K; k++) {
            bool taken[COUNT] = {false};
            for (int i = 0; i < COUNT; i++) {
                int x = (int)(p[i][0] * (float)(1 << k)), y = (int)(p[i][1] * (float)(1 << (K - k)));
                assert_false(taken[(x << (K - k)) + y]);
                taken[(x << (K - k)) + y] = true;
            }
        }
    }
}

// A sequence's point of a given index is uniform over all streams, and two streams are uncorrelated.
TEST_ALONE(StreamsAreIndependent)
{
    enum { STREAMS = 20000 };
    const vplSobol sobol = vplSobol_Make();
    for (uint32_t index = 0; index < 5; index++) {
        double mean[VPL_SOBOL_DIMENSIONS] = {0}, products[3] = {0};
        for (uint64_t stream = 0; stream < STREAMS; stream++) {
            float a[VPL_SOBOL_DIMENSIONS], b[VPL_SOBOL_DIMENSIONS], c[VPL_SOBOL_DIMENSIONS];
            vplSobol_Sample(&sobol, 1, stream, 0, index, a);
            vplSobol_Sample(&sobol, 1, stream + 1, 0, index, b);
            vplSobol_Sample(&sobol, 1, stream, 1, index, c);
            for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
                mean[d] += (double)a[d] / STREAMS;
            }
            const double x[3] = {(double)b[0], (double)c[0], (double)a[1]}; // pixels, sets, dimensions
            for (int i = 0; i < 3; i++) {
                products[i] += ((double)a[0] - 0.5) * (x[i] - 0.5) / STREAMS;
            }
        }
        for (int d = 0; d < VPL_SOBOL_DIMENSIONS; d++) {
            assertNear(mean[d], 0.5, 0.01, "mean", (int)index); // five standard deviations
        }
        for (int i = 0; i < 3; i++) {
            assertNear(products[i], 0, 0.003, "covariance", i);
        }
    }
}

// The numbers of points on a floor are uniform; those of neighbours and those of two seeds are uncorrelated.
TEST_ALONE(NumbersOfPositionsAreIndependent)
{
    enum { SIDE = 200 };
    double mean = 0, products[3] = {0};
    for (int i = 0; i < SIDE * SIDE; i++) {
        const float x = 0.01f * (float)(i % SIDE), z = 0.01f * (float)(i / SIDE);
        const uint64_t hashes[4] = {vplHashPosition(1, x, 0, z), vplHashPosition(1, x + 0.01f, 0, z),
                                    vplHashPosition(1, x, 0, z + 0.01f), vplHashPosition(2, x, 0, z)};
        double u[4];
        for (int k = 0; k < 4; k++) {
            u[k] = 0x1p-64 * (double)hashes[k] - 0.5;
        }
        mean += u[0] / (SIDE * SIDE);
        for (int k = 0; k < 3; k++) {
            products[k] += u[0] * u[k + 1] / (SIDE * SIDE);
        }
    }
    assertNear(mean, 0, 0.007, "mean", 0); // five standard deviations
    for (int k = 0; k < 3; k++) {
        assertNear(products[k], 0, 0.0021, "covariance", k);
    }
}
