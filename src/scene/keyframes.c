// SPDX-License-Identifier: MIT
// Cameras and emitters that move, by linear interpolation between keyframes. The formula a + t (b - a)
// reproduces the keys, and values that both keys share, exactly.
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

// ---- interpolation

// In double, because the difference of two floats may overflow or lose digits.
static float lerp(double t, float a, float b)
{
    return (float)((double)a + t * ((double)b - (double)a));
}

static vplVec3 lerpVec(double t, vplVec3 a, vplVec3 b)
{
    return vplVec(lerp(t, a.x, b.x), lerp(t, a.y, b.y), lerp(t, a.z, b.z));
}

static vplRgb lerpRgb(double t, vplRgb a, vplRgb b)
{
    return (vplRgb){lerp(t, a.r, b.r), lerp(t, a.g, b.g), lerp(t, a.b, b.b)};
}

static const vplTrack* findTrack(const vplTrackList* list, int index)
{
    for (int i = 0; i < list->count; i++) {
        if (list->tracks[i].index == index) {
            return &list->tracks[i];
        }
    }
    return NULL;
}

// Both types of key begin with their frame.
static double frameOf(const void* keys, size_t size, int k)
{
    double frame;
    memcpy(&frame, (const char*)keys + (size_t)k * size, sizeof frame);
    return frame;
}

// The keys around a frame. Before the first key and after the last, both are the same and t is 0.
typedef struct Interval {
    int key, next;
    double t; // [0, 1)
} Interval;

static Interval findInterval(const vplTrack* track, size_t size, double frame)
{
    int low = 0, high = track->count; // the key is in [low, high)
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        const bool before = frameOf(track->keys, size, middle) <= frame;
        low = before ? middle : low;
        high = before ? high : middle;
    }
    const double from = frameOf(track->keys, size, low);
    if (low + 1 == track->count || !(frame > from)) {
        return (Interval){low, low, 0};
    }
    return (Interval){low, low + 1, (frame - from) / (frameOf(track->keys, size, low + 1) - from)};
}

static vplResult reportPose(const vplScene* scene, const char* what, int index, double frame,
                            const vplFault* fault)
{
    return fault->field == NULL ? VPL_SUCCESS
                                : vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s %d at frame %g: %s %s",
                                          what, index, frame, fault->field, fault->text);
}

vplResult vplScene_PoseCamera(const vplScene* scene, int index, double frame, vplCameraDef* defOut)
{
    const vplTrack* track = findTrack(&scene->cameraTracks, index);
    vplCameraDef def = scene->cameras[index];
    if (track != NULL) {
        const vplCameraKey* keys = track->keys;
        const Interval i = findInterval(track, sizeof *keys, frame);
        const vplCameraKey *a = &keys[i.key], *b = &keys[i.next];
        def.eye = lerpVec(i.t, a->eye, b->eye);
        def.target = lerpVec(i.t, a->target, b->target);
        def.up = lerpVec(i.t, a->up, b->up);
        def.fovY = a->fovY + i.t * (b->fovY - a->fovY);
        const vplFault fault = vplCheckCamera(&def);
        TRY(reportPose(scene, "camera", index, frame, &fault));
    }
    *defOut = def;
    return VPL_SUCCESS;
}

vplResult vplScene_PoseEmitter(const vplScene* scene, int index, double frame, vplEmitterDef* defOut)
{
    const vplTrack* track = findTrack(&scene->emitterTracks, index);
    vplEmitterDef def = scene->emitters[index];
    if (track != NULL) {
        const vplEmitterKey* keys = track->keys;
        const Interval i = findInterval(track, sizeof *keys, frame);
        const vplEmitterKey *a = &keys[i.key], *b = &keys[i.next];
        def.position = lerpVec(i.t, a->position, b->position);
        def.direction = lerpVec(i.t, a->direction, b->direction);
        def.intensity = lerpRgb(i.t, a->intensity, b->intensity);
        const vplFault fault = vplCheckEmitter(&def);
        TRY(reportPose(scene, "light", index, frame, &fault));
    }
    *defOut = def;
    return VPL_SUCCESS;
}

