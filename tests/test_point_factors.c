// SPDX-License-Identifier: MIT
// Tests of form factors from a point to a triangle: closed forms, and properties of all pairs.
#include "factor_cases.h"

#include "base/context.h"
#include "radiosity/radiosity_kernels.h"

// ---- a point and a triangle

// Returns the form factor from a point to a convex polygon, whose corners are in order, as a fan of
// triangles.
static double pointFactorOfFan(vplVec3 point, vplVec3 normal, const vplVec3* corners, int count)
{
    double sum = 0;
    for (int i = 2; i < count; i++) {
        sum += vplPointFormFactor(point, normal, (const vplVec3[3]){corners[0], corners[i - 1], corners[i]});
    }
    return sum;
}

// Returns the form factor from a point to a rectangle a x b at height c, with a corner above the point.
static double pointFactorOfCorner(vplVec3 normal, const float v[3])
{
    const float a = v[0], b = v[1], c = v[2];
    return pointFactorOfFan((vplVec3){0, 0, 0}, normal,
                            (const vplVec3[4]){{0, 0, c}, {0, b, c}, {a, b, c}, {a, 0, c}}, 4);
}

// Lengths are rounded to float: 0.001 has a relative error of 5e-8, and so do the smallest factors. In
// millimetres all lengths are exact, and the measured error is 4e-16.
TEST_ALONE(CornersOfRectanglesAreThoseOfTheClosedForms)
{
    Table t = loadTable("ff_analytic.csv");
    int compared = 0;
    for (int row = 0; row < t.rows; row++) {
        const char *config = cell(&t, row, "config"), *parameters = cell(&t, row, "parameters");
        const bool perpendicular = strcmp(config, "dA_rect_perp_corner") == 0;
        if (!perpendicular && strcmp(config, "dA_rect_parallel_corner") != 0) {
            continue;
        }
        double v[3];
        assert_int_equal(sscanf(parameters, "a=%lf b=%lf c=%lf", &v[0], &v[1], &v[2]), 3);
        const vplVec3 normal = perpendicular ? (vplVec3){1, 0, 0} : (vplVec3){0, 0, 1};
        const double wanted = number(&t, row, "F12");
        bool exact = true;
        float metres[3], millimetres[3];
        for (int k = 0; k < 3; k++) {
            metres[k] = (float)v[k];
            millimetres[k] = (float)(1000 * v[k]);
            exact = exact && (double)metres[k] == v[k];
            assert_true(fabs((double)millimetres[k] - 1000 * v[k]) < 1e-12);
        }
        assertRelative(pointFactorOfCorner(normal, metres), wanted, exact ? 1e-14 : 1e-7, parameters, row);
        assertRelative(pointFactorOfCorner(normal, millimetres), wanted, 1e-14, parameters, row);
        compared++;
    }
    assert_int_equal(compared, 9);
    freeTable(&t);
}

// Returns the form factor from a point to a regular polygon of `count` corners, centred at height h above the
// point.
static double pointFactorOfRing(double radius, float h, int count)
{
    const vplVec3 point = {0, 0, 0}, up = {0, 0, 1};
    double sum = 0;
    vplVec3 last = {(float)radius, 0, h};
    for (int i = 1; i <= count; i++) {
        const double angle = 2 * 3.14159265358979323846 * (i % count) / count;
        const vplVec3 next = {(float)(radius * cos(angle)), (float)(radius * sin(angle)), h};
        sum += vplPointFormFactor(point, up, (const vplVec3[3]){{0, 0, h}, next, last});
        last = next;
    }
    return sum;
}

