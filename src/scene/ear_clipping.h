// SPDX-License-Identifier: MIT
#ifndef VPL_SCENE_EAR_CLIPPING_H
#define VPL_SCENE_EAR_CLIPPING_H

#include <vpl/vecmath.h>

// Most corners of one face.
#define VPL_MAX_CORNERS 1024

// Working memory and result of a triangulation; about 40 KB.
typedef struct vplEarClipper {
    double at[VPL_MAX_CORNERS][2]; // corners in the polygon's plane, counter-clockwise
    int previous[VPL_MAX_CORNERS], next[VPL_MAX_CORNERS];
    bool ear[VPL_MAX_CORNERS];
    int triangles[VPL_MAX_CORNERS - 2][3]; // the result: numbers of corners, in the polygon's orientation
    int triangleCount;
    bool simple; // false: the outline crosses itself or has no area, so the triangles may overlap
} vplEarClipper;

// Cuts a polygon of 3 to VPL_MAX_CORNERS corners into count - 2 triangles that cover it without overlap. It
// may be concave and have corners on its edges. The same corners give the same triangles on every machine.
void vplEarClipper_Triangulate(vplEarClipper* clipper, const vplVec3* corners, int count);

#endif
