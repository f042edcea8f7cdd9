// SPDX-License-Identifier: MIT
// Light of the environment as virtual lights that are so far away that their light is parallel.
#ifndef VPL_LIGHTS_SKY_LIGHTS_H
#define VPL_LIGHTS_SKY_LIGHTS_H

#include <vpl/lights.h>

// Radii of the scene from its centre. Directions differ by 1/4096 at most over the scene; the square of the largest
// distance is finite in float.
#define VPL_SKY_DISTANCE 4096.0f

// The place of a light in the direction of a unit vector.
vplVec3 vplSkyLight_Position(const vplEmission* emission, vplVec3 towards);

#endif
