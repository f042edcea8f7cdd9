// SPDX-License-Identifier: MIT
// Tests of B = E + rho F B with form factors made by hand: tests/data/two_patch.csv, furnace.csv, gs_cube6.csv.
#include "solving.h"

// ---- two patches

static void openTwoPatches(Exchange* e, vplContext* context, const Table* t, int row, vplRgb source[2])
{
    openExchange(e, context, 2);
    for (int i = 0; i < 2; i++) {
        e->side[i].area = (float)number(t, row, i ? "A2" : "A1");
        e->side[i].reflectance = grey(number(t, row, i ? "rho2" : "rho1"));
        source[i] = grey(number(t, row, i ? "E2" : "E1"));
    }
    e->rows[1] = (float)number(t, row, "F12");
    e->rows[2] = (float)number(t, row, "F21");
}

// X096
TEST(TwoPatchesAreThoseOfTheTable, 1)
{
    Table t = loadTable("two_patch.csv");
    const struct {
        vplSolver solver;
        int iterations;
        const char *b1, *b2;
    } cases[] = {
        {VPL_SOLVER_JACOBI, 1, "jac1_B1", "jac1_B2"},     {VPL_SOLVER_JACOBI, 4, "jac4_B1", "jac4_B2"},
        {VPL_SOLVER_GAUSS_SEIDEL, 1, "gs1_B1", "gs1_B2"}, {VPL_SOLVER_GAUSS_SEIDEL, 4, "gs4_B1", "gs4_B2"},
        {VPL_SOLVER_GAUSS_SEIDEL, 3000, "B1", "B2"},      {VPL_SOLVER_JACOBI, 3000, "B1", "B2"},
        {VPL_SOLVER_SHOOTING, 3000, "B1", "B2"}};
    int compared = 0;
    for (int row = 0; row < t.rows; row++) {
        Exchange e;
        vplRgb source[2], b[2];
        openTwoPatches(&e, context, &t, row, source);
        const bool singular = strcmp(cell(&t, row, "B1"), "singular") == 0;
        for (size_t i = 0; i < sizeof cases / sizeof *cases && !singular; i++) {
            const vplSolveDef def = sweeps(cases[i].solver, cases[i].iterations);
            const vplSolveStats stats = solve(&e, &def, source, b);
            // Values are floats; 25 bounces of 0.99^2 lose precision proportionally.
            assertRatio((double)b[0].r, number(&t, row, cases[i].b1), 1e-5, cases[i].b1, row);
            assertRatio((double)b[1].b, number(&t, row, cases[i].b2), 1e-5, cases[i].b2, row);
            assertNear(stats.spectralRadius, number(&t, row, "rate_jacobi"), 1e-6, "radius", row);
            compared++;
        }
        freeExchange(&e);
    }
    assert_int_equal(compared, 8 * 7);
    freeTable(&t);
}

// X096
TEST(WithoutASolutionIterationsEndItAndTheResidualIsReported, 1)
{
    Table t = loadTable("two_patch.csv");
    int singular = 0;
    for (int row = 0; row < t.rows; row++) {
        Exchange e;
        vplRgb source[2], b[2];
        openTwoPatches(&e, context, &t, row, source);
        for (int i = 0; i < 3 && strcmp(cell(&t, row, "B1"), "singular") == 0; i++) {
            vplSolveDef def = sweeps(SOLVERS[i], 50);
            def.residual = 1e-4;
            takeMessage();
            const vplSolveStats stats = solve(&e, &def, source, b);
            const char* warning = takeMessage();
            assert_non_null(strstr(warning, "ended after 50 sweeps with a residual of"));
            assert_int_equal(stats.iterations, 50);
            assert_true(stats.residual > 1e-4 && isfinite(b[0].r) && b[0].r > 40);
            assertNear(stats.spectralRadius, 1, 1e-9, "radius", i);
            singular++;
        }
        freeExchange(&e);
    }
    assert_int_equal(singular, 3);
    freeTable(&t);
}

// ---- closed rooms

