// SPDX-License-Identifier: MIT
// Which sides of patches light reaches, and where (X101).
#include "patch_model.h"

#include "base/hash.h"
#include "math/vec.h"
#include "radiosity/cells.h"

#include <stdlib.h>

static const vplVec3 NEAR_CEILING = {2.775f, 5.4f, 2.775f};

// ---- what is built here

static void addFlat(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c, vplVec3 d)
{
    addTriangle(shape, a, b, c);
    addTriangle(shape, a, c, d);
}

// The box from low to high; fronts inside where `inward`.
static void addBox(Shape* shape, vplVec3 low, vplVec3 high, bool inward)
{
    static const int8_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    vplVec3 p[8];
    for (int i = 0; i < 8; i++) {
        p[i] = vplVec(i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z);
    }
    for (int f = 0; f < 6; f++) {
        const int8_t* c = faces[f];
        addFlat(shape, p[c[0]], p[c[inward ? 3 : 1]], p[c[2]], p[c[inward ? 1 : 3]]);
    }
}

// A floor [-2, 2]^2 at y = 0, its front up.
static void addFloor(Shape* shape)
{
    addFlat(shape, vplVec(-2, 0, -2), vplVec(-2, 0, 2), vplVec(2, 0, 2), vplVec(2, 0, -2));
}

typedef struct Case {
    vplContext* context;
    vplGeometry* geometry;
    vplPatches* patches;
    vplPatchSides* sides;
} Case;

// Frees the shape.
static Case openCase(Shape* shape, float size, const vplVec3* lamp)
{
    Case c = {.context = openTestContext(2)};
    c.geometry = geometryOf(c.context, shape, 0.5f, 0);
    c.patches = openPatches(c.geometry, size, VPL_MAX_PATCH_ROUNDS);
    c.sides = sidesOf(c.patches, lamp);
    freeShape(shape);
    return c;
}

static void closeCase(Case* c)
{
    vplPatchSides_Destroy(c->sides);
    vplPatches_Destroy(c->patches);
    vplGeometry_Destroy(c->geometry);
    closeTestContext(c->context);
}

static int triangleOf(const vplPatches* p, int patch)
{
    return p->nodes[p->patches[patch]].triangle;
}

// Sides among triangles first .. first + count - 1, front or back; the number of patches there in *patchesOut.
static int countSides(const vplPatchSides* s, int first, int count, bool back, int* patchesOut)
{
    int sides = 0, patches = 0;
    for (int i = 0; i < s->patches->patchCount; i++) {
        const int triangle = triangleOf(s->patches, i);
        if (triangle >= first && triangle < first + count) {
            patches++;
            sides += s->ofPatch[2 * i + back] >= 0;
        }
    }
    *patchesOut = patches;
    return sides;
}

static void assertAll(const vplPatchSides* s, int first, int count, bool back)
{
    int patches;
    const int sides = countSides(s, first, count, back, &patches);
    assert_int_equal(sides, patches);
    assert_true(patches > 0);
}

static void assertNone(const vplPatchSides* s, int first, int count, bool back)
{
    int patches;
    assert_int_equal(countSides(s, first, count, back, &patches), 0);
    assert_true(patches > 0);
}

// ---- cells

static vplPatchSide sideOf(vplVec3 a, vplVec3 b, vplVec3 c)
{
    return (vplPatchSide){.open = 0xffff, .corners = {a, b, c}};
}

