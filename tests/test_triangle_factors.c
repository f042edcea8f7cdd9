// SPDX-License-Identifier: MIT
// Tests of form factors between two triangles: tests/data/ff_triangles.csv, ff_cube12.csv, ff_analytic.csv,
// ff_closure.csv, and properties of all pairs.
#include "factor_cases.h"

// X095
TEST_ALONE(FactorsOfPairsAreThoseOfTheTable)
{
    Table t = loadTable("ff_triangles.csv");
    for (int row = 0; row < t.rows; row++) {
        vplVec3 a[3], b[3];
        for (int i = 0; i < 3; i++) {
            a[i] = cornerOf(&t, row, "A", i);
            b[i] = cornerOf(&t, row, "B", i);
        }
        assertRelative(factorOfEitherSide(a, b), number(&t, row, "F_AB"), 1e-11, cell(&t, row, "pair"), row);
        assertRelative(vplTriangleFormFactor(b, a), number(&t, row, "F_BA"), 1e-11, cell(&t, row, "pair"),
                       row);
    }
    freeTable(&t);
}

TEST_ALONE(RowsOfACubeAreThoseOfTheTableAndSumToOne)
{
    Table t = loadTable("ff_cube12.csv");
    vplVec3 corners[12][3];
    for (int i = 0; i < 12; i++) {
        for (int k = 0; k < 3; k++) {
            corners[i][k] = cornerOf(&t, i, "v", k);
        }
        // The front is the side that faces the cube's centre.
        const vplVec3 *p = corners[i], m = {0.5f, 0.5f, 0.5f};
        const vplVec3 u = {p[1].x - p[0].x, p[1].y - p[0].y, p[1].z - p[0].z};
        const vplVec3 v = {p[2].x - p[0].x, p[2].y - p[0].y, p[2].z - p[0].z};
        const float height = (u.y * v.z - u.z * v.y) * (m.x - p[0].x) +
                             (u.z * v.x - u.x * v.z) * (m.y - p[0].y) +
                             (u.x * v.y - u.y * v.x) * (m.z - p[0].z);
        if (height < 0) {
            swapCorners(corners[i]);
        }
    }
    for (int i = 0; i < 12; i++) {
        double sum = 0;
        for (int k = 0; k < 12; k++) {
            char name[16];
            snprintf(name, sizeof name, "F_to_%d", k);
            const double f = vplTriangleFormFactor(corners[i], corners[k]);
            assertNear(f, number(&t, i, name), 1e-13, name, i);
            sum += f;
        }
        assertNear(sum, 1, 1e-13, "sum", i);
    }
    freeTable(&t);
}

// ---- rectangles, as two triangles each

// Returns the form factor from rectangle a to rectangle b, with corners in order.
static double factorOfRectangles(const vplVec3 a[4], const vplVec3 b[4])
{
    double sum = 0, all = 0;
    for (int i = 0; i < 2; i++) {
        const vplVec3 s[3] = {a[0], a[1 + i], a[2 + i]};
        const double ux = s[1].x - s[0].x, uy = s[1].y - s[0].y, uz = s[1].z - s[0].z;
        const double vx = s[2].x - s[0].x, vy = s[2].y - s[0].y, vz = s[2].z - s[0].z;
        const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
        const double area = 0.5 * sqrt(x * x + y * y + z * z);
        for (int k = 0; k < 2; k++) {
            sum += area * vplTriangleFormFactor(s, (const vplVec3[3]){b[0], b[1 + k], b[2 + k]});
        }
        all += area;
    }
    return sum / all;
}

static double factorOfParallel(float a, float b, float c)
{
    return factorOfRectangles((const vplVec3[4]){{0, 0, 0}, {a, 0, 0}, {a, b, 0}, {0, b, 0}},
                              (const vplVec3[4]){{0, 0, c}, {0, b, c}, {a, b, c}, {a, 0, c}});
}

// Returns the form factor from the floor, w x l, to the wall at its edge, l x h.
static double factorOfPerpendicular(float w, float l, float h)
{
    return factorOfRectangles((const vplVec3[4]){{0, 0, 0}, {w, 0, 0}, {w, l, 0}, {0, l, 0}},
                              (const vplVec3[4]){{0, 0, 0}, {0, l, 0}, {0, l, h}, {0, 0, h}});
}

