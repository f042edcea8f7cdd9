// SPDX-License-Identifier: MIT
// Tests of the light kernel against vpl_kernel.csv and vpl_clamp_plane.csv. Covers extremes X085 to X090.
#include "kernel_points.h"

#include "math/vec.h"

#include <float.h>
#include <stdlib.h>

// A row of vpl_kernel.csv: a point x, a light y, and their unit normals.
typedef struct Pair {
    vplVec3 x, nx, y, ny;
} Pair;

static Pair pairOf(const Table* t, int row)
{
    return (Pair){vectorOf(t, row, "x_"), vplNormalize(vectorOf(t, row, "nx_")), vectorOf(t, row, "y_"),
                  vplNormalize(vectorOf(t, row, "ny_"))};
}

// The same pair at 2^exponent times the distance from the origin: cosines stay as they are.
static Pair scaled(Pair p, int exponent)
{
    const float s = ldexpf(1, exponent);
    return (Pair){vplScale(s, p.x), p.nx, vplScale(s, p.y), p.ny};
}

static double documented(const vplContext* context, vplVec3 x, vplVec3 nx, vplVec3 y)
{
    const vplShadeLight light = lightAt(y, vplVec(0, 1, 0), 1);
    return irradianceAt(context, (vplLightFormula){VPL_LIGHTING_DOCUMENTED, 0}, x, nx, &light, 1);
}

static double physical(const vplContext* context, Pair p, double minDistance)
{
    const vplShadeLight light = lightAt(p.y, p.ny, 1);
    return irradianceAt(context, (vplLightFormula){VPL_LIGHTING_PHYSICAL, (float)minDistance}, p.x, p.nx,
                        &light, 1);
}

// The sum of the magnitudes of the products in n.l, for the unit vector l between two points: 1 at most, and hardly more
// than the cosine where one product is all of it, as at grazing angles over an axis-aligned surface.
static double productsOf(vplVec3 n, vplVec3 from, vplVec3 to)
{
    const double x = (double)to.x - (double)from.x, y = (double)to.y - (double)from.y,
                 z = (double)to.z - (double)from.z;
    const double sum = fabs((double)n.x * x) + fabs((double)n.y * y) + fabs((double)n.z * z),
                 r2 = x * x + y * y + z * z;
    return r2 > 0 ? sum / sqrt(r2) : 0;
}

// The error of a cosine as a share of its products, and that of the factor 1/r^2. Up to 14 roundings take part: 4 in the
// normal, 1 in the way, 1 in the product, 2 in the sum, 6 in the length. Independent ones add up to sqrt(14) units.
#define ROUNDING (4 * 0x1p-24)

// Compares the cosine at one end, whichever its sign: the surface's back sees the opposite of what its front sees, and one
// of both sees nothing.
static void compareCosine(const vplContext* context, const Table* t, int row, const char* column, vplVec3 at,
                          vplVec3 n, vplVec3 to)
{
    const double front = documented(context, at, n, to), back = documented(context, at, vplNegate(n), to);
    const double wanted =
        isEmpty(t, row, column) ? 0 : number(t, row, column); // empty: no direction, so no light
    assert_true(front == 0 || back == 0);
    assertNear(front - back, wanted, ROUNDING * productsOf(n, at, to), column, row);
}

// Compares all that has no clamp, where float can hold r^2 / 4^exponent; what falls behind a surface is exactly 0.
static void compareOpen(const vplContext* context, const Table* t, int row, int exponent)
{
    const Pair own = pairOf(t, row), p = scaled(own, exponent);
    compareCosine(context, t, row, "cos_x", p.x, p.nx, p.y);
    compareCosine(context, t, row, "cos_y", p.y, p.ny, p.x);
    const double kernel = number(t, row, "documented_kernel"), g = number(t, row, "G"),
                 r2 = number(t, row, "r2");
    const double sx = productsOf(p.nx, p.x, p.y), sy = productsOf(p.ny, p.y, p.x);
    assertNear(documented(context, p.x, p.nx, p.y), kernel, kernel > 0 ? ROUNDING * sx : 0, "documented",
               row);
    if (g == 0) {
        assertNear(physical(context, p, 0), 0, 0, "G", row);
        assertNear(physical(context, p, sqrt(number(t, row, "c"))), number(t, row, "G_clamped_r2"), 0,
                   "G_clamped_r2", row);
        return;
    }
    const double cx = number(t, row, "cos_x"), cy = number(t, row, "cos_y");
    const double slack = ROUNDING * (sx * cy + sy * cx + cx * cy);
    assertNear(physical(context, p, 0) * ldexp(1, 2 * exponent), g, slack / r2, "G", row);
    if (exponent == 0) {
        const double c = number(t, row, "c");
        assertNear(physical(context, p, sqrt(c)), number(t, row, "G_clamped_r2"), slack / fmax(r2, c),
                   "G_clamped_r2", row);
    }
}

