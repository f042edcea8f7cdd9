// SPDX-License-Identifier: MIT
// Tests of the OBJ reader's parts: numbers become the nearest floats, and triangulation covers every polygon
// once.
#include "test.h"

#include "base/hash.h"
#include "base/rng.h"
#include "scene/obj_number.h"
#include "scene/ear_clipping.h"

#include <stdlib.h>

static bool readNumber(const char* text, float* out)
{
    return vplReadNumber(text, text + strlen(text), out);
}

// glibc's strtof rounds correctly, so the bits must be equal.
static void assertNearest(const char* text)
{
    float value = NAN, wanted = strtof(text, NULL);
    if (!readNumber(text, &value) || value != wanted || (value == 0 && signbit(value))) {
        fail_msg("%s read as %.9g, wanted %.9g", text, (double)value, (double)wanted);
    }
}

TEST_ALONE(NumbersAreTheNearestFloats)
{
    static const char* const texts[] = {
        "0", "-0", "1", "+1", "-1", "1.", ".5", "-.5e1", "0.1", "1e0", "1E+2", "100e-2", "000123.4500",
        // halfway between two floats, and next to it
        "16777217", "16777219", "16777217.0000000000000000000000000000000000000001",
        "16777216.9999999999999999999999999999999999999999", "33554434", "33554438",
        "1.00000005960464477539062500000000000000000000000001", "1.000000059604644775390625",
        "1.0000000596046447753906249999999999999999999999999", "0.100000001490116119384765625",
        // the smallest denormal, half of it, and the smallest normal float
        "1e-45", "7.006492321624085e-46", "7.0064923216240853546186479164495e-46",
        "7.0064923216240853546186479164496e-46", "7.0064923216240854e-46", "1.1754943508222875e-38",
        "1.17549429e-38", "1.1754942807573642918e-38", "1e-46", "1e-400", "4.7e-324",
        "1e-99999999999999999999",
        // the largest float, and beyond
        "3.4028234663852886e38", "3.4028235677973366e38", "3.40282356779733661637e38",
        "3.4028235677973366163753939545814e38", "3.4028235677973367e38", "1e39", "1e400",
        "1e99999999999999999999", "0e99999999999999999999",
        // more digits than 64 bits hold, before and after the decimal point
        "123456789012345678901234567890", "0.000000000000000000000000000000123456789012345678901234567890",
        "9007199254740993", "9007199254740992.5e-10", "18446744073709551616", "0.00000000000000000000e30"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        assertNearest(texts[i]);
    }
    char text[400] = "0."; // 300 digits that equal a midpoint exactly, then one more
    strcat(text, "000000059604644775390625");
    memset(text + strlen(text), '0', 300);
    text[2 + 24 + 300] = 0;
    assertNearest(text);
    text[2 + 24 + 299] = '1';
    assertNearest(text);
}

TEST_ALONE(RandomNumbersAreTheNearestFloats)
{
    char text[100];
    for (uint64_t i = 0; i < 100000; i++) {
        vplRandom4 r = vplRandomAt(1, 0, i);
        uint32_t bits = r.v[0] & 0x7FFFFFFF;
        float value, next;
        memcpy(&value, &bits, sizeof value);
        bits++;
        memcpy(&next, &bits, sizeof next);
        if (!isfinite(value) || !isfinite(next)) {
            continue;
        }
        snprintf(text, sizeof text, "%.*g", (int)(r.v[1] % 20) + 1, (double)value);
        assertNearest(text);
        double middle = 0.5 * ((double)value + (double)next);
        snprintf(text, sizeof text, "%.*g", (int)(r.v[2] % 30) + 15, middle); // near a midpoint or on it
        assertNearest(text);
        snprintf(text, sizeof text, "%s%u.%06ue%d", r.v[3] % 2 ? "-" : "", r.v[1] % 100000, r.v[2] % 1000000,
                 (int)(r.v[3] % 90) - 50);
        assertNearest(text);
    }
}

TEST_ALONE(WhatIsNoNumberIsRefused)
{
    static const char* const texts[] = {"",    "-",    "+",   ".",    "-.",    "e5",    "1e", "1e+",
                                        "1e-", "1.2.", "1,5", "0x10", "nan",   "inf",   "1f", "--1",
                                        "+-1", "1 ",   " 1",  "1e5.", "1e1e1", "1_000", "½",  "Infinity"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        float value = 7;
        if (readNumber(texts[i], &value) || value != 7) {
            fail_msg("\"%s\" was read as %g", texts[i], (double)value);
        }
    }
}

// ---- polygons: integer coordinates make areas exact

static vplEarClipper polygon;

