// SPDX-License-Identifier: MIT
// Reflective shadow maps from the inside.
#ifndef VPL_LIGHTS_RSM_H
#define VPL_LIGHTS_RSM_H

#include <vpl/lights.h>

// Planes of the framebuffer while a face is drawn.
enum {
    VPL_RSM_TRIANGLE = 0, // bits of an int: 1 + index of the triangle, 0 where nothing is
    VPL_RSM_POSITION = 1, // 3 planes
    VPL_RSM_NORMAL = 4,   // 3 planes: interpolated, not yet unit; 0 of flat objects
    VPL_RSM_PLANES = 7
};

// One object on one face.
typedef struct vplRsmUniforms {
    const vplReflectiveMap* map;
    int face;
    float near, inverseFar;   // metres; directional: 0, 1 / length of the view
    const vplVec3* positions; // of the object's vertices
    const vplVec3* normals;   // NULL: flat
    int firstTriangle;
} vplRsmUniforms;

// What is drawn becomes what the map says.
vplResult vplReflectiveMap_Finish(vplReflectiveMap* map, const vplGeometry* geometry);

#endif
