// SPDX-License-Identifier: MIT
// Patches for tests, with sides as a test wants them.
#ifndef VPL_TESTS_PATCH_SUPPORT_H
#define VPL_TESTS_PATCH_SUPPORT_H

#include "shapes.h"

// The report's box (tests/data/cornell_testmodel.csv), one object, laboratory units.
vplGeometry* openTestModel(vplContext* context);

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

#endif
