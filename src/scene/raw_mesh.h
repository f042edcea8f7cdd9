// SPDX-License-Identifier: MIT
// A mesh as a file has it, before it becomes one of the scene.
#ifndef VPL_SCENE_RAW_MESH_H
#define VPL_SCENE_RAW_MESH_H

#include "scene/scene.h"

// A reader fills the arrays of vertices, which are of one length, and adds triangles.
typedef struct vplRawMesh {
    const char* file; // in messages
    vplArena* arena;  // owns the arrays; becomes the scene's
    vplVec3* positions;
    vplVec3* normals; // of any length; NULL: there are none; 0 or not finite: that of the triangle
    vplRgb* colors;   // linear, in [0, 1]; NULL: there are none
    float* texcoords; // two per vertex; NULL: there are none
    size_t vertexCount;
    uint32_t* indices; // three per triangle
    int* materials;    // of the scene, one per triangle
    size_t triangleCount, indexCapacity, materialCapacity;
} vplRawMesh;

// Adds a triangle, whose indices must be those of vertices. VPL_OUT_OF_MEMORY, VPL_LIMIT.
vplResult vplRawMesh_AddTriangle(vplRawMesh* raw, vplContext* context, const uint32_t corners[3],
                                 int material);

// Moves the mesh to the scene. Leaves out triangles without area and vertices without triangles, gives corners without
// a normal that of their triangle, and merges vertices that are equal in everything. *indexOut is -1, and nothing is
// added, if no triangle is left. The arena is the scene's afterwards, or destroyed.
vplResult vplScene_AddRawMesh(vplScene* scene, vplRawMesh* raw, int* indexOut);

#endif
