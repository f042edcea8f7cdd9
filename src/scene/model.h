// SPDX-License-Identifier: MIT
// Model files: OBJ, PLY and STL, which are one mesh, and glTF, whose nodes place meshes.
#ifndef VPL_SCENE_MODEL_H
#define VPL_SCENE_MODEL_H

#include "math/matrix.h"
#include "scene/obj_text.h"
#include "scene/raw_mesh.h"

typedef enum vplModelKind {
    VPL_MODEL_NONE, // no model file
    VPL_MODEL_OBJ,
    VPL_MODEL_PLY,
    VPL_MODEL_STL,
    VPL_MODEL_GLTF // .gltf or .glb
} vplModelKind;

// All endings, for messages.
#define VPL_MODEL_ENDINGS ".obj, .ply, .stl, .gltf or .glb"

// The kind by the path's ending, in either case.
vplModelKind vplModelKindOf(const char* path);

// The ending of a path that names a model that is not read, such as ".fbx"; else NULL.
const char* vplForeignEnding(const char* path);

typedef struct vplModelPart {
    int mesh; // of the scene
    vplAffine toModel;
    const char* name; // NULL: none
    // Where it stands at frames firstFrame, firstFrame + 1 and so on; 0: it does not move.
    const vplAffine* places;
    int placeCount;
    int64_t firstFrame;
} vplModelPart;

// The meshes that a file places.
typedef struct vplModel {
    vplArena* arena; // owns the parts and their names
    vplModelPart* parts;
    size_t count, capacity;
} vplModel;

// Adds the meshes and materials of a model file to the scene, and lists their places. On failure the scene is as it
// was. A glTF file's cameras and lights are added, too, if `whole`.
vplResult vplScene_ReadModel(vplScene* scene, const char* path, bool whole, vplModel* model);

// Adds an object of the def's name and material for a part, with its path, within the transform `outer`.
vplResult vplScene_AddPart(vplScene* scene, const vplAffine* outer, const vplModelPart* part,
                           const vplObjectDef* def);

// Reads the bytes of a file into a mesh whose triangles all have one material of the scene.
typedef vplResult vplReadMeshFcn(vplText* bytes, vplArena* scratch, int material, vplRawMesh* out);
vplReadMeshFcn vplReadPly, vplReadStl;

#endif
