// SPDX-License-Identifier: MIT
// Scenes made in code and pictures of them, for tests of path tracing.
#ifndef VPL_TESTS_PATH_SCENES_H
#define VPL_TESTS_PATH_SCENES_H

#include "scenes.h"

#include "reference/path_trace.h"

#include <stdlib.h>

vplScene* newScene(vplContext* context);

int addGrey(vplScene* scene, float rho, float emission);

// Adds a quad after `quarters` quarter turns about x: 0 faces +z, -1 up, 1 down.
void addQuad(vplScene* scene, int material, vplVec3 place, int quarters, float size);

// Adds the cube [-1, 1]^3 as six quads that face inwards.
void addRoom(vplScene* scene, int material);

// Adds a sphere of radius `radius`: an octahedron whose faces are cut into n^2 triangles each, with the true
// sphere's normals if `smooth`.
void addSphere(vplScene* scene, int material, vplVec3 centre, float radius, int n, bool smooth);

vplEmitterDef* addWhite(vplScene* scene, vplEmitterType type, vplVec3 position, float intensity);

void addCamera(vplScene* scene, vplVec3 eye, vplVec3 target, double fovY);

vplRenderOptions pathOptions(int size, int samples);

double meanOfImage(const vplImage* image, int channel);

// Returns the mean of one channel of a small picture.
double radianceOf(const vplScene* scene, const vplRenderOptions* options, int channel);

#define ROOM      "examples/scenes/room.json"
#define AREA_ROOM "examples/scenes/room-area.json"

// Adds a room with every type of emitter that has a place, an area light and a smooth sphere as of addSphere, and a camera. Returns the scene.
vplScene* addAllLights(vplScene* scene, int n);

// The mean of the squared differences of all values; both are as large.
double squaredDifference(const vplImage* a, const vplImage* b);

// Traces a picture of 24x24 pixels by the scene's first camera and all its emitters.
vplImage* traceWith(const vplScene* scene, const vplGeometry* geometry, const vplPathDef* def, int samples,
                    vplPathStats* stats);

vplImage* renderShown(const vplScene* scene, vplShow show, int bounce);

#endif
