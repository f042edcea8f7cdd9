// SPDX-License-Identifier: MIT
// Helpers and state of the functions that read scene files.
#ifndef VPL_SCENE_SCENE_JSON_H
#define VPL_SCENE_SCENE_JSON_H

#include "scene/hash_index.h"
#include "scene/json_reader.h"
#include "scene/model.h"
#include "scene/scene.h"

typedef struct vplSceneLoader {
    vplJsonFile json;
    vplArena* scratch;
    vplScene* scene;
    int materialCount;   // of the scene file itself; those of meshes follow
    vplNames modelFiles; // paths that objects named so far
    vplModel* models;    // of those files
    size_t modelCapacity;
} vplSceneLoader;

// Reads what a material says of textures and opacity. (scene_json_textures.c)
vplResult vplSceneLoader_ReadTextures(vplSceneLoader* l, const vplJson* material, vplMaterialDef* def);

// Finds the origin of a scene file, as vplScene_SetOrigin describes it.
void vplFindOrigin(json_t* root, double originOut[3]);

// Logs a fault, if there is one, as "file:line:column: path sentence" of a member of `object`.
vplResult vplJson_ReportFault(const vplJson* object, vplFault fault);

// Reads an angle in degrees, in the open interval (above, below), into radians.
vplResult vplJson_ReadAngle(const vplJson* object, const char* key, double above, double below, double* out);

// Reads "type", before all other keys: it decides which of them are known. *out is its index among `names`,
// which NULL ends; `expected` completes "must be ...".
vplResult vplJson_ReadType(const vplJson* object, const char* const* names, const char* expected, int* out);

// Reads one of "objects" and adds it to the scene.
vplResult vplSceneLoader_ReadObject(vplSceneLoader* l, const vplJson* object);

// Reads "environment" of the root, if there is one.
vplResult vplSceneLoader_ReadEnvironment(vplSceneLoader* l, const vplJson* root);

// Reads "path" of camera or emitter `index`, if there is one.
vplResult vplSceneLoader_ReadCameraPath(vplSceneLoader* l, const vplJson* camera, int index);
vplResult vplSceneLoader_ReadEmitterPath(vplSceneLoader* l, const vplJson* emitter, int index);

#endif
