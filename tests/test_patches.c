// SPDX-License-Identifier: MIT
// Tests of triangles bisected at their longest edges: tests/data/subdivision_*.csv, X093, X097 to X099.
#include "patch_support.h"

#include "base/hash.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <stdlib.h>

static int countOf(const vplGeometry* g, float size, int rounds)
{
    vplPatches* patches = openPatches(g, size, rounds);
    const int count = patches->patchCount;
    vplPatches_Destroy(patches);
    return count;
}

static void compareCounts(const vplGeometry* g, float size, int most, const Table* t, int row)
{
    for (int rounds = 0; rounds <= most; rounds++) {
        const char name[] = {'i', 't', (char)('0' + rounds), 0};
        assertNear(countOf(g, size, rounds), number(t, row, name), 0, name, row);
    }
}

static bool startsWith(const Table* t, int row, const char* text)
{
    return strncmp(cell(t, row, "rule"), text, strlen(text)) == 0;
}

// Squared lengths in the lab's unit are exact in float, so the next floats above and below a length are on the
// right side of it. Edges of length T exactly are not bisected (X097). From below the seventh round is left
// out: the table lacks its lengths (98.1).
TEST(EveryThresholdGivesTheTablesCountsFromBothSides, 1)
{
    vplGeometry* g = testModel(context, MODEL_LAB, 0.5f);
    Table t = loadTable("subdivision_counts.csv");
    int rows = 0;
    for (int row = 0; row < t.rows && strcmp(cell(&t, row, "rule"), "longest_edge > T") == 0; row++, rows++) {
        const double length = number(&t, row, "T_lab");
        float size = (float)length;
        size = (double)size < length ? nextafterf(size, INFINITY) : size;
        compareCounts(g, size, 7, &t, row);
        if (row > 0) {
            compareCounts(g, nextafterf(size, 0), 6, &t, row - 1);
        }
    }
    assert_true(rows > 50);
    freeTable(&t);
    vplGeometry_Destroy(g);
}

// T = 0.5 in the lab's own coordinates is half the length of walls: 464 patches, slightly below it 784 (X097).
TEST(ScaledThresholdsInFloatGiveTheTablesCounts, 1)
{
    vplGeometry* g = testModel(context, MODEL_SCALED, 0.5f);
    Table t = loadTable("subdivision_counts.csv");
    int rows = 0;
    for (int row = 0; row < t.rows; row++) {
        if (startsWith(&t, row, "binary32") || startsWith(&t, row, "longest_edge > T=0.5")) {
            compareCounts(g, (float)number(&t, row, "T_scaled"), 7, &t, row);
            rows++;
        } else if (startsWith(&t, row, "longest_edge >= T=0.5")) {
            compareCounts(g, nextafterf(0.5f, 0), 7, &t, row);
            rows++;
        }
    }
    assert_int_equal(rows, 6);
    freeTable(&t);
    vplGeometry_Destroy(g);
}

// With permuted corners another of several equal longest edges comes first, but counts are the same (X099).
TEST(CountsDoNotDependOnWhichOfEqualEdgesIsFirst, 1)
{
    Table model = loadTable("cornell_testmodel.csv"), t = loadTable("subdivision_counts.csv");
    for (int turn = 0; turn < 3; turn++) {
        Shape shape = {0};
        for (int row = 0; row < model.rows; row++) {
            const vplVec3 c[] = {vectorOf(&model, row, "v0"), vectorOf(&model, row, "v1"),
                                 vectorOf(&model, row, "v2")};
            addTriangle(&shape, c[turn], c[(turn + 1) % 3], c[(turn + 2) % 3]);
        }
        vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
        int rows = 0;
        for (int row = 0; row < t.rows; row++) {
            if (startsWith(&t, row, "longest_edge > T; tie")) {
                compareCounts(g, (float)number(&t, row, "T_lab"), 7, &t, row);
                rows++;
            }
        }
        assert_int_equal(rows, 4);
        freeShape(&shape);
        vplGeometry_Destroy(g);
    }
    freeTable(&model);
    freeTable(&t);
}

// ---- the mesh

static double distance(vplVec3 a, vplVec3 b)
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y, z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}

static void cornersOf(const vplPatches* p, int patch, vplVec3 c[3])
{
    for (int k = 0; k < 3; k++) {
        c[k] = p->positions[p->nodes[p->patches[patch]].corners[k]];
    }
}

