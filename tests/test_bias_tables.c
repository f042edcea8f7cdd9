// SPDX-License-Identifier: MIT
// Tests of shadow bias against tables of exact answers, in double by vplFormula_PlaneBias and in float by the kernel that
// renders. Covers extremes X063, X064 and X067.
#include "shadow_maps.h"

#include <vpl/formulas.h>

#define UNIT 0x1p-24 // of float's rounding

// The kernel adds so much of the distance, for what distances are rounded by.
#define BIAS_ADDED 0x1p-20

// Half the distance of floats at v: what rounding a result costs.
static double rounding(double v)
{
    return ldexp(UNIT, ilogb(v));
}

// What float costs the kernel's bias of a plane at cosine c, 0 < c < 1, whose samples are off by the angle a, as a share of
// the distance. The bias is 1 - q, q = cos t / cos(t - a), and q is near 1 where the bias is small. The steps are
//   tan a and c, which are rounded when they are given: c turns t by UNIT c / sin t;
//   cos a = 1 / sqrtf(1 + tan^2 a): 2 UNIT; sin a = tan a cos a: 3 UNIT of itself;
//   sin t = sqrtf(1 - c c): the rounding of c c counts 1 / (2 sin t) times;
//   cos(t - a) = c cos a + sin t sin a, and the quotient: a rounding each.
// So cancellation costs up to 4 UNIT = 2.4e-7 of the distance, which is 3 % of the bias at 1 degree for a = 1/2048, and a
// third of the smallest bias of bias_texel.csv. BIAS_ADDED is four times as much. Where a exceeds t, q is c itself.
static double kernelError(double c, double a)
{
    const double t = acos(c), s = sin(t), turned = cos(fmax(t - a, 0)), q = c / turned;
    const double ending = 2 * rounding(1 - q + BIAS_ADDED);
    if (t <= a) {
        return rounding(c) + ending;
    }
    const double given = UNIT * sin(a) * (c * c / (s * turned * turned) + q * tan(t - a));
    const double sine = (rounding(c * c) + rounding(s * s)) / (2 * s) + rounding(s);
    const double sum =
        2 * UNIT * c + rounding(c * cos(a)) + sin(a) * (sine + 3 * UNIT * s) + rounding(s * sin(a));
    return given + q * (sum + rounding(turned)) / turned + rounding(q) + ending;
}

// Compares the kernel's bias, at distance r, with the exact one.
static void compareKernel(const vplShadow* shadow, double r, double cosine, double wanted, const char* what,
                          int row)
{
    const double error = kernelError(cosine, atan((double)shadow->texelTangent));
    const double bias =
        (double)vplShadow_Bias(shadow, (float)r, (float)cosine) / (double)(float)r - BIAS_ADDED;
    assert_true(error < 3e-7);
    assertNear(bias, wanted / r, error, what, row);
}

// X063
// At 0 degrees the table's bias is negative, and ours exactly 0: the next sample is no nearer.
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
        if (wanted < 0) {
            assertNear((double)vplShadow_Bias(&shadow, 3, (float)cosine), 3 * BIAS_ADDED, 0, "facing", row);
            assert_true(theta == 0 && isEmpty(&t, row, "needed_bdmax_over_r_if_bs0"));
            assert_true(isEmpty(&t, row, "same_first_order"));
            facing++;
            continue;
        }
        compareKernel(&shadow, 3, cosine, 3 * wanted, "bias", row);
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

// Eight roundings of double: a length, a scalar product, which cancels at slanted planes, and quotients.
#define ROUNDINGS (8 * 0x1p-53)

// A direction from the light, of any length.
typedef struct Way {
    double x, y, z;
} Way;

// The way to a point of the texel of a row of bias_texel.csv: (x, y) in [0, 1]^2 from its upper left corner. The library's
// frames have ones and zeros, and texels are powers of two, so that no digit is lost.
static Way inTexel(const Table* t, int row, double x, double y)
{
    static const char* const faces[6] = {"+x", "-x", "+y", "-y", "+z", "-z"};
    int face = 0;
    while (strcmp(faces[face], cell(t, row, "face")) != 0) {
        face++;
    }
    const vplCubeFrame f = vplCube_GetFrame(face);
    const double size = number(t, row, "R"), u = 2 * (number(t, row, "i") + x) / size - 1,
                 v = 1 - 2 * (number(t, row, "j") + y) / size;
    return (Way){(double)f.forward.x + u * (double)f.right.x + v * (double)f.up.x,
                 (double)f.forward.y + u * (double)f.right.y + v * (double)f.up.y,
                 (double)f.forward.z + u * (double)f.right.z + v * (double)f.up.z};
}

static double lengthOf(Way d)
{
    return sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
}

static double angleBetween(Way a, Way b)
{
    const Way cross = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return atan2(lengthOf(cross), a.x * b.x + a.y * b.y + a.z * b.z);
}

// The way against the plane's normal.
static Way downOf(const Table* t, int row)
{
    return (Way){-number(t, row, "nx"), -number(t, row, "ny"), -number(t, row, "nz")};
}

