// SPDX-License-Identifier: MIT
// Tests of bias and PCF against tables of exact answers. Covers extremes X061 to X068.
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

// A float near 1 is off by 2^-24; the exact bias is 1 less a quotient of two such, and has 2^-20 added to it.
#define BIAS_SLACK 3e-7
#define BIAS_ADDED 0x1p-20

// r (1 - cos t / cos(t - a)): the bias of a plane at angle t whose samples are off by a; r (1 - cos t) where a
// exceeds t.
static double exactBias(double r, double t, double a)
{
    return r * (1 - cos(t) / cos(fmax(t - a, 0)));
}

// X063
// At 0 degrees the table's bias is negative, and ours 0: the next sample is no nearer.
TEST(ExactBiasIsThatOfTheTable, 1)
{
    Table t = loadTable("bias_angle.csv");
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    vplShadow shadow = exactShadow(&flat.map, 1, 0);
    int facing = 0;
    for (int row = 0; row < t.rows; row++) {
        const double alpha = number(&t, row, "alpha"), cosine = number(&t, row, "n_dot_l"),
                     theta = number(&t, row, "theta_deg") * VPL_PI / 180,
                     wanted = number(&t, row, "bias_over_r_exact"),
                     first = number(&t, row, "bias_over_r_first_order_alpha_tan");
        assertNear(cosine, cos(theta), 1e-15, "n.l", row);
        assertNear(first, alpha * tan(theta), 1e-12, "first order", row);
        shadow.texelTangent = (float)tan(alpha);
        const double bias = (double)vplShadow_Bias(&shadow, 3, (float)cosine) / 3 - BIAS_ADDED;
        assertNear(bias, fmax(wanted, 0), BIAS_SLACK, "bias", row);
        if (wanted < 0) {
            assert_true(theta == 0 && isEmpty(&t, row, "needed_bdmax_over_r_if_bs0"));
            assert_true(isEmpty(&t, row, "same_first_order"));
            facing++;
            continue;
        }
        // Both dynamic biases give theirs at this angle.
        const char* const columns[2] = {"needed_bdmax_over_r_if_bs0", "same_first_order"};
        for (int k = 0; k < 2; k++) {
            const double dynamic = number(&t, row, columns[k]);
            const vplShadow pair = pairShadow(&flat.map, 0, (float)dynamic);
            assertNear((double)vplShadow_Bias(&pair, 3, (float)cosine), k == 0 ? wanted : first,
                       1e-7 * dynamic, columns[k], row);
        }
    }
    assert_int_equal(t.rows, 45);
    assert_int_equal(facing, 2);
    freeTable(&t);
}

// A point of the texel of a row of bias_texel.csv: (x, y) in [0, 1]^2 from its upper left corner.
static vplVec3 inTexel(const Table* t, int row, double x, double y)
{
    static const char* const faces[6] = {"+x", "-x", "+y", "-y", "+z", "-z"};
    int face = 0;
    while (strcmp(faces[face], cell(t, row, "face")) != 0) {
        face++;
    }
    const vplCubeFrame f = vplCube_GetFrame(face);
    const double size = number(t, row, "R"), u = 2 * (number(t, row, "i") + x) / size - 1,
                 v = 1 - 2 * (number(t, row, "j") + y) / size;
    return vplNormalize(vplAdd(f.forward, vplAdd(vplScale((float)u, f.right), vplScale((float)v, f.up))));
}

// The cosine between a direction and the plane's normal, and the distance at which it meets the plane.
static double cosineTo(const Table* t, int row, vplVec3 d)
{
    return -(number(t, row, "nx") * (double)d.x + number(t, row, "ny") * (double)d.y +
             number(t, row, "nz") * (double)d.z);
}

