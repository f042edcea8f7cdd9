// SPDX-License-Identifier: MIT
// Tests of shadow verdicts, light leaks and PCF against tables of exact answers; test_bias_tables.c has the bias. Covers
// extremes X061, X062, X065 and X070.
#include "shadow_maps.h"

#include "math/vec.h"

// X061, X062
TEST(EveryShadowVerdictOfTheTable, 1)
{
    Table t = loadTable("shadow_compare.csv");
    for (int row = 0; row < t.rows; row++) {
        FlatMap flat;
        makeFlatMap(&flat, context, vectorOf(&t, row, "l"), (float)number(&t, row, "far"),
                    (float)number(&t, row, "stored"));
        const vplShadow shadow =
            pairShadow(&flat.map, (float)number(&t, row, "b_s"), (float)number(&t, row, "b_dmax"));
        vplVec3 n = vplNormalize(vectorOf(&t, row, "n"));
        double s = (double)vplShadow_Factor(&shadow, (vplVec3){0, 0, 0}, n);
        assertNear(s, number(&t, row, "s_clamped"), 0, "s", row);
        double cosine = fmax(number(&t, row, "n_dot_lhat"), 0), dist = number(&t, row, "dist");
        assertNear((double)vplShadow_Bias(&shadow, (float)dist, (float)cosine),
                   number(&t, row, "bias_clamped"), 2e-8, "bias", row);
    }
    freeTable(&t);
}

// X065
// peter_panning.csv: the width of the light leak behind a thin wall at x0. Seen from the light at height h, the
// floor at x lies r away and the wall r x0 / x, which every texel stores.
TEST(LightLeaksBehindAWallAsFarAsTheTableSays, 1)
{
    Table t = loadTable("peter_panning.csv");
    for (int row = 0; row < t.rows; row++) {
        const double h = number(&t, row, "light_height"), x0 = number(&t, row, "occluder_x0"),
                     bias = number(&t, row, "bias"), wanted = number(&t, row, "gap_exact"),
                     first = number(&t, row, "gap_first_order_bias_sin"), theta = atan2(x0, h);
        double lit = x0, dark = x0 + 1;
        while (dark - lit > 1e-9) {
            const double x = (lit + dark) / 2, r = hypot(x, h);
            FlatMap flat;
            makeFlatMap(&flat, context, vplVec(0, (float)h, 0), 16, (float)(r * x0 / x / 16));
            const vplShadow shadow = pairShadow(&flat.map, (float)bias, 0);
            if (vplShadow_Factor(&shadow, vplVec((float)x, 0, 0), vplVec(0, 1, 0)) > 0) {
                dark = x;
            } else {
                lit = x;
            }
        }
        // Distances in floats are off by 2^-24 of themselves each, and so is x. Behind the wall they grow by
        // `slope` faster than the wall's.
        const double x = x0 + wanted, r = hypot(x, h), slope = x / r * (1 - x0 / x) + r * x0 / (x * x);
        assertNear(lit - x0, wanted, 0x1p-24 * (4 * r / slope + x), "gap", row);
        assertNear(number(&t, row, "theta_deg_at_x0"), theta * 180 / VPL_PI, 1e-12, "theta", row);
        assertNear(first, bias * sin(theta), 1e-12, "first order", row);
        assertNear(number(&t, row, "ratio"), wanted / first, 1e-12, "ratio", row);
    }
    assert_int_equal(t.rows, 30);
    freeTable(&t);
}

// X065
// The same with drawn maps, where the table's leak is at least twice as wide as what a texel hides.
TEST(LightLeaksBehindADrawnWallAsFarAsTheTableSays, 2)
{
    Table t = loadTable("peter_panning.csv");
    enum { SIZE = 1024 };
    int tested = 0;
    for (int row = 0; row < t.rows; row++) {
        double h = number(&t, row, "light_height"), x0 = number(&t, row, "occluder_x0"),
               gap = number(&t, row, "gap_exact");
        double theta = atan2(x0 + gap, h), texel = 2 * h / SIZE * (1 + pow((x0 + gap) / h, 2));
        // The stored distance is that of a texel's centre: it is off by half a texel, in the slope as well.
        const double slack = 1.5 * texel * (1 + tan(theta));
        if (slack > gap / 2) {
            continue;
        }
        vplGeometry* g = wallOnFloor(context, (float)x0);
        vplCubeMap* map = makeCubeMap(g, (vplVec3){0, (float)h, 0.01f}, SIZE);
        const vplShadow shadow = pairShadow(map, (float)number(&t, row, "bias"), 0);
        double step = texel / 16, x = x0 + step;
        while (x < x0 + 20 &&
               vplShadow_Factor(&shadow, (vplVec3){(float)x, 0, 0.01f}, (vplVec3){0, 1, 0}) == 0) {
            x += step;
        }
        assertNear(x - x0, gap, slack, "gap", row);
        tested++;
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
    }
    assert_int_equal(tested, 3);
    freeTable(&t);
}