TEST(AFurnaceGlowsByTheGeometricSeries, 1)
{
    Table t = loadTable("furnace.csv");
    static const int iterations[] = {1, 2, 5, 10, 100};
    enum { COUNT = 37 };
    for (int row = 0; row < t.rows; row++) {
        Exchange e;
        vplRgb source[COUNT], b[COUNT];
        openExchange(&e, context, COUNT);
        fillSphere(&e, 5);
        setReflectance(&e, (float)number(&t, row, "rho"));
        for (int i = 0; i < COUNT; i++) {
            source[i] = grey(number(&t, row, "E"));
        }
        for (int k = 0; k < 5; k++) {
            char column[32];
            snprintf(column, sizeof column, "B_jacobi_%d", iterations[k]);
            const vplSolveDef def = sweeps(VPL_SOLVER_JACOBI, iterations[k]);
            const vplSolveStats stats = solve(&e, &def, source, b);
            for (int i = 0; i < COUNT; i++) {
                // The error is that of 0.999^100 if rho is rounded to 2^-25.
                assertRatio((double)b[i].g, number(&t, row, column), 1e-5, column, row);
            }
            assertNear(stats.spectralRadius, number(&t, row, "rho"), 1e-6, "radius", row);
            assertNear(stats.rowSumMin, 1, 1e-6, "least sum", row);
            assertNear(stats.rowSumMean, 1, 1e-6, "mean sum", row);
            assertNear(stats.rowSumMax, 1, 1e-6, "largest sum", row);
        }
        freeExchange(&e);
    }
    freeTable(&t);
}

TEST(AlgorithmOneOnACubeIsThatOfTheTable, 1)
{
    Table t = loadTable("gs_cube6.csv");
    static const char* const columns[] = {"B_-z", "B_+z", "B_-y", "B_+y", "B_-x", "B_+x"};
    for (int row = 0; row < t.rows; row++) {
        Exchange e;
        vplRgb source[6] = {{0, 0, 0}}, b[6];
        openCube(&e, context, (float)number(&t, row, "rho"));
        const bool uniform = strcmp(cell(&t, row, "emission"), "uniform") == 0;
        for (int i = 0; i < 6; i++) {
            source[i] = grey(uniform || i == 1 ? 1 : 0);
        }
        const bool exact = strcmp(cell(&t, row, "sweep"), "exact") == 0;
        const vplSolveDef def = sweeps(VPL_SOLVER_GAUSS_SEIDEL, exact ? 1000 : (int)number(&t, row, "sweep"));
        solve(&e, &def, source, b);
        for (int i = 0; i < 6; i++) {
            assertRatio((double)b[i].b, number(&t, row, columns[i]), 3e-6, columns[i], row);
        }
        freeExchange(&e);
    }
    assert_int_equal(t.rows, 42);
    freeTable(&t);
}

// ---- all solvers

TEST(EverySolverFindsTheSameSolution, 2)
{
    Exchange e;
    vplRgb source[MANY], b[MANY], residual[MANY], received[MANY];
    openExchange(&e, context, MANY);
    fillSphere(&e, 11);
    fillSources(source, MANY, 12);
    for (int k = 0; k < 3; k++) {
        const vplSolveDef def = sweeps(SOLVERS[k], 60);
        const vplSolveStats stats = solve(&e, &def, source, b);
        assert_int_equal(stats.solver, SOLVERS[k]);
        assert_int_equal(vplRadiosityResidual(&e.transport, source, b, residual), VPL_SUCCESS);
        assert_int_equal(vplGatherRadiosity(&e.transport, b, received), VPL_SUCCESS);
        for (int c = 0; c < 3; c++) {
            const double h = sphereIrradiance(&e, source, c);
            for (int i = 0; i < MANY; i++) {
                const double wanted = (double)(&source[i].r)[c] + (double)(&e.side[i].reflectance.r)[c] * h;
                assertRatio((double)(&b[i].r)[c], wanted, 2e-6, "radiosity", i);
                assertRatio((double)(&received[i].r)[c], h, 2e-6, "irradiance", i);
                assertNear((double)(&residual[i].r)[c], 0, 2e-6, "residual", i);
            }
        }
    }
    freeExchange(&e);
}

