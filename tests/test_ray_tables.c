// SPDX-License-Identifier: MIT
// Tests of rays against single quads and boxes, alone and as scenes: tables of exact answers. Covers extremes X001 to X028.
#include "shapes.h"

#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/vec.h"

static const double UNIT = 0x1p-53;   // unit roundoff of the arithmetic
static const double RESULT = 0x1p-24; // unit roundoff of the results
static const double C = 1.5;          // the error constant of a plain implementation

// Compares distance and position of a hit; no coordinate in the object's frame exceeds `reach`.
static void checkHit(const Table* t, int row, const vplHit* hit, double wantedT, double ampT, double reach)
{
    const double ampP = number(t, row, "amp_p");
    assertNear((double)hit->t, wantedT, C * UNIT * ampT + RESULT * wantedT + 1e-45, "t", row);
    vplVec3 p = vectorOf(t, row, "w");
    // Hit positions are transformed by the model matrix, whose largest element scales the local error.
    double size = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            char name[4] = {'m', (char)('0' + i), (char)('0' + j), 0};
            size = fmax(size, fabs(number(t, row, name)));
        }
    }
    double tolerance = size * (reach * RESULT + 4 * C * UNIT * ampP);
    assertNear((double)hit->position.x, (double)p.x, tolerance, "px", row);
    assertNear((double)hit->position.y, (double)p.y, tolerance, "py", row);
    assertNear((double)hit->position.z, (double)p.z, tolerance, "pz", row);
}

static void checkNormal(const Table* t, int row, const vplHit* hit)
{
    vplVec3 n = vectorOf(t, row, "n");
    assertNear((double)vplLength(vplSub(hit->normal, n)), 0, 3e-7, "normal", row);
}

// The determinant of the inverse, times the table's: 1.
static double inverseTimesDet(const Table* t, int row, const vplPlacement* p)
{
    double cross[3];
    vplCross3(p->toLocal[1], p->toLocal[2], cross);
    return vplDot3(p->toLocal[0], cross) * number(t, row, "det");
}

// Fails where rounding by C units cannot explain the other verdict.
static void allowFlip(const Table* t, int row, bool found)
{
    const double amp = fmax(isEmpty(t, row, "amp_p") ? 0 : number(t, row, "amp_p"), number(t, row, "amp_t"));
    if (number(t, row, "exactarith") == 1 || number(t, row, "margin") >= C * UNIT * amp) {
        fail_msg("row %d (%s, %s): %s, wanted %s", row, cell(t, row, "cat"), cell(t, row, "xform"),
                 found ? "hit" : "miss", cell(t, row, "status"));
    }
}

// Shoots the ray of a row, its direction `faster` times as long and reversed where that is negative, at a quad that is
// `larger` times as large, and compares all that follows from t: position, normal, and the place in the quad's own frame.
static void compareQuadHit(vplContext* context, const Table* t, int row, float faster, float larger)
{
    vplMat4 m = matrixOf(t, row);
    for (int i = 0; i < 8; i++) {
        m.m[i] *= larger; // the quad's two sides
    }
    vplPlacement placement;
    assert_int_equal(vplPlacement_Create(context, &m, &placement), VPL_SUCCESS);
    const vplRay ray = {vectorOf(t, row, "o"), vplScale(faster, vectorOf(t, row, "d")), {0, 0}};
    vplHit hit;
    assert_true(vplRay_HitQuad(&ray, &placement, &hit));
    const double times = (double)faster,
                 reach = fmax(1, fmax(fabs(number(t, row, "lx")), fabs(number(t, row, "ly"))));
    checkHit(t, row, &hit, number(t, row, "t") / times, number(t, row, "amp_t") / fabs(times), reach);
    checkNormal(t, row, &hit);
    const double slack = reach * RESULT + C * UNIT * number(t, row, "amp_p");
    assertNear((double)(hit.u * larger), number(t, row, "lx"), slack, "lx", row);
    assertNear((double)(hit.v * larger), number(t, row, "ly"), slack, "ly", row);
    assert_true(number(t, row, "ndotd_sign") * times * (double)vplDot(hit.normal, ray.direction) > 0);
}

// How the rows of ray_quad.csv were compared.
typedef struct QuadRows {
    int hits, behind, outside, overflows, started, parallel, singular;
} QuadRows;

