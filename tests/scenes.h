// SPDX-License-Identifier: MIT
// Scenes that several test files build by hand.
#ifndef VPL_TESTS_SCENES_H
#define VPL_TESTS_SCENES_H

#include "test.h"

// The room of tests/data/room_objects.csv (the tables' matrices, which turn the quads otherwise than room.json).
vplGeometry* tableRoom(vplContext* context);

// A scene with one material of reflectance rho.
vplScene* sceneOf(vplContext* context, float rho);

// The cube [-1, 1]^3 seen from inside: six quads facing inwards, all of reflectance rho. Emission: of red, half as much
// green, a quarter blue.
vplScene* closedCubeScene(vplContext* context, float rho, float emission);
vplGeometry* closedCube(vplContext* context, float rho);

// A quad of the given size around `centre`, its front towards +y, of reflectance rho.
vplGeometry* floorQuad(vplContext* context, vplVec3 centre, float size, float rho);

// Model matrix from a table's row-major 3x4 columns m00 .. m23.
vplMat4 matrixOf(const Table* t, int row);

#endif