// A disk lies between its inscribed and circumscribed polygons. Both are scaled by 2^-22, which is more than
// the rounding of corners. A polygon of the same area has the same factor up to (pi / count)^4 and the
// corners' mean rounding: the measured error is 8e-10.
TEST_ALONE(DisksAreThoseOfTheClosedForm)
{
    enum { CORNERS = 4096 };
    const double part = 3.14159265358979323846 / CORNERS;
    Table t = loadTable("ff_analytic.csv");
    int compared = 0;
    for (int row = 0; row < t.rows; row++) {
        if (strcmp(cell(&t, row, "config"), "dA_disk_coaxial_parallel") != 0) {
            continue;
        }
        const char* parameters = cell(&t, row, "parameters");
        double r, h;
        assert_int_equal(sscanf(parameters, "r=%lf h=%lf", &r, &h), 2);
        if ((double)(float)h != h) { // the height is exact in millimetres
            r *= 1000;
            h *= 1000;
        }
        const double wanted = number(&t, row, "F12");
        const double inside = pointFactorOfRing(r * (1 - 0x1p-22), (float)h, CORNERS),
                     around = pointFactorOfRing(r * (1 + 0x1p-22) / cos(part), (float)h, CORNERS),
                     same = pointFactorOfRing(r * sqrt(2 * part / sin(2 * part)), (float)h, CORNERS);
        assert_true(inside < wanted && wanted < around);
        assertRelative(around, inside, 2e-6, parameters, row);
        assertRelative(same, wanted, 3e-9, parameters, row);
        compared++;
    }
    assert_int_equal(compared, 4);
    freeTable(&t);
}

// Returns the form factor from a disk to a coaxial disk: that of points at distance x from the axis, which
// see a polygon of the disk's area, averaged by 6-point Gauss-Legendre over parts of the radius that shrink
// towards the other disk's edge.
static double factorOfDisks(double r1, double r2, double h)
{
    static const double nodes[3] = {0.238619186083196909, 0.661209386466264514, 0.932469514203152028},
                        weights[3] = {0.467913934572691047, 0.360761573048138608, 0.171324492379170345};
    enum { CORNERS = 720 };
    const double part = 3.14159265358979323846 / CORNERS, radius = r2 * sqrt(2 * part / sin(2 * part));
    const double edge = r2 < r1 ? r2 : r1;
    double ends[64], sum = 0;
    int count = 0;
    for (int k = 0; k < 20; k++) { // up to the edge, then away from it
        ends[count++] = edge * (1 - pow(0.5, k));
    }
    ends[count++] = edge;
    for (int k = 19; k >= 0 && r1 > edge; k--) {
        ends[count++] = edge + (r1 - edge) * pow(0.5, k);
    }
    for (int i = 0; i + 1 < count; i++) {
        const double half = 0.5 * (ends[i + 1] - ends[i]), middle = ends[i] + half;
        for (int k = 0; k < 6; k++) {
            const double x = middle + half * (k < 3 ? -nodes[k] : nodes[k - 3]), w = half * weights[k % 3];
            const vplVec3 point = {(float)x, 0, 0}, top = {0, 0, (float)h};
            vplVec3 last = {(float)radius, 0, (float)h};
            double factor = 0;
            for (int c = 1; c <= CORNERS; c++) {
                const double angle = 2 * part * (c % CORNERS);
                const vplVec3 next = {(float)(radius * cos(angle)), (float)(radius * sin(angle)), (float)h};
                factor += vplPointFormFactor(point, (vplVec3){0, 0, 1}, (const vplVec3[3]){top, next, last});
                last = next;
            }
            sum += w * factor * 2 * x / (r1 * r1);
        }
    }
    return sum;
}

TEST_ALONE(CoaxialDisksAreThoseOfTheClosedForm)
{
    Table t = loadTable("ff_analytic.csv");
    int compared = 0;
    for (int row = 0; row < t.rows; row++) {
        const char* parameters = cell(&t, row, "parameters");
        double r1, r2, h;
        if (strcmp(cell(&t, row, "config"), "coaxial_disks") == 0) {
            assert_int_equal(sscanf(parameters, "r1=%lf r2=%lf h=%lf", &r1, &r2, &h), 3);
            assertRelative(factorOfDisks(r1, r2, h), number(&t, row, "F12"), 1e-6, parameters, row);
            compared++;
        }
    }
    assert_int_equal(compared, 5); // with 23 rectangles, 9 corners and 4 disks, all 41 rows of the table
    assert_int_equal(t.rows, 23 + 9 + 4 + 5);
    freeTable(&t);
}