// Sixteen triangles that tile theirs: points of a cell are found in it again, their mean is where its centre is, and the
// means of all cells have the patch's.
TEST_ALONE(CellsTileThePatch)
{
    const vplPatchSide s = sideOf(vplVec(1, 2, 3), vplVec(4, 2, 1), vplVec(0, 5, 2));
    double total[3] = {0};
    for (int k = 0; k < VPL_PATCH_CELLS; k++) {
        double mean[3] = {0};
        for (int i = 0; i < 32 * 32; i++) {
            const float u = ((float)(i % 32) + 0.5f) / 32, v = ((float)(i / 32) + 0.5f) / 32;
            const vplVec3 p = vplPatchSide_SampleCell(&s, k, u, v);
            assert_int_equal(vplCell_Find(s.corners, p), k);
            for (int axis = 0; axis < 3; axis++) {
                mean[axis] += (double)vplComponent(p, axis) / 1024;
            }
        }
        for (int axis = 0; axis < 3; axis++) {
            total[axis] += mean[axis] / VPL_PATCH_CELLS;
        }
    }
    for (int axis = 0; axis < 3; axis++) {
        const double centre = (double)vplComponent(s.corners[0], axis) +
                              (double)vplComponent(s.corners[1], axis) +
                              (double)vplComponent(s.corners[2], axis);
        assertNear(total[axis], centre / 3, 1e-3, "mean", axis);
    }
}

// Cell 0 is at corner 0, 5 at corner 1, 10 at corner 2, 15 in the middle; extreme u and v stay within.
TEST_ALONE(CellsAreInTheStatedOrder)
{
    const vplPatchSide s = sideOf(vplVec(0, 0, 0), vplVec(4, 0, 0), vplVec(0, 4, 0));
    const float ends[2] = {0, 1 - 0x1p-24f};
    for (int i = 0; i < 4; i++) {
        const vplVec3 first = vplPatchSide_SampleCell(&s, 0, ends[i & 1], ends[i >> 1]),
                      second = vplPatchSide_SampleCell(&s, 5, ends[i & 1], ends[i >> 1]),
                      third = vplPatchSide_SampleCell(&s, 10, ends[i & 1], ends[i >> 1]),
                      middle = vplPatchSide_SampleCell(&s, 15, ends[i & 1], ends[i >> 1]);
        assert_true(first.x >= 0 && first.y >= 0 && first.x + first.y <= 1);
        assert_true(second.x >= 3 && second.y >= 0 && second.x + second.y <= 4);
        assert_true(third.x >= 0 && third.y >= 3 && third.x + third.y <= 4);
        assert_true(middle.x >= 1 && middle.y >= 1 && middle.x + middle.y <= 3);
    }
}

// ---- the report's box

// How much of a cell stands under a block, from 16 x 16 points: blocks are the model's triangles whose fronts look up.
static double coveredShare(const vplPatchSide* s, int cell, const vplGeometry* g)
{
    int covered = 0;
    for (int i = 0; i < 256; i++) {
        const vplVec3 p =
            vplPatchSide_SampleCell(s, cell, ((float)(i % 16) + 0.5f) / 16, ((float)(i / 16) + 0.5f) / 16);
        const vplRay up = {vplVec(p.x, 1, p.z), vplVec(0, 1, 0), {0, 0}};
        vplHit hit;
        covered +=
            vplGeometry_ClosestHit(g, &up, &hit) && hit.position.y < 5; // a block's top, not the ceiling
    }
    return covered / 256.0;
}

// Fronts of all 784 patches but for those of the floor that a block stands on; no backs, and no cell that a block
// covers whole. Cells of which most is free are open, and of those alone.
TEST(TheReportsBoxHasItsFrontsButUnderBlocks, 2)
{
    vplGeometry* g = testModel(context, MODEL_METRES, 0.5f);
    vplPatches* p = openPatches(g, 1.25f, VPL_MAX_PATCH_ROUNDS);
    vplPatchSides* s = sidesOf(p, &NEAR_CEILING);
    int covered = 0, partly = 0, more = 0;
    assert_int_equal(p->patchCount, 784);
    for (int i = 0; i < p->patchCount; i++) {
        const int front = s->ofPatch[2 * i];
        assert_int_equal(s->ofPatch[2 * i + 1], -1);
        if (triangleOf(p, i) >= 2) {
            assert_true(front >= 0 && s->sides[front].open == 0xffff);
            continue;
        }
        vplPatchSide whole = {.patch = i};
        vplSide_GetCorners(p, i, false, whole.corners);
        const unsigned open = front >= 0 ? s->sides[front].open : 0;
        bool dark = true;
        for (int k = 0; k < VPL_PATCH_CELLS; k++) {
            const double share = coveredShare(&whole, k, g);
            if (share < 0.2 || share >= 1) {
                assert_int_equal(open >> k & 1, share < 1);
            }
            dark = dark && share >= 1;
            more += share > 0.2 && share < 1 && (open >> k & 1) != (share < 0.5);
        }
        assert_int_equal(front < 0, dark);
        covered += dark;
        partly += front >= 0 && open != 0xffff;
    }
    assert_true(more <= 10); // 8 points tell halves of most of about a hundred cells
    assert_int_equal(covered, 7);
    assert_true(partly >= 25);
    assert_int_equal(s->count, 777);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
}

