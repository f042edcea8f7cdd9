// SPDX-License-Identifier: MIT
// Reads "path" of a camera or a light in a scene file: an array of keys, each with its frame and the values
// that change. Other values are as declared.
#include "scene/scene_json.h"

#include <math.h>
#include <string.h>

// Gets the array "path" and memory for its keys. *countOut is 0 if there is none.
static vplResult openPath(vplSceneLoader* l, const vplJson* path, size_t size, void* keysOut, int* countOut)
{
    *countOut = 0;
    if (path->value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(vplJson_RequireArray(path));
    const size_t count = json_array_size(path->value);
    if (count == 0) {
        return vplJson_Fail(path, "is empty, must hold at least one key");
    }
    if (count > VPL_MAX_KEYS) {
        return vplJson_Fail(path, "has %zu keys, must have at most %d", count, VPL_MAX_KEYS);
    }
    void* keys = vplArena_Alloc(l->scratch, count, size);
    *countOut = (int)count;
    memcpy(keysOut, &keys, sizeof keys);
    return keys != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

static vplResult readCameraKey(const vplJson* at, const vplCameraDef* def, double before, vplCameraKey* key)
{
    static const char* const names[] = {"!frame", "eye", "target", "up", "fov_y", NULL};
    *key = vplMakeCameraKey(def, 0);
    TRY(vplJson_CheckKeys(at, names));
    TRY(vplJson_ReadNumber(at, "frame", &key->frame));
    TRY(vplJson_ReadVec3(at, "eye", &key->eye));
    TRY(vplJson_ReadVec3(at, "target", &key->target));
    TRY(vplJson_ReadVec3(at, "up", &key->up));
    TRY(vplJson_ReadFieldOfView(at, &key->fovY));
    const vplCameraDef posed = vplApplyCameraKey(def, key);
    vplFault fault = vplCheckKeyFrame(before, key->frame);
    fault = fault.field ? fault : vplCheckCamera(&posed);
    return vplJson_ReportFault(at, NULL, &fault);
}

vplResult vplSceneLoader_ReadCameraPath(vplSceneLoader* l, const vplJson* camera, int index)
{
    const vplJson path = vplJson_Member(camera, "path");
    const vplCameraDef def = *vplScene_GetCamera(l->scene, index);
    vplCameraKey* keys;
    int count;
    TRY(openPath(l, &path, sizeof *keys, &keys, &count));
    for (int k = 0; k < count; k++) {
        const vplJson element = vplJson_Element(&path, k);
        TRY(readCameraKey(&element, &def, k > 0 ? keys[k - 1].frame : -INFINITY, &keys[k]));
    }
    return count > 0 ? vplScene_SetCameraPath(l->scene, index, keys, count) : VPL_SUCCESS;
}

static vplResult readEmitterKey(const vplJson* at, const vplEmitterDef* def, double before,
                                vplEmitterKey* key)
{
    static const char* const names[][5] = {
        [VPL_EMITTER_POINT] = {"!frame", "position", "intensity", NULL},
        [VPL_EMITTER_SPOT] = {"!frame", "position", "direction", "intensity", NULL},
        [VPL_EMITTER_DIRECTIONAL] = {"!frame", "direction", "irradiance", NULL}};
    *key = vplMakeEmitterKey(def, 0);
    TRY(vplJson_CheckKeys(at, names[def->type]));
    TRY(vplJson_ReadNumber(at, "frame", &key->frame));
    TRY(vplJson_ReadVec3(at, "position", &key->position));
    TRY(vplJson_ReadVec3(at, "direction", &key->direction));
    TRY(vplJson_ReadRgb(at, vplJson_IntensityKey(def->type), &key->intensity));
    const vplEmitterDef posed = vplApplyEmitterKey(def, key);
    vplFault fault = vplCheckKeyFrame(before, key->frame);
    fault = fault.field ? fault : vplCheckEmitter(&posed);
    return vplJson_ReportEmitterFault(at, def->type, &fault);
}

vplResult vplSceneLoader_ReadEmitterPath(vplSceneLoader* l, const vplJson* emitter, int index)
{
    const vplJson path = vplJson_Member(emitter, "path");
    const vplEmitterDef def = *vplScene_GetEmitter(l->scene, index);
    vplEmitterKey* keys;
    int count;
    TRY(openPath(l, &path, sizeof *keys, &keys, &count));
    for (int k = 0; k < count; k++) {
        const vplJson element = vplJson_Element(&path, k);
        TRY(readEmitterKey(&element, &def, k > 0 ? keys[k - 1].frame : -INFINITY, &keys[k]));
    }
    return count > 0 ? vplScene_SetEmitterPath(l->scene, index, keys, count) : VPL_SUCCESS;
}