// ---- storage

static const void* getKeys(const vplTrackList* list, int index, int* countOut)
{
    const vplTrack* track = findTrack(list, index);
    *countOut = track ? track->count : 0;
    return track ? track->keys : NULL;
}

const vplCameraKey* vplScene_GetCameraPath(const vplScene* scene, int index, int* countOut)
{
    return getKeys(&scene->cameraTracks, index, countOut);
}

const vplEmitterKey* vplScene_GetEmitterPath(const vplScene* scene, int index, int* countOut)
{
    return getKeys(&scene->emitterTracks, index, countOut);
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

static vplFault checkCameraKey(const vplScene* scene, int index, const void* key)
{
    const vplCameraDef def = vplApplyCameraKey(&scene->cameras[index], key);
    return vplCheckCamera(&def);
}

static vplFault checkEmitterKey(const vplScene* scene, int index, const void* key)
{
    const vplEmitterDef def = vplApplyEmitterKey(&scene->emitters[index], key);
    return vplCheckEmitter(&def);
}

// Cameras or emitters, as the functions below need to know them.
typedef struct Kind {
    vplTrackList* list;
    int count;        // of cameras or emitters
    const char* type; // of the keys
    size_t size;      // of a key
    vplFault (*check)(const vplScene* scene, int index, const void* key);
} Kind;

static vplResult checkKeys(const vplScene* scene, const Kind* kind, int index, const void* keys, int count)
{
    if (index < 0 || index >= kind->count) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s: index is %d, must be one of the scene's %d",
                       kind->type, index, kind->count);
    }
    if (count < 0 || count > VPL_MAX_KEYS) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s: count is %d, must be in [0, %d]",
                       kind->type, count, VPL_MAX_KEYS);
    }
    double before = -INFINITY;
    for (int k = 0; k < count; k++) {
        const double frame = frameOf(keys, kind->size, k);
        vplFault fault = vplCheckKeyFrame(before, frame);
        fault = fault.field ? fault : kind->check(scene, index, (const char*)keys + (size_t)k * kind->size);
        if (fault.field != NULL) {
            char component[16] = "";
            if (fault.index >= 0) {
                snprintf(component, sizeof component, "[%d]", fault.index);
            }
            return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s %d: %s%s %s", kind->type, k, fault.field,
                           component, fault.text);
        }
        before = frame;
    }
    return VPL_SUCCESS;
}

// Copies the keys. They replace those that the camera or emitter had.
static vplResult setKeys(vplScene* scene, const Kind* kind, int index, const void* keys, int count)
{
    TRY(checkKeys(scene, kind, index, keys, count));
    vplTrackList* list = kind->list;
    TRY(vplArena_Reserve(scene->arena, &list->tracks, &list->capacity, (size_t)list->count + 1,
                         sizeof *list->tracks));
    void* copy = count > 0 ? vplArena_Copy(scene->arena, keys, (size_t)count, kind->size) : NULL;
    if (count > 0 && copy == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const vplTrack* found = findTrack(list, index);
    if (found != NULL) {
        vplArena_Free(scene->arena, found->keys);
        list->tracks[found - list->tracks] = list->tracks[--list->count];
    }
    if (count > 0) {
        list->tracks[list->count++] = (vplTrack){index, count, copy};
    }
    return VPL_SUCCESS;
}

vplResult vplScene_SetCameraPath(vplScene* scene, int index, const vplCameraKey* keys, int count)
{
    const Kind kind = {&scene->cameraTracks, scene->cameraCount, "vplCameraKey", sizeof *keys,
                       checkCameraKey};
    return setKeys(scene, &kind, index, keys, count);
}

vplResult vplScene_SetEmitterPath(vplScene* scene, int index, const vplEmitterKey* keys, int count)
{
    const Kind kind = {&scene->emitterTracks, scene->emitterCount, "vplEmitterKey", sizeof *keys,
                       checkEmitterKey};
    return setKeys(scene, &kind, index, keys, count);
}