static double shortestEdge(const vplPatches* p)
{
    double shortest = INFINITY;
    for (int i = 0; i < p->patchCount; i++) {
        vplVec3 c[3];
        cornersOf(p, i, c);
        for (int k = 0; k < 3; k++) {
            shortest = fmin(shortest, distance(c[k], c[(k + 1) % 3]));
        }
    }
    return shortest;
}

// Returns whether a point lies inside some patch's edge, not at its ends.
static bool isHanging(const vplPatches* p, vplVec3 at)
{
    for (int i = 0; i < p->patchCount; i++) {
        vplVec3 c[3];
        cornersOf(p, i, c);
        for (int k = 0; k < 3; k++) {
            const double a = distance(c[k], at), b = distance(c[(k + 1) % 3], at),
                         ab = distance(c[k], c[(k + 1) % 3]);
            if (a > 1e-3 && b > 1e-3 && a + b < ab * (1 + 1e-9)) {
                return true;
            }
        }
    }
    return false;
}

static void compareSurfaces(const vplPatches* p, const Table* model, const Table* t, int row)
{
    static const char* const names[] = {"floor", "left", "right", "ceiling", "back", "short", "tall"};
    for (int k = 0; k < 7; k++) {
        int count = 0;
        for (int i = 0; i < p->patchCount; i++) {
            count += strcmp(cell(model, p->nodes[p->patches[i]].triangle, "surface"), names[k]) == 0;
        }
        assertNear(count, number(t, row, names[k]), 0, names[k], row);
    }
}

TEST(TheMeshOfEachRoundIsTheTables, 1)
{
    vplGeometry* g = testModel(context, MODEL_LAB, 0.5f);
    Table t = loadTable("subdivision_mesh.csv"), model = loadTable("cornell_testmodel.csv");
    for (int row = 0; row < t.rows; row++) {
        vplPatches* p = openPatches(g, 125, row);
        double area = 0;
        int hanging = 0;
        for (int i = 0; i < p->patchCount; i++) {
            area += vplPatches_Area(p, i);
        }
        for (int i = 0; i < p->positionCount; i++) {
            hanging += isHanging(p, p->positions[i]);
        }
        assertNear(p->patchCount, number(&t, row, "patches"), 0, "patches", row);
        assertNear(p->positionCount, number(&t, row, "distinct_vertices"), 0, "vertices", row);
        assertNear(hanging, number(&t, row, "hanging_vertices"), 0, "hanging", row);
        assertNear((double)p->longestEdge, number(&t, row, "longest_edge"), 4e-5, "longest", row);
        assertNear(shortestEdge(p), number(&t, row, "shortest_edge"), 1e-10, "shortest", row);
        assertNear(area, number(&t, row, "total_area"), 1e-6, "area", row);
        compareSurfaces(p, &model, &t, row);
        vplPatches_Destroy(p);
    }
    freeTable(&t);
    freeTable(&model);
    vplGeometry_Destroy(g);
}

