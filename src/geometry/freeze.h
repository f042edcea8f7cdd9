// SPDX-License-Identifier: MIT
#ifndef VPL_GEOMETRY_FREEZE_H
#define VPL_GEOMETRY_FREEZE_H

#include <vpl/geometry.h>

#include "scene/scene.h"

// The arrays of a geometry while they are filled.
typedef struct vplFreezer {
    const vplScene* scene;
    vplGeometryObject* objects;
    vplVec3* positions;
    vplVec3* shadingNormals; // NULL: no object is smooth
    uint32_t* indices;
    vplVec3* normals;
    int* owners;
    int* materials; // per triangle
} vplFreezer;

int vplCountVertices(const vplScene* scene, const vplObjectDef* def);
int vplCountTriangles(const vplScene* scene, const vplObjectDef* def);

// Fills the vertices and triangles of object `index`, whose placement, counts and places are set.
void vplFreezeObject(const vplFreezer* freezer, int index);

#endif