// cos cos / (pi r^2) between the centres of parallel unit squares.
TEST(OneSampleBetweenCentresIsThatOfTheTable, 1)
{
    Table t = loadTable("ff_analytic.csv");
    const vplRadiosityKernels* kernels = vplGetRadiosityKernels(context->isa);
    int compared = 0;
    for (int row = 0; row < t.rows; row++) {
        double d;
        if (isEmpty(&t, row, "one_sample_centre_estimate")) {
            continue;
        }
        assert_int_equal(sscanf(cell(&t, row, "parameters"), "d=%lf", &d), 1);
        vplLinkPoints p = {.normal[2][0] = 1}, q = {.at[2][0] = (float)d, .normal[2][0] = -1};
        vplLinkTerms terms;
        kernels->linkTerms(&p, &q, &terms);
        const double wanted = number(&t, row, "one_sample_centre_estimate");
        assertRelative((double)terms.of[0][0], wanted, 4e-7, cell(&t, row, "parameters"), row);
        compared++;
    }
    assert_int_equal(compared, 13);
    freeTable(&t);
}

static vplVec3 rollNormal(uint64_t seed)
{
    Dice dice = {seed + 1000, 0};
    return rollUnit(&dice);
}

static double heightAbove(vplVec3 point, vplVec3 normal, vplVec3 p)
{
    return ((double)p.x - point.x) * normal.x + ((double)p.y - point.y) * normal.y +
           ((double)p.z - point.z) * normal.z;
}

// The point sees one of a triangle's two windings, and neither if the triangle is below its horizon.
TEST_ALONE(PointsSeeOneSideAndNothingBehindThem)
{
    int seen = 0, behind = 0;
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 a[3], b[3];
        rollPair(seed, a, b);
        const vplVec3 point = a[0], normal = rollNormal(seed);
        double highest = -INFINITY;
        for (int i = 0; i < 3; i++) {
            highest = fmax(highest, heightAbove(point, normal, b[i]));
        }
        const double one = vplPointFormFactor(point, normal, b);
        swapCorners(b);
        const double other = vplPointFormFactor(point, normal, b);
        assert_true(one >= 0 && one <= 1 && other >= 0 && other <= 1);
        if (highest > 1e-3) {
            assert_true((one > 0) != (other > 0));
            seen++;
        } else if (highest < -1e-3) {
            assert_true(one == 0 && other == 0);
            behind++;
        }
    }
    assert_true(seen > MOST_CASES / 2 && behind > MOST_CASES / 10);
}

// A closed box is all that the element sees, in any direction: clipping triangles at its horizon must lose
// nothing and count nothing twice.
TEST_ALONE(BoxesAroundAPointSumToOne)
{
    // Corner i of the box has the upper x, y, z if bits 0, 1, 2 of i are set; faces are counter-clockwise
    // seen from inside.
    static const int faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                    {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    static const float sizes[4][3] = {{1, 1, 1}, {1, 2, 3}, {1, 1, 1000}, {1000, 1, 1000}};
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        const float* size = sizes[seed % 4];
        const vplVec3 normal = rollNormal(seed);
        vplVec3 point = {size[0] * (float)uniformAt(seed, 0), size[1] * (float)uniformAt(seed, 1),
                         size[2] * (float)uniformAt(seed, 2)};
        vplVec3 ahead = normal;
        if (seed % 3 == 1) { // as near to the floor as the table's points
            point.z = 0.001f;
        } else if (seed % 3 == 2) { // the element lies in the floor
            point.z = 0;
            ahead = (vplVec3){0, 0, 1};
        }
        double sum = 0;
        for (int face = 0; face < 6; face++) {
            vplVec3 corners[4];
            for (int k = 0; k < 4; k++) {
                const int i = faces[face][k];
                corners[k] = (vplVec3){i & 1 ? size[0] : 0, i & 2 ? size[1] : 0, i & 4 ? size[2] : 0};
            }
            sum += pointFactorOfFan(point, ahead, corners, 4);
        }
        assertNear(sum, 1, 1e-13, "box", (int)seed);
    }
}

