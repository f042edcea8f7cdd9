// SPDX-License-Identifier: MIT
// The declared scene from the inside, and the checks that the API and the file reader share.
#ifndef VPL_SCENE_SCENE_H
#define VPL_SCENE_SCENE_H

#include <vpl/scene.h>

#include "base/context.h"

struct vplScene {
    vplContext* context;
    vplCameraDef* cameras;
    vplMaterialDef* materials;
    vplObjectDef* objects;
    vplEmitterDef* emitters;
    int cameraCount, materialCount, objectCount, emitterCount;
    size_t cameraCapacity, materialCapacity, objectCapacity, emitterCapacity;
};

// What is wrong with a def: which field, and the rest of the sentence after "<field> ".
typedef struct vplFault {
    const char* field; // as in the def; NULL: nothing is wrong
    int index;         // of a vector's component, or -1
    char text[160];
} vplFault;

vplFault vplCheckCamera(const vplCameraDef* def);
vplFault vplCheckMaterial(const vplMaterialDef* def);
vplFault vplCheckTransform(const vplMat4* transform);
vplFault vplCheckEmitter(const vplEmitterDef* def);

#endif