// bias_texel.csv compares a fragment at the worst corner of a texel with the distance at the texel's centre.
// Ours must be the table's closed form for the angle between both, and enough everywhere in the texel for the
// largest angle of the map. Where a corner lies beyond the plane's horizon (X067) no finite bias is enough
// for it, but for all points of the texel this side of it.
TEST(ExactBiasIsThatOfEveryTexelOfTheTableAndEnough, 1)
{
    Table t = loadTable("bias_texel.csv");
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    int finite = 0, horizon = 0, points = 0;
    for (int row = 0; row < t.rows; row++) {
        flat.map.size = (int)number(&t, row, "R");
        vplShadow shadow = exactShadow(&flat.map, 1, 0);
        const double h = number(&t, row, "h"), centre = number(&t, row, "r_centre"),
                     cosine = cosineTo(&t, row, inTexel(&t, row, 0.5, 0.5));
        assertNear(h / cosine / centre, 1, 2e-7 / cosine, "r_centre", row);
        assertNear(acos(h / centre), number(&t, row, "theta_centre"), 1e-12, "theta_centre", row);
        double farthest = 0, nearest = 1;
        for (int i = 0; i <= 16; i++) {
            for (int j = 0; j <= 16; j++) {
                const vplVec3 d = inTexel(&t, row, i / 16.0, j / 16.0);
                const double c = cosineTo(&t, row, d), r = h / c;
                nearest = fmin(nearest, c);
                if (c > 1e-4) {
                    assert_true((double)vplShadow_Bias(&shadow, (float)r, (float)c) >= r - centre);
                    farthest = fmax(farthest, r);
                    points++;
                }
            }
        }
        if (strcmp(cell(&t, row, "r_max_corner"), "inf") == 0) {
            assert_true(nearest < 1e-6 && isinf(number(&t, row, "bias_exact")));
            assert_true(isEmpty(&t, row, "bias_closed_A") && isEmpty(&t, row, "alpha_corner"));
            horizon++;
            continue;
        }
        const double r = number(&t, row, "r_max_corner"), closed = number(&t, row, "bias_closed_A"),
                     alpha = number(&t, row, "alpha_corner");
        assertNear(farthest / r, 1, 2e-7 * r / h, "r_max_corner", row);
        assertNear(r - centre, number(&t, row, "bias_exact"), 1e-12 * r, "bias_exact", row);
        assertNear(exactBias(r, acos(h / r), alpha), closed, 1e-12 * r, "bias_closed_A", row);
        assert_true(closed >= number(&t, row, "bias_exact") * (1 - 1e-12) &&
                    tan(alpha) <= (double)shadow.texelTangent * 1.0000001);
        // The largest angle of the map, and the texel's own.
        const double bias = (double)vplShadow_Bias(&shadow, (float)r, (float)(h / r));
        assertNear(bias - r * BIAS_ADDED, exactBias(r, acos(h / r), atan((double)shadow.texelTangent)),
                   r * BIAS_SLACK, "bias", row);
        shadow.texelTangent = (float)tan(alpha);
        assertNear((double)vplShadow_Bias(&shadow, (float)r, (float)(h / r)) - r * BIAS_ADDED, closed,
                   r * BIAS_SLACK, "bias of the texel", row);
        finite++;
    }
    assert_int_equal(finite, 312);
    assert_int_equal(horizon, 94);
    assert_true(points > 110000);
    freeTable(&t);
}

// X064
// bias_pair.csv: the least dynamic bias is enough up to the greatest angle, which binds.
TEST(PairsOfTheTableAreJustEnough, 1)
{
    Table t = loadTable("bias_pair.csv");
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    for (int row = 0; row < t.rows; row++) {
        enum { ANGLES = 4000 };
        const double alpha = number(&t, row, "alpha"), most = number(&t, row, "theta_max_deg") * VPL_PI / 180,
                     fixed = number(&t, row, "bs_over_r"), dynamic = number(&t, row, "bdmax_over_r_min"),
                     binding = number(&t, row, "binding_theta_deg") * VPL_PI / 180;
        assertNear(number(&t, row, "bs_over_r_in_units_of_alpha") * alpha, fixed, 1e-12, "b_s", row);
        assertNear(number(&t, row, "bdmax_over_r_in_alpha") * alpha, dynamic, 1e-12, "b_dmax", row);
        const vplShadow pair = pairShadow(&flat.map, (float)fixed, (float)dynamic);
        vplShadow exact = exactShadow(&flat.map, 1, 0);
        exact.texelTangent = (float)tan(alpha);
        for (int i = 1; i <= ANGLES; i++) {
            const float c = (float)cos(most * i / ANGLES);
            const double needed = (double)vplShadow_Bias(&exact, 1, c) - BIAS_ADDED;
            assert_true((double)vplShadow_Bias(&pair, 1, c) >= needed * (1 - 1e-5) - BIAS_SLACK);
        }
        const double given = (double)vplShadow_Bias(&pair, 1, (float)cos(most)),
                     atBinding = (double)vplShadow_Bias(&pair, 1, (float)cos(binding));
        assertNear(given, number(&t, row, "bias_over_r_at_theta_max"), 1e-7 * (fixed + dynamic),
                   "at the most", row);
        if (dynamic > 0) {
            assertNear(atBinding, exactBias(1, binding, alpha), 1e-5 * atBinding + 1e-7 * dynamic, "binding",
                       row);
        } else {
            assertNear(binding, 0, 0, "nothing binds", row);
        }
    }
    assert_int_equal(t.rows, 50);
    freeTable(&t);
}

// X063
// The automatic pair is b_s = alpha far and b_dmax = 5.6 b_s. Without end, finer maps need (tan t - 1) / (1 -
// cos t), which is 5.6 at 79.9 degrees.
TEST(AutomaticPairIsJustEnoughUpTo79Point9Degrees, 1)
{
    static const int sizes[] = {64, 512, 724, 1448, 8192};
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    for (int k = 0; k < 5; k++) {
        flat.map.size = sizes[k];
        const vplShadow pair = pairShadow(&flat.map, -1, -1), exact = exactShadow(&flat.map, 1, 0);
        assertNear((double)pair.def.biasStatic * sizes[k], 10 * sqrt(2), 1e-5, "b_s", sizes[k]);
        assertNear((double)(pair.def.biasDynamic / pair.def.biasStatic), 5.6, 1e-6, "b_dmax", sizes[k]);
        double least = INFINITY;
        for (int i = 1; i <= 4000; i++) {
            const float c = (float)cos(79.9 * VPL_PI / 180 * i / 4000);
            const double needed = (double)vplShadow_Bias(&exact, 10, c) - 10 * BIAS_ADDED;
            least = fmin(least, (double)vplShadow_Bias(&pair, 10, c) / needed);
        }
        assert_true(least >= 1 && (sizes[k] < 512 || least < 1.02));
    }
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
// edge: lengths are such that the edge then lies between two texels.
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