// Lengths are rounded to float: 0.001 has a relative error of 5e-8. Lengths that float holds exactly agree to
// 1e-11.
TEST_ALONE(RectanglesAreThoseOfTheClosedForms)
{
    Table t = loadTable("ff_analytic.csv");
    int compared = 0;
    for (int row = 0; row < t.rows; row++) {
        const char *config = cell(&t, row, "config"), *parameters = cell(&t, row, "parameters");
        double v[3] = {1, 1, 1}, found;
        if (strcmp(config, "parallel_unit_squares") == 0) {
            assert_int_equal(sscanf(parameters, "d=%lf", &v[2]), 1);
            found = factorOfParallel(1, 1, (float)v[2]);
        } else if (strcmp(config, "parallel_rect") == 0) {
            assert_int_equal(sscanf(parameters, "a=%lf b=%lf c=%lf", &v[0], &v[1], &v[2]), 3);
            found = factorOfParallel((float)v[0], (float)v[1], (float)v[2]);
        } else if (strcmp(config, "perp_common_edge") == 0) {
            assert_int_equal(sscanf(parameters, "w=%lf l=%lf h=%lf", &v[0], &v[1], &v[2]), 3);
            found = factorOfPerpendicular((float)v[0], (float)v[1], (float)v[2]);
        } else {
            continue;
        }
        bool exact = true;
        for (int k = 0; k < 3; k++) {
            exact = exact && (double)(float)v[k] == v[k];
        }
        assertRelative(found, number(&t, row, "F12"), exact ? 1e-11 : 1e-7, parameters, row);
        compared++;
    }
    assert_int_equal(compared, 23);
    freeTable(&t);
}

// Both derivations of the table, to its 25 digits' difference of 3e-36.
TEST_ALONE(BothDerivationsOfTheCrossCheckAreMet)
{
    const double found[4] = {factorOfParallel(1, 1, 1), factorOfParallel(100, 100, 10),
                             factorOfPerpendicular(1, 1, 1), factorOfPerpendicular(2, 1, 3)};
    Table t = loadTable("ff_crosscheck.csv");
    for (int row = 0; row < t.rows; row++) {
        const char* config = cell(&t, row, "config");
        assertRelative(found[row], number(&t, row, "contour"), 1e-11, config, row);
        assertRelative(found[row], number(&t, row, "closed_form"), 1e-11, config, row);
        assertNear(number(&t, row, "contour") - number(&t, row, "closed_form"), number(&t, row, "difference"),
                   1e-16, config, row);
    }
    assert_int_equal(t.rows, 4);
    freeTable(&t);
}

TEST_ALONE(BoxesCloseAsTheTableSays)
{
    static const float sizes[5][3] = {{1, 1, 1}, {5, 5, 5}, {1, 2, 3}, {1, 1, 100}, {1, 100, 100}};
    Table t = loadTable("ff_closure.csv");
    for (int row = 0; row < t.rows; row++) {
        const float a = sizes[row][0], b = sizes[row][1], c = sizes[row][2];
        const double opposite = factorOfParallel(a, b, c), overB = factorOfPerpendicular(b, a, c),
                     overA = factorOfPerpendicular(a, b, c);
        assertRelative(opposite, number(&t, row, "F_opposite"), 1e-11, cell(&t, row, "box"), row);
        assertRelative(overB, number(&t, row, "F_adjacent_first"), 1e-11, cell(&t, row, "box"), row);
        assertNear(opposite + 2 * overA + 2 * overB, 1, 1e-12, cell(&t, row, "box"), row);
    }
    freeTable(&t);
}

// ---- any two triangles

TEST_ALONE(BothDirectionsExchangeTheSame)
{
    int seen = 0;
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 a[3], b[3];
        rollPair(seed, a, b);
        const double there = areaOf(a) * vplTriangleFormFactor(a, b),
                     back = areaOf(b) * vplTriangleFormFactor(b, a);
        assert_true((there > 0) == (back > 0));
        if (there > 1e-8 * areaOf(a)) {
            assertRelative(there, back, 1e-8, "exchange", (int)seed); // measured: 1.7e-9
            seen++;
        }
    }
    assert_true(seen > MOST_CASES / 2);
}

