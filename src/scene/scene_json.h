// SPDX-License-Identifier: MIT
// What the functions that read scene files share.
#ifndef VPL_SCENE_SCENE_JSON_H
#define VPL_SCENE_SCENE_JSON_H

#include "scene/hash_index.h"
#include "scene/json_reader.h"
#include "scene/scene.h"

typedef struct vplSceneLoader {
    vplJsonFile json;
    vplArena* scratch;
    vplScene* scene;
    int materialCount;  // of the scene file itself; those of meshes follow
    vplNames meshFiles; // paths of the scene's meshes, in their order
} vplSceneLoader;

// Logs a fault, if there is one, as "file:line:column: path sentence" of a member of `object`. `key`
// overrides the field's own.
vplResult vplJson_ReportFault(const vplJson* object, const char* key, const vplFault* fault);

// The same for an emitter, whose intensity has the key below.
vplResult vplJson_ReportEmitterFault(const vplJson* object, vplEmitterType type, const vplFault* fault);

// The key of an emitter's intensity: "irradiance" for directional emitters, else "intensity".
const char* vplJson_IntensityKey(vplEmitterType type);

// Reads "fov_y", degrees, into radians.
vplResult vplJson_ReadFieldOfView(const vplJson* object, double* out);

// Reads "type", before all other keys: it decides which of them are known. *out is its index among `names`,
// which NULL ends; `expected` completes "must be ...".
vplResult vplJson_ReadType(const vplJson* object, const char* const* names, const char* expected, int* out);

// Reads one of "objects" and adds it to the scene.
vplResult vplSceneLoader_ReadObject(vplSceneLoader* l, const vplJson* object);

// Reads "path" of camera or emitter `index`, if there is one.
vplResult vplSceneLoader_ReadCameraPath(vplSceneLoader* l, const vplJson* camera, int index);
vplResult vplSceneLoader_ReadEmitterPath(vplSceneLoader* l, const vplJson* emitter, int index);

#endif
