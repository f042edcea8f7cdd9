// SPDX-License-Identifier: MIT
// The report's box (tests/data/cornell_testmodel.csv) and what tests of patches ask of it.
#ifndef VPL_TESTS_PATCH_MODEL_H
#define VPL_TESTS_PATCH_MODEL_H

#include "patch_support.h"

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

#endif