// Halves are smaller than the whole, so that other formulas and other clipping apply to them: the results
// must agree.
TEST_ALONE(HalvesSumToTheWhole)
{
    int seen = 0;
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 a[3], b[3];
        rollPair(seed, a, b);
        // Corners are multiples of 2^-14, so that the midpoint is exact.
        for (int i = 0; i < 3; i++) {
            b[i] = (vplVec3){rintf(b[i].x * 0x1p14f) * 0x1p-14f, rintf(b[i].y * 0x1p14f) * 0x1p-14f,
                             rintf(b[i].z * 0x1p14f) * 0x1p-14f};
        }
        const vplVec3 m = {0.5f * (b[0].x + b[1].x), 0.5f * (b[0].y + b[1].y), 0.5f * (b[0].z + b[1].z)};
        const double whole = vplTriangleFormFactor(a, b);
        const double first = vplTriangleFormFactor(a, (const vplVec3[3]){b[0], m, b[2]}),
                     second = vplTriangleFormFactor(a, (const vplVec3[3]){m, b[1], b[2]});
        if (whole > 1e-6) {
            assertRelative(first + second, whole, 2e-8, "halves", (int)seed); // measured: 1.1e-8 of 33000
            seen++;
        }
    }
    assert_true(seen > MOST_CASES / 2);
}

// Triangles scaled over all magnitudes of float have the same form factor, and it is finite.
TEST_ALONE(FactorsDoNotDependOnTheUnit)
{
    for (uint64_t seed = 0; seed < 100; seed++) {
        vplVec3 a[3], b[3];
        rollPair(seed, a, b);
        const double wanted = vplTriangleFormFactor(a, b);
        for (int power = -100; power <= 100; power += 20) {
            vplVec3 c[2][3];
            for (int i = 0; i < 3; i++) {
                c[0][i] = (vplVec3){ldexpf(a[i].x, power), ldexpf(a[i].y, power), ldexpf(a[i].z, power)};
                c[1][i] = (vplVec3){ldexpf(b[i].x, power), ldexpf(b[i].y, power), ldexpf(b[i].z, power)};
            }
            assertNear(vplTriangleFormFactor(c[0], c[1]), wanted, 1e-12 * wanted, "scaled", (int)seed);
        }
    }
}

// X093, X095: coplanar, touching, coincident and degenerate triangles give finite factors.
TEST_ALONE(PlanesTouchesAndDuplicatesAreNumbers)
{
    const vplVec3 floor[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, over[3] = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}};
    const vplVec3 beside[3] = {{1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, point[3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    const vplVec3 line[3] = {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}},
                  crossing[3] = {{0, 0, -1}, {0, 1, 1}, {1, 0, 1}};
    assert_true(vplTriangleFormFactor(floor, floor) == 0);
    assert_true(vplTriangleFormFactor(floor, over) == 0);
    assert_true(vplTriangleFormFactor(floor, beside) == 0);
    assert_true(vplTriangleFormFactor(floor, point) == 0);
    assert_true(vplTriangleFormFactor(point, floor) == 0);
    assert_true(vplTriangleFormFactor(floor, line) == 0);
    const double f = vplTriangleFormFactor(floor, crossing), g = vplTriangleFormFactor(crossing, floor);
    assert_true(f >= 0 && f <= 1 && g >= 0 && g <= 1 && f + g > 0);
}

// Two triangles share an edge at a varying angle: the factor falls from 1, folded onto each other, to 0,
// coplanar.
TEST_ALONE(FoldedPairsFallFromOneToZero)
{
    double last = 1;
    for (int degrees = 1; degrees < 180; degrees++) {
        double sine, cosine;
        sine = sin(degrees * 3.14159265358979 / 180);
        cosine = cos(degrees * 3.14159265358979 / 180);
        const vplVec3 a[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        const vplVec3 b[3] = {{0, 0, 0}, {0, (float)cosine, (float)sine}, {1, 0, 0}};
        const double f = vplTriangleFormFactor(a, b);
        assert_true(f > 0 && f < last);
        assertNear(f, vplTriangleFormFactor(b, a), 1e-7, "degrees", degrees);
        last = f;
    }
    assert_true(last < 1e-4);
}