TEST(AMovedLightStartsFromTheOldSolution, 1)
{
    Exchange e;
    vplRgb before[MANY], after[MANY], old[MANY], b[MANY], fresh[MANY];
    openExchange(&e, context, MANY);
    fillSphere(&e, 21);
    fillSources(before, MANY, 22);
    memcpy(after, before, sizeof after);
    for (int i = 0; i < 10; i++) { // a small part of the light moves
        after[i].r += 0.5f;
        after[MANY - 1 - i].r *= 0.5f;
    }
    for (int k = 0; k < 3; k++) {
        vplSolveDef def = sweeps(SOLVERS[k], 100);
        def.residual = 1e-6;
        solve(&e, &def, before, old);
        const vplSolveStats scratch = solve(&e, &def, after, fresh);
        memcpy(b, old, sizeof b);
        vplSolveStats stats;
        assert_int_equal(vplSolveRadiosity(&e.transport, &def, after, b, &stats), VPL_SUCCESS);
        assert_true(stats.iterations < scratch.iterations || k == 2);
        for (int i = 0; i < MANY; i++) {
            assertRatio((double)b[i].r, (double)fresh[i].r, 2e-5, "radiosity", i);
            assertRatio((double)b[i].g, (double)fresh[i].g, 2e-5, "radiosity", i);
        }
    }
    freeExchange(&e);
}

TEST(ResidualsEndIt, 1)
{
    Exchange e;
    vplRgb source[MANY], b[MANY];
    openExchange(&e, context, MANY);
    fillSphere(&e, 31);
    fillSources(source, MANY, 32);
    for (int k = 0; k < 3; k++) {
        int last = 0;
        for (double residual = 1e-1; residual > 5e-6; residual /= 10) {
            vplSolveDef def = vplDefaultSolveDef();
            def.solver = SOLVERS[k];
            def.residual = residual;
            def.spectrum = false;
            takeMessage();
            const vplSolveStats stats = solve(&e, &def, source, b);
            assert_string_equal(takeMessage(), "");
            assert_true(stats.residual <= residual && stats.iterations < 100 && stats.iterations >= last);
            assert_true(stats.spectralRadius == 0 && stats.rowSumMax == 0);
            last = stats.iterations;
        }
        assert_true(last > 2);
    }
    freeExchange(&e);
}

// A sweep of a bright closed room changes little, and so do very many: the warning says how much they would add.
TEST(LightThatIsMissingIsSaid, 1)
{
    static const struct {
        float rho;
        double residual;
        const char* words;
    } cases[] = {{0.99f, 1e-4, "radiosity ended after 100 sweeps with a residual of 0.00"},
                 {0.999f, 1e-6, "radiosity ended after 100 sweeps with a residual of 0.00"},
                 {0.99f, 1e-2, "radiosity ended with a residual of 0.00"},
                 {0.5f, 1e-4, NULL},
                 {0.5f, 1e-2, NULL}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        Exchange e;
        openCube(&e, context, cases[i].rho);
        vplRgb source[6], b[6];
        for (int k = 0; k < 6; k++) {
            source[k] = grey(1);
        }
        vplSolveDef def = sweeps(VPL_SOLVER_JACOBI, 100);
        def.residual = cases[i].residual;
        takeMessage();
        const vplSolveStats stats = solve(&e, &def, source, b);
        const char* warning = takeMessage();
        if (cases[i].words == NULL) {
            assert_string_equal(warning, "");
        } else { // after n sweeps of equal light everywhere rho^n of it is missing
            assert_memory_equal(warning, cases[i].words, strlen(cases[i].words));
            const double left = pow((double)cases[i].rho, stats.iterations + 1),
                         said = 100 * left / (1 - left);
            const char* another = strstr(warning, "another ");
            assert_non_null(another);
            assertRatio(atof(another + strlen("another ")), said, 0.1, "share", (int)i);
        }
        freeExchange(&e);
    }
}

// ---- bits

static uint64_t solveHash(vplContext* context)
{
    enum { LARGE = 1109 }; // enough rows for workers to share Jacobi sweeps
    Exchange e;
    vplRgb source[LARGE], b[LARGE];
    uint64_t hash = 0;
    openExchange(&e, context, LARGE);
    fillSphere(&e, 81);
    fillSources(source, LARGE, 82);
    for (int k = 0; k < 3; k++) {
        const vplSolveDef def = sweeps(SOLVERS[k], 5);
        const vplSolveStats stats = solve(&e, &def, source, b);
        const float numbers[] = {(float)stats.residual, (float)stats.spectralRadius, (float)stats.rowSumMin};
        hash = vplHashFloats(hash, &b[0].r, 3 * LARGE);
        hash = vplHashFloats(hash, numbers, 3);
        assert_int_equal(vplGatherRadiosity(&e.transport, b, b), VPL_SUCCESS);
        hash = vplHashFloats(hash, &b[0].r, 3 * LARGE);
    }
    freeExchange(&e);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(SolutionsAreTheSameBitsEverywhere)
{
    assertSameEverywhere(solveHash);
}
