// SPDX-License-Identifier: MIT
// Tests of finding the sides of patches that light reaches, and their open cells (X101).
#include "sides_cases.h"

#include "base/context.h"

// Makes sides that one point light lights, with the def's other values.
static vplPatchSides* sidesLitFrom(const vplPatches* p, vplVec3 position, vplPatchSidesDef def)
{
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplPatchSides* s;
    emitter.position = position;
    def.emitters = &emitter;
    def.emitterCount = 1;
    assert_int_equal(vplPatchSides_Create(p, &def, &s), VPL_SUCCESS);
    return s;
}

// ---- unlit sides

// A crate stands on a floor: triangles 0 and 1 are the floor's, 2 to 13 the crate's. Its inside and the floor
// below it are dark: the open cells have the area of the floor minus the crate's base, except for cells that
// the base covers partly.
TEST_ALONE(TheInsideOfACrateAndTheFloorUnderItAreDark)
{
    for (int sunk = 0; sunk < 3; sunk++) { // on the floor, sunk into it, and slightly above
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
        assertNear(area, 16 - 1.7 * 1.6, 0.35, "open floor", sunk); // a cell is 0.009, 76 are partly covered
        closeCase(&c);
    }
}

// Twenty seeds and different patch sizes: rounding lets no light through a wall.
TEST(NoSeedLightsTheBackOfAWall, 2, SLOW)
{
    vplGeometry* g = testModel(context, MODEL_METRES, 0.5f);
    for (uint64_t seed = 0; seed < 20; seed++) {
        vplPatches* p = openPatches(g, 2.0f - 0.07f * (float)seed, VPL_MAX_PATCH_ROUNDS);
        vplPatchSidesDef def = vplDefaultPatchSidesDef();
        int patches;
        def.seed = seed;
        vplPatchSides* s = sidesLitFrom(p, NEAR_CEILING, def);
        assertNone(s, 0, 30, true);
        assertAll(s, 2, 28, false);
        const int lit = countSides(s, 0, 2, false, &patches);
        assert_true(lit > patches * 8 / 10);
        vplPatchSides_Destroy(s);
        vplPatches_Destroy(p);
    }
    vplGeometry_Destroy(g);
}

// Two closed rooms lie side by side, with an emitter in one.
TEST_ALONE(ARoomWithoutAnEmitterTakesNoPart)
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

// Sides that a viewpoint sees are included, even if they are dark.
TEST_ALONE(WhatAViewpointSeesTakesPart)
{
    Shape shape = {0};
    addBox(&shape, vplVec(0, 0, 0), vplVec(2, 2, 2), true);
    addBox(&shape, vplVec(3, 0, 0), vplVec(5, 2, 2), true);
    Case c = openCase(&shape, 1, NULL);
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    const vplVec3 eye = {1, 1, 1};
    vplPatchSides* s;
    def.viewpoints = &eye;
    def.viewpointCount = 1;
    assert_int_equal(vplPatchSides_Create(c.patches, &def, &s), VPL_SUCCESS);
    assertAll(s, 0, 12, false);
    assertNone(s, 0, 12, true);
    assertNone(s, 12, 12, false);
    assertNone(s, 12, 12, true);
    vplPatchSides_Destroy(s);
    closeCase(&c);
}

// ---- lit sides

TEST_ALONE(OneTriangleHasTheSideThatFacesTheEmitter)
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

