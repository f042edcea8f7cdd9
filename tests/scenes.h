// SPDX-License-Identifier: MIT
// Scenes that several test files build by hand.
#ifndef VPL_TESTS_SCENES_H
#define VPL_TESTS_SCENES_H

#include "test.h"

// The room of tests/data/room_objects.csv. Its objects have the tables' matrices, which rotate the quads
// differently from room.json.
vplGeometry* tableRoom(vplContext* context);

// Makes a scene with one material of reflectance rho.
vplScene* sceneOf(vplContext* context, float rho);

// Makes the cube [-1, 1]^3 as six quads that face inwards, all of reflectance rho. They emit `emission` in
// red, half of it in green, a quarter in blue.
vplScene* closedCubeScene(vplContext* context, float rho, float emission);
vplGeometry* closedCube(vplContext* context, float rho);

// Makes a quad of the given size around `centre`, of reflectance rho, whose front faces +y.
vplGeometry* floorQuad(vplContext* context, vplVec3 centre, float size, float rho);

// Adds a camera with a vertical field of view of 1.2 radians.
void aim(vplScene* scene, vplVec3 eye, vplVec3 target);

// Adds an emitter of white light; parameters that its type lacks are ignored.
void addEmitter(vplScene* scene, vplEmitterType type, vplVec3 position, vplVec3 direction, float intensity);

// Adds a material that emits white light, and returns its index.
int addMaterial(vplScene* scene, vplRgb diffuse, float emission);

// Adds a quad or box, rotated about x, then y, in radians.
void addThing(vplScene* scene, vplObjectType type, int material, vplVec3 place, double turnX, double turnY,
              vplVec3 size);

// Returns the model matrix from a table's row-major 3x4 columns m00 .. m23.
vplMat4 matrixOf(const Table* t, int row);

#endif
