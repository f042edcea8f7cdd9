// SPDX-License-Identifier: MIT
// Tests of B = E + rho F B without a solution (X094, X096), at extremes, and of refusals.
#include "solving.h"

// ---- divergence (X094)

TEST(WhatDivergesIsRefusedWithItsRadius, 1)
{
    for (int k = 0; k < 3; k++) {
        for (int large = 0; large < 2; large++) {
            Exchange e;
            vplRgb source[MANY], b[MANY];
            vplSolveStats stats = {.iterations = 77};
            openExchange(&e, context, MANY);
            fillSphere(&e, 41);
            setReflectance(&e, 0.5f);
            for (size_t i = 0; i < (size_t)MANY * MANY; i++) {
                e.rows[i] *= large ? 100 : 3; // spectral radius 50 or 1.5
            }
            fillSources(source, MANY, 42);
            memcpy(b, source, sizeof b);
            const vplSolveDef def = sweeps(SOLVERS[k], 1 << 20);
            assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, &stats), VPL_LIMIT);
            const char* message = takeMessage();
            assert_non_null(strstr(message, large ? "is 50, must be below 1" : "is 1.5, must be below 1"));
            assert_non_null(strstr(message, "--row-sums clamp"));
            assert_memory_equal(b, source, sizeof b);
            assert_int_equal(stats.iterations, 77);
            freeExchange(&e);
        }
    }
}

// Factors so large, or infinite, that a sweep or the radius overflows: the sentence has numbers of float only.
TEST(OverflowWhileDivergingIsASentenceOfFiniteNumbers, 1)
{
    static const float factors[] = {1e20f, 1e30f, FLT_MAX, INFINITY};
    for (int k = 0; k < 3; k++) {
        for (int i = 0; i < 4; i++) {
            Exchange e;
            vplRgb source[MANY], b[MANY];
            openExchange(&e, context, MANY);
            fillSphere(&e, 43);
            for (size_t r = 0; r < (size_t)MANY * MANY; r++) {
                e.rows[r] = factors[i];
            }
            fillSources(source, MANY, 44);
            memcpy(b, source, sizeof b);
            const vplSolveDef def = sweeps(SOLVERS[k], 100);
            assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_LIMIT);
            const char* message = takeMessage();
            assert_non_null(strstr(message, "the largest is beyond the range of float, and grows"));
            assert_non_null(
                strstr(message, i < 2 ? "form factors is 1.421e+" : "form factors is beyond the range"));
            assert_null(strstr(message, "inf"));
            assert_null(strstr(message, "nan"));
            assert_memory_equal(b, source, sizeof b);
            freeExchange(&e);
        }
    }
}

// Divergence is refused even if few sweeps are requested.
TEST(AFewSweepsOfWhatDivergesAreRefusedToo, 1)
{
    Exchange e;
    vplRgb source[MANY], b[MANY];
    openExchange(&e, context, MANY);
    fillSphere(&e, 51);
    setReflectance(&e, 0.6f);
    for (size_t i = 0; i < (size_t)MANY * MANY; i++) {
        e.rows[i] *= 2;
    }
    fillSources(source, MANY, 52);
    for (int k = 0; k < 2; k++) {
        memcpy(b, source, sizeof b);
        const vplSolveDef def = sweeps(SOLVERS[k], 3);
        assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_LIMIT);
        assert_non_null(strstr(takeMessage(), "is 1.2, must be below 1"));
        assert_memory_equal(b, source, sizeof b);
    }
    freeExchange(&e);
}

TEST(WhatIsBeyondFloatIsRefused, 1)
{
    Exchange e;
    vplRgb source[6], b[6], received[6];
    openCube(&e, context, 0.5f);
    for (int i = 0; i < 6; i++) {
        source[i] = b[i] = grey(3e38);
    }
    for (int k = 0; k < 3; k++) {
        const vplSolveDef def = sweeps(SOLVERS[k], 20);
        assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_LIMIT);
        assert_non_null(strstr(takeMessage(), "beyond the range of float"));
    }
    setReflectance(&e, 0);
    const vplSolveDef def = sweeps(VPL_SOLVER_JACOBI, 20);
    assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_SUCCESS);
    assert_int_equal(vplGatherRadiosity(&e.transport, b, received), VPL_SUCCESS);
    for (int i = 0; i < 6; i++) {
        assert_true(isfinite(received[i].r) && b[i].r == source[i].r);
    }
    freeExchange(&e);
}

// ---- extremes

TEST(NoSidesOneSideAndNoLight, 2)
{
    for (int k = 0; k < 3; k++) {
        Exchange e;
        vplRgb source[MANY] = {{0, 0, 0}}, b[MANY];
        vplSolveDef def = vplDefaultSolveDef();
        def.solver = SOLVERS[k];
        openExchange(&e, context, 0);
        vplSolveStats stats = solve(&e, &def, source, b);
        assert_true(stats.residual == 0 && stats.spectralRadius == 0 && stats.rowSumMin == 0);
        assert_int_equal(vplGatherRadiosity(&e.transport, b, b), VPL_SUCCESS);
        freeExchange(&e);

        openExchange(&e, context, 1);
        source[0] = (vplRgb){1, 2, 3};
        stats = solve(&e, &def, source, b);
        assert_true(b[0].r == 1 && b[0].g == 2 && b[0].b == 3 && stats.spectralRadius == 0);
        freeExchange(&e);

        openExchange(&e, context, MANY);
        fillSphere(&e, 61);
        memset(source, 0, sizeof source);
        stats = solve(&e, &def, source, b);
        for (int i = 0; i < MANY; i++) {
            assert_true(b[i].r == 0 && b[i].g == 0 && b[i].b == 0);
        }
        assert_true(stats.residual == 0 && stats.iterations == 1);
        freeExchange(&e);
    }
}

