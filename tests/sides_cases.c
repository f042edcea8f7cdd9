// SPDX-License-Identifier: MIT
#include "sides_cases.h"

const vplVec3 NEAR_CEILING = {2.775f, 5.4f, 2.775f};

void addFlat(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c, vplVec3 d)
{
    addTriangle(shape, a, b, c);
    addTriangle(shape, a, c, d);
}

void addBox(Shape* shape, vplVec3 low, vplVec3 high, bool inward)
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

void addFloor(Shape* shape)
{
    addFlat(shape, vplVec(-2, 0, -2), vplVec(-2, 0, 2), vplVec(2, 0, 2), vplVec(2, 0, -2));
}

Case openCase(Shape* shape, float size, const vplVec3* emitter)
{
    Case c = {.context = openTestContext(2)};
    c.geometry = geometryOf(c.context, shape, 0.5f, 0);
    c.patches = openPatches(c.geometry, size, VPL_MAX_PATCH_ROUNDS);
    c.sides = sidesOf(c.patches, emitter);
    freeShape(shape);
    return c;
}

void closeCase(Case* c)
{
    vplPatchSides_Destroy(c->sides);
    vplPatches_Destroy(c->patches);
    vplGeometry_Destroy(c->geometry);
    closeTestContext(c->context);
}

int triangleOf(const vplPatches* p, int patch)
{
    return p->nodes[p->patches[patch]].triangle;
}

int countSides(const vplPatchSides* s, int first, int count, bool back, int* patchesOut)
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

void assertAll(const vplPatchSides* s, int first, int count, bool back)
{
    int patches;
    const int sides = countSides(s, first, count, back, &patches);
    assert_int_equal(sides, patches);
    assert_true(patches > 0);
}

void assertNone(const vplPatchSides* s, int first, int count, bool back)
{
    int patches;
    assert_int_equal(countSides(s, first, count, back, &patches), 0);
    assert_true(patches > 0);
}

void assertSide(const vplPatchSides* s, int index)
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
    for (int k = 0; k < 3; k++) { // distances from the edges
        const vplVec3 edge = vplNormalize(vplSub(c[(k + 1) % 3], c[k]));
        distances[k] = (double)vplDot(vplCross(edge, vplSub(side->incentre, c[k])), side->normal);
    }
    assert_true(distances[0] > 0);
    assertNear(distances[1], distances[0], 2e-6, "incentre", index);
    assertNear(distances[2], distances[0], 2e-6, "incentre", index);
}
