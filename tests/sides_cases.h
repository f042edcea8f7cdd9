// SPDX-License-Identifier: MIT
// Rooms for tests of patch sides.
#ifndef VPL_TESTS_SIDES_CASES_H
#define VPL_TESTS_SIDES_CASES_H

#include "patch_support.h"

#include "base/hash.h"
#include "math/vec.h"
#include "radiosity/sides/side.h"

#include <stdlib.h>

extern const vplVec3 NEAR_CEILING;

void addFlat(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c, vplVec3 d);

// Adds the box from low to high; its fronts are inside if `inward`.
void addBox(Shape* shape, vplVec3 low, vplVec3 high, bool inward);

// Adds a floor [-2, 2]^2 at y = 0 that faces up.
void addFloor(Shape* shape);

typedef struct Case {
    vplContext* context;
    vplGeometry* geometry;
    vplPatches* patches;
    vplPatchSides* sides;
} Case;

// Makes geometry, patches and sides of a shape. It frees the shape.
Case openCase(Shape* shape, float size, const vplVec3* emitter);

void closeCase(Case* c);

int triangleOf(const vplPatches* p, int patch);

// Counts the sides of triangles first .. first + count - 1, front or back; *patchesOut is the number of their
// patches.
int countSides(const vplPatchSides* s, int first, int count, bool back, int* patchesOut);

void assertAll(const vplPatchSides* s, int first, int count, bool back);

void assertNone(const vplPatchSides* s, int first, int count, bool back);

void assertSide(const vplPatchSides* s, int index);

#endif
