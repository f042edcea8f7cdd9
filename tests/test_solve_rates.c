// SPDX-License-Identifier: MIT
// Tests of how fast sweeps converge in a cube: tests/data/gs_rates.csv.
#include "solving.h"

// Counts the sweeps from B = 0, as the table does, until all values are within 1e-3 of the solution. At 0.99
// rounding errors of the row sums change the count, so the solution is computed from the same rounded rows.
static int sweepsNeeded(const Exchange* e, vplSolver solver)
{
    vplRgb source[6], b[6] = {{0, 0, 0}}, exact[6];
    const vplSolveDef def = sweeps(solver, 1), many = sweeps(VPL_SOLVER_GAUSS_SEIDEL, 5000);
    for (int i = 0; i < 6; i++) {
        source[i] = grey(1);
    }
    solve(e, &many, source, exact);
    for (int sweep = 1;; sweep++) {
        assert_int_equal(vplSolveRadiosity(&e->transport, &def, source, b, NULL), VPL_SUCCESS);
        double worst = 0;
        for (int i = 0; i < 6; i++) {
            worst = fmax(worst, fabs((double)b[i].r / (double)exact[i].r - 1));
        }
        if (worst <= 1e-3) {
            return sweep;
        }
    }
}

// The factor by which a sweep lowers the error, which follows the same steps as the light of a room without a source: that
// falls without end, so that no rounding of a solution stops it. After 20 sweeps the parts that fall faster are gone.
static double rateOf(const Exchange* e, vplSolver solver)
{
    enum { BEFORE = 20, MEASURED = 20 };
    const vplSolveDef before = sweeps(solver, BEFORE), measured = sweeps(solver, MEASURED);
    vplRgb black[6] = {{0, 0, 0}}, b[6];
    double left[2] = {0, 0};
    for (int i = 0; i < 6; i++) {
        b[i] = grey(1);
    }
    for (int k = 0; k < 2; k++) {
        assert_int_equal(vplSolveRadiosity(&e->transport, k ? &measured : &before, black, b, NULL),
                         VPL_SUCCESS);
        for (int i = 0; i < 6; i++) {
            left[k] += (double)b[i].r;
        }
    }
    return pow(left[1] / left[0], 1.0 / MEASURED);
}

// Compares radii and speed-up, log(gauss) / log(jacobi). Reflectance and form factors are rounded to float, one unit each,
// which counts once in Jacobi's radius and up to twice in Gauss-Seidel's; the roundings of 20 sweeps cancel each other.
// A logarithm has the relative error of its number as its absolute one.
static void compareRates(const Exchange* e, const Table* t, int row)
{
    const double unit = 0x1p-24, wanted = number(t, row, "jacobi_radius");
    const double jacobi = rateOf(e, VPL_SOLVER_JACOBI), gauss = rateOf(e, VPL_SOLVER_GAUSS_SEIDEL);
    assertRatio(jacobi, wanted, 2 * unit, "Jacobi's radius", row);
    assertRatio(gauss, number(t, row, "gs_radius_cube6"), 4 * unit, "Gauss-Seidel's radius", row);
    const double slack = 2 * unit / -log(jacobi) + 4 * unit / -log(gauss);
    assertRatio(log(gauss) / log(jacobi), number(t, row, "gs_speedup"), slack, "speed-up", row);
    vplRgb source[6], b[6];
    for (int i = 0; i < 6; i++) {
        source[i] = grey(1);
    }
    const vplSolveDef def = sweeps(VPL_SOLVER_JACOBI, 1);
    assertRatio(solve(e, &def, source, b).spectralRadius, wanted, 2 * unit, "radius of the statistics", row);
}

TEST(GaussSeidelNeedsHalfTheSweepsOfJacobi, 1)
{
    Table t = loadTable("gs_rates.csv");
    for (int row = 0; row < t.rows; row++) {
        Exchange e;
        openCube(&e, context, (float)number(&t, row, "rho"));
        // Rounding to float, magnified by 1 / (1 - rho), is 6e-6 at 0.99; the 687th sweep ends 3.2e-6 above 1e-3.
        const double wanted = number(&t, row, "jacobi_sweeps_for_1e-3"), rho = number(&t, row, "rho");
        const bool close = fabs(pow(rho, wanted - 1) - 1e-3) < 0x1p-24 / (1 - rho);
        assertNear(sweepsNeeded(&e, VPL_SOLVER_JACOBI), wanted, close, "sweeps of Jacobi's", row);
        assert_true(close == (row == 3));
        assertNear(sweepsNeeded(&e, VPL_SOLVER_GAUSS_SEIDEL), number(&t, row, "gs_sweeps_for_1e-3"), 0,
                   "sweeps of Gauss-Seidel", row);
        compareRates(&e, &t, row);
        freeExchange(&e);
    }
    assert_int_equal(t.rows, 4);
    freeTable(&t);
}
