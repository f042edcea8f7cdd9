// SPDX-License-Identifier: MIT
// The declared scene from the inside, and the checks that the API and the file readers share.
#ifndef VPL_SCENE_SCENE_H
#define VPL_SCENE_SCENE_H

#include <vpl/scene.h>

#include "base/arena.h"

// The keyframes of one camera or emitter.
typedef struct vplTrack {
    int index; // of the camera or emitter
    int count; // of keys, at least 1
    void* keys;
} vplTrack;

// The tracks of all cameras, or of all emitters, that move; in no order.
typedef struct vplTrackList {
    vplTrack* tracks;
    size_t capacity;
    int count;
} vplTrackList;

struct vplScene {
    vplContext* context;
    vplArena* arena; // owns the scene and everything in it
    uint64_t stamp;  // changes with each addition
    vplCameraDef* cameras;
    vplMaterialDef* materials;
    vplMeshDef* meshes;
    vplObjectDef* objects;
    vplEmitterDef* emitters;
    int cameraCount, materialCount, meshCount, objectCount, emitterCount;
    size_t cameraCapacity, materialCapacity, meshCapacity, objectCapacity, emitterCapacity;
    vplTrackList cameraTracks, emitterTracks;
};

// Adds a mesh without checking it. Its arrays are in `arena`, which becomes part of the scene's; on failure
// it is destroyed. Fails, too, if an allocation of `arena` failed.
vplResult vplScene_AdoptMesh(vplScene* scene, const vplMeshDef* mesh, vplArena* arena, int* indexOut);

// Adds a material without checking it or copying its name.
vplResult vplScene_AdoptMaterial(vplScene* scene, const vplMaterialDef* material, int* indexOut);

// Reads an OBJ file as a whole scene, with a camera and a light of our own.
vplResult vplScene_LoadObjAlone(vplContext* context, const char* path, vplScene** sceneOut);

// The first thing that is wrong with a def: its field, and the rest of the sentence after "<field> ".
typedef struct vplFault {
    const char* field; // as in the def; NULL: nothing is wrong
    int index;         // of a vector's component or an array's element, or -1
    char text[160];
} vplFault;

vplFault vplCheckCamera(const vplCameraDef* def);
vplFault vplCheckMaterial(const vplMaterialDef* def);
vplFault vplCheckMesh(const vplMeshDef* def, int materialCount);
vplFault vplCheckTransform(const vplMat4* transform);
vplFault vplCheckEmitter(const vplEmitterDef* def);

// Checks that a key may follow one at frame `before`.
vplFault vplCheckKeyFrame(double before, double frame);

// The def with the values of the key.
vplCameraDef vplApplyCameraKey(const vplCameraDef* def, const vplCameraKey* key);
vplEmitterDef vplApplyEmitterKey(const vplEmitterDef* def, const vplEmitterKey* key);

#endif
