// SPDX-License-Identifier: MIT
#ifndef VPL_GEOMETRY_OBJECT_BUILD_H
#define VPL_GEOMETRY_OBJECT_BUILD_H

#include <vpl/geometry.h>

#include "scene/scene.h"

// The arrays of a geometry while they are filled.
typedef struct vplGeometryBuilder {
    const vplScene* scene;
    vplGeometryObject* objects;
    vplVec3* positions;
    vplVec3* shadingNormals; // NULL: no object is smooth
    uint32_t* indices;
    vplVec3* normals;
    int* owners;
    int* triangleMaterials;
    int* formulaObjects;
    vplMaterialDef* materials;
} vplGeometryBuilder;

// The shape of an object in its own space: the mesh, or the triangles of the unit quad or box.
vplMeshDef vplShapeOf(const vplScene* scene, const vplObjectDef* def);

// Fills the vertices and triangles of object `index`, whose placement, counts and first indices are set.
void vplBuildObject(const vplGeometryBuilder* builder, int index);

// Sets geometry->paint, and the mean reflectances of `objects`, if the scene shows textures or colours of
// vertices. VPL_OUT_OF_MEMORY.
vplResult vplBuildPaint(const vplScene* scene, vplGeometry* geometry, vplGeometryObject* objects);

// Releases the textures of a geometry that is about to be destroyed.
void vplReleasePaint(const vplGeometry* geometry);

// Sets `coplanar` of the objects of a geometry whose triangles and bounds are known. VPL_OUT_OF_MEMORY.
vplResult vplMarkCoplanar(const vplGeometry* geometry, vplGeometryObject* objects);

#endif
