// SPDX-License-Identifier: MIT
// Cameras and emitters that move. What is between two keys is a + t (b - a), so that what both keys share stays as it
// is to the last bit; what the keys themselves say is met exactly.
#include "math/vec.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

vplCameraKey vplMakeCameraKey(const vplCameraDef* def, double frame)
{
    return (vplCameraKey){frame, def->eye, def->target, def->up, def->fovY};
}

vplEmitterKey vplMakeEmitterKey(const vplEmitterDef* def, double frame)
{
    return (vplEmitterKey){frame, def->position, def->direction, def->intensity};
}

vplCameraDef vplApplyCameraKey(const vplCameraDef* def, const vplCameraKey* key)
{
    vplCameraDef posed = *def;
    posed.eye = key->eye;
    posed.target = key->target;
    posed.up = key->up;
    posed.fovY = key->fovY;
    return posed;
}

vplEmitterDef vplApplyEmitterKey(const vplEmitterDef* def, const vplEmitterKey* key)
{
    vplEmitterDef posed = *def;
    posed.position = key->position;
    posed.direction = key->direction;
    posed.intensity = key->intensity;
    return posed;
}

// ---- between keys

// In double: the difference of two floats must neither overflow nor lose what it is added to.
static float mixNumbers(double t, float a, float b)
{
    return (float)((double)a + t * ((double)b - (double)a));
}

static vplVec3 mixVectors(double t, vplVec3 a, vplVec3 b)
{
    return vplVec(mixNumbers(t, a.x, b.x), mixNumbers(t, a.y, b.y), mixNumbers(t, a.z, b.z));
}

static vplCameraKey mixCameraKeys(double t, const vplCameraKey* a, const vplCameraKey* b)
{
    return (vplCameraKey){0, mixVectors(t, a->eye, b->eye), mixVectors(t, a->target, b->target),
                          mixVectors(t, a->up, b->up), a->fovY + t * (b->fovY - a->fovY)};
}

static vplEmitterKey mixEmitterKeys(double t, const vplEmitterKey* a, const vplEmitterKey* b)
{
    const vplRgb intensity = {mixNumbers(t, a->intensity.r, b->intensity.r),
                              mixNumbers(t, a->intensity.g, b->intensity.g),
                              mixNumbers(t, a->intensity.b, b->intensity.b)};
    return (vplEmitterKey){0, mixVectors(t, a->position, b->position),
                           mixVectors(t, a->direction, b->direction), intensity};
}

static const vplPath* findPath(const vplPathList* list, int index)
{
    for (int i = 0; i < list->count; i++) {
        if (list->paths[i].index == index) {
            return &list->paths[i];
        }
    }
    return NULL;
}

// Both kinds of key begin with their frame.
static double frameOf(const void* keys, size_t size, int k)
{
    double frame;
    memcpy(&frame, (const char*)keys + (size_t)k * size, sizeof frame);
    return frame;
}

// The last key that is not after the frame, or the first; how far the frame is from there to the next, [0, 1); and
// that, or the same where it stays.
static int findKey(const vplPath* path, size_t size, double frame, double* share, int* next)
{
    int low = 0, high = path->count; // the key is in [low, high)
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        const bool before = frameOf(path->keys, size, middle) <= frame;
        low = before ? middle : low;
        high = before ? high : middle;
    }
    const double from = frameOf(path->keys, size, low);
    *next = low + 1 < path->count && frame > from ? low + 1 : low;
    *share = *next > low ? (frame - from) / (frameOf(path->keys, size, *next) - from) : 0;
    return low;
}

static vplResult failPose(const vplScene* scene, const char* what, int index, double frame,
                          const vplFault* fault)
{
    return fault->field == NULL ? VPL_SUCCESS
                                : vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s %d at frame %g: %s %s",
                                          what, index, frame, fault->field, fault->text);
}

vplResult vplScene_PoseCamera(const vplScene* scene, int index, double frame, vplCameraDef* defOut)
{
    const vplPath* path = findPath(&scene->cameraPaths, index);
    vplCameraDef def = scene->cameras[index];
    if (path != NULL) {
        double t;
        int next;
        const vplCameraKey* keys = path->keys;
        const int k = findKey(path, sizeof *keys, frame, &t, &next);
        const vplCameraKey key = mixCameraKeys(t, &keys[k], &keys[next]);
        def = vplApplyCameraKey(&def, &key);
        const vplFault fault = vplCheckCamera(&def);
        vplResult result = failPose(scene, "camera", index, frame, &fault);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    *defOut = def;
    return VPL_SUCCESS;
}

vplResult vplScene_PoseEmitter(const vplScene* scene, int index, double frame, vplEmitterDef* defOut)
{
    const vplPath* path = findPath(&scene->emitterPaths, index);
    vplEmitterDef def = scene->emitters[index];
    if (path != NULL) {
        double t;
        int next;
        const vplEmitterKey* keys = path->keys;
        const int k = findKey(path, sizeof *keys, frame, &t, &next);
        const vplEmitterKey key = mixEmitterKeys(t, &keys[k], &keys[next]);
        def = vplApplyEmitterKey(&def, &key);
        const vplFault fault = vplCheckEmitter(&def);
        vplResult result = failPose(scene, "light", index, frame, &fault);
        if (result != VPL_SUCCESS) {
            return result;
        }
    }
    *defOut = def;
    return VPL_SUCCESS;
}

// ---- keeping paths

const vplCameraKey* vplScene_GetCameraPath(const vplScene* scene, int index, int* countOut)
{
    const vplPath* path = findPath(&scene->cameraPaths, index);
    *countOut = path ? path->count : 0;
    return path ? path->keys : NULL;
}

const vplEmitterKey* vplScene_GetEmitterPath(const vplScene* scene, int index, int* countOut)
{
    const vplPath* path = findPath(&scene->emitterPaths, index);
    *countOut = path ? path->count : 0;
    return path ? path->keys : NULL;
}

static vplResult checkCount(const vplScene* scene, const char* type, int index, int things, int count)
{
    if (index < 0 || index >= things) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s: index is %d, must be one of the scene's %d",
                       type, index, things);
    }
    if (count < 0 || count > VPL_MAX_KEYS) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s: count is %d, must be in [0, %d]", type,
                       count, VPL_MAX_KEYS);
    }
    return VPL_SUCCESS;
}