TEST(NoSweepsChangeNothing, 1)
{
    Exchange e;
    vplRgb source[6], b[6];
    openCube(&e, context, 0.5f);
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 6; i++) {
            source[i] = grey(1);
            b[i] = grey(i);
        }
        const vplSolveDef def = sweeps(SOLVERS[k], 0);
        vplSolveStats stats;
        assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, &stats), VPL_SUCCESS);
        assert_true(stats.iterations == 0 && stats.residual == 0 && b[5].r == 5);
        assertNear(stats.spectralRadius, 0.5, 1e-6, "radius", 0);
    }
    freeExchange(&e);
}

TEST(TheBrightestSideShootsFirst, 1)
{
    // Shooting should converge faster at first: one sweep of it must distribute more of the light than one
    // Jacobi sweep.
    Exchange e;
    vplRgb source[MANY], shot[MANY], gathered[MANY], exact[MANY];
    openExchange(&e, context, MANY);
    fillSphere(&e, 71);
    setReflectance(&e, 0.8f);
    memset(source, 0, sizeof source);
    source[7] = grey(100);
    const vplSolveDef one = sweeps(VPL_SOLVER_SHOOTING, 1), jacobi = sweeps(VPL_SOLVER_JACOBI, 1),
                      many = sweeps(VPL_SOLVER_JACOBI, 400);
    solve(&e, &one, source, shot);
    solve(&e, &jacobi, source, gathered);
    solve(&e, &many, source, exact);
    double shotError = 0, gatheredError = 0;
    for (int i = 0; i < MANY; i++) {
        shotError += fabs((double)shot[i].r - (double)exact[i].r);
        gatheredError += fabs((double)gathered[i].r - (double)exact[i].r);
    }
    assert_true(shotError < 0.8 * gatheredError);
    freeExchange(&e);
}

TEST(WrongArgumentsAreRefused, 1)
{
    Exchange e;
    vplRgb source[6] = {{0, 0, 0}}, b[6] = {{0, 0, 0}};
    openCube(&e, context, 0.5f);
    const struct {
        int solver, iterations;
        double residual;
        const char* message;
    } cases[] = {{3, 1, 0, "vplSolveDef.solver is 3"},
                 {-1, 1, 0, "vplSolveDef.solver is -1"},
                 {0, -1, 0, "vplSolveDef.iterations is -1, must be in [0, 1048576]"},
                 {0, 1048577, 0, "vplSolveDef.iterations is 1048577"},
                 {0, 1, -1e-9, "vplSolveDef.residual is -1e-09, must be in [0, 1]"},
                 {0, 1, (double)NAN, "vplSolveDef.residual is"},
                 {0, 1, 1.5, "vplSolveDef.residual is 1.5"}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        vplSolveDef def = sweeps((vplSolver)cases[i].solver, cases[i].iterations);
        def.residual = cases[i].residual;
        assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), cases[i].message));
    }
    vplSolveDef def = sweeps(VPL_SOLVER_JACOBI, 1);
    def.cookie = 0;
    assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "vplDefaultSolveDef"));
    def = sweeps(VPL_SOLVER_JACOBI, 1);
    source[4].g = INFINITY;
    assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "source[4] is (0, inf, 0), must be finite"));
    source[4].g = 0;
    b[3].b = NAN;
    assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "radiosity[3]"));
    assert_int_equal(vplGatherRadiosity(&e.transport, b, source), VPL_INVALID_ARGUMENT);
    e.transport.factors = NULL;
    assert_int_equal(vplGatherRadiosity(&e.transport, source, b), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "neither factors nor links"));
    e.transport.factors = &e.factors;
    e.factors.count = 5;
    assert_int_equal(vplRadiosityResidual(&e.transport, source, source, b), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "6 sides, but its form factors were made for 5"));
    freeExchange(&e);
}

TEST(CancellingLeavesTheRadiosities, 1)
{
    Exchange e;
    vplRgb source[6], b[6];
    openCube(&e, context, 0.5f);
    for (int i = 0; i < 6; i++) {
        source[i] = b[i] = grey(1);
    }
    int asked = 0;
    vplSolveDef def = sweeps(VPL_SOLVER_GAUSS_SEIDEL, 10);
    def.progress = refuseThird;
    def.progressUser = &asked;
    assert_int_equal(vplSolveRadiosity(&e.transport, &def, source, b, NULL), VPL_CANCELLED);
    assert_true(asked == 3 && b[0].r == 1);
    freeExchange(&e);
}
