// SPDX-License-Identifier: MIT
// Types that the three sweeps over an OBJ file share. The first sweep counts and reads the MTL files, the
// second reads points and normals, the third reads faces.
#ifndef VPL_SCENE_OBJ_H
#define VPL_SCENE_OBJ_H

#include "scene/ear_clipping.h"
#include "scene/hash_index.h"
#include "scene/obj_text.h"
#include "scene/scene.h"

typedef struct vplObjMaterial {
    vplRgb diffuse, emission;
    bool defined;   // by an MTL file
    int sceneIndex; // -1 until a triangle needs it
} vplObjMaterial;

// Materials by name, in the order in which an OBJ or MTL file first names them.
typedef struct vplObjMaterials {
    vplNames names;
    vplObjMaterial* list; // as many as there are names
    size_t capacity;
} vplObjMaterials;

// The number of the material of this name; a new one is grey and not defined.
vplResult vplObjMaterials_Get(vplObjMaterials* materials, vplWord name, int* out);

// Reads an MTL file. The first definition of a name counts.
vplResult vplMtl_Read(vplContext* context, const char* path, vplObjMaterials* materials);

typedef struct vplObj {
    vplArena* scratch; // owns everything here but the text
    vplText text;
    vplObjMaterials materials;
    vplNames libraries; // the files that mtllib named so far
    vplUnknownWords unknown;
    // From the first sweep.
    int64_t pointCount, normalCount;
    int64_t triangleCount; // an upper bound: triangles without area are left out later
    bool hasNormals;       // a face refers to one
    // From the second sweep.
    vplVec3* points;          // without duplicates
    uint32_t differentPoints; // the number of points
    uint32_t* pointOf;        // the point of each v
    vplVec3* normals;         // unit vectors, or 0 where the file has a zero vector
} vplObj;

// A mesh that grows triangle by triangle. A vertex is made when a triangle first needs it.
typedef struct vplObjMesh {
    // Owns indices, materials and cornerNormal, for the scene. The scratch arena owns the rest.
    vplArena* arena;
    uint32_t* indices;
    int* materials; // numbers in vplObjMaterials; -1: none
    int64_t triangleCount;
    int64_t emptyCount; // triangles without area, left out
    uint32_t vertexCount;
    // Without normals: the vertex of each point.
    uint32_t* vertexOf;
    // With normals: an index of the vertices by point and normal, and the point and normal of each vertex.
    vplHashIndex corners;
    uint32_t* cornerPoint;
    vplVec3* cornerNormal;
    size_t pointCapacity, normalCapacity;
} vplObjMesh;

// The three sweeps, in this order.
vplResult vplObj_Count(vplObj* obj);
vplResult vplObj_ReadPoints(vplObj* obj);
vplResult vplObj_ReadFaces(vplObj* obj, vplObjMesh* mesh);

// Adds a triangle, unless it has no area. A normal of -1 means none.
vplResult vplObjMesh_AddTriangle(const vplObj* obj, vplObjMesh* mesh, const uint32_t points[3],
                                 const int64_t normals[3], int material);

#endif