// The visible part of a triangle ends at the horizon: the length of its edges below the horizon does not
// matter.
TEST_ALONE(WhatIsBelowTheHorizonChangesNothing)
{
    const vplVec3 point = {0, 0, 0}, up = {0, 0, 1}, left = {-0.25f, 1, -1.5f}, right = {-0.5f, -1, -2};
    for (uint64_t seed = 0; seed < 500; seed++) {
        // Coordinates are multiples of 2^-10, so that the longer edges are exact.
        const vplVec3 top = {0.5f + rintf((float)uniformAt(seed, 0) * 0x1p10f) * 0x1p-10f,
                             rintf((float)uniformAt(seed, 1) * 0x1p10f) * 0x1p-10f,
                             rintf((float)uniformAt(seed, 2) * 0x1p10f) * 0x1p-10f + 0x1p-10f};
        vplVec3 triangles[2][3];
        for (int i = 0; i < 2; i++) {
            const float l = i == 0 ? 1 : 3, r = i == 0 ? 1 : 5;
            triangles[i][0] = top;
            triangles[i][1] = (vplVec3){top.x + l * left.x, top.y + l * left.y, top.z + l * left.z};
            triangles[i][2] = (vplVec3){top.x + r * right.x, top.y + r * right.y, top.z + r * right.z};
            assert_true(triangles[i][1].z < 0 && triangles[i][2].z < 0);
        }
        if (vplPointFormFactor(point, up, triangles[0]) == 0) {
            swapCorners(triangles[0]);
            swapCorners(triangles[1]);
        }
        const double f = vplPointFormFactor(point, up, triangles[0]);
        assert_true(f > 0);
        assertNear(vplPointFormFactor(point, up, triangles[1]), f, 1e-15 + 1e-13 * f, "longer", (int)seed);
    }
}

// Factors have the same bits at any scale and position, for near and far triangles, clipped or not.
TEST_ALONE(PointFactorsDoNotDependOnTheUnitOrThePlace)
{
    static const int powers[6] = {-100, -33, -30, 30, 33, 100};
    int seen = 0;
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 a[3], b[3], moved[3];
        rollPair(seed, a, b);
        const float step = 0x1p-10f, far = 4096;
        for (int i = 0; i < 3; i++) { // rounded, so that moved positions are exact
            b[i] = (vplVec3){rintf(b[i].x / step) * step, rintf(b[i].y / step) * step,
                             rintf(b[i].z / step) * step};
            moved[i] = (vplVec3){b[i].x + far, b[i].y - far, b[i].z + far};
        }
        const vplVec3 point = {rintf(a[0].x / step) * step, rintf(a[0].y / step) * step,
                               rintf(a[0].z / step) * step},
                      normal = rollNormal(seed);
        const double wanted = vplPointFormFactor(point, normal, b);
        seen += wanted > 0;
        assert_true(vplPointFormFactor((vplVec3){point.x + far, point.y - far, point.z + far}, normal,
                                       moved) == wanted);
        for (int k = 0; k < 6; k++) {
            const float scale = ldexpf(1, powers[k]);
            vplVec3 c[3];
            for (int i = 0; i < 3; i++) {
                c[i] = (vplVec3){b[i].x * scale, b[i].y * scale, b[i].z * scale};
            }
            assert_true(vplPointFormFactor((vplVec3){point.x * scale, point.y * scale, point.z * scale},
                                           normal, c) == wanted);
        }
    }
    assert_true(seen > MOST_CASES / 3);
}

// The triangle is seen at an angle: the terms of the integral along its edges cancel, by 6 digits at a
// distance of 2^20 sizes, and by all digits of double at 2^60.
TEST_ALONE(FarTrianglesAreTheirAreaOverTheSquare)
{
    // The centroid is the origin, so that the next term of the series is smaller by the square of the
    // distance.
    const vplVec3 triangle[3] = {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}}, normal = {0.6f, 0, -0.8f};
    const double length = sqrt((double)normal.x * normal.x + (double)normal.z * normal.z);
    for (int power = 4; power <= 60; power++) {
        const float d = ldexpf(1, power);
        const vplVec3 point = {-2 * d, d, 2 * d}; // at distance 3d
        const double f = vplPointFormFactor(point, normal, triangle);
        const double square = 9 * (double)d * d,
                     cosine = (2 * (double)normal.x - 2 * (double)normal.z) / (3 * length);
        const double wanted = 4.5 * (2 / 3.0) * cosine / (3.14159265358979323846 * square);
        assertNear(f / wanted, 1, 20 / square + 1e-15, "power", power);
    }
}