// Compares the numbers of a row, also where there is no hit: then another ray or quad has the same. Behind the origin the
// reversed ray hits (three rows: outside, too); outside of the quad the plane is met where a quad of 8 times its size is hit; and where t exceeds
// float's range (X017), a direction 2^60 times as long is in it. A ray that starts on the quad has t = 0, and leaves
// nothing to see; rays in the plane and parallel to it have no numbers.
static void compareQuadRow(vplContext* context, const Table* t, int row, QuadRows* rows)
{
    const char* status = cell(t, row, "status");
    if (strcmp(cell(t, row, "cat"), "t_overflows_float") == 0) {
        compareQuadHit(context, t, row, 0x1p60f, 1);
        rows->overflows++;
    } else if (strcmp(status, "hit") == 0) {
        compareQuadHit(context, t, row, 1, 1);
        rows->hits++;
    } else if (strcmp(status, "outside") == 0) {
        compareQuadHit(context, t, row, 1, 8);
        rows->outside++;
    } else if (strcmp(status, "behind") == 0 && number(t, row, "t") == 0) {
        rows->started++;
    } else if (strcmp(status, "behind") == 0) {
        compareQuadHit(context, t, row, -1, number(t, row, "margin") < 0 ? 8 : 1);
        rows->behind++;
    } else {
        assert_true(isEmpty(t, row, "t") && isEmpty(t, row, "lx") && isEmpty(t, row, "wx"));
        rows->parallel++;
    }
}

// Places the object of a row; false if its matrix is singular, which must be refused.
static bool placeRow(vplContext* context, const Table* t, int row, vplPlacement* placementOut)
{
    const vplMat4 m = matrixOf(t, row);
    const bool singular = strcmp(cell(t, row, "status"), "singular") == 0;
    assert_int_equal(vplPlacement_Create(context, &m, placementOut),
                     singular ? VPL_INVALID_ARGUMENT : VPL_SUCCESS);
    if (!singular) {
        assertNear(inverseTimesDet(t, row, placementOut), 1, 5e-8, "det", row);
    }
    return !singular;
}

// X001, X004, X006, X007, X009, X010, X011, X013, X014, X015, X016, X018, X019
// Where float cannot hold t, the documented result is a miss (X017).
TEST(EveryRayQuadVerdictOfTheTable, 1)
{
    Table t = loadTable("ray_quad.csv");
    QuadRows rows = {0};
    for (int row = 0; row < t.rows; row++) {
        vplPlacement placement;
        if (!placeRow(context, &t, row, &placement)) {
            rows.singular++;
            continue;
        }
        const vplRay ray = {vectorOf(&t, row, "o"), vectorOf(&t, row, "d"), {0, 0}};
        vplHit hit;
        const bool wanted = strcmp(cell(&t, row, "status"), "hit") == 0 &&
                            strcmp(cell(&t, row, "cat"), "t_overflows_float") != 0;
        assert_true(vplRay_HitQuad(&ray, &placement, &hit) == wanted); // rounding flips none
        compareQuadRow(context, &t, row, &rows);
    }
    assert_int_equal(rows.hits, 208);
    assert_int_equal(rows.behind, 48);
    assert_int_equal(rows.outside, 65);
    assert_int_equal(rows.overflows, 2);
    assert_int_equal(rows.started, 1);
    assert_int_equal(rows.parallel, 6);
    assert_int_equal(rows.singular, 7);
    assert_int_equal(t.rows, 208 + 48 + 65 + 2 + 1 + 6 + 7);
    freeTable(&t);
}

// X002, X004, X005, X006, X020, X021, X022, X023, X024, X025, X026, X027, X028
// All columns but a and b (the box's entry and exit: t_strict is the one of them that is hit) and t_doc, the
// printed rule, from which vplRay_HitBox departs.
TEST(EveryRayBoxVerdictOfTheTable, 1)
{
    Table t = loadTable("ray_box.csv");
    int singular = 0, hits = 0, misses = 0;
    for (int row = 0; row < t.rows; row++) {
        vplPlacement placement;
        if (!placeRow(context, &t, row, &placement)) {
            singular++;
            continue;
        }
        vplRay ray = {vectorOf(&t, row, "o"), vectorOf(&t, row, "d"), {0, 0}};
        vplHit hit;
        bool found = vplRay_HitBox(&ray, &placement, VPL_FACE_NONE, &hit);
        if (found == isEmpty(&t, row, "t_strict")) {
            allowFlip(&t, row, found);
        } else if (found) {
            int mask = (int)number(&t, row, "face_mask");
            if ((mask >> hit.face & 1) == 0 &&
                number(&t, row, "margin") >= C * UNIT * number(&t, row, "amp_p")) {
                fail_msg("row %d: face %d, wanted one of mask %d", row, hit.face, mask);
            }
            checkHit(&t, row, &hit, number(&t, row, "t_strict"), number(&t, row, "amp_t"), 1);
            if (hit.face == (int)number(&t, row, "face")) { // the normal of another face in the mask is right
                checkNormal(&t, row, &hit);
            } else {
                assert_true((mask & (mask - 1)) != 0);
            }
            hits++;
        } else {
            misses++;
        }
    }
    assert_int_equal(hits + misses + singular, t.rows);
    freeTable(&t);
}