static double dotAxis(const double* a, const double* b)
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Adds half the cross product of (b - a) and (c - a).
static void addArea(double* sum, const vplVec3* a, const vplVec3* b, const vplVec3* c)
{
    double u[3] = {(double)b->x - (double)a->x, (double)b->y - (double)a->y, (double)b->z - (double)a->z};
    double v[3] = {(double)c->x - (double)a->x, (double)c->y - (double)a->y, (double)c->z - (double)a->z};
    for (int k = 0; k < 3; k++) {
        int i = (k + 1) % 3, j = (k + 2) % 3;
        sum[k] += 0.5 * (u[i] * v[j] - u[j] * v[i]);
    }
}

// Asserts that the polygon gives n - 2 triangles of positive area with the outline's orientation, whose areas
// sum to the outline's area (shoelace formula): then none overlaps another or sticks out. Returns a hash of
// the triangles.
static uint64_t assertCovered(const vplVec3* corners, int count, const char* what, int row)
{
    double outline[3] = {0, 0, 0}, sum = 0;
    for (int i = 1; i + 1 < count; i++) {
        addArea(outline, &corners[0], &corners[i], &corners[i + 1]);
    }
    double size = sqrt(dotAxis(outline, outline));
    vplEarClipper_Triangulate(&polygon, corners, count);
    if (polygon.triangleCount != count - 2 || !polygon.simple) {
        fail_msg("%s, row %d: %d triangles of %d corners%s", what, row, polygon.triangleCount, count,
                 polygon.simple ? "" : ", called crossing");
    }
    for (int i = 0; i < polygon.triangleCount; i++) {
        const int* t = polygon.triangles[i];
        double area[3] = {0, 0, 0};
        addArea(area, &corners[t[0]], &corners[t[1]], &corners[t[2]]);
        double along = dotAxis(area, outline);
        if (!(along > 0)) {
            fail_msg("%s, row %d: triangle %d (%d %d %d) is empty or turns the other way", what, row, i, t[0],
                     t[1], t[2]);
        }
        sum += along / size;
    }
    assertNear(sum, size, 1e-12 * size, what, row);
    return vplHashWords(0, (const uint32_t*)polygon.triangles, 3 * (size_t)polygon.triangleCount);
}

// Tests the outline in six planes, in both orientations, from every starting corner.
static void assertCoveredEveryWay(const float (*outline)[2], int count, const char* what)
{
    vplVec3 corners[VPL_MAX_CORNERS];
    for (int way = 0; way < 12; way++) {
        for (int start = 0; start < count; start++) {
            for (int i = 0; i < count; i++) {
                const float* p = outline[(start + (way >= 6 ? count - i : i)) % count];
                const float third = way % 6 < 3 ? 0 : p[0] + 2 * p[1]; // a slanted plane
                float v[3];
                v[way % 3] = p[0];
                v[(way + 1) % 3] = p[1];
                v[(way + 2) % 3] = third;
                corners[i] = (vplVec3){v[0], v[1], v[2]};
            }
            assertCovered(corners, count, what, 1000 * way + start);
        }
    }
}

#define COVERED(...)                                                                                         \
    do {                                                                                                     \
        static const float outline[][2] = __VA_ARGS__;                                                       \
        assertCoveredEveryWay(outline, (int)(sizeof outline / sizeof *outline), #__VA_ARGS__);               \
    } while (0)

TEST_ALONE(PolygonsAreCoveredOnce)
{
    COVERED({{0, 0}, {4, 0}, {0, 3}});                                         // triangle
    COVERED({{0, 0}, {4, 0}, {5, 3}, {0, 3}});                                 // convex
    COVERED({{0, 0}, {4, 0}, {1, 1}, {0, 4}});                                 // dart
    COVERED({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 3}, {0, 3}});                 // L
    COVERED({{0, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 1}, {1, 1}, {1, 3}, {0, 3}}); // U
    COVERED({{0, 0}, {1, 0}, {2, 0}, {2, 2}});                                 // a corner on an edge
    COVERED({{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {3, 2}, {1, 2}, {0, 2}}); // several
    COVERED({{0, 0}, {6, 0}, {6, 5}, {5, 1}, {4, 5}, {3, 1}, {2, 5}, {1, 1}}); // comb
    COVERED({{0, 0},
             {7, 0},
             {7, 7},
             {1, 7},
             {1, 2},
             {5, 2},
             {5, 5},
             {3, 5},
             {3, 4},
             {4, 4},
             {4, 3},
             {2, 3},
             {2, 6},
             {6, 6},
             {6, 1},
             {0, 1}});                                                         // spiral
    COVERED({{0, 0}, {5, 0}, {5, 4}, {0, 4}, {0, 3}, {4, 3}, {4, 1}, {0, 1}}); // C
    COVERED({{4, 0},
             {3, 1},
             {4, 4},
             {1, 3},
             {0, 4},
             {-1, 3},
             {-4, 4},
             {-3, 1},
             {-4, 0},
             {-3, -1},
             {-4, -4},
             {0, -3},
             {4, -4},
             {3, -1}}); // star
}

// A hole is joined to the outline by an edge that is walked twice, which repeats two corners.
TEST_ALONE(HolesJoinedByADoubleEdgeAreCutOut)
{
    COVERED({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}});
    COVERED({{0, 0},
             {9, 0},
             {9, 4},
             {0, 4},
             {0, 0},
             {1, 1},
             {1, 3},
             {3, 3},
             {3, 1},
             {5, 1},
             {5, 3},
             {7, 3},
             {7, 1},
             {5, 1},
             {3, 1},
             {1, 1}}); // two holes in a row
}

