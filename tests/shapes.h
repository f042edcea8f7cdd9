// SPDX-License-Identifier: MIT
// Triangles for tests: closed surfaces and loose ones, and dice to place them with.
#ifndef VPL_TESTS_SHAPES_H
#define VPL_TESTS_SHAPES_H

#include "scenes.h"

// Three corners per triangle, counter-clockwise seen from outside. What meets has the same bits.
typedef struct Shape {
    vplVec3* corners;
    int triangleCount, capacity;
} Shape;

void addTriangle(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c);
void freeShape(Shape* shape);

// Closed surfaces around the origin: an icosahedron halved `levels` times and blown up to the unit sphere;
// the unit sphere in `rings` rings of twice as many parts, needles at the poles; the box [-1, 1]^3 in cells^2
// cells a face.
Shape icosphere(int levels);
Shape ringSphere(int rings);
Shape gridBox(int cells);

// Scales, rotates (radians), moves, in this order.
void placeShape(Shape* shape, float scale, const double rotate[3], vplVec3 offset);

// Adds the shape as an object of material 0; smooth: its corners are its normals.
void addShape(vplScene* scene, const Shape* shape, bool smooth, const vplMat4* transform);

// The same as `object`, whose mesh it becomes; may fail.
vplResult tryAddShape(vplScene* scene, const Shape* shape, bool smooth, vplObjectDef* object);

// Builds the geometry of the scene and destroys the scene.
vplGeometry* buildGeometry(vplScene* scene);

// Numbers from a seed, one after another.
typedef struct Dice {
    uint64_t seed, next;
} Dice;

float roll(Dice* dice, float low, float high);
vplVec3 rollVec(Dice* dice, float size); // each component in [-size, size)
vplVec3 rollUnit(Dice* dice);            // a direction, all alike

// 0: the room's objects; 1: a ball of 1,280 triangles in a box of 972.
vplGeometry* clutter(vplContext* context, int which);

// A place on some triangle, on the side that a random point in the bounds sees.
vplHemiMapPlace rollPlace(const vplGeometry* g, Dice* dice, vplHit* hitOut);

// Its reflective map, or a failed test.
vplReflectiveMap* mapOf(const vplGeometry* geometry, const vplEmitterDef* emitter, int size);

#endif