static void assertSide(const vplPatchSides* s, int index)
{
    const vplPatchSide* side = &s->sides[index];
    const vplVec3 *c = side->corners, n = vplNormalize(vplCross(vplSub(c[1], c[0]), vplSub(c[2], c[0])));
    assert_int_equal(s->ofPatch[2 * side->patch + side->back], index);
    assert_true(vplDot(n, side->normal) > 0.9999f);
    assert_true(side->open != 0);
    assertNear((double)side->area,
               vplPatches_Area(s->patches, side->patch) * __builtin_popcount(side->open) / VPL_PATCH_CELLS,
               1e-6, "area", index);
    double distances[3];
    for (int k = 0; k < 3; k++) { // from the edges
        const vplVec3 edge = vplNormalize(vplSub(c[(k + 1) % 3], c[k]));
        distances[k] = (double)vplDot(vplCross(edge, vplSub(side->incentre, c[k])), side->normal);
    }
    assert_true(distances[0] > 0);
    assertNear(distances[1], distances[0], 2e-6, "incentre", index);
    assertNear(distances[2], distances[0], 2e-6, "incentre", index);
}

TEST(SidesAreWhatTheHeaderSays, 2)
{
    vplScene* scene;
    vplGeometry* g;
    assert_int_equal(vplScene_Load(context, "examples/scenes/room-area.json", &scene), VPL_SUCCESS);
    assert_int_equal(vplGeometry_Create(scene, &g), VPL_SUCCESS);
    vplPatches* p = openPatches(g, 0.8f, VPL_MAX_PATCH_ROUNDS);
    vplPatchSides* s = sidesOf(p, NULL);
    double emitted = 0;
    int before = -1;
    for (int i = 0; i < s->count; i++) {
        const vplPatchSide* side = &s->sides[i];
        assertSide(s, i);
        assert_true(2 * side->patch + side->back > before);
        before = 2 * side->patch + side->back;
        assert_true(!side->back || side->emission.r == 0);
        emitted += (double)side->area * (double)side->emission.g;
    }
    vplEmission* e;
    assert_int_equal(vplEmission_Create(g, NULL, 0, &e), VPL_SUCCESS);
    double wanted = 0;
    for (int i = 0; i < e->sourceCount; i++) {
        wanted += (double)e->sources[i].power.g;
    }
    assertNear(emitted, wanted, 1e-5 * wanted, "power", 0);
    vplEmission_Destroy(e);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    vplScene_Destroy(scene);
}

// ---- what light does not reach