// Draws the map of a quad, halfway down, that shadows the half-plane x < edge of the floor 2 below the light.
static vplCubeMap* halfPlaneMap(vplContext* context, float edge, int size, vplGeometry** geometryOut)
{
    vplGeometry* g = floorQuad(context, (vplVec3){edge / 2 - 5, -1, 0}, 10, 0.5f);
    *geometryOut = g;
    return makeCubeMap(g, (vplVec3){0, 0, 0}, size);
}

// X070
TEST(PcfGivesTheExpectationOfADisc, 2)
{
    Table t = loadTable("pcf_halfplane.csv");
    const float e = 0.2f;
    for (int row = 0; row < t.rows; row++) {
        // Positive x: the edge is moved so that it covers less of the kernel.
        double x = number(&t, row, "x_over_e"), wanted = number(&t, row, "disk");
        vplGeometry* g;
        vplCubeMap* map = halfPlaneMap(context, (float)-x * e, 1024, &g);
        const int samples[] = {4, 16, 64, 256};
        for (int k = 0; k < 4; k++) {
            vplShadow shadow = exactShadow(map, samples[k], e);
            double s = (double)vplShadow_Factor(&shadow, (vplVec3){0, -2, 0}, (vplVec3){0, 1, 0});
            double count = s * samples[k];
            assertNear(count, rint(count), 1e-5, "k/S", row);
            // Low-discrepancy points stay below the 2 standard deviations of random ones. The tolerance also
            // allows for the texels along the edge (a texel is 1/102 of the kernel's radius).
            double slack = x == 0 ? 2.0 / samples[k] : 2 * sqrt(number(&t, row, "varS_disk") / samples[k]);
            assertNear(s, wanted, slack + 0.015, "s", row);
        }
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
    }
    freeTable(&t);
}

// X070
// pcf_grid.csv: the table's own offsets replace ours, and counts must be exact, also where a sample falls on the
// edge: lengths are such that the edge then lies between two texels. The expectation is that of a square, to the last digit
// in test_formulas.c; samples in a grid find it to half of the grid's step.
TEST(PcfCountsTheGridsOfTheTable, 2)
{
    Table t = loadTable("pcf_grid.csv");
    const float e = 0.25f;
    int ties = 0;
    for (int row = 0; row < t.rows; row++) {
        const int samples = (int)number(&t, row, "S"), side = (int)rint(sqrt(samples));
        const double x = number(&t, row, "x_over_e"), wanted = number(&t, row, "expectation");
        char kernel[16];
        snprintf(kernel, sizeof kernel, "grid%dx%d", side, side);
        assert_string_equal(kernel, cell(&t, row, "kernel"));
        vplGeometry* g;
        vplCubeMap* map = halfPlaneMap(context, (float)-x * e, 1024, &g);
        // The table's grid, and one that is finer and finds the expectation to half of its own step.
        for (int fine = 0; fine < 2; fine++) {
            const int n = fine ? 16 : side;
            vplShadow shadow = exactShadow(map, n * n, e);
            for (int i = 0; i < n * n; i++) {
                shadow.offsets[i][0] = (2 * (float)(i % n) + 1) / (float)n - 1;
                shadow.offsets[i][1] = (2 * (float)(i / n) + 1) / (float)n - 1;
                ties += !fine && (double)shadow.offsets[i][1] == -x && i % n == 0;
            }
            const double s = (double)vplShadow_Factor(&shadow, (vplVec3){0, -2, 0}, (vplVec3){0, 1, 0});
            if (fine) {
                assertNear(s, wanted, 0.5 / 16 + 1e-6, "expectation", row);
            } else {
                assertNear(s, number(&t, row, "factor"), 0, "factor", row);
                assertNear(s * samples, number(&t, row, "shadowed"), 0, "shadowed", row);
            }
        }
        vplCubeMap_Destroy(map);
        vplGeometry_Destroy(g);
    }
    assert_int_equal(t.rows, 42);
    assert_int_equal(ties, 1);
    freeTable(&t);
}
