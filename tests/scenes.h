// SPDX-License-Identifier: MIT
// Scenes that several test files build by hand.
#ifndef VPL_TESTS_SCENES_H
#define VPL_TESTS_SCENES_H

#include "test.h"

// The room of tests/data/room_objects.csv (the tables' matrices, which turn the quads otherwise than
// room.json).
vplGeometry* tableRoom(vplContext* context);

// A scene with one material of reflectance rho.
vplScene* sceneOf(vplContext* context, float rho);

// The cube [-1, 1]^3 seen from inside: six quads facing inwards, all of reflectance rho. Emission: of red,
// half as much green, a quarter blue.
vplScene* closedCubeScene(vplContext* context, float rho, float emission);
vplGeometry* closedCube(vplContext* context, float rho);

// A quad of the given size around `centre`, its front towards +y, of reflectance rho.
vplGeometry* floorQuad(vplContext* context, vplVec3 centre, float size, float rho);

// Adds a camera of 1.2 radians.
void aim(vplScene* scene, vplVec3 eye, vplVec3 target);

// Adds an emitter of white light; what its type does not have is not used.
void addEmitter(vplScene* scene, vplEmitterType type, vplVec3 position, vplVec3 direction, float intensity);

// The new material's index; emission is white.
int addMaterial(vplScene* scene, vplRgb diffuse, float emission);

// A quad or box, turned about x, then y, radians.
void addThing(vplScene* scene, vplObjectType type, int material, vplVec3 place, double turnX, double turnY,
              vplVec3 size);

// Model matrix from a table's row-major 3x4 columns m00 .. m23.
vplMat4 matrixOf(const Table* t, int row);

#endif
