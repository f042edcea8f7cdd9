// SPDX-License-Identifier: MIT
// Patches for tests: of the report's box (tests/data/cornell_testmodel.csv) and of other shapes, with sides
// as a test wants them.
#ifndef VPL_TESTS_PATCH_SUPPORT_H
#define VPL_TESTS_PATCH_SUPPORT_H

#include "shapes.h"

typedef enum ModelUnit {
    MODEL_LAB,    // 555 a side, all coordinates whole numbers
    MODEL_SCALED, // p * 2 / 555 - 1 in float, as the lab does
    MODEL_METRES  // 0.01 of the lab's
} ModelUnit;

// 30 triangles of reflectance rho whose fronts face the room (the table's winding is turned).
vplGeometry* testModel(vplContext* context, ModelUnit unit, float rho);

// Triangles from a shape, of one material.
vplGeometry* geometryOf(vplContext* context, const Shape* shape, float rho, float emission);

// Sides lit by a point at `position`; NULL: by what emits itself.
vplPatchSides* sidesOf(const vplPatches* patches, const vplVec3* position);

// `rounds` of bisection of what is longer than `size`.
vplPatches* openPatches(const vplGeometry* geometry, float size, int rounds);

// Bisected at random: in each of `rounds`, each patch with probability 1/2.
vplPatches* openUnevenPatches(const vplGeometry* geometry, int rounds, uint64_t seed);

// Which cells of a side are open; 0: it is not among the sides.
typedef uint16_t OpenFcn(const vplPatches* patches, int patch, int face);

uint16_t allOpen(const vplPatches* patches, int patch, int face);
uint16_t frontsOpen(const vplPatches* patches, int patch, int face);

// Sides filled by hand; reflectance from the material of the triangle.
vplPatchSides* openSides(const vplPatches* patches, OpenFcn* open);
void closeSides(vplPatchSides* sides);

// The mesh of them, or a failed test.
vplPatchMesh* meshOf(const vplPatchSides* sides);

// Closes mesh, sides, patches and geometry.
void closeMesh(vplPatchMesh* mesh);

// The fronts of triangles, three corners each, after `rounds` rounds of bisecting all whose longest edge is
// longer than `size`; 0: all.
typedef struct SidesFixture {
    vplGeometry* geometry;
    vplPatches* patches;
    vplPatchSides* sides;
} SidesFixture;

SidesFixture openFronts(vplContext* context, const vplVec3* corners, int triangleCount, float size,
                        int rounds);
void closeFronts(SidesFixture* fixture);

// The inside of a box with a corner at the origin, two triangles per face, 36 corners.
void boxCorners(float x, float y, float z, vplVec3 corners[36]);

#endif