// The cosine between a way and the plane's normal.
static double cosineTo(const Table* t, int row, Way d)
{
    const Way n = downOf(t, row);
    return (n.x * d.x + n.y * d.y + n.z * d.z) / lengthOf(d);
}

// The largest distance of the plane at the texel's corners, and the corner; infinite if one looks past the plane.
static double farthestCorner(const Table* t, int row, Way* cornerOut)
{
    double farthest = 0;
    for (int k = 0; k < 4; k++) {
        const Way d = inTexel(t, row, k % 2, k / 2);
        const double c = cosineTo(t, row, d), r = c > 1e-15 ? number(t, row, "h") / c : INFINITY;
        *cornerOut = r > farthest ? d : *cornerOut;
        farthest = fmax(farthest, r);
    }
    return farthest;
}

// The automatic bias is enough everywhere this side of the horizon. Returns how many points that are.
static int checkThatEnough(const vplShadow* shadow, const Table* t, int row)
{
    const double h = number(t, row, "h"), centre = number(t, row, "r_centre");
    int points = 0;
    for (int i = 0; i < 17 * 17; i++) {
        const double c = cosineTo(t, row, inTexel(t, row, i % 17 / 16.0, i / 17 / 16.0)), r = h / c;
        if (c > 1e-4) {
            assert_true((double)vplShadow_Bias(shadow, (float)r, (float)c) >= r - centre);
            points++;
        }
    }
    return points;
}

// bias_texel.csv compares a fragment at the worst corner of a texel with the distance at the texel's centre.
// The library's texels and formula must give the table's numbers to roundings of double, and the kernel's bias be theirs and
// enough everywhere in the texel for the largest angle of the map. Where a corner lies beyond the plane's horizon (X067) no
// finite bias is enough for it, but for all points of the texel this side of it.
TEST(ExactBiasIsThatOfEveryTexelOfTheTableAndEnough, 1)
{
    Table t = loadTable("bias_texel.csv");
    FlatMap flat;
    makeFlatMap(&flat, context, (vplVec3){0, 0, 0}, 10, 0.5f);
    int finite = 0, horizon = 0, points = 0;
    for (int row = 0; row < t.rows; row++) {
        flat.map.size = (int)number(&t, row, "R");
        vplShadow shadow = exactShadow(&flat.map, 1, 0);
        const Way centre = inTexel(&t, row, 0.5, 0.5);
        const double h = number(&t, row, "h"), cosine = cosineTo(&t, row, centre);
        assertNear(h / cosine / number(&t, row, "r_centre"), 1, ROUNDINGS / cosine, "r_centre", row);
        assertNear(angleBetween(centre, downOf(&t, row)), number(&t, row, "theta_centre"), 1e-15,
                   "theta_centre", row);
        points += checkThatEnough(&shadow, &t, row);
        Way corner = centre;
        const double r = farthestCorner(&t, row, &corner);
        if (isinf(r)) {
            assert_true(isinf(number(&t, row, "r_max_corner")) && isinf(number(&t, row, "bias_exact")));
            assert_true(isEmpty(&t, row, "bias_closed_A") && isEmpty(&t, row, "alpha_corner"));
            horizon++;
            continue;
        }
        const double alpha = angleBetween(centre, corner), theta = angleBetween(corner, downOf(&t, row)),
                     exact = r - h / cosine, closed = number(&t, row, "bias_closed_A");
        assertNear(r / number(&t, row, "r_max_corner"), 1, ROUNDINGS * r / h, "r_max_corner", row);
        assertNear(exact, number(&t, row, "bias_exact"), 2 * ROUNDINGS * r * r / h, "bias_exact", row);
        assertNear(alpha, number(&t, row, "alpha_corner"), ROUNDINGS, "alpha_corner", row);
        assertNear(vplFormula_PlaneBias(r, theta, alpha), closed, 2 * ROUNDINGS * r * r / h, "bias_closed_A",
                   row);
        assert_true(closed >= number(&t, row, "bias_exact") * (1 - 1e-12));
        assert_true(tan(alpha) <= (double)shadow.texelTangent * 1.0000001);
        // The largest angle of the map, and the texel's own.
        const double widest = atan((double)shadow.texelTangent);
        compareKernel(&shadow, r, h / r, vplFormula_PlaneBias(r, theta, widest), "bias", row);
        shadow.texelTangent = (float)tan(alpha);
        compareKernel(&shadow, r, h / r, closed, "bias of the texel", row);
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
            assert_true((double)vplShadow_Bias(&pair, 1, c) >=
                        needed * (1 - 1e-5) - kernelError((double)c, alpha));
        }
        const double given = (double)vplShadow_Bias(&pair, 1, (float)cos(most)),
                     atBinding = (double)vplShadow_Bias(&pair, 1, (float)cos(binding));
        assertNear(given, number(&t, row, "bias_over_r_at_theta_max"), 1e-7 * (fixed + dynamic),
                   "at the most", row);
        if (dynamic > 0) {
            assertNear(atBinding, vplFormula_PlaneBias(1, binding, alpha), 1e-5 * atBinding + 1e-7 * dynamic,
                       "binding", row);
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