// X085
// Of the 84 rows, 64 have a light behind the surface or a surface behind the light, and one has both in one place: their
// kernel is exactly 0. Two are 1e-25 and 1e20 apart, where float cannot hold r^2: all but the clamp is compared for the
// same points at 2^83 and 2^-66 of the distance, and as they are the kernel must be between 0 and the clamped value (X087,
// X088). G_clamped_Gmax is the table's minimum of its own columns: a rule that the library does not offer, because it
// bounds r^2.
TEST(EveryKernelValueOfTheTable, 1)
{
    Table t = loadTable("vpl_kernel.csv");
    int inside = 0, outside = 0, behind = 0;
    for (int row = 0; row < t.rows; row++) {
        const Pair p = pairOf(&t, row);
        const double r2 = number(&t, row, "r2"), g = number(&t, row, "G"), c = number(&t, row, "c");
        const double dx = (double)p.y.x - (double)p.x.x, dy = (double)p.y.y - (double)p.x.y,
                     dz = (double)p.y.z - (double)p.x.z;
        assertNear(dx * dx + dy * dy + dz * dz, r2, 1e-12 * r2, "r2", row);
        assertNear(fmin(g, number(&t, row, "Gmax")), number(&t, row, "G_clamped_Gmax"), 1e-12 * g, "Gmax",
                   row);
        behind += g == 0;
        if (r2 == 0 || (r2 >= (double)FLT_MIN && r2 <= (double)FLT_MAX)) {
            compareOpen(context, &t, row, 0);
            inside++;
            continue;
        }
        compareOpen(context, &t, row, r2 < 1 ? 83 : -66);
        const double bounded = physical(context, p, sqrt(c));
        assert_true(bounded >= 0 && bounded <= number(&t, row, "G_clamped_r2") * (1 + ROUNDING));
        assert_true(isfinite(documented(context, p.x, p.nx, p.y)));
        outside++;
    }
    assert_int_equal(inside, 82);
    assert_int_equal(outside, 2);
    assert_int_equal(behind, 64 + 1);
    freeTable(&t);
}

// X087, X088: without a clamp, wherever d^2 is a float.
TEST(LightFallsWithTheSquareOfAnyDistance, 1)
{
    for (int exponent = -18; exponent <= 18; exponent++) {
        const float d = powf(10, (float)exponent);
        const vplShadeLight light = lightAt(vplVec(0, d, 0), vplVec(0, -1, 0), 1);
        const double e = irradianceAt(context, (vplLightFormula){VPL_LIGHTING_PHYSICAL, 0}, vplVec(0, 0, 0),
                                      vplVec(0, 1, 0), &light, 1);
        assertNear(e * (double)d * (double)d, 1, 1e-6, "irradiance", exponent);
    }
}

// X089: a plane of uniform radiance L seen from height h: E / (pi L) with r^2 -> max(r^2, c), integrated over
// 20,000 rings.
TEST(ClampLosesOnAPlaneWhatTheTableSays, 1)
{
    Table t = loadTable("vpl_clamp_plane.csv");
    enum { RINGS = 20000 };
    vplShadeLight* rings = malloc(RINGS * sizeof *rings);
    for (int row = 0; row < t.rows; row++) {
        double h = number(&t, row, "h"), c = number(&t, row, "c"), sum = 0;
        // The rings go from 1e-3 to 1e3 times the larger of h and sqrt(c), evenly in the logarithm, with a
        // disc inside.
        double unit = fmax(h, sqrt(c)), inner = 1e-3 * fmin(h, sqrt(c)),
               ratio = pow(1e3 * unit / inner, 1.0 / RINGS);
        double r = inner;
        for (int i = 0; i < RINGS; i++) {
            double next = r * ratio, middle = sqrt(0.5 * (r * r + next * next));
            double area = VPL_PI * (next * next - r * r);
            rings[i] = lightAt(vplVec((float)middle, 0, 0), vplVec(0, 1, 0), (float)area); // L = 1
            r = next;
        }
        for (int i = 0; i < RINGS; i += VPL_LIGHT_GROUP) {
            int count = RINGS - i < VPL_LIGHT_GROUP ? RINGS - i : VPL_LIGHT_GROUP;
            sum += irradianceAt(context, (vplLightFormula){VPL_LIGHTING_PHYSICAL, (float)sqrt(c)},
                                vplVec(0, (float)h, 0), vplVec(0, -1, 0), rings + i, count);
        }
        // The rings end at 1000 units and miss at most (h / (1000 unit))^2.
        assertNear(sum / VPL_PI, number(&t, row, "fraction_kept_r2clamp"), 2e-4, "fraction kept", row);
    }
    free(rings);
    freeTable(&t);
}
