// SPDX-License-Identifier: MIT
// The declared scene from the inside, and the checks that the API and the file reader share.
#ifndef VPL_SCENE_SCENE_H
#define VPL_SCENE_SCENE_H

#include <vpl/scene.h>

#include "base/context.h"

// How one camera or emitter moves.
typedef struct vplPath {
    int index; // of the camera or emitter
    int count; // of keys, at least 1
    void* keys;
} vplPath;

// Those that move, in no order.
typedef struct vplPathList {
    vplPath* paths;
    size_t capacity;
    int count;
} vplPathList;

struct vplScene {
    vplContext* context;
    uint64_t stamp; // another one after each addition
    vplCameraDef* cameras;
    vplMaterialDef* materials;
    vplMeshDef* meshes; // their arrays are the scene's own
    vplObjectDef* objects;
    vplEmitterDef* emitters;
    int cameraCount, materialCount, meshCount, objectCount, emitterCount;
    vplPathList cameraPaths, emitterPaths;
    size_t cameraCapacity, materialCapacity, meshCapacity, objectCapacity, emitterCapacity;
};

// Adds a mesh whose arrays were made by vplAlloc and now belong to the scene, also on failure. Nothing is
// checked: readers make valid meshes.
vplResult vplScene_AdoptMesh(vplScene* scene, const vplMeshDef* mesh, int* indexOut);

// Adds a material whose name (or NULL) was made by vplAlloc and now belongs to the scene, also on failure.
// Nothing is checked: the name must be unique.
vplResult vplScene_AdoptMaterial(vplScene* scene, const vplMaterialDef* material, int* indexOut);

// Takes back the materials from number `count` on; nothing may refer to them.
void vplScene_DropMaterials(vplScene* scene, int count);

void vplFreeMesh(vplContext* context, const vplMeshDef* mesh);

// Reads a scene file, or an OBJ file with a camera and a light of our own.
vplResult vplScene_LoadJson(vplContext* context, const char* path, vplScene** sceneOut);
vplResult vplScene_LoadObjAlone(vplContext* context, const char* path, vplScene** sceneOut);

// What is wrong with a def: which field, and the rest of the sentence after "<field> ".
typedef struct vplFault {
    const char* field; // as in the def; NULL: nothing is wrong
    int index;         // of a vector's component, or -1
    char text[160];
} vplFault;

vplFault vplCheckCamera(const vplCameraDef* def);
vplFault vplCheckMaterial(const vplMaterialDef* def);
vplFault vplCheckMesh(const vplMeshDef* def, int materialCount);
vplFault vplCheckTransform(const vplMat4* transform);
vplFault vplCheckEmitter(const vplEmitterDef* def);

// The declared thing with what the key says instead.
vplCameraDef vplApplyCameraKey(const vplCameraDef* def, const vplCameraKey* key);
vplEmitterDef vplApplyEmitterKey(const vplEmitterDef* def, const vplEmitterKey* key);

// Whether a key may follow one of frame `before`.
vplFault vplCheckKeyFrame(double before, double frame);

void vplFreePaths(vplScene* scene);

#endif
