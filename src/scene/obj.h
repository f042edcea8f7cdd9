// SPDX-License-Identifier: MIT
// Between an OBJ file and a mesh: what its three sweeps share. The first counts and reads the MTL files, the
// second reads points and normals, the third faces.
#ifndef VPL_SCENE_OBJ_H
#define VPL_SCENE_OBJ_H

#include "scene/obj_index.h"
#include "scene/obj_polygon.h"
#include "scene/obj_text.h"
#include "scene/scene.h"

// Materials by name, in the order they were first named by either kind of file.
typedef struct vplObjMaterial {
    vplRgb diffuse, emission;
    bool defined;   // by an MTL file
    int sceneIndex; // -1 until a triangle needs it
} vplObjMaterial;

typedef struct vplObjMaterials {
    vplNames names;
    vplObjMaterial* list; // as many as there are names
    size_t capacity;
} vplObjMaterials;

// The number of the material of this name; a new one is grey and not defined.
vplResult vplObjMaterials_Get(vplObjMaterials* materials, vplWord name, int* out);
void vplObjMaterials_Close(vplObjMaterials* materials);

// Reads an MTL file. The first definition of a name counts.
vplResult vplMtl_Read(vplContext* context, const char* path, vplObjMaterials* materials);

typedef struct vplObj {
    vplContext* context;
    vplText text;
    vplObjMaterials materials;
    vplNames libraries; // named by mtllib so far
    vplUnknownWords unknown;
    // counted by the first sweep
    int64_t pointCount, normalCount, triangleCount; // triangles at most: some may have no area
    bool hasNormals;                                // a face refers to one
    // filled by the second: different points, and which of them each v is; unit normals, 0 for one of no length
    vplVec3* points;
    uint32_t* pointOf;
    vplVec3* normals;
    uint32_t differentPoints;
} vplObj;

// A mesh that grows triangle by triangle. Vertices are made when a triangle first needs them.
typedef struct vplObjMesh {
    uint32_t* indices;
    int* materials; // as numbered by vplObjMaterials; -1: none
    int64_t triangleCount;
    int64_t emptyCount; // triangles without area, left out
    uint32_t vertexCount;
    uint32_t* vertexOf;    // of a point; used without normals
    vplHashIndex corners;  // the vertices by point and normal; used with normals, as the next two
    uint32_t* cornerPoint; // of each vertex
    vplVec3* cornerNormal;
    size_t pointCapacity, normalCapacity;
} vplObjMesh;

// The statements of OBJ files that libvpl knows.
typedef enum vplObjStatement {
    VPL_OBJ_POINT,      // v
    VPL_OBJ_NORMAL,     // vn
    VPL_OBJ_FACE,       // f
    VPL_OBJ_MATERIAL,   // usemtl
    VPL_OBJ_LIBRARY,    // mtllib
    VPL_OBJ_IGNORED,    // vt, g, o, s: say nothing that a mesh needs
    VPL_OBJ_UNSUPPORTED // anything else
} vplObjStatement;

// Cuts the keyword off a line.
vplObjStatement vplObj_ReadKeyword(vplWord* line, vplWord* keywordOut);

// Sweep 1.
vplResult vplObj_Count(vplObj* obj);

// Sweep 2.
vplResult vplObj_ReadPoints(vplObj* obj);

// Sweep 3. The mesh is closed by the caller, also on failure.
vplResult vplObj_ReadFaces(vplObj* obj, vplObjMesh* mesh);
void vplObjMesh_Close(vplContext* context, vplObjMesh* mesh);

// Adds the triangle of three corners (numbers of points, and of normals or -1), unless it has no area.
vplResult vplObjMesh_AddTriangle(const vplObj* obj, vplObjMesh* mesh, const uint32_t* points,
                                 const int64_t* normals, int material);

#endif