// Halves are nearer relative to their size than the whole, so that one may use the integral along the edges
// and the other the integral over the area.
TEST_ALONE(HalvesSeenFromAPointSumToTheWhole)
{
    int seen = 0;
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 a[3], b[3];
        rollPair(seed, a, b);
        for (int i = 0; i < 3; i++) { // so that the midpoint is exact
            b[i] = (vplVec3){rintf(b[i].x * 0x1p14f) * 0x1p-14f, rintf(b[i].y * 0x1p14f) * 0x1p-14f,
                             rintf(b[i].z * 0x1p14f) * 0x1p-14f};
        }
        const vplVec3 m = {0.5f * (b[0].x + b[1].x), 0.5f * (b[0].y + b[1].y), 0.5f * (b[0].z + b[1].z)};
        const vplVec3 normal = rollNormal(seed);
        const double whole = vplPointFormFactor(a[0], normal, b);
        const double first = vplPointFormFactor(a[0], normal, (const vplVec3[3]){b[0], m, b[2]}),
                     second = vplPointFormFactor(a[0], normal, (const vplVec3[3]){m, b[1], b[2]});
        if (whole > 0) {
            assertNear(first + second, whole, 1e-15 + 1e-12 * whole, "halves", (int)seed);
            seen++;
        }
    }
    assert_true(seen > MOST_CASES / 3);
}

// Returns the mean factor from the centroids of the triangles that a is divided into, n per edge.
static double meanOfPointFactors(const vplVec3 a[3], vplVec3 normal, const vplVec3 b[3], int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 2 * i + 1; k++) { // in strip i, triangles alternate in orientation
            const double u = (i - k / 2 + (k & 1 ? -1 / 3.0 : 1 / 3.0)) / n,
                         v = (k / 2 + (k & 1 ? 2 / 3.0 : 1 / 3.0)) / n;
            const vplVec3 point = {(float)(a[0].x + u * (a[1].x - a[0].x) + v * (a[2].x - a[0].x)),
                                   (float)(a[0].y + u * (a[1].y - a[0].y) + v * (a[2].y - a[0].y)),
                                   (float)(a[0].z + u * (a[1].z - a[0].z) + v * (a[2].z - a[0].z))};
            sum += vplPointFormFactor(point, normal, b);
        }
    }
    return sum / ((double)n * n);
}

// A triangle's form factor is the mean of its points' factors. Centroids of parts cause an error proportional
// to their squared size, which the difference of two such means removes; points are rounded to float.
TEST_ALONE(MeansOverPointsAreFactorsOfTriangles)
{
    int compared = 0, cut = 0;
    for (uint64_t seed = 0; seed < 400; seed++) {
        vplVec3 a[3], b[3];
        rollPair(seed, a, b);
        const double ux = (double)a[1].x - a[0].x, uy = (double)a[1].y - a[0].y, uz = (double)a[1].z - a[0].z;
        const double vx = (double)a[2].x - a[0].x, vy = (double)a[2].y - a[0].y, vz = (double)a[2].z - a[0].z;
        const double twice = 2 * areaOf(a);
        const vplVec3 normal = {(float)((uy * vz - uz * vy) / twice), (float)((uz * vx - ux * vz) / twice),
                                (float)((ux * vy - uy * vx) / twice)};
        bool behind = false;
        for (int i = 0; i < 3; i++) {
            behind = behind || heightAbove(a[0], normal, b[i]) < 0;
        }
        // The averaged function is smooth if all of a is in front of b and b is some distance away.
        const double wanted = vplTriangleFormFactor(a, b);
        if (!(wanted > 1e-4) || !(b[0].z > 0.6f && b[1].z > 0.6f && b[2].z > 0.6f) ||
            !(vplPointFormFactor(a[0], normal, b) > 0 && vplPointFormFactor(a[1], normal, b) > 0 &&
              vplPointFormFactor(a[2], normal, b) > 0)) {
            continue;
        }
        const double coarse = meanOfPointFactors(a, normal, b, 16),
                     fine = meanOfPointFactors(a, normal, b, 32);
        assertRelative((4 * fine - coarse) / 3, wanted, 1e-6, "mean", (int)seed);
        cut += behind;
        compared++;
    }
    assert_true(compared > 50 && cut > 10);
}

