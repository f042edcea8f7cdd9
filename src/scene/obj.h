// SPDX-License-Identifier: MIT
// Types that the three sweeps over an OBJ file share. The first sweep counts and reads the MTL files, the
// second reads points and normals, the third reads faces.
#ifndef VPL_SCENE_OBJ_H
#define VPL_SCENE_OBJ_H

#include "scene/ear_clipping.h"
#include "scene/hash_index.h"
#include "scene/mtl_maps.h"
#include "scene/obj_text.h"
#include "scene/scene.h"

typedef struct vplObjMaterial {
    vplRgb diffuse, emission;
    vplObjMap colourMap, opacityMap; // map_Kd, map_d
    float opacity;                   // d
    bool defined;                    // by an MTL file
    int sceneIndex;                  // -1 until a triangle needs it
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

// What is given with a point: a vertex is made for each different corner.
typedef struct vplTexcoord {
    float u, v;
} vplTexcoord;

typedef struct vplObjCorner {
    uint32_t point;
    vplVec3 normal;       // 0 if the file has no normals
    vplTexcoord texcoord; // 0 where the material has no picture
} vplObjCorner;

typedef struct vplObj {
    vplArena* scratch; // owns everything here but the text
    vplText text;
    vplObjMaterials materials;
    vplNames libraries; // the files that mtllib named so far
    vplUnknownWords unknown;
    vplTally unplaced;       // texture coordinates that are none, or that faces refer to in vain
    vplTally thin, nameless; // faces of fewer than three corners; usemtl and mtllib without a name
    // From the first sweep.
    int64_t pointCount, normalCount, texcoordCount;
    int64_t triangleCount; // an upper bound: triangles without area are left out later
    bool hasNormals;       // a face refers to one, or is in a smoothing group
    bool hasTexcoords;     // the file has some, and a material has a picture
    bool smooths;          // faces are in smoothing groups, and none refers to a normal
    int64_t group;         // the smoothing group of the last line (s) so far; 0: none
    // From the second sweep.
    vplVec3* points;          // without duplicates
    uint32_t differentPoints; // the number of points
    uint32_t* pointOf;        // the point of each v
    vplVec3* normals;         // unit vectors, or 0 where the file has a zero vector
    vplTexcoord* texcoords;   // NULL without hasTexcoords
} vplObj;

// A mesh that grows triangle by triangle. A vertex is made when a triangle first needs it.
typedef struct vplObjMesh {
    // Owns indices, materials and cornerNormal, for the scene. The scratch arena owns the rest.
    vplArena* arena;
    uint32_t* indices;
    int* materials;  // numbers in vplObjMaterials; -1: none
    int64_t* groups; // of triangles, until normals are known; NULL: none are smoothed
    vplTexcoord*
        waiting; // of the triangles' corners, until normals are known; NULL as well without texcoords
    int64_t triangleCount;
    int64_t emptyCount; // triangles without area, left out
    uint32_t vertexCount;
    // Without normals and texture coordinates: the vertex of each point.
    uint32_t* vertexOf;
    // Else: an index of the vertices by corner, and the parts of each vertex's corner.
    vplHashIndex corners;
    uint32_t* cornerPoint;
    vplVec3* cornerNormal;
    vplTexcoord* cornerTexcoord; // NULL without texture coordinates
    size_t pointCapacity, normalCapacity, texcoordCapacity;
} vplObjMesh;

// A prefix for the names of a file's materials that no name in the scene has: "room.obj:", or with the number
// of the mesh, from 1, "room.obj(2):". Files may share material names, and one file may be read twice. NULL when out of
// memory.
char* vplScene_MakePrefix(const vplScene* scene, const char* path, vplArena* scratch);

// The three sweeps, in this order.
vplResult vplObj_Count(vplObj* obj);
vplResult vplObj_ReadPoints(vplObj* obj);
vplResult vplObj_ReadFaces(vplObj* obj, vplObjMesh* mesh);

// The smoothing group that a line (s) begins: a number, "on" (1) or "off" (0).
int64_t vplObj_ReadGroup(vplWord line);

// Makes the vertices of triangles in smoothing groups, whose indices are those of points so far. Normals are the mean
// over the group's triangles at a point. (obj_smooth.c)
vplResult vplObjMesh_Smooth(const vplObj* obj, vplObjMesh* mesh);

// The vertex of a corner.
vplResult vplObjMesh_FindVertex(const vplObj* obj, vplObjMesh* mesh, const vplObjCorner* corner,
                                uint32_t* vertexOut);

// Tests whether corners have more than points.
static inline bool vplObj_HasCorners(const vplObj* obj)
{
    return obj->hasNormals || obj->hasTexcoords;
}

// Tests whether a material shows a picture.
static inline bool vplObj_HasPicture(const vplObj* obj, int material)
{
    return material >= 0 && (obj->materials.list[material].colourMap.path != NULL ||
                             obj->materials.list[material].opacityMap.path != NULL);
}

// A corner of a face as the file gives it; -1: no such index.
typedef struct vplObjIndices {
    uint32_t point;
    int64_t normal, texcoord;
} vplObjIndices;

// Finds a triangle's unit normal from the order of its corners; false if it has no area. Computes in double, where no
// triangle of floats underflows and where floats of similar size give an exact 0.
bool vplObj_FindNormal(const vplVec3 corners[3], vplVec3* normalOut);

// Adds a triangle, unless it has no area.
vplResult vplObjMesh_AddTriangle(const vplObj* obj, vplObjMesh* mesh, const vplObjIndices corners[3],
                                 int material);

#endif
