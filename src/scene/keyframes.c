// SPDX-License-Identifier: MIT
// Cameras and emitters that move, by linear interpolation between keyframes. The formula a + t (b - a)
// reproduces the keys, and values that both keys share, exactly.
#include "base/numbers.h"
#include "math/vec.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

vplCameraKey vplMakeCameraKey(const vplCameraDef* def, double frame)
{
    if (def == NULL) {
        return (vplCameraKey){0};
    }
    return (vplCameraKey){frame, def->eye, def->target, def->up, def->fovY};
}

vplEmitterKey vplMakeEmitterKey(const vplEmitterDef* def, double frame)
{
    if (def == NULL) {
        return (vplEmitterKey){0};
    }
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

// Interpolates in double, because the difference of two floats may overflow or lose digits.
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

// All types of key begin with their frame.
static double frameOf(const void* keys, size_t size, int k)
{
    double frame;
    memcpy(&frame, (const char*)keys + (size_t)k * size, sizeof frame);
    return frame;
}

vplKeyInterval vplTrack_Find(const vplTrack* track, size_t size, double frame)
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
        return (vplKeyInterval){low, low, 0};
    }
    return (vplKeyInterval){low, low + 1, (frame - from) / (frameOf(track->keys, size, low + 1) - from)};
}

vplResult vplScene_PoseCamera(const vplScene* scene, int index, double frame, vplCameraDef* defOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, defOut);
    TRY(vplScene_CheckIndex(scene, "camera", index, scene->cameraCount));
    const vplTrack* track = &scene->cameras[index].track;
    vplCameraDef def = scene->cameras[index].def;
    if (track->count > 0) {
        const vplCameraKey* keys = track->keys;
        const vplKeyInterval i = vplTrack_Find(track, sizeof *keys, frame);
        const vplCameraKey *a = &keys[i.key], *b = &keys[i.next];
        def.eye = lerpVec(i.t, a->eye, b->eye);
        def.target = lerpVec(i.t, a->target, b->target);
        def.up = lerpVec(i.t, a->up, b->up);
        def.fovY = a->fovY + i.t * (b->fovY - a->fovY);
        char subject[64];
        vplFormat(subject, sizeof subject, "camera %d at frame %g: ", index, frame);
        TRY(vplScene_ReportFault(scene, subject, vplCheckCamera(&def)));
    }
    *defOut = def;
    return VPL_SUCCESS;
}

vplResult vplScene_PoseEmitter(const vplScene* scene, int index, double frame, vplEmitterDef* defOut)
{
    REQUIRE(CONTEXT_OF(scene), scene, defOut);
    TRY(vplScene_CheckIndex(scene, "light", index, scene->emitterCount));
    const vplTrack* track = &scene->emitters[index].track;
    vplEmitterDef def = scene->emitters[index].def;
    if (track->count > 0) {
        const vplEmitterKey* keys = track->keys;
        const vplKeyInterval i = vplTrack_Find(track, sizeof *keys, frame);
        const vplEmitterKey *a = &keys[i.key], *b = &keys[i.next];
        def.position = lerpVec(i.t, a->position, b->position);
        def.direction = lerpVec(i.t, a->direction, b->direction);
        def.intensity = lerpRgb(i.t, a->intensity, b->intensity);
        char subject[64];
        vplFormat(subject, sizeof subject, "light %d at frame %g: ", index, frame);
        TRY(vplScene_ReportFault(scene, subject, vplCheckEmitter(&def)));
    }
    *defOut = def;
    return VPL_SUCCESS;
}

// ---- storage

const void* vplTrack_GetKeys(const vplTrack* track, int* countOut)
{
    if (countOut != NULL) {
        *countOut = track != NULL ? track->count : 0;
    }
    return track != NULL ? track->keys : NULL;
}

const vplCameraKey* vplScene_GetCameraPath(const vplScene* scene, int index, int* countOut)
{
    const bool there = index >= 0 && index < vplScene_GetCameraCount(scene);
    return vplTrack_GetKeys(there ? &scene->cameras[index].track : NULL, countOut);
}

const vplEmitterKey* vplScene_GetEmitterPath(const vplScene* scene, int index, int* countOut)
{
    const bool there = index >= 0 && index < vplScene_GetEmitterCount(scene);
    return vplTrack_GetKeys(there ? &scene->emitters[index].track : NULL, countOut);
}

static vplFault checkCameraKey(const void* def, const void* key)
{
    const vplCameraDef posed = vplApplyCameraKey(def, key);
    return vplCheckCamera(&posed);
}

static vplFault checkEmitterKey(const void* def, const void* key)
{
    const vplEmitterDef posed = vplApplyEmitterKey(def, key);
    return vplCheckEmitter(&posed);
}

static vplResult checkIndex(const vplScene* scene, const char* type, int index, int count)
{
    return index >= 0 && index < count
               ? VPL_SUCCESS
               : vplFail(scene->context, VPL_INVALID_ARGUMENT,
                         "%s: index is %d, must be one of the scene's %d", type, index, count);
}

static vplResult checkKeys(const vplScene* scene, const vplKeys* k, const void* def)
{
    if (k->count < 0 || k->count > VPL_MAX_KEYS) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "%s: count is %d, must be in [0, %d]", k->type,
                       k->count, VPL_MAX_KEYS);
    }
    double before = -INFINITY;
    for (int i = 0; i < k->count; i++) {
        char subject[64];
        snprintf(subject, sizeof subject, "%s %d: ", k->type, i);
        const double frame = frameOf(k->keys, k->size, i);
        TRY(vplScene_ReportFault(scene, subject, vplCheckKeyFrame(before, frame)));
        TRY(vplScene_ReportFault(scene, subject, k->check(def, (const char*)k->keys + (size_t)i * k->size)));
        before = frame;
    }
    return VPL_SUCCESS;
}

vplResult vplScene_SetKeys(vplScene* scene, const vplKeys* k, const void* def, vplTrack* track)
{
    TRY(checkKeys(scene, k, def));
    void* copy = NULL;
    if (k->count > 0) {
        copy = vplArena_Copy(scene->arena, k->keys, (size_t)k->count, k->size);
        TRY(copy != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY);
    }
    vplArena_Free(scene->arena, track->keys);
    *track = (vplTrack){copy, k->count};
    return VPL_SUCCESS;
}

vplResult vplScene_SetCameraPath(vplScene* scene, int index, const vplCameraKey* keys, int count)
{
    REQUIRE(CONTEXT_OF(scene), scene);
    REQUIRE_ARRAY(CONTEXT_OF(scene), keys, count);
    const vplKeys k = {"vplCameraKey", keys, sizeof *keys, count, checkCameraKey};
    TRY(checkIndex(scene, k.type, index, scene->cameraCount));
    return vplScene_SetKeys(scene, &k, &scene->cameras[index].def, &scene->cameras[index].track);
}

vplResult vplScene_SetEmitterPath(vplScene* scene, int index, const vplEmitterKey* keys, int count)
{
    REQUIRE(CONTEXT_OF(scene), scene);
    REQUIRE_ARRAY(CONTEXT_OF(scene), keys, count);
    const vplKeys k = {"vplEmitterKey", keys, sizeof *keys, count, checkEmitterKey};
    TRY(checkIndex(scene, k.type, index, scene->emitterCount));
    return vplScene_SetKeys(scene, &k, &scene->emitters[index].def, &scene->emitters[index].track);
}
