// SPDX-License-Identifier: MIT
// What the shaders of patches know.
#ifndef VPL_RADIOSITY_DRAW_PATCHES_H
#define VPL_RADIOSITY_DRAW_PATCHES_H

#include "radiosity/mesh.h"

// One of the two sides of all triangles.
typedef struct vplPatchFace {
    const vplPatchDraw* draw;
    const float (*clip)[4];
    int face;             // 0: fronts
    double width, height; // pixels of the picture
} vplPatchFace;

#endif
