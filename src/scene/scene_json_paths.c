// SPDX-License-Identifier: MIT
// "path" of a camera or a light in a scene file: an array of keys, each with its frame and what changes. What a key does
// not name is as declared.
#include "scene/scene_json.h"

#include <math.h>

// The array at "path" with room for its keys; NULL, and success, where there is none.
static vplResult openPath(vplSceneLoader* l, const json_t* value, const vplJsonPath* path, size_t size,
                          void** keysOut, int* countOut)
{
    const json_t* array = json_object_get(value, "path");
    *keysOut = NULL;
    *countOut = 0;
    if (array == NULL) {
        return VPL_SUCCESS;
    }
    const vplJsonPath member = {path, "path", 0};
    TRY(vplJsonReader_RequireArray(&l->json, array, &member));
    const size_t count = json_array_size(array);
    if (count == 0) {
        return vplJsonReader_Fail(&l->json, &member, "is empty, must hold at least one key");
    }
    if (count > VPL_MAX_KEYS) {
        return vplJsonReader_Fail(&l->json, &member, "has %zu keys, must have at most %d", count,
                                  VPL_MAX_KEYS);
    }
    *countOut = (int)count;
    *keysOut = vplAlloc(l->json.context, count, size);
    return *keysOut != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static vplResult readCameraKey(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                               const vplCameraDef* def, double before, vplCameraKey* key)
{
    static const char* const names[] = {"!frame", "eye", "target", "up", "fov_y", NULL};
    const vplJsonReader* json = &l->json;
    *key = vplMakeCameraKey(def, 0);
    TRY(vplJsonReader_CheckKeys(json, value, path, names));
    TRY(vplJsonReader_Number(json, value, path, "frame", &key->frame));
    TRY(vplJsonReader_Floats(json, value, path, "eye", 3, &key->eye.x));
    TRY(vplJsonReader_Floats(json, value, path, "target", 3, &key->target.x));
    TRY(vplJsonReader_Floats(json, value, path, "up", 3, &key->up.x));
    TRY(vplSceneLoader_ReadFieldOfView(l, value, path, &key->fovY));
    const vplCameraDef posed = vplApplyCameraKey(def, key);
    vplFault fault = vplCheckKeyFrame(before, key->frame);
    fault = fault.field ? fault : vplCheckCamera(&posed);
    return vplSceneLoader_ReportFault(l, path, NULL, &fault);
}

vplResult vplSceneLoader_ReadCameraPath(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                        int index)
{
    const json_t* array = json_object_get(value, "path");
    const vplJsonPath member = {path, "path", 0};
    const vplCameraDef def = *vplScene_GetCamera(l->scene, index);
    vplCameraKey* keys;
    int count;
    vplResult result = openPath(l, value, path, sizeof *keys, (void**)&keys, &count);
    for (int k = 0; k < count && result == VPL_SUCCESS; k++) {
        const vplJsonPath element = {&member, NULL, k};
        result = readCameraKey(l, json_array_get(array, (size_t)k), &element, &def,
                               k > 0 ? keys[k - 1].frame : -INFINITY, &keys[k]);
    }
    if (keys != NULL && result == VPL_SUCCESS) {
        result = vplScene_SetCameraPath(l->scene, index, keys, count);
    }
    vplFree(l->json.context, keys);
    return result;
}

// The keys of a key are those of the light's type that can change.
static vplResult readEmitterKey(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                const vplEmitterDef* def, double before, vplEmitterKey* key)
{
    static const char* const names[][5] = {
        [VPL_EMITTER_POINT] = {"!frame", "position", "intensity", NULL},
        [VPL_EMITTER_SPOT] = {"!frame", "position", "direction", "intensity", NULL},
        [VPL_EMITTER_DIRECTIONAL] = {"!frame", "direction", "irradiance", NULL}};
    const vplJsonReader* json = &l->json;
    const char* strength = def->type == VPL_EMITTER_DIRECTIONAL ? "irradiance" : "intensity";
    *key = vplMakeEmitterKey(def, 0);
    TRY(vplJsonReader_CheckKeys(json, value, path, names[def->type]));
    TRY(vplJsonReader_Number(json, value, path, "frame", &key->frame));
    TRY(vplJsonReader_Floats(json, value, path, "position", 3, &key->position.x));
    TRY(vplJsonReader_Floats(json, value, path, "direction", 3, &key->direction.x));
    TRY(vplJsonReader_Floats(json, value, path, strength, 3, &key->intensity.r));
    const vplEmitterDef posed = vplApplyEmitterKey(def, key);
    vplFault fault = vplCheckKeyFrame(before, key->frame);
    fault = fault.field ? fault : vplCheckEmitter(&posed);
    return vplSceneLoader_ReportEmitterFault(l, path, def->type, &fault);
}

vplResult vplSceneLoader_ReadEmitterPath(vplSceneLoader* l, const json_t* value, const vplJsonPath* path,
                                         int index)
{
    const json_t* array = json_object_get(value, "path");
    const vplJsonPath member = {path, "path", 0};
    const vplEmitterDef def = *vplScene_GetEmitter(l->scene, index);
    vplEmitterKey* keys;
    int count;
    vplResult result = openPath(l, value, path, sizeof *keys, (void**)&keys, &count);
    for (int k = 0; k < count && result == VPL_SUCCESS; k++) {
        const vplJsonPath element = {&member, NULL, k};
        result = readEmitterKey(l, json_array_get(array, (size_t)k), &element, &def,
                                k > 0 ? keys[k - 1].frame : -INFINITY, &keys[k]);
    }
    if (keys != NULL && result == VPL_SUCCESS) {
        result = vplScene_SetEmitterPath(l->scene, index, keys, count);
    }
    vplFree(l->json.context, keys);
    return result;
}
