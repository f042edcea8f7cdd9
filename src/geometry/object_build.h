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

// Fills the vertices and triangles of object `index`, whose placement, counts and first indices are set. VPL_OUT_OF_MEMORY.
vplResult vplBuildObject(const vplGeometryBuilder* builder, int index);

// Calls vplBuildObject, and decides whether rays test the object by formula. VPL_OUT_OF_MEMORY.
vplResult vplFinishObject(const vplGeometryBuilder* builder, int index);

// Fills geometry->formulaObjects from the objects.
void vplListFormulaObjects(vplGeometry* geometry, const vplGeometryBuilder* builder);

// Copies the materials of the scene.
void vplFillMaterials(const vplGeometry* geometry, const vplGeometryBuilder* builder);

// Finds bounds, area, mean reflectance and what emits. VPL_OUT_OF_MEMORY.
vplResult vplSummarise(vplGeometry* geometry);

// Sets geometry->paint, and the mean reflectances of `objects`, if the scene shows textures or colours of
// vertices. VPL_OUT_OF_MEMORY.
vplResult vplBuildPaint(const vplScene* scene, vplGeometry* geometry, vplGeometryObject* objects);

// How an object of the scene has changed since the geometry was made or updated.
enum {
    VPL_OBJECT_MOVED = 1,
    VPL_OBJECT_RECOLOURED = 2, // it has another material, or one of its materials was changed
};

// True if vplUpdatePaint can make the paint of a geometry that of the scene as it is now, which it cannot where materials were
// added; or if neither has any.
bool vplPaintFits(const vplGeometry* geometry, const vplScene* scene);

// Updates the paint of a geometry, which has some that fits, and the mean reflectances of changed objects. VPL_CANCELLED.
vplResult vplUpdatePaint(const vplScene* scene, const vplGeometry* geometry, vplGeometryObject* objects,
                         const uint8_t* changes);

// True if the environment, or NULL, is that of the scene as it is now.
bool vplEnvironment_IsOf(const vplEnvironment* environment, const vplScene* scene);

// Sets `coplanar` of the objects of a geometry whose triangles and bounds are known. VPL_OUT_OF_MEMORY.
vplResult vplMarkCoplanar(const vplGeometry* geometry, vplGeometryObject* objects);

#endif
