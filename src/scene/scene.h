// SPDX-License-Identifier: MIT
// The declared scene from the inside, and the checks that the API and the file readers share.
#ifndef VPL_SCENE_SCENE_H
#define VPL_SCENE_SCENE_H

#include <vpl/scenetools.h>

#include "base/arena.h"

// The keyframes of a camera, emitter or object. One that stands still has none.
typedef struct vplTrack {
    void* keys; // vplCameraKey, vplEmitterKey or vplTransformKey
    int count;
} vplTrack;

typedef struct vplCamera {
    vplCameraDef def;
    vplTrack track;
} vplCamera;

typedef struct vplEmitter {
    vplEmitterDef def;
    vplTrack track;
} vplEmitter;

// The keyframes of an object that moves.
typedef struct vplMover {
    int object;
    vplTrack track;
} vplMover;

typedef struct vplSceneTexture {
    vplTextureDef def; // without texels
    struct vplTexture* decoded;
    float otherwise; // see vplTextureFile
} vplSceneTexture;

struct vplScene {
    vplContext* context;
    vplArena* arena;           // owns the scene and everything in it
    uint64_t identity;         // differs from that of every other scene of the context
    uint64_t stamp;            // changes with everything
    uint64_t surfaces;         // changes with all that geometry is made of
    uint64_t environmentStamp; // changes with the environment
    double origin[3];
    vplCamera* cameras;
    vplSceneTexture* textures;
    vplMaterialDef* materials;
    vplMeshDef* meshes;
    vplObjectDef* objects;
    vplEmitter* emitters;
    vplMover* movers;
    vplEnvironmentDef environment;
    float* environmentPixels; // in the arena
    int sun;                  // 1 + index of the environment's emitter; 0: none
    int cameraCount, textureCount, materialCount, meshCount, objectCount, emitterCount, moverCount;
    size_t cameraCapacity, textureCapacity, materialCapacity, meshCapacity, objectCapacity, emitterCapacity,
        moverCapacity;
};

// Notes a change; of surfaces: of anything but cameras and emitters.
void vplScene_Touch(vplScene* scene, bool surfaces);

// Forgets the path of an object, if it has one. It stays where it is.
void vplScene_DropMover(vplScene* scene, int object);

// Adds a mesh without checking it. Its arrays are in `arena`, which becomes part of the scene's; on failure
// it is destroyed. Fails, too, if an allocation of `arena` failed.
vplResult vplScene_AdoptMesh(vplScene* scene, const vplMeshDef* mesh, vplArena* arena, int* indexOut);

// Adds a material without checking it or copying its name.
vplResult vplScene_AdoptMaterial(vplScene* scene, const vplMaterialDef* material, int* indexOut);

// Bytes that the context holds for a scene and its textures.
size_t vplScene_GetBytes(const vplScene* scene);

// Releases all textures but the first `count`.
void vplScene_DropTextures(vplScene* scene, int count);

// Ends the creation of a scene: on success stores it in *sceneOut, else destroys it. Returns `result`.
vplResult vplScene_Deliver(vplScene* scene, vplResult result, vplScene** sceneOut);

// Reads a model file as a whole scene, with a camera, a ground and a light of our own.
vplResult vplScene_LoadModelAlone(vplContext* context, const char* path, const vplModelSceneDef* def,
                                  vplScene** sceneOut);

// VPL_MAX_MAGNITUDE for fields in double. The float nearest to 1e15 is 1.3e7 below it, so a comparison with that float
// refuses 1e15 itself.
#define VPL_MAX_MAGNITUDE_DOUBLE 1e15

// The first thing that is wrong with a def: its field, and the rest of the sentence after "<field> ".
typedef struct vplFault {
    const char* field; // as in the def; NULL: nothing is wrong
    int index;         // of a vector's component or an array's element, or -1
    char text[160];
} vplFault;

vplFault vplCheckCamera(const vplCameraDef* def);
vplFault vplCheckTexture(const vplTextureDef* def);
vplFault vplCheckMaterial(const vplMaterialDef* def, int textureCount);
vplFault vplCheckMesh(const vplMeshDef* def, int materialCount);
vplFault vplCheckTransform(const vplMat4* transform);
vplFault vplCheckEmitter(const vplEmitterDef* def);
vplFault vplCheckEnvironment(const vplEnvironmentDef* def);

// Checks a camera def and its cookie; the message begins with `subject`.
vplResult vplScene_CheckCamera(const vplScene* scene, const char* subject, const vplCameraDef* def);

// Check a def and its cookie; a material is to be number `index`.
vplResult vplScene_CheckTexture(const vplScene* scene, const vplTextureDef* def);
vplResult vplScene_CheckMaterial(const vplScene* scene, const vplMaterialDef* def, int index);
vplResult vplScene_CheckMesh(const vplScene* scene, const vplMeshDef* def);
vplResult vplScene_CheckObject(const vplScene* scene, const vplObjectDef* def);
vplResult vplScene_CheckEmitter(const vplScene* scene, const vplEmitterDef* def);

// Fails unless an object of this type and mesh may have the material.
vplResult vplScene_CheckObjectMaterial(const vplScene* scene, vplObjectType type, int mesh, int material);

// Logs a fault, if there is one, as "<subject><field> <text>"; fails if there is one.
vplResult vplScene_ReportFault(const vplScene* scene, const char* subject, vplFault fault);

// Fails unless 0 <= index < count; `what` names what the scene has so many of.
vplResult vplScene_CheckIndex(const vplScene* scene, const char* what, int index, int count);

// ---- keyframes (keyframes.c)

// The keys around a frame. Before the first key and after the last, both are the same and t is 0.
typedef struct vplKeyInterval {
    int key, next;
    double t; // [0, 1)
} vplKeyInterval;

// Finds the interval of a track that has keys; `size` is that of a key.
vplKeyInterval vplTrack_Find(const vplTrack* track, size_t size, double frame);

// The keys, and their number, which may be NULL; NULL and 0 where the track is NULL.
const void* vplTrack_GetKeys(const vplTrack* track, int* countOut);

// The keys of a path that the user sets.
typedef struct vplKeys {
    const char* type;
    const void* keys;
    size_t size; // of a key
    int count;
    vplFault (*check)(const void* def, const void* key);
} vplKeys;

// Replaces the keys of a track by a copy of others, which are checked for the def.
vplResult vplScene_SetKeys(vplScene* scene, const vplKeys* keys, const void* def, vplTrack* track);

// Checks that a key may follow one at frame `before`.
vplFault vplCheckKeyFrame(double before, double frame);

// The def with the values of the key.
vplCameraDef vplApplyCameraKey(const vplCameraDef* def, const vplCameraKey* key);
vplEmitterDef vplApplyEmitterKey(const vplEmitterDef* def, const vplEmitterKey* key);

// The emitter that is the sun of the scene's sky; -1: there is none.
int vplScene_GetSun(const vplScene* scene);

#endif
