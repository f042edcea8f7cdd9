// SPDX-License-Identifier: MIT
// Form factors of a point and a triangle: closed forms, and what holds for all of them.
#include "factor_cases.h"

// ---- a point and a triangle

// Of a fan: corners in order, convex.
static double pointFactorOfFan(vplVec3 point, vplVec3 normal, const vplVec3* corners, int count)
{
    double sum = 0;
    for (int i = 2; i < count; i++) {
        sum += vplPointFormFactor(point, normal, (const vplVec3[3]){corners[0], corners[i - 1], corners[i]});
    }
    return sum;
}

// From below the corner of a rectangle a x b, c above.
static double pointFactorOfCorner(vplVec3 normal, const float v[3])
{
    const float a = v[0], b = v[1], c = v[2];
    return pointFactorOfFan((vplVec3){0, 0, 0}, normal,
                            (const vplVec3[4]){{0, 0, c}, {0, b, c}, {a, b, c}, {a, 0, c}}, 4);
}

// Lengths are floats: 0.001 is wrong by 5e-8 of it, and the smallest factors by as much. In millimetres all
// lengths are exact, and 4e-16 are measured.
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

// A regular polygon of so many corners, h above its middle's foot.
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

// A disk lies between polygons in it and around it, whatever their corners' rounding, which is less than the
// 2^-22 that they are moved. One of the same area has the same factor to (pi / count)^4 and the mean of the
// corners' rounding: 8e-10 of it are measured.
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
        if ((double)(float)h != h) { // in millimetres it is exact
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

// Of two windings one is seen, and none of what is below the horizon.
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

// Whatever the element's direction, a closed box is all it sees: triangles are cut at its horizon so that
// nothing is lost and nothing is counted twice.
TEST_ALONE(BoxesAroundAPointSumToOne)
{
    // Corner i of the box has the upper x, y, z where bits 0, 1, 2 of i are set; counter-clockwise seen from
    // inside.
    static const int faces[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1},
                                    {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};
    static const float sizes[4][3] = {{1, 1, 1}, {1, 2, 3}, {1, 1, 1000}, {1000, 1, 1000}};
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        const float* size = sizes[seed % 4];
        const vplVec3 normal = rollNormal(seed);
        vplVec3 point = {size[0] * (float)uniformAt(seed, 0), size[1] * (float)uniformAt(seed, 1),
                         size[2] * (float)uniformAt(seed, 2)};
        vplVec3 ahead = normal;
        if (seed % 3 == 1) { // as near to the floor as the table's rows
            point.z = 0.001f;
        } else if (seed % 3 == 2) { // a part of the floor
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

// The part of a triangle that is seen ends at the horizon: where its edges end below is all the same.
TEST_ALONE(WhatIsBelowTheHorizonChangesNothing)
{
    const vplVec3 point = {0, 0, 0}, up = {0, 0, 1}, left = {-0.25f, 1, -1.5f}, right = {-0.5f, -1, -2};
    for (uint64_t seed = 0; seed < 500; seed++) {
        // Multiples of 2^-10, so that the longer edges are exact.
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

// The same bits, of whatever size and wherever: near and far, cut and whole.
TEST_ALONE(PointFactorsDoNotDependOnTheUnitOrThePlace)
{
    static const int powers[6] = {-100, -33, -30, 30, 33, 100};
    int seen = 0;
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 a[3], b[3], moved[3];
        rollPair(seed, a, b);
        const float step = 0x1p-10f, far = 4096;
        for (int i = 0; i < 3; i++) { // so that places a few thousand away are exact
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

// Seen at an angle: along its edges almost all cancels, at 2^20 sizes 6 digits and at 2^60 all that doubles
// have.
TEST_ALONE(FarTrianglesAreTheirAreaOverTheSquare)
{
    // Its middle is the origin, so that what follows the first term has the square of the distance below it.
    const vplVec3 triangle[3] = {{-1, -1, 0}, {2, -1, 0}, {-1, 2, 0}}, normal = {0.6f, 0, -0.8f};
    const double length = sqrt((double)normal.x * normal.x + (double)normal.z * normal.z);
    for (int power = 4; power <= 60; power++) {
        const float d = ldexpf(1, power);
        const vplVec3 point = {-2 * d, d, 2 * d}; // 3d from it
        const double f = vplPointFormFactor(point, normal, triangle);
        const double square = 9 * (double)d * d,
                     cosine = (2 * (double)normal.x - 2 * (double)normal.z) / (3 * length);
        const double wanted = 4.5 * (2 / 3.0) * cosine / (3.14159265358979323846 * square);
        assertNear(f / wanted, 1, 20 / square + 1e-15, "power", power);
    }
}

// Halves are nearer for their size than the whole, so that one is along edges and the other over the area.
TEST_ALONE(HalvesSeenFromAPointSumToTheWhole)
{
    int seen = 0;
    for (uint64_t seed = 0; seed < MOST_CASES; seed++) {
        vplVec3 a[3], b[3];
        rollPair(seed, a, b);
        for (int i = 0; i < 3; i++) { // so that the middle is exact
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

// Of the middles of the parts of a, n to an edge.
static double meanOfPointFactors(const vplVec3 a[3], vplVec3 normal, const vplVec3 b[3], int n)
{
    double sum = 0;
    for (int i = 0; i < n; i++) {
        for (int k = 0; k < 2 * i + 1; k++) { // in strip i, up and down by turns
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

// What a triangle sends is the mean of what its points send. The middle of a part errs by its size squared,
// which the difference of two such means takes away, and by the rounding of points to floats.
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
        // The mean is of a smooth function where all of a is in front of b, and b is some way off.
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

// Over the middle of a triangle all is seen, over its edges half, over a corner the corner's share of the
// turn.
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

// Corners and middles of edges, which are exact, in planes at any angle; and what has no area, or no
// direction.
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
    // Behind the element, and with an edge on its horizon.
    assert_true(vplPointFormFactor(origin, (vplVec3){0, 0, -1}, over) == 0);
    assert_true(vplPointFormFactor(origin, up, (const vplVec3[3]){{1, 0, 0}, {1, 1, 0}, {1, 0, -1}}) == 0);
}
