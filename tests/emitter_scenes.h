// SPDX-License-Identifier: MIT
// Scenes with emitters of all kinds, seen from above.
#ifndef VPL_TESTS_EMITTER_SCENES_H
#define VPL_TESTS_EMITTER_SCENES_H

#include "shapes.h"

#include "geometry/emission.h"
#include "math/vec.h"

uint64_t renderHash(const vplScene* scene, const vplRenderOptions* options);

// Looks straight down; `half` is the tangent of half the angle of view.
void lookDown(vplScene* scene, float height, double half);

// The floor point that a pixel of a square picture sees from above.
void floorPoint(int pixel, int size, double height, double half, double* x, double* z);

// A quad that looks up (or down), of the scene's material `material`.
void addLevel(vplScene* scene, vplVec3 centre, float size, bool down, int material);

int addGlow(vplScene* scene, vplRgb emission, float rho);

void addColoured(vplScene* scene, vplEmitterType type, vplVec3 position, vplVec3 direction, float intensity);

// rho/pi E: E = I cos / d^2 times 3x^2 - 2x^3 of the cosine's way between the angles, or the irradiance times
// cos. A room with a smooth ball, a box that glows, a spot, the sun and a point; all light multiplied by
// `factor`.
vplScene* zoo(vplContext* context, float factor);

vplRenderOptions zooOptions(int shadows);

#endif