// A crate on a floor: triangles 0 and 1 are the floor's, 2 to 13 the crate's. Its inside is dark, and so is what it
// stands on: open cells make up the floor less its base, but for those that it covers in part.
TEST_ALONE(TheInsideOfACrateAndTheFloorUnderItAreDark)
{
    for (int sunk = 0; sunk < 3; sunk++) { // on the floor, into it, and a hair above
        Shape shape = {0};
        addFloor(&shape);
        const float bottom = sunk == 0 ? 0 : sunk == 1 ? -0.1f : 1e-5f;
        addBox(&shape, vplVec(-0.9f, bottom, -0.7f), vplVec(0.8f, 1, 0.9f), false);
        Case c = openCase(&shape, 0.5f, &(vplVec3){1, 3, 1});
        double area = 0;
        assertNone(c.sides, 2, 12, true);
        assertNone(c.sides, 0, 2, true);
        for (int i = 0; i < c.sides->count; i++) {
            area += triangleOf(c.patches, c.sides->sides[i].patch) < 2 ? (double)c.sides->sides[i].area : 0;
        }
        assertNear(area, 16 - 1.7 * 1.6, 0.35, "open floor", sunk); // a cell is 0.009, 76 of them are in part
        closeCase(&c);
    }
}

// Twenty seeds and other sizes: rounding lets no light through a wall.
TEST(NoSeedLightsTheBackOfAWall, 2, SLOW)
{
    vplGeometry* g = testModel(context, MODEL_METRES, 0.5f);
    for (uint64_t seed = 0; seed < 20; seed++) {
        vplPatches* p = openPatches(g, 2.0f - 0.07f * (float)seed, VPL_MAX_PATCH_ROUNDS);
        vplPatchSidesDef def = vplDefaultPatchSidesDef();
        vplEmitterDef lamp = vplDefaultEmitterDef();
        vplPatchSides* s;
        int patches;
        lamp.position = NEAR_CEILING;
        def.emitters = &lamp;
        def.emitterCount = 1;
        def.seed = seed;
        assert_int_equal(vplPatchSides_Create(p, &def, &s), VPL_SUCCESS);
        assertNone(s, 0, 30, true);
        assertAll(s, 2, 28, false);
        const int lit = countSides(s, 0, 2, false, &patches);
        assert_true(lit > patches * 8 / 10);
        vplPatchSides_Destroy(s);
        vplPatches_Destroy(p);
    }
    vplGeometry_Destroy(g);
}

// Two closed rooms beside each other, a lamp in one.
TEST_ALONE(ARoomWithoutALampTakesNoPart)
{
    Shape shape = {0};
    addBox(&shape, vplVec(0, 0, 0), vplVec(2, 2, 2), true);
    addBox(&shape, vplVec(2, 0, 0), vplVec(4, 2, 2), true);
    Case c = openCase(&shape, 0.7f, &(vplVec3){1, 1.5f, 1});
    assertAll(c.sides, 0, 12, false);
    assertNone(c.sides, 12, 12, false);
    assertNone(c.sides, 12, 12, true);
    closeCase(&c);
}

TEST_ALONE(WithoutLightThereAreNoSides)
{
    Shape shape = {0};
    addBox(&shape, vplVec(0, 0, 0), vplVec(2, 2, 2), true);
    Case c = openCase(&shape, 1, NULL);
    assert_int_equal(c.sides->count, 0);
    for (int i = 0; i < 2 * c.patches->patchCount; i++) {
        assert_int_equal(c.sides->ofPatch[i], -1);
    }
    closeCase(&c);
}

// What an eye sees takes part, dark as it is.
TEST_ALONE(WhatAnEyeSeesTakesPart)
{
    Shape shape = {0};
    addBox(&shape, vplVec(0, 0, 0), vplVec(2, 2, 2), true);
    addBox(&shape, vplVec(3, 0, 0), vplVec(5, 2, 2), true);
    Case c = openCase(&shape, 1, NULL);
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    const vplVec3 eye = {1, 1, 1};
    vplPatchSides* s;
    def.eyes = &eye;
    def.eyeCount = 1;
    assert_int_equal(vplPatchSides_Create(c.patches, &def, &s), VPL_SUCCESS);
    assertAll(s, 0, 12, false);
    assertNone(s, 0, 12, true);
    assertNone(s, 12, 12, false);
    assertNone(s, 12, 12, true);
    vplPatchSides_Destroy(s);
    closeCase(&c);
}