// Nothing reflects light to the floor, and the particles are fewer than its patches: each must find the lamp or the sun itself.
TEST_ALONE(EachPatchOfAFloorFindsItsLightSource)
{
    static const vplEmitterType types[] = {VPL_EMITTER_POINT, VPL_EMITTER_SPOT, VPL_EMITTER_DIRECTIONAL};
    Shape shape = {0};
    addFloor(&shape);
    Case c = openCase(&shape, 0.1f, NULL);
    assert_true(c.patches->patchCount > 4096);
    for (int i = 0; i < 3; i++) {
        vplEmitterDef emitter = vplDefaultEmitterDef();
        vplPatchSidesDef def = vplDefaultPatchSidesDef();
        vplPatchSides* s;
        emitter.type = types[i];
        emitter.position = vplVec(0.3f, 3, 0.1f);
        emitter.direction = vplVec(0, -1, 0);
        emitter.innerAngle = emitter.outerAngle = 0.4 * VPL_PI;
        def.emitters = &emitter;
        def.emitterCount = 1;
        assert_int_equal(vplPatchSides_Create(c.patches, &def, &s), VPL_SUCCESS);
        assertAll(s, 0, 2, false);
        assertNone(s, 0, 2, true);
        vplPatchSides_Destroy(s);
    }
    closeCase(&c);
}

TEST(AnAreaLightAloneIsASide, 1)
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

// A curtain hangs in a lit room: direct light reaches one side, light from the walls the other.
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

// Rays hit the first of two coincident triangles: it gets the light of both sides, the other none.
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

// Five rooms in a row are connected by doors of a tenth of the wall, which do not face each other; the
// emitter is in the first room. All walls of all rooms must be found, with few patches and with many.
TEST_ALONE(LightGoesThroughDoorsToTheLastRoom, SLOW)
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

// One emitter has a millionth of the other's power, but is the only one in its room.
TEST(AWeakAreaLightLightsItsRoom, 1)
{
    Shape shape = {0};
    addBox(&shape, vplVec(0, 0, 0), vplVec(2, 2, 2), true);
    addBox(&shape, vplVec(3, 0, 0), vplVec(5, 2, 2), true);
    vplGeometry* g = geometryOf(context, &shape, 0.5f, 0);
    vplPatches* p = openPatches(g, 0.7f, VPL_MAX_PATCH_ROUNDS);
    vplEmitterDef emitters[2] = {vplDefaultEmitterDef(), vplDefaultEmitterDef()};
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    vplPatchSides* s;
    emitters[0].position = vplVec(1, 1, 1);
    emitters[1].position = vplVec(4, 1, 1);
    emitters[1].intensity = (vplRgb){1e-6f, 0, 0};
    def.emitters = emitters;
    def.emitterCount = 2;
    assert_int_equal(vplPatchSides_Create(p, &def, &s), VPL_SUCCESS);
    assertAll(s, 0, 24, false);
    assertNone(s, 0, 24, true);
    vplPatchSides_Destroy(s);
    vplPatches_Destroy(p);
    vplGeometry_Destroy(g);
    freeShape(&shape);
}

// A poster half a millimetre off the wall (triangles 0 and 1) covers it; the wall around the poster is lit.
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

// ---- whole sides