vplFault vplCheckKeyFrame(double before, double frame)
{
    vplFault fault = {NULL, -1, ""};
    if (!(fabs(frame) <= VPL_MAX_FRAME)) {
        fault.field = "frame";
        snprintf(fault.text, sizeof fault.text, "is %g, must be in [%d, %d]", frame, -VPL_MAX_FRAME,
                 VPL_MAX_FRAME);
    } else if (!(frame > before)) {
        fault.field = "frame";
        snprintf(fault.text, sizeof fault.text, "is %g, must be greater than that of the key before (%g)",
                 frame, before);
    }
    return fault;
}

static vplResult failKey(const vplScene* scene, const char* type, int k, const vplFault* fault)
{
    if (fault->field == NULL) {
        return VPL_SUCCESS;
    }
    char component[16] = "";
    if (fault->index >= 0) {
        snprintf(component, sizeof component, "[%d]", fault->index);
    }
    return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s %d: %s%s %s", type, k, fault->field, component,
                   fault->text);
}

// Copies the keys; the path that was there goes.
static vplResult setPath(vplScene* scene, vplPathList* list, int index, const void* keys, size_t size,
                         int count)
{
    vplResult result = vplReserve(scene->context, &list->paths, &list->capacity, (size_t)list->count + 1,
                                  sizeof *list->paths);
    void* copy = result == VPL_SUCCESS ? vplAlloc(scene->context, (size_t)count, size) : NULL;
    if (copy == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplPath* path = (vplPath*)findPath(list, index);
    if (path != NULL) {
        vplFree(scene->context, path->keys);
        *path = list->paths[--list->count];
    }
    if (count == 0) {
        vplFree(scene->context, copy);
        return VPL_SUCCESS;
    }
    memcpy(copy, keys, (size_t)count * size);
    list->paths[list->count++] = (vplPath){index, count, copy};
    return VPL_SUCCESS;
}

vplResult vplScene_SetCameraPath(vplScene* scene, int index, const vplCameraKey* keys, int count)
{
    vplResult result = checkCount(scene, "vplCameraKey", index, scene->cameraCount, count);
    for (int k = 0; k < count && result == VPL_SUCCESS; k++) {
        const vplCameraDef def = vplApplyCameraKey(&scene->cameras[index], &keys[k]);
        vplFault fault = vplCheckKeyFrame(k > 0 ? keys[k - 1].frame : -INFINITY, keys[k].frame);
        fault = fault.field ? fault : vplCheckCamera(&def);
        result = failKey(scene, "vplCameraKey", k, &fault);
    }
    return result == VPL_SUCCESS ? setPath(scene, &scene->cameraPaths, index, keys, sizeof *keys, count)
                                 : result;
}

vplResult vplScene_SetEmitterPath(vplScene* scene, int index, const vplEmitterKey* keys, int count)
{
    vplResult result = checkCount(scene, "vplEmitterKey", index, scene->emitterCount, count);
    for (int k = 0; k < count && result == VPL_SUCCESS; k++) {
        const vplEmitterDef def = vplApplyEmitterKey(&scene->emitters[index], &keys[k]);
        vplFault fault = vplCheckKeyFrame(k > 0 ? keys[k - 1].frame : -INFINITY, keys[k].frame);
        fault = fault.field ? fault : vplCheckEmitter(&def);
        result = failKey(scene, "vplEmitterKey", k, &fault);
    }
    return result == VPL_SUCCESS ? setPath(scene, &scene->emitterPaths, index, keys, sizeof *keys, count)
                                 : result;
}

static void freeList(vplContext* context, vplPathList* list)
{
    for (int i = 0; i < list->count; i++) {
        vplFree(context, list->paths[i].keys);
    }
    vplFree(context, list->paths);
}

void vplFreePaths(vplScene* scene)
{
    freeList(scene->context, &scene->cameraPaths);
    freeList(scene->context, &scene->emitterPaths);
}