// Makes a random outline without self-intersections: a ring of integer corners in several directions from the
// centre.
static int randomOutline(uint64_t seed, vplVec3* corners)
{
    enum { DIRECTIONS = 12 };
    static const int around[DIRECTIONS][2] = {{3, 0},  {3, 1},  {1, 1},   {1, 3},  {0, 3},  {-1, 2},
                                              {-3, 2}, {-3, 0}, {-2, -3}, {0, -3}, {2, -3}, {3, -2}};
    int count = 0;
    vplRandom4 slope = vplRandomAt(seed, 1, 0);
    for (int i = 0; i < DIRECTIONS; i++) {
        vplRandom4 r = vplRandomAt(seed, 2, (uint64_t)i);
        if (around[i][0] * around[i][1] != 0 && r.v[0] % 4 == 0) {
            continue; // the axes stay, so that the ring encloses the centre
        }
        float size = (float)(1 + r.v[1] % 60);
        float x = size * (float)around[i][0], y = size * (float)around[i][1];
        float z = (float)(int)(slope.v[0] % 7 - 3) * x + (float)(int)(slope.v[1] % 7 - 3) * y;
        float v[6] = {x, y, z, x, y, z};
        const float* p = v + slope.v[2] % 3;
        corners[count++] = (vplVec3){p[0], p[1], p[2]};
    }
    return count;
}

TEST_ALONE(RandomPolygonsAreCoveredOnce)
{
    uint64_t checksum = 0;
    int concave = 0;
    for (uint64_t seed = 0; seed < 20000; seed++) {
        vplVec3 corners[12];
        int count = randomOutline(seed, corners);
        uint64_t hash = assertCovered(corners, count, "seed", (int)seed);
        uint32_t words[2] = {(uint32_t)hash, (uint32_t)(hash >> 32)};
        checksum = vplHashWords(checksum, words, 2);
        concave += polygon.triangles[0][0] != 0; // a fan would start at corner 0
    }
    assert_true(concave > 10000);
    if (checksum != 0x057965586b7d7458) {
        fail_msg("checksum is %016llx", (unsigned long long)checksum);
    }
}

TEST_ALONE(AThousandCornersAreCoveredOnce)
{
    static vplVec3 corners[VPL_MAX_CORNERS];
    for (int i = 0; i < VPL_MAX_CORNERS / 2; i++) { // a comb, and its back
        corners[i] = (vplVec3){(float)i, i % 2 ? 100 : 1, 0};
        corners[VPL_MAX_CORNERS - 1 - i] = (vplVec3){(float)i, 200, 0};
    }
    assertCovered(corners, VPL_MAX_CORNERS, "comb", 0);
    for (int i = 0; i < VPL_MAX_CORNERS; i++) { // a spiral
        int turns = i < VPL_MAX_CORNERS / 2 ? i : VPL_MAX_CORNERS - 1 - i;
        float size = (float)(2000 - 3 * turns) + (i < VPL_MAX_CORNERS / 2 ? 0 : -5);
        static const float around[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};
        corners[i] = (vplVec3){size * around[turns % 4][0], 0, size * around[turns % 4][1]};
    }
    assertCovered(corners, VPL_MAX_CORNERS, "spiral", 0);
}

// Outlines that are not planar simple polygons must not cause an endless loop; they give as many triangles as
// others.
TEST_ALONE(CrossingOutlinesEnd)
{
    static vplVec3 corners[VPL_MAX_CORNERS];
    for (uint64_t seed = 0; seed < 300; seed++) {
        int count = 3 + (int)(vplRandomAt(seed, 3, 0).v[0] % (seed < 290 ? 30 : VPL_MAX_CORNERS - 2));
        for (int i = 0; i < count; i++) {
            vplRandom4 r = vplRandomAt(seed, 4, (uint64_t)i);
            corners[i] =
                (vplVec3){(float)(r.v[0] % 5), (float)(r.v[1] % 5), (float)(r.v[2] % (1 + seed % 3))};
        }
        vplEarClipper_Triangulate(&polygon, corners, count);
        assert_int_equal(polygon.triangleCount, count - 2);
        for (int i = 0; i < count - 2; i++) {
            const int* t = polygon.triangles[i];
            assert_true(t[0] != t[1] && t[1] != t[2] && t[0] != t[2]);
            assert_true(t[0] >= 0 && t[0] < count && t[1] >= 0 && t[1] < count && t[2] >= 0 && t[2] < count);
        }
    }
}