// `whole` opens, for each triangle that light reaches, all patches on that side, with all their cells.
TEST_ALONE(WholeSidesAreThoseOfWholeTriangles)
{
    Shape shape = {0};
    addFloor(&shape);
    addBox(&shape, vplVec(-0.9f, 0, -0.7f), vplVec(0.8f, 1, 0.9f), false);
    Case c = openCase(&shape, 0.5f, &(vplVec3){1, 3, 1});
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    def.wholeTriangles = true;
    vplPatchSides* s = sidesLitFrom(c.patches, vplVec(1, 3, 1), def);
    assert_true(s->count > c.sides->count); // includes patches under the box
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

// ---- faint sides

// A lit room, triangles 0 to 15, in an empty hall, 16 to 27. A hole of 10 x 10 cm in the room's ceiling lights the hall a little.
static void addRoomInHall(Shape* shape)
{
    const float x[2] = {1, 5}, y[2] = {1, 3}, z[2] = {1, 5}, hx[2] = {2.95f, 3.05f}, hz[2] = {2.95f, 3.05f};
    const vplVec3 p[8] = {{x[0], y[0], z[0]}, {x[1], y[0], z[0]}, {x[1], y[0], z[1]}, {x[0], y[0], z[1]},
                          {x[0], y[1], z[0]}, {x[1], y[1], z[0]}, {x[1], y[1], z[1]}, {x[0], y[1], z[1]}};
    addFlat(shape, p[3], p[2], p[1], p[0]);
    for (int k = 0; k < 4; k++) {
        addFlat(shape, p[k], p[(k + 1) % 4], p[4 + (k + 1) % 4], p[4 + k]);
    }
    const vplVec3 h[4] = {
        {hx[0], y[1], hz[0]}, {hx[1], y[1], hz[0]}, {hx[1], y[1], hz[1]}, {hx[0], y[1], hz[1]}};
    for (int k = 0; k < 4; k++) {
        addFlat(shape, p[4 + k], p[4 + (k + 1) % 4], h[(k + 1) % 4], h[k]);
    }
    addBox(shape, vplVec(0, 0, 0), vplVec(6, 4, 6), true);
}

static vplPatchSides* sidesSeenFrom(const vplPatches* p, const vplVec3* viewpoints, int count,
                                    bool leaveFaint)
{
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    def.viewpoints = viewpoints;
    def.viewpointCount = count;
    def.leaveFaint = leaveFaint;
    return sidesLitFrom(p, vplVec(2, 2.5f, 2), def);
}

// From the room, the hall's sides are left out, except the few that a particle hit; all of the room stays. The hall stays if a camera
// in it sees how dim it is, without a camera, and by default.
TEST_ALONE(FaintSidesThatNobodySeesAreLeftOut)
{
    const vplVec3 eyes[2] = {{4, 2, 4}, {0.5f, 2, 0.5f}}; // in the room and in the hall
    Shape shape = {0};
    addRoomInHall(&shape);
    Case c = openCase(&shape, 0.4f, &(vplVec3){2, 2.5f, 2});
    vplPatchSides* all = sidesSeenFrom(c.patches, eyes, 1, false);
    vplPatchSides* left = sidesSeenFrom(c.patches, eyes, 1, true);
    int patches;
    const int inHall = countSides(all, 16, 12, false, &patches),
              inRoom = countSides(all, 0, 16, false, &patches);
    assert_true(inHall > 1000);
    assert_int_equal(all->faintCount, 0);
    assert_int_equal(left->count + left->faintCount, all->count);
    assert_true(countSides(left, 16, 12, false, &patches) < inHall / 10);
    assert_int_equal(countSides(left, 0, 16, false, &patches), inRoom);
    vplPatchSides_Destroy(left);
    for (int i = 0; i < 3; i++) { // from both, from the hall, from nowhere
        left = sidesSeenFrom(c.patches, eyes + (i == 1), i == 0 ? 2 : i == 1 ? 1 : 0, true);
        assert_int_equal(left->faintCount, 0);
        assert_true(countSides(left, 16, 12, false, &patches) >= inHall);
        vplPatchSides_Destroy(left);
    }
    vplPatchSides_Destroy(all);
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
    def.viewpointCount = -1;
    expectFailure(
        c.patches, def, VPL_INVALID_ARGUMENT,
        "vplPatchSidesDef.viewpointCount is -1, must be at least 0, and 0 where viewpoints is NULL");
    def.viewpoints = eyes;
    def.viewpointCount = 2;
    expectFailure(c.patches, def, VPL_INVALID_ARGUMENT, "vplPatchSidesDef.viewpoints[1] is not finite");
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
    vplEmitterDef emitter = vplDefaultEmitterDef();
    vplPatchSidesDef def = vplDefaultPatchSidesDef();
    int asked = 0;
    emitter.position = vplVec(0, 2, 0);
    def.emitters = &emitter;
    def.emitterCount = 1;
    c.context->workerCount = 1; // of two workers one may do all tasks, and only the caller's asks
    def.progress = refuseThird;
    def.progressUser = &asked;
    expectFailure(c.patches, def, VPL_CANCELLED, "");
    assert_int_equal(asked, 3);
    closeCase(&c);
}