// A point next to a triangle's interior sees all of it, a point next to an edge half, a point next to a
// corner the corner's share of the full angle.
TEST_ALONE(PointsOnATriangleSeeItsShareOfTheTurn)
{
    const vplVec3 triangle[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, down = {0, 0, -1};
    static const struct {
        float x, y;
        double share;
    } places[8] = {{0.25f, 0.25f, 1}, {0.5f, 0, 0.5}, {0, 0.5f, 0.5}, {0.5f, 0.5f, 0.5},
                   {0, 0, 0.25},      {1, 0, 0.125},  {0, 1, 0.125},  {1.5f, 0.25f, 0}};
    for (int i = 0; i < 8; i++) {
        for (int power = -10; power >= -100; power -= 10) {
            const float h = ldexpf(1, power);
            const double f = vplPointFormFactor((vplVec3){places[i].x, places[i].y, h}, down, triangle);
            assertNear(f, places[i].share, 16 * (double)h * h + 1e-15, "place", i);
        }
        const vplVec3 on = {places[i].x, places[i].y, 0}, under = {places[i].x, places[i].y, -0x1p-100f};
        assert_true(vplPointFormFactor(on, down, triangle) == 0);
        assert_true(vplPointFormFactor(under, (vplVec3){0, 0, 1}, triangle) == 0);
    }
}

// Tests corners and midpoints of edges, which are exact, in planes at any angle; then triangles without area
// and normals without direction.
TEST_ALONE(PointsInThePlaneAndNoAreaSeeNothing)
{
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 t[3];
        for (uint64_t i = 0; i < 3; i++) {
            t[i] = rollPoint(seed, i, 1, (vplVec3){0, 0, 0});
            t[i] = (vplVec3){rintf(t[i].x * 0x1p22f) * 0x1p-22f, rintf(t[i].y * 0x1p22f) * 0x1p-22f,
                             rintf(t[i].z * 0x1p22f) * 0x1p-22f};
        }
        const vplVec3 normal = rollNormal(seed);
        for (int i = 0; i < 3; i++) {
            const vplVec3 p = t[i], q = t[(i + 1) % 3];
            const vplVec3 m = {0.5f * (p.x + q.x), 0.5f * (p.y + q.y), 0.5f * (p.z + q.z)};
            assert_true(vplPointFormFactor(p, normal, t) == 0);
            assert_true(vplPointFormFactor(m, normal, t) == 0);
        }
    }
    const vplVec3 origin = {0, 0, 0}, up = {0, 0, 1}, point[3] = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}},
                  line[3] = {{0, 0, 1}, {1, 0, 1}, {2, 0, 1}}, over[3] = {{0, 0, 1}, {0, 1, 1}, {1, 0, 1}};
    assert_true(vplPointFormFactor(origin, up, point) == 0);
    assert_true(vplPointFormFactor(origin, up, line) == 0);
    assert_true(vplPointFormFactor(origin, up, over) > 0);
    assert_true(vplPointFormFactor(origin, origin, over) == 0);
    for (int i = 0; i < 2; i++) {
        const float bad = i == 0 ? INFINITY : NAN;
        assert_true(vplPointFormFactor((vplVec3){0, 0, bad}, up, over) == 0);
        assert_true(vplPointFormFactor(origin, (vplVec3){0, 0, bad}, over) == 0);
        assert_true(vplPointFormFactor(origin, up, (const vplVec3[3]){over[0], over[1], {bad, 0, 1}}) == 0);
    }
    // The triangle is behind the element, or has an edge on its horizon.
    assert_true(vplPointFormFactor(origin, (vplVec3){0, 0, -1}, over) == 0);
    assert_true(vplPointFormFactor(origin, up, (const vplVec3[3]){{1, 0, 0}, {1, 1, 0}, {1, 0, -1}}) == 0);
}