// ---- what it reaches

TEST_ALONE(OneTriangleHasTheSideThatFacesTheLamp)
{
    for (int back = 0; back < 2; back++) {
        Shape shape = {0};
        addTriangle(&shape, vplVec(0, 0, 0), vplVec(1, 0, 0), vplVec(0, 1, 0));
        Case c = openCase(&shape, 10, &(vplVec3){0.3f, 0.3f, back ? -1.0f : 1.0f});
        assert_int_equal(c.sides->count, 1);
        assert_int_equal(c.sides->sides[0].back, back);
        assert_int_equal(c.sides->sides[0].open, 0xffff);
        assertSide(c.sides, 0);
        closeCase(&c);
    }
}

TEST(ALampAloneIsASide, 1)
{
    Shape shape = {0};
    addTriangle(&shape, vplVec(0, 0, 0), vplVec(1, 0, 0), vplVec(0, 1, 0));
    vplGeometry* g = geometryOf(context, &shape, 0, 2);
    vplPatches* p = openPatches(g, 0.5f, VPL_MAX_PATCH_ROUNDS);
    vplPatchSides* s = sidesOf(p, NULL);
    assert_true(p->patchCount > 1);
    assertAll(s, 0, 1, false);
    assertNone(s, 0, 1, true);
    for (int i = 0; i < s->count; i++) {
        assert_int_equal(s->sides[i].open, 0xffff);
        assertNear((double)s->sides[i].emission.r, 2 * VPL_PI, 1e-6, "emission", i);
    }
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

// A curtain that hangs in a lit room: light on one side, and from the walls on the other.
TEST_ALONE(ACurtainHasBothSides)
{
    Shape shape = {0};
    addBox(&shape, vplVec(0, 0, 0), vplVec(2, 2, 2), true);
    addFlat(&shape, vplVec(0.4f, 0.3f, 1), vplVec(1.6f, 0.3f, 1), vplVec(1.6f, 1.7f, 1),
            vplVec(0.4f, 1.7f, 1));
    Case c = openCase(&shape, 0.7f, &(vplVec3){1, 1, 1.8f});
    assertAll(c.sides, 12, 2, false);
    assertAll(c.sides, 12, 2, true);
    assertAll(c.sides, 0, 12, false);
    assertNone(c.sides, 0, 12, true);
    closeCase(&c);
}

// Of triangles in one place rays meet the first: it has the light of both sides, the other has none.
TEST_ALONE(OfTwoTrianglesInOnePlaceTheFirstHasTheLight)
{
    for (int turned = 0; turned < 2; turned++) {
        Shape shape = {0};
        addFloor(&shape);
        if (turned) {
            addFlat(&shape, vplVec(-2, 0, -2), vplVec(2, 0, -2), vplVec(2, 0, 2), vplVec(-2, 0, 2));
        } else {
            addFloor(&shape);
        }
        Case c = openCase(&shape, 1, &(vplVec3){0.3f, 2, 0.1f});
        assertAll(c.sides, 0, 2, false);
        assertNone(c.sides, 0, 2, true);
        assertNone(c.sides, 2, 2, false);
        assertNone(c.sides, 2, 2, true);
        closeCase(&c);
    }
}

// Five rooms in a row with doors a tenth of the wall, which do not face each other; the lamp is in the first. All walls
// of all rooms are met, at few patches and at many.
TEST_ALONE(LightGoesThroughDoorsToTheLastRoom)
{
    for (int fine = 0; fine < 2; fine++) {
        Shape shape = {0};
        addBox(&shape, vplVec(0, 0, 0), vplVec(20, 4, 4), true);
        for (int wall = 1; wall < 5; wall++) {
            const float x = 4 * (float)wall, low = wall & 1 ? 0 : 0.8f, high = wall & 1 ? 3.2f : 4;
            const float gapLow = wall & 1 ? high : 0, gapHigh = wall & 1 ? 4 : low;
            addFlat(&shape, vplVec(x, 0, low), vplVec(x, 4, low), vplVec(x, 4, high), vplVec(x, 0, high));
            addFlat(&shape, vplVec(x, 2, gapLow), vplVec(x, 4, gapLow), vplVec(x, 4, gapHigh),
                    vplVec(x, 2, gapHigh));
        }
        Case c = openCase(&shape, fine ? 0.4f : 3, &(vplVec3){1, 2, 2});
        assertAll(c.sides, 0, 12, false);
        assertNone(c.sides, 0, 12, true);
        assertAll(c.sides, 12, 16, false);
        assertAll(c.sides, 12, 16, true);
        for (int i = 0; i < c.sides->count; i++) {
            assert_int_equal(c.sides->sides[i].open, 0xffff);
        }
        closeCase(&c);
    }
}

// A lamp of a millionth of another's power, alone in its room, and the only one of a hundred triangles.
TEST(AWeakLampLightsItsRoom, 1)
{
    Shape shape = {0};
    addBox(&shape, vplVec(0, 0, 0), vplVec(2, 2, 2), true);
    addBox(&shape, vplVec(3, 0, 0), vplVec(5, 2, 2), true);
    vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    vplPatches* p = openPatches(g, 0.7f, VPL_MAX_PATCH_ROUNDS);
    vplEmitterDef lamps[2] = {vplDefaultEmitterDef(), vplDefaultEmitterDef()};
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplPatchSides* s;
    lamps[0].position = vplVec(1, 1, 1);
    lamps[1].position = vplVec(4, 1, 1);
    lamps[1].intensity = (vplRgb){1e-6f, 0, 0};
    def.emitters = lamps;
    def.emitterCount = 2;
    assert_int_equal(vplPatchSides_Create(p, &def, &s), VPL_SUCCESS);
    assertAll(s, 0, 24, false);
    assertNone(s, 0, 24, true);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

// A poster half a millimetre off the wall (triangles 0 and 1) covers it; the wall around it is light.
TEST_ALONE(APosterCoversItsWall)
{
    Shape shape = {0};
    addFloor(&shape);
    addFlat(&shape, vplVec(-1, 5e-4f, -1), vplVec(-1, 5e-4f, 1), vplVec(1, 5e-4f, 1), vplVec(1, 5e-4f, -1));
    Case c = openCase(&shape, 1, &(vplVec3){0.3f, 2, 0.1f});
    double area = 0;
    for (int i = 0; i < c.sides->count; i++) {
        area += triangleOf(c.patches, c.sides->sides[i].patch) < 2 ? (double)c.sides->sides[i].area : 0;
    }
    assertNear(area, 12, 1e-5, "wall", 0);
    assertAll(c.sides, 2, 2, false);
    assertNone(c.sides, 2, 2, true);
    closeCase(&c);
}

// ---- the rest

// `whole`: of each triangle that light reaches, all patches on that side, none of them in part.
TEST_ALONE(WholeSidesAreThoseOfWholeTriangles)
{
    Shape shape = {0};
    addFloor(&shape);
    addBox(&shape, vplVec(-0.9f, 0, -0.7f), vplVec(0.8f, 1, 0.9f), false);
    Case c = openCase(&shape, 0.5f, &(vplVec3){1, 3, 1});
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplEmitterDef lamp = vplDefaultEmitterDef();
    vplPatchSides* s;
    lamp.position = vplVec(1, 3, 1);
    def.emitters = &lamp;
    def.emitterCount = 1;
    def.whole = true;
    assert_int_equal(vplPatchSides_Create(c.patches, &def, &s), VPL_SUCCESS);
    assert_true(s->count > c.sides->count); // what is under the box
    for (int i = 0; i < 2 * c.patches->patchCount; i++) {
        bool reached = false;
        for (int k = 0; k < 2 * c.patches->patchCount; k++) {
            const bool same = k % 2 == i % 2 && c.patches->nodes[c.patches->patches[k / 2]].triangle ==
                                                    c.patches->nodes[c.patches->patches[i / 2]].triangle;
            reached = reached || (same && c.sides->ofPatch[k] >= 0);
        }
        assert_true((s->ofPatch[i] >= 0) == reached);
    }
    for (int i = 0; i < s->count; i++) {
        assert_int_equal(s->sides[i].open, 0xffff);
        assertSide(s, i);
    }
    vplPatchSides_Destroy(s);
    closeCase(&c);
}

static uint64_t hashOfModel(vplContext* context)
{
    vplGeometry* g = testModel(context, MODEL_METRES, 0.5f);
    vplPatches* p = openPatches(g, 0.8f, VPL_MAX_PATCH_ROUNDS);
    vplPatchSides* s = sidesOf(p, &NEAR_CEILING);
    uint64_t hash = vplHashFloats(0, &p->positions[0].x, 3 * (size_t)p->positionCount);
    for (int i = 0; i < s->count; i++) {
        const uint32_t words[] = {(uint32_t)s->sides[i].patch, s->sides[i].back, s->sides[i].open};
        hash = vplHashWords(hash, words, 3);
        hash = vplHashFloats(hash, &s->sides[i].area, 1);
        hash = vplHashFloats(hash, &s->sides[i].incentre.x, 3);
    }
    hash = vplHashWords(hash, (const uint32_t[]){(uint32_t)s->rays}, 1);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    closeTestContext(context);
    return hash;
}

TEST_ALONE(SidesAreTheSameEverywhere)
{
    assertSameEverywhere(hashOfModel);
}

static void expectFailure(const vplPatches* p, vplPatchSidesDef def, vplResult wanted, const char* sentence)
{
    vplPatchSides* untouched = (vplPatchSides*)&def;
    vplPatchSides* s = untouched;
    takeMessage();
    assert_int_equal(vplPatchSides_Create(p, &def, &s), wanted);
    assert_ptr_equal(s, untouched);
    assert_string_equal(takeMessage(), sentence);
}

TEST_ALONE(WrongDefsAreRefused)
{
    Shape shape = {0};
    addFloor(&shape);
    Case c = openCase(&shape, 1, NULL);
    const vplVec3 eyes[2] = {{0, 0, 0}, {0, NAN, 0}};
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    def.emitterCount = 2;
    expectFailure(c.patches, def, VPL_INVALID_ARGUMENT,
                  "vplPatchSidesDef.emitterCount is 2, must be at least 0, and 0 where emitters is NULL");
    def = vplDefaultPatchSidesDef();
    def.eyeCount = -1;
    expectFailure(c.patches, def, VPL_INVALID_ARGUMENT,
                  "vplPatchSidesDef.eyeCount is -1, must be at least 0, and 0 where eyes is NULL");
    def.eyes = eyes;
    def.eyeCount = 2;
    expectFailure(c.patches, def, VPL_INVALID_ARGUMENT, "vplPatchSidesDef.eyes[1] is not finite");
    def.cookie = 0;
    expectFailure(c.patches, def, VPL_INVALID_ARGUMENT,
                  "vplPatchSidesDef was not made by vplDefaultPatchSidesDef");
    vplPatchSides_Destroy(NULL);
    closeCase(&c);
}

TEST_ALONE(ARefusedProgressCancels)
{
    Shape shape = {0};
    addFloor(&shape);
    Case c = openCase(&shape, 0.2f, NULL);
    vplEmitterDef lamp = vplDefaultEmitterDef();
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    int asked = 0;
    lamp.position = vplVec(0, 2, 0);
    def.emitters = &lamp;
    def.emitterCount = 1;
    def.progress = refuseThird;
    def.progressUser = &asked;
    expectFailure(c.patches, def, VPL_CANCELLED, "");
    assert_int_equal(asked, 3);
    closeCase(&c);
}