static bool isSame(vplVec3 a, vplVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Asserts what vpl/geometry.h says about nodes, for triangles of all shapes.
static void assertNodes(const vplPatches* p)
{
    int patches = 0;
    for (int i = 0; i < p->nodeCount; i++) {
        const vplPatchNode* node = &p->nodes[i];
        vplVec3 c[3];
        for (int k = 0; k < 3; k++) {
            c[k] = p->positions[node->corners[k]];
        }
        const double opposite = distance(c[1], c[2]);
        assert_true(opposite >= distance(c[0], c[1]) && opposite >= distance(c[0], c[2]));
        const vplVec3 n = vplCross(vplSub(c[1], c[0]), vplSub(c[2], c[0]));
        assert_true(vplDot(n, p->geometry->normals[node->triangle]) > 0);
        if (node->children < 0) {
            assert_int_equal(p->patches[node->patch], i);
            patches++;
            continue;
        }
        assert_int_equal(node->patch, -1);
        const vplVec3 middle = vplScale(0.5f, vplAdd(c[1], c[2]));
        for (int half = 0; half < 2; half++) {
            const vplPatchNode* child = &p->nodes[node->children + half];
            bool hasMiddle = false, hasApex = false, hasEnd = false;
            for (int k = 0; k < 3; k++) {
                hasMiddle = hasMiddle || isSame(p->positions[child->corners[k]], middle);
                hasApex = hasApex || child->corners[k] == node->corners[0];
                hasEnd = hasEnd || child->corners[k] == node->corners[1 + half];
            }
            assert_true(hasMiddle && hasApex && hasEnd);
            assert_true(child->parent == i && child->triangle == node->triangle);
        }
    }
    assert_int_equal(patches, p->patchCount);
}

static void assertPositionsDiffer(const vplPatches* p)
{
    for (int i = 0; i < p->positionCount; i++) {
        for (int k = 0; k < i; k++) {
            assert_false(isSame(p->positions[i], p->positions[k]));
        }
    }
}

static Shape looseTriangles(int count, uint64_t seed)
{
    Shape shape = {0};
    Dice dice = {seed, 0};
    for (int i = 0; i < count; i++) {
        addTriangle(&shape, rollVec(&dice, 1), rollVec(&dice, 1), rollVec(&dice, 1));
    }
    return shape;
}

TEST(NodesAreWhatTheHeaderSays, 1)
{
    Shape shapes[] = {looseTriangles(20, 7), ringSphere(5), gridBox(2)};
    for (int i = 0; i < 3; i++) {
        vplGeometry* g = geometryOf(context, &shapes[i], 0.5f, 0);
        vplPatches* p = openPatches(g, 0.3f, VPL_MAX_PATCH_ROUNDS);
        assert_true(p->patchCount > 4 * g->triangleCount);
        assert_true(p->longestEdge <= 0.3f);
        assertNodes(p);
        assertPositionsDiffer(p);
        vplPatches_Destroy(p);
        vplGeometry_Destroy(g);
        freeShape(&shapes[i]);
    }
}

// Points slightly inside a patch are found in it, and corners of the triangle in a patch that has them.
TEST(PointsAreFoundInTheirPatch, 1)
{
    Shape shape = looseTriangles(20, 8);
    vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    vplPatches* p = openPatches(g, 0.2f, VPL_MAX_PATCH_ROUNDS);
    Dice dice = {9, 0};
    for (int i = 0; i < p->patchCount; i++) {
        const int triangle = p->nodes[p->patches[i]].triangle;
        for (int k = 0; k < 8; k++) {
            vplVec3 c[3];
            cornersOf(p, i, c);
            const float a = roll(&dice, 0.01f, 0.49f), b = roll(&dice, 0.01f, 0.49f);
            const vplVec3 at =
                vplAdd(vplScale(1 - a - b, c[0]), vplAdd(vplScale(a, c[1]), vplScale(b, c[2])));
            assert_int_equal(vplPatches_Find(p, triangle, at), i);
        }
    }
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

// ---- extremes

// X093: triangles that degenerate to lines or points have no patch, also beside others, and no bisection
// makes a patch without area.
TEST(TrianglesWithoutAreaHaveNoPatch, 1)
{
    Shape shape = {0};
    const vplVec3 a = {0, 0, 0}, b = {1, 0, 0}, c = {2, 0, 0}, d = {0, 1, 0};
    addTriangle(&shape, a, b, c);
    addTriangle(&shape, a, b, d);
    addTriangle(&shape, b, b, b);
    addTriangle(&shape, a, a, d);
    vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    vplPatches* p = openPatches(g, 0.5f, VPL_MAX_PATCH_ROUNDS);
    assert_true(p->patchCount > 1);
    for (int i = 0; i < p->patchCount; i++) {
        assert_int_equal(p->nodes[p->patches[i]].triangle, 1);
        assert_true(vplPatches_Area(p, i) > 0);
    }
    for (int t = 0; t < 4; t += 1 + (t == 0)) {
        assert_true(p->nodes[t].children == -1 && p->nodes[t].patch == -1);
        assert_int_equal(vplPatches_Find(p, t, a), -1);
    }
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

static void expectFailure(const vplGeometry* g, vplPatchDef def, vplResult wanted, const char* sentence)
{
    vplPatches* untouched = (vplPatches*)&def;
    vplPatches* p = untouched;
    takeMessage();
    assert_int_equal(vplPatches_Create(g, &def, &p), wanted);
    assert_ptr_equal(p, untouched);
    assert_string_equal(takeMessage(), sentence);
}

// X098: T = 0 leaves the choice to the count; negative and non-finite T are refused; a tiny T is refused
// before memory is allocated, or ends after the last round, or where float has no midpoint.
TEST(TinyThresholdsEnd, 1, SLOW)
{
    vplGeometry* g = testModel(context, MODEL_LAB, 0.5f);
    vplPatchDef def = vplDefaultPatchDef();
    def.size = 1e-30f;
    vplContext_ResetPeakBytes(context);
    const size_t before = vplContext_GetPeakBytes(context);
    expectFailure(g, def, VPL_LIMIT,
                  "patches with edges up to 1e-30 m are more than 16777216, which are allowed");
    assert_int_equal(vplContext_GetPeakBytes(context), before);
    assert_int_equal(countOf(g, 1e-30f, 5), 30 << 5);
    def.size = -1;
    expectFailure(g, def, VPL_INVALID_ARGUMENT, "vplPatchDef.size is -1, must be finite and at least 0");
    def.size = NAN;
    expectFailure(g, def, VPL_INVALID_ARGUMENT, "vplPatchDef.size is nan, must be finite and at least 0");
    def.size = 0;
    def.count = 0;
    expectFailure(g, def, VPL_INVALID_ARGUMENT, "vplPatchDef.count is 0, must be in [1, 16777216]");
    def.count = 1;
    def.rounds = 41;
    expectFailure(g, def, VPL_INVALID_ARGUMENT, "vplPatchDef.rounds is 41, must be in [0, 40]");
    def.cookie = 0;
    expectFailure(g, def, VPL_INVALID_ARGUMENT, "vplPatchDef was not made by vplDefaultPatchDef");
    vplGeometry_Destroy(g);
}

// The triangle is a few ulps large: bisection ends at float's resolution.
TEST(EdgesEndWhereFloatDoes, 1)
{
    const float u = 0x1p-23f;
    Shape shape = {0};
    addTriangle(&shape, (vplVec3){1, 1, 1}, (vplVec3){1 + 8 * u, 1, 1}, (vplVec3){1, 1 + 8 * u, 1});
    vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    vplPatches* p = openPatches(g, 1e-20f, VPL_MAX_PATCH_ROUNDS);
    assert_true(p->patchCount >= 64);
    assert_true(p->patchCount < 1000);
    double area = 0;
    for (int i = 0; i < p->patchCount; i++) {
        assert_true(vplPatches_Area(p, i) > 0);
        area += vplPatches_Area(p, i);
    }
    assertNear(area, 32.0 * (double)u * (double)u, 1e-20, "area", 0);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

TEST(NoTrianglesGiveNoPatches, 1)
{
    Shape shape = {0};
    addTriangle(&shape, (vplVec3){0}, (vplVec3){0}, (vplVec3){0});
    vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* p;
    assert_int_equal(vplPatches_Create(g, &def, &p), VPL_SUCCESS);
    assert_int_equal(p->patchCount, 0);
    vplPatches_Destroy(p);
    vplPatches_Destroy(NULL);
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

// ---- counts

static vplPatches* byCount(const vplGeometry* g, int count)
{
    vplPatchDef def = vplDefaultPatchDef();
    vplPatches* p = NULL;
    def.count = count;
    assert_int_equal(vplPatches_Create(g, &def, &p), VPL_SUCCESS);
    return p;
}

static double longestOf(const vplPatches* p, int node)
{
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        const vplVec3 a = p->positions[p->nodes[node].corners[k]],
                      b = p->positions[p->nodes[node].corners[(k + 1) % 3]];
        longest = fmax(longest, (double)vplLength(vplSub(a, b)));
    }
    return longest;
}

// No patch has a longer edge than one that was bisected. At most 5 % of the bisections are added so that equal patches stay so:
// 770 become 784, but 465 and 600 divide patches of one length.
TEST(ACountBisectsTheLongestFirst, 1)
{
    vplGeometry* lab = testModel(context, MODEL_LAB, 0.5f);
    vplGeometry* metres = testModel(context, MODEL_METRES, 0.5f);
    static const int counts[] = {1, 30, 31, 450, 464, 465, 600, 770, 784, 785, 5000};
    static const int wanted[] = {30, 30, 31, 452, 464, 465, 600, 784, 784, 788, 5000};
    for (int i = 0; i < 11; i++) {
        vplPatches *p = byCount(lab, counts[i]), *q = byCount(metres, counts[i]);
        assertNear(p->patchCount, wanted[i], 0, "patches", counts[i]);
        assertNear(q->patchCount, p->patchCount, 0, "patches in metres", counts[i]);
        for (int n = 0; n < p->nodeCount; n++) {
            const double length = longestOf(p, n);
            assert_true(p->nodes[n].children >= 0 ? length >= (double)p->longestEdge * (1 - 0x1p-16)
                                                  : length <= (double)p->longestEdge);
        }
        vplPatches_Destroy(p);
        vplPatches_Destroy(q);
    }
    vplGeometry_Destroy(lab);
    vplGeometry_Destroy(metres);
}

TEST(ACountObeysTheRounds, 1)
{
    vplGeometry* lab = testModel(context, MODEL_LAB, 0.5f);
    vplPatchDef def = vplDefaultPatchDef();
    def.count = 5000;
    def.rounds = 2;
    vplPatches* p;
    assert_int_equal(vplPatches_Create(lab, &def, &p), VPL_SUCCESS);
    assert_int_equal(p->patchCount, 4 * lab->triangleCount);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(lab);
}

// Triangle 0 has a longest edge of exactly T and stays whole; triangle 1 has one that is longer by a last bit, and far less area. T may be
// in any unit.
TEST(EdgesAreComparedWithTToTheLastBit, 1)
{
    for (float size = 0x1p-10f; size < 2000; size *= 2) {
        const float longer = nextafterf(size, INFINITY);
        Shape shape = {0};
        addTriangle(&shape, vplVec(0, 0, 0), vplVec(size, 0, 0), vplVec(0.5f * size, 0.75f * size, 0));
        addTriangle(&shape, vplVec(0, 0, 1), vplVec(longer, 0, 1), vplVec(0.5f * size, 0.125f * size, 1));
        vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
        vplPatches* p = openPatches(g, size, VPL_MAX_PATCH_ROUNDS);
        assert_int_equal(p->patchCount, 3);
        assert_true(p->nodes[0].children < 0 && p->nodes[1].children >= 0);
        vplPatches_Destroy(p);
        vplGeometry_Destroy(g);
        freeShape(&shape);
    }
}

// ---- refining

TEST(RefiningBisectsTheLargestPrioritiesAndTheFirstOfEqualOnes, 1)
{
    vplGeometry* g = testModel(context, MODEL_LAB, 0.5f);
    vplPatches *p = openPatches(g, 125, 2), *q;
    float priorities[120] = {0};
    for (int i = 10; i < 60; i++) {
        priorities[i] = (float)(i % 5);
    }
    assert_int_equal(vplPatches_Refine(p, priorities, 133, &q), VPL_SUCCESS);
    assert_int_equal(q->patchCount, 133);
    assertNodes(q);
    assertPositionsDiffer(q);
    int bisected = 0;
    for (int i = 0; i < p->patchCount; i++) { // ten of priority 4 and the first three of priority 3
        const bool wanted = i >= 10 && i < 60 && (i % 5 == 4 || (i % 5 == 3 && i < 25));
        assert_int_equal(q->nodes[p->patches[i]].children >= 0, wanted);
        bisected += wanted;
    }
    assert_int_equal(bisected, 13);
    assert_int_equal(p->nodes[p->patches[14]].children, -1);
    vplPatches_Destroy(q);
    assert_int_equal(vplPatches_Refine(p, priorities, 1000, &q), VPL_SUCCESS); // 40 are above 0
    assert_int_equal(q->patchCount, 160);
    vplPatches_Destroy(q);
    assert_int_equal(vplPatches_Refine(p, priorities, 1, &q), VPL_SUCCESS);
    assert_int_equal(q->patchCount, 120);
    vplPatches_Destroy(q);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

// Refining all patches equals one round of a threshold. Refined patches outlive those they were made from.
TEST(RefiningEverythingIsARound, 1)
{
    vplGeometry* g = testModel(context, MODEL_LAB, 0.5f);
    float ones[960];
    for (int i = 0; i < 960; i++) {
        ones[i] = 1;
    }
    vplPatches* p = openPatches(g, 1, 0);
    for (int rounds = 1; rounds <= 5; rounds++) {
        vplPatches *next, *wanted = openPatches(g, 1, rounds);
        assert_int_equal(vplPatches_Refine(p, ones, VPL_MAX_PATCHES, &next), VPL_SUCCESS);
        vplPatches_Destroy(p);
        p = next;
        assert_int_equal(p->patchCount, 30 << rounds);
        assert_int_equal(p->positionCount, wanted->positionCount);
        for (int i = 0; i < p->patchCount; i++) {
            vplVec3 a[3], b[3];
            cornersOf(p, i, a);
            cornersOf(wanted, i, b);
            assert_memory_equal(a, b, sizeof a);
        }
        vplPatches_Destroy(wanted);
    }
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

TEST(RefiningRefusesWhatIsNoPriority, 1)
{
    vplGeometry* g = testModel(context, MODEL_LAB, 0.5f);
    vplPatches *p = openPatches(g, 1, 0), *q = p;
    float priorities[30] = {0};
    priorities[7] = NAN;
    assert_int_equal(vplPatches_Refine(p, priorities, 40, &q), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "priorities[7] is not a number");
    priorities[7] = 0;
    assert_int_equal(vplPatches_Refine(p, priorities, 0, &q), VPL_INVALID_ARGUMENT);
    assert_string_equal(takeMessage(), "count is 0, must be in [1, 16777216]");
    assert_ptr_equal(q, p);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}
