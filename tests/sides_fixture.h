// SPDX-License-Identifier: MIT
// Sides of patches made by hand: triangles one by one, seen from the front, all of them open.
#ifndef VPL_TESTS_SIDES_FIXTURE_H
#define VPL_TESTS_SIDES_FIXTURE_H

#include <vpl/radiosity.h>

#include <stdbool.h>

typedef struct SidesFixture {
    vplContext* context; // not owned
    vplScene* scene;
    vplGeometry* geometry;
    vplPatches patches;
    vplPatchSides sides;
} SidesFixture;

// A mesh of triangles, three corners each, and sides: those triangles after `rounds` rounds of bisecting all whose
// longest edge is longer than `size`.
bool makeSides(vplContext* context, const vplVec3* corners, int triangleCount, double size, int rounds,
               SidesFixture* fixture);
void freeSides(SidesFixture* fixture);

// The inside of a box with a corner at the origin, two triangles per face, 36 corners.
void boxCorners(float x, float y, float z, vplVec3 corners[36]);

#endif
