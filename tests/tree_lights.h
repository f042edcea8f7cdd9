// SPDX-License-Identifier: MIT
// Lights that are hard to put into a tree, and their tree.
#ifndef VPL_TESTS_TREE_LIGHTS_H
#define VPL_TESTS_TREE_LIGHTS_H

#include "shapes.h"

#include "base/hash.h"
#include "lights/light_tree.h"
#include "math/vec.h"
#include "shading/shading.h"

#include <stdlib.h>

typedef enum Kind {
    KIND_CLOUD,   // random positions and normals
    KIND_WALLS,   // on the inside of a cube
    KIND_FAR,     // in a small box 1000 km from the origin
    KIND_SERIES,  // 2^-i m from a corner: one half contains all but one
    KIND_POINT,   // all at one position
    KIND_SAME,    // all at one position with one normal
    KIND_HUGE,    // up to 1e17 m apart
    KIND_UNEQUAL, // a few are brighter by 1e12, some are black
    KIND_BACK,    // pairs of opposite normals
    KIND_COUNT
} Kind;

vplShadeLight rollLight(Dice* dice, Kind kind, int i);

vplShadeLight* rollTreeLights(Kind kind, int count, uint64_t seed);

vplLightTree* plant(vplContext* context, const vplShadeLight* lights, int count);

#endif
