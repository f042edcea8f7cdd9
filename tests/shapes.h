// SPDX-License-Identifier: MIT
// Triangles for tests, closed surfaces and separate ones, and random numbers to place them with.
#ifndef VPL_TESTS_SHAPES_H
#define VPL_TESTS_SHAPES_H

#include "scenes.h"

// Triangles of three corners each, counter-clockwise seen from outside. Shared corners have the same bits.
typedef struct Shape {
    vplVec3* corners;
    int triangleCount, capacity;
} Shape;

void addTriangle(Shape* shape, vplVec3 a, vplVec3 b, vplVec3 c);
void freeShape(Shape* shape);

// Make closed surfaces around the origin: an icosahedron subdivided `levels` times and projected to the unit
// sphere; the unit sphere in `rings` rings of twice as many segments, with needles at the poles; the box [-1,
// 1]^3 with cells^2 cells per face.
Shape icosphere(int levels);
Shape ringSphere(int rings);
Shape gridBox(int cells);

// Scales, rotates (radians) and translates the shape, in this order.
void placeShape(Shape* shape, float scale, const double rotate[3], vplVec3 offset);

// Adds the shape as an object of material 0; smooth: the corners serve as normals.
void addShape(vplScene* scene, const Shape* shape, bool smooth, const vplMat4* transform);

// Makes the shape the mesh of `object` and adds that object; may fail.
vplResult tryAddShape(vplScene* scene, const Shape* shape, bool smooth, vplObjectDef* object);

// Builds the geometry of the scene and destroys the scene.
vplGeometry* buildGeometry(vplScene* scene);

// A sequence of random numbers from a seed.
typedef struct Dice {
    uint64_t seed, next;
} Dice;

float roll(Dice* dice, float low, float high);
vplVec3 rollVec(Dice* dice, float size); // each component in [-size, size)
vplVec3 rollUnit(Dice* dice);            // a direction, uniform on the sphere

// Makes a scene. 0: the room's objects; 1: a sphere of 1,280 triangles in a box of 972.
vplGeometry* clutter(vplContext* context, int which);

// Returns a place on a random triangle, on the side that a random point in the bounds sees.
vplHemiMapPlace rollPlace(const vplGeometry* g, Dice* dice, vplHit* hitOut);

// Draws the emitter's reflective shadow map; fails the test if that fails.
vplReflectiveMap* mapOf(const vplGeometry* geometry, const vplEmitterDef* emitter, int size);

#endif
