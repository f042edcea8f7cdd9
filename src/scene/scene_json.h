// SPDX-License-Identifier: MIT
// What the functions that read scene files share.
#ifndef VPL_SCENE_SCENE_JSON_H
#define VPL_SCENE_SCENE_JSON_H

#include "scene/json_reader.h"
#include "scene/obj_index.h"
#include "scene/scene.h"

typedef struct vplSceneLoader {
    vplJsonReader json;
    vplScene* scene;
    int materialCount;  // of the scene file itself; those of meshes follow
    vplNames meshFiles; // paths of the scene's meshes, in their order
} vplSceneLoader;

// Returns from the caller what a call returns, unless it succeeded.
#define TRY(call)                                                                                            \
    do {                                                                                                     \
        vplResult tryResult = (call);                                                                        \
        if (tryResult != VPL_SUCCESS) {                                                                      \
            return tryResult;                                                                                \
        }                                                                                                    \
    } while (0)

// Turns what the checks found into "file:line:column: path sentence"; `key` overrides the field's own.
vplResult vplSceneLoader_ReportFault(const vplSceneLoader* l, const vplJsonPath* path, const char* key,
                                     const vplFault* fault);

// The same of an emitter, whose intensity is called irradiance where it is directional.
vplResult vplSceneLoader_ReportEmitterFault(const vplSceneLoader* l, const vplJsonPath* path,
                                            vplEmitterType type, const vplFault* fault);

// "fov_y", degrees, into radians.
vplResult vplSceneLoader_ReadFieldOfView(const vplSceneLoader* l, const json_t* object,
                                         const vplJsonPath* path, double* out);

// The type comes before all other keys, because it decides which of them are known.
vplResult vplSceneLoader_ReadType(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                  const char** out);

// Reads one of "objects" and adds it to the scene.
vplResult vplSceneLoader_ReadObject(vplSceneLoader* l, const json_t* value, const vplJsonPath* path);

// "path" of camera or emitter `index`, if there is one.
vplResult vplSceneLoader_ReadCameraPath(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                        int index);
vplResult vplSceneLoader_ReadEmitterPath(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                         int index);

#endif
