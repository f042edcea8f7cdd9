// SPDX-License-Identifier: MIT
// Makes patches for tests, of the report's box (tests/data/cornell_testmodel.csv) and of other shapes, and
// sides of them that tests choose.
#ifndef VPL_TESTS_PATCH_SUPPORT_H
#define VPL_TESTS_PATCH_SUPPORT_H

#include "shapes.h"

typedef enum ModelUnit {
    MODEL_LAB,    // 555 per edge, all coordinates integers
    MODEL_SCALED, // p * 2 / 555 - 1 in float, as the lab scales it
    MODEL_METRES  // 0.01 of MODEL_LAB
} ModelUnit;

// Makes the box of 30 triangles with reflectance rho whose fronts face the room (the table's winding is
// reversed).
vplGeometry* testModel(vplContext* context, ModelUnit unit, float rho);

// Makes geometry of a shape's triangles, with one material.
vplGeometry* geometryOf(vplContext* context, const Shape* shape, float rho, float emission);

// Makes the sides lit by a point light at `position`; NULL: by the patches' own emission.
vplPatchSides* sidesOf(const vplPatches* patches, const vplVec3* position);

// Bisects patches with edges longer than `size`, for at most `rounds` rounds.
vplPatches* openPatches(const vplGeometry* geometry, float size, int rounds);

// Bisects at random: in each of `rounds` rounds, each patch with probability 1/2.
vplPatches* openUnevenPatches(const vplGeometry* geometry, int rounds, uint64_t seed);

// Returns the bit mask of a side's open cells; 0: the side is left out.
typedef uint16_t OpenFcn(const vplPatches* patches, int patch, int face);

uint16_t allOpen(const vplPatches* patches, int patch, int face);
uint16_t frontsOpen(const vplPatches* patches, int patch, int face);

// Makes sides by hand; reflectance comes from the triangle's material.
vplPatchSides* openSides(const vplPatches* patches, OpenFcn* open);
void closeSides(vplPatchSides* sides);

// Makes the sides' mesh; fails the test if that fails.
vplPatchMesh* meshOf(const vplPatchSides* sides);

// Destroys mesh, sides, patches and geometry.
void closeMesh(vplPatchMesh* mesh);

// The front sides of triangles, three corners each, after `rounds` rounds that bisect all patches whose
// longest edge is longer than `size`; 0: all.
typedef struct SidesFixture {
    vplGeometry* geometry;
    vplPatches* patches;
    vplPatchSides* sides;
} SidesFixture;

SidesFixture openFronts(vplContext* context, const vplVec3* corners, int triangleCount, float size,
                        int rounds);
void closeFronts(SidesFixture* fixture);

// Writes the inside of a box with a corner at the origin: two triangles per face, 36 corners.
void boxCorners(float x, float y, float z, vplVec3 corners[36]);

#endif
