// SPDX-License-Identifier: MIT
#ifndef VPL_SCENE_OBJ_POLYGON_H
#define VPL_SCENE_OBJ_POLYGON_H

#include <vpl/vecmath.h>

// Most corners of one face.
#define VPL_MAX_CORNERS 1024

// Room to work in; about 40 KB.
typedef struct vplPolygon {
    double at[VPL_MAX_CORNERS][2]; // corners in the polygon's plane, counter-clockwise
    int previous[VPL_MAX_CORNERS], next[VPL_MAX_CORNERS];
    bool ear[VPL_MAX_CORNERS];
    int triangles[VPL_MAX_CORNERS - 2][3]; // the result: corners in the polygon's own order of turning
    int triangleCount;
    bool simple; // false: the outline crosses itself or has no area, and the triangles cover it somehow
} vplPolygon;

// Cuts a polygon of 3 to VPL_MAX_CORNERS corners into `count` - 2 triangles that cover it without overlap, also
// where it is concave or has corners on its edges. The same corners give the same triangles everywhere.
void vplPolygon_Triangulate(vplPolygon* polygon, const vplVec3* corners, int count);

#endif