// ---- rays through a scene

// Compares the scene's hit with the formula's, for one ray and all ways to ask.
static void compareHits(const vplGeometry* g, const vplRay* ray, int row)
{
    const vplGeometryObject* object = &g->objects[0];
    vplHit wanted, hit;
    const bool found = object->type == VPL_OBJECT_QUAD
                           ? vplRay_HitQuad(ray, &object->placement, &wanted)
                           : vplRay_HitBox(ray, &object->placement, VPL_FACE_NONE, &wanted);
    vplRayPacket packet = {.active = 0};
    vplRayPacket_Set(&packet, row % VPL_RAY_PACKET, ray);
    if (vplGeometry_ClosestHit(g, ray, &hit) != found || vplGeometry_IsOccluded(g, ray, INFINITY) != found ||
        (vplGeometry_AreOccluded(g, &packet, INFINITY) != 0) != found) {
        fail_msg("row %d, length 2^%d: the formula %s", row, ilogbf(vplLargestOf(ray->direction)),
                 found ? "hits" : "misses");
    }
    if (found) {
        assert_true(hit.t == wanted.t && hit.face == wanted.face && hit.object == 0);
        assert_int_equal(vplGeometry_FaceOf(g, hit.triangle), hit.face);
        assert_memory_equal(&hit.position, &wanted.position, sizeof hit.position);
        assert_memory_equal(&hit.normal, &wanted.normal, sizeof hit.normal);
        assert_false(vplGeometry_IsOccluded(g, ray, 0.999f * wanted.t));
        const vplRay leaving = {ray->origin, ray->direction, {0, g->triangleCount}};
        assert_false(vplGeometry_ClosestHit(g, &leaving, &hit));
    }
}

// X007, X016, X028: of all rays of both tables, with directions of any length.
TEST(ASceneAnswersAsTheFormulasOfItsQuadsAndBoxes, 1)
{
    static const char* const tables[] = {"ray_quad.csv", "ray_box.csv"};
    static const int exponents[] = {0, -120, -140, -70, -40, 40, 100};
    int rows = 0, byFormula = 0;
    for (int type = 0; type < 2; type++) {
        Table t = loadTable(tables[type]);
        for (int row = 0; row < t.rows; row++) {
            vplScene* scene = sceneOf(context, 0.5f);
            vplObjectDef def = vplDefaultObjectDef();
            def.type = (vplObjectType)type;
            def.transform = matrixOf(&t, row);
            const bool singular = strcmp(cell(&t, row, "status"), "singular") == 0;
            assert_int_equal(vplScene_AddObject(scene, &def, NULL),
                             singular ? VPL_INVALID_ARGUMENT : VPL_SUCCESS);
            vplGeometry* g = buildGeometry(scene);
            byFormula += g->formulaCount;
            for (int i = 0; i < (singular ? 0 : 14); i++) {
                vplVec3 d = vectorOf(&t, row, "d");
                const bool unscaled = i < 2 || vplLargestOf(d) == 0;
                const int shift = unscaled ? 0 : exponents[i / 2] - ilogbf(vplLargestOf(d));
                d = vplVec(ldexpf(d.x, shift), ldexpf(d.y, shift), ldexpf(d.z, shift));
                const vplRay ray = {vectorOf(&t, row, "o"), d, {0, 0}};
                if (i >= 10 && strstr("hand_tiny_t hand_denormal_t", cell(&t, row, "cat")) != NULL) {
                    continue; // t underflows
                }
                struct vplBvh* tree = g->rayTree;
                g->rayTree = i & 1 ? NULL : tree;
                compareHits(g, &ray, row);
                g->rayTree = tree;
            }
            rows++;
            vplGeometry_Destroy(g);
        }
        freeTable(&t);
    }
    assert_int_equal(rows, 690);
    assert_int_equal(byFormula, 107);
}
