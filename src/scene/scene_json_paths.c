// SPDX-License-Identifier: MIT
// Reads "path" of a camera or a light in a scene file: an array of keys, each with its frame and the values
// that change. Other values are as declared.
#include "scene/scene_json.h"

#include <math.h>
#include <string.h>

// Reads one key and checks it. `before` is the frame of the key before it, `def` the camera or emitter.
typedef vplResult ReadKeyFcn(const vplJson* at, const void* def, double before, void* key);

static vplResult readCameraKey(const vplJson* at, const void* def, double before, void* out)
{
    static const char* const names[] = {"!frame", "eye", "target", "up", "fov_y", NULL};
    vplCameraKey* key = out;
    *key = vplMakeCameraKey(def, 0);
    TRY(vplJson_CheckKeys(at, names));
    TRY(vplJson_ReadNumber(at, "frame", &key->frame));
    TRY(vplJson_ReadPosition(at, "eye", &key->eye));
    TRY(vplJson_ReadPosition(at, "target", &key->target));
    TRY(vplJson_ReadFloats(at, "up", 3, &key->up));
    TRY(vplJson_ReadAngle(at, "fov_y", 0, 180, &key->fovY));
    const vplCameraDef posed = vplApplyCameraKey(def, key);
    TRY(vplJson_ReportFault(at, vplCheckKeyFrame(before, key->frame)));
    return vplJson_ReportFault(at, vplCheckCamera(&posed));
}

static vplResult readEmitterKey(const vplJson* at, const void* def, double before, void* out)
{
    static const char* const names[][5] = {
        [VPL_EMITTER_POINT] = {"!frame", "position", "intensity", NULL},
        [VPL_EMITTER_SPOT] = {"!frame", "position", "direction", "intensity", NULL},
        [VPL_EMITTER_DIRECTIONAL] = {"!frame", "direction", "irradiance", NULL}};
    vplEmitterKey* key = out;
    *key = vplMakeEmitterKey(def, 0);
    TRY(vplJson_CheckKeys(at, names[((const vplEmitterDef*)def)->type]));
    TRY(vplJson_ReadNumber(at, "frame", &key->frame));
    TRY(vplJson_ReadPosition(at, "position", &key->position));
    TRY(vplJson_ReadFloats(at, "direction", 3, &key->direction));
    TRY(vplJson_ReadFloats(at, "intensity", 3, &key->intensity));
    TRY(vplJson_ReadFloats(at, "irradiance", 3, &key->intensity));
    const vplEmitterDef posed = vplApplyEmitterKey(def, key);
    TRY(vplJson_ReportFault(at, vplCheckKeyFrame(before, key->frame)));
    return vplJson_ReportFault(at, vplCheckEmitter(&posed));
}

// Reads the keys of an array into memory of the loader.
static vplResult readKeys(vplSceneLoader* l, const vplJson* path, const void* def, ReadKeyFcn* readKey,
                          size_t size, char** keysOut)
{
    TRY(vplJson_RequireArray(path));
    const size_t count = json_array_size(path->value);
    if (count == 0) {
        return vplJson_Fail(path, "is empty, must hold at least one key");
    }
    if (count > VPL_MAX_KEYS) {
        return vplJson_Fail(path, "has %zu keys, must have at most %d", count, VPL_MAX_KEYS);
    }
    *keysOut = vplArena_Alloc(l->scratch, count, size);
    TRY(vplArena_Check(l->scratch));
    double before = -INFINITY;
    for (size_t k = 0; k < count; k++) {
        const vplJson element = vplJson_Element(path, (int)k);
        TRY(readKey(&element, def, before, *keysOut + k * size));
        memcpy(&before, *keysOut + k * size, sizeof before); // both types of key begin with their frame
    }
    return VPL_SUCCESS;
}

vplResult vplSceneLoader_ReadCameraPath(vplSceneLoader* l, const vplJson* camera, int index)
{
    const vplJson path = vplJson_Member(camera, "path");
    char* keys = NULL;
    if (path.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(readKeys(l, &path, &l->scene->cameras[index].def, readCameraKey, sizeof(vplCameraKey), &keys));
    return vplScene_SetCameraPath(l->scene, index, (vplCameraKey*)keys, (int)json_array_size(path.value));
}

vplResult vplSceneLoader_ReadEmitterPath(vplSceneLoader* l, const vplJson* emitter, int index)
{
    const vplJson path = vplJson_Member(emitter, "path");
    char* keys = NULL;
    if (path.value == NULL) {
        return VPL_SUCCESS;
    }
    TRY(readKeys(l, &path, &l->scene->emitters[index].def, readEmitterKey, sizeof(vplEmitterKey), &keys));
    return vplScene_SetEmitterPath(l->scene, index, (vplEmitterKey*)keys, (int)json_array_size(path.value));
}
