// SPDX-License-Identifier: MIT
// Scenes with emitters of all types, seen from above.
#ifndef VPL_TESTS_EMITTER_SCENES_H
#define VPL_TESTS_EMITTER_SCENES_H

#include "shapes.h"

#include "geometry/emission.h"
#include "math/vec.h"

uint64_t renderHash(const vplScene* scene, const vplRenderOptions* options);

// Adds a camera that looks straight down; `half` is the tangent of half the angle of view.
void lookDown(vplScene* scene, float height, double half);

// Finds the floor point that a pixel of a square picture sees from above.
void floorPoint(int pixel, int size, double height, double half, double* x, double* z);

// Adds a horizontal quad that faces up (or down), with material `material`.
void addLevel(vplScene* scene, vplVec3 centre, float size, bool down, int material);

int addGlow(vplScene* scene, vplRgb emission, float rho);

void addColoured(vplScene* scene, vplEmitterType type, vplVec3 position, vplVec3 direction, float intensity);

// Makes a room with a smooth sphere, a glowing box, a spot, a directional and a point light; all light is
// multiplied by `factor`. Pixels of the floor show rho/pi E, where E is I cos / d^2 times the spot's falloff
// 3x^2 - 2x^3 (x goes from 0 to 1 between the cosines of its two angles), or the irradiance times cos.
vplScene* zoo(vplContext* context, float factor);

vplRenderOptions zooOptions(int shadows);

#endif
