// SPDX-License-Identifier: MIT
// The formulas of bias and PCF by themselves against tables of exact answers, to roundings of double. X061 to X068.
#include "shadow_maps.h"

#include <vpl/formulas.h>

#include <float.h>

TEST(BiasFormulasGiveTheTableToTheLastDigits, 1)
{
    (void)context;
    Table t = loadTable("bias_angle.csv");
    // Four roundings of numbers up to 1, and those of the angle times the slope of the bias, which is steep at 90 degrees.
    for (int row = 0; row < t.rows; row++) {
        const double alpha = number(&t, row, "alpha"), theta = number(&t, row, "theta_deg") * VPL_PI / 180,
                     cosine = number(&t, row, "n_dot_l"), wanted = number(&t, row, "bias_over_r_exact");
        const double slope = sin(alpha) / (cos(theta - alpha) * cos(theta - alpha));
        const double rounding = DBL_EPSILON * (2 + theta * slope);
        assertNear(vplFormula_PlaneBias(1, theta, alpha), fmax(wanted, 0), rounding, "plane", row);
        assertNear(vplFormula_PlaneBias(3, theta, alpha), fmax(3 * wanted, 0), 3 * rounding, "plane at 3",
                   row);
        if (wanted >= 0) {
            const double dynamic = number(&t, row, "needed_bdmax_over_r_if_bs0");
            assertNear(vplFormula_PairBias(0, dynamic, cosine), wanted, 4e-16 * fmax(dynamic, 1), "pair",
                       row);
        }
    }
    assert_int_equal(t.rows, 45);
    freeTable(&t);
}

TEST(ShadowFormulasGiveEveryVerdictOfTheTable, 1)
{
    (void)context;
    Table t = loadTable("shadow_compare.csv");
    for (int row = 0; row < t.rows; row++) {
        const double bias = vplFormula_PairBias(number(&t, row, "b_s"), number(&t, row, "b_dmax"),
                                                number(&t, row, "n_dot_lhat"));
        assertNear(bias, number(&t, row, "bias_clamped"), 4e-16, "bias", row);
        assertNear(vplFormula_Shadow(number(&t, row, "dist"), bias,
                                     number(&t, row, "stored") * number(&t, row, "far")),
                   number(&t, row, "s_clamped"), 0, "s", row);
    }
    assert_true(t.rows > 0);
    freeTable(&t);
}

TEST(PcfFormulasGiveTheTableToTheLastDigits, 1)
{
    (void)context;
    static const char* const names[4][2] = {{"disk", "varS_disk"},
                                            {"square", "varS_square"},
                                            {"ball", "varS_ball"},
                                            {"sphere_surface", "varS_sphere"}};
    Table t = loadTable("pcf_halfplane.csv");
    for (int row = 0; row < t.rows; row++) {
        const double x = number(&t, row, "x_over_e");
        for (int k = 0; k < 4; k++) {
            assertNear(vplFormula_PcfAtEdge((vplPcfKernel)k, x), number(&t, row, names[k][0]), 4e-16,
                       names[k][0], row);
            assertNear(vplFormula_PcfVariance((vplPcfKernel)k, x), number(&t, row, names[k][1]), 4e-16,
                       names[k][1], row);
        }
    }
    assert_true(t.rows > 4);
    freeTable(&t);
}

// The table's grids beside an edge: samples beyond the edge see something at half the distance. What they expect is the
// share of the square.
TEST(PcfFormulasCountTheGridsOfTheTable, 1)
{
    (void)context;
    Table t = loadTable("pcf_grid.csv");
    for (int row = 0; row < t.rows; row++) {
        const int samples = (int)number(&t, row, "S"), side = (int)rint(sqrt(samples));
        const double x = number(&t, row, "x_over_e");
        double stored[VPL_MAX_PCF_SAMPLES];
        for (int i = 0; i < samples; i++) {
            stored[i] = (2.0 * (i / side) + 1) / side - 1 > x ? 0.5 : INFINITY;
        }
        const double factor = vplFormula_Pcf(1, 0.01, stored, samples);
        assertNear(factor, number(&t, row, "factor"), 0, "factor", row);
        assertNear(factor * samples, number(&t, row, "shadowed"), 0, "shadowed", row);
        assertNear(vplFormula_PcfAtEdge(VPL_PCF_SQUARE, x), number(&t, row, "expectation"), 4e-16,
                   "expectation", row);
    }
    assert_int_equal(t.rows, 42);
    freeTable(&t);
}

TEST(LeakFormulaGivesTheTableToTheLastDigits, 1)
{
    (void)context;
    Table t = loadTable("peter_panning.csv");
    for (int row = 0; row < t.rows; row++) {
        const double wanted = number(&t, row, "gap_exact");
        assertNear(vplFormula_LeakBehindWall(number(&t, row, "light_height"), number(&t, row, "occluder_x0"),
                                             number(&t, row, "bias")),
                   wanted, 1e-14 * wanted, "gap", row);
    }
    assert_true(t.rows > 2);
    freeTable(&t);
}

TEST(FormulasOutOfRangeGiveNaN, 1)
{
    (void)context;
    assert_true(isnan(vplFormula_PlaneBias(-1, 0, 0)) && isnan(vplFormula_PlaneBias(1, NAN, 0)));
    assert_true(isnan(vplFormula_PlaneBias(1, 2, 0)) && isnan(vplFormula_PlaneBias(1, 0, 2)));
    assert_true(isnan(vplFormula_Pcf(1, 0, NULL, 4)) && isnan(vplFormula_Pcf(1, 0, (double[1]){1}, 0)));
    assert_true(isnan(vplFormula_PcfAtEdge((vplPcfKernel)9, 0)) && isnan(vplFormula_LeakBehindWall(0, 1, 1)));
}
