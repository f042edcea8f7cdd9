// SPDX-License-Identifier: MIT
// Objects that move: transforms at keyframes, and in between their matrices interpolated linearly. Rendering does not change
// a scene, and geometry is made of what stands in it, so moving to a frame is an edit of the scene, not part of a render.
#include "scene/model.h"
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static vplMat4 poseAt(const vplMover* m, double frame)
{
    int low = 0, high = m->count; // the key is in [low, high)
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        const bool before = m->keys[middle].frame <= frame;
        low = before ? middle : low;
        high = before ? high : middle;
    }
    const vplTransformKey *a = &m->keys[low], *b = a + (low + 1 < m->count ? 1 : 0);
    vplMat4 pose = a->transform;
    if (a == b || !(frame > a->frame)) {
        return pose;
    }
    const double t = (frame - a->frame) / (b->frame - a->frame);
    for (int i = 0; i < 16; i++) {
        const double from = (double)a->transform.m[i], way = (double)b->transform.m[i] - from;
        pose.m[i] = way != 0 ? (float)(from + t * way) : pose.m[i]; // -0 stays what it is
    }
    return pose;
}

static vplMover* findMover(const vplScene* scene, int object)
{
    for (int i = 0; i < scene->moverCount; i++) {
        if (scene->movers[i].object == object) {
            return &scene->movers[i];
        }
    }
    return NULL;
}

static void stand(vplScene* scene, int object, const vplMat4* transform)
{
    if (memcmp(&scene->objects[object].transform, transform, sizeof *transform) != 0) {
        scene->objects[object].transform = *transform;
        vplScene_Touch(scene, true);
    }
}

void vplScene_DropMover(vplScene* scene, int object)
{
    vplMover* m = findMover(scene, object);
    if (m != NULL) {
        vplArena_Free(scene->arena, m->keys);
        *m = scene->movers[--scene->moverCount];
    }
}

static vplResult checkKeys(const vplScene* scene, const vplTransformKey* keys, int count)
{
    double before = -INFINITY;
    if (count < 0 || count > VPL_MAX_KEYS) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT,
                       "vplTransformKey: count is %d, must be in [0, %d]", count, VPL_MAX_KEYS);
    }
    for (int i = 0; i < count; i++) {
        char subject[64];
        snprintf(subject, sizeof subject, "vplTransformKey %d: ", i);
        TRY(vplScene_ReportFault(scene, subject, vplCheckKeyFrame(before, keys[i].frame)));
        TRY(vplScene_ReportFault(scene, subject, vplCheckTransform(&keys[i].transform)));
        before = keys[i].frame;
    }
    return VPL_SUCCESS;
}

vplResult vplScene_SetObjectPath(vplScene* scene, int object, const vplTransformKey* keys, int count)
{
    REQUIRE(CONTEXT_OF(scene), scene);
    REQUIRE_ARRAY(scene->context, keys, count);
    if (object < 0 || object >= scene->objectCount) {
        return vplFail(scene->context, VPL_INVALID_ARGUMENT, "object %d does not exist, the scene has %d",
                       object, scene->objectCount);
    }
    TRY(checkKeys(scene, keys, count));
    if (count == 0) {
        vplScene_DropMover(scene, object);
        return VPL_SUCCESS;
    }
    TRY(vplArena_Reserve(scene->arena, &scene->movers, &scene->moverCapacity, (size_t)scene->moverCount + 1,
                         sizeof *scene->movers));
    vplTransformKey* copy = vplArena_Copy(scene->arena, keys, (size_t)count, sizeof *keys);
    TRY(copy != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY);
    vplScene_DropMover(scene, object);
    scene->movers[scene->moverCount] = (vplMover){object, count, copy};
    const vplMat4 pose = poseAt(&scene->movers[scene->moverCount++], 0);
    stand(scene, object, &pose);
    return VPL_SUCCESS;
}

const vplTransformKey* vplScene_GetObjectPath(const vplScene* scene, int object, int* countOut)
{
    const vplMover* m = scene != NULL ? findMover(scene, object) : NULL;
    if (countOut != NULL) {
        *countOut = m != NULL ? m->count : 0;
    }
    return m != NULL ? m->keys : NULL;
}

vplResult vplScene_SetFrame(vplScene* scene, double frame)
{
    REQUIRE(CONTEXT_OF(scene), scene);
    for (int i = 0; i < scene->moverCount; i++) { // a failure changes nothing
        const vplMat4 pose = poseAt(&scene->movers[i], frame);
        char subject[64];
        snprintf(subject, sizeof subject, "object %d at frame %g: ", scene->movers[i].object, frame);
        TRY(vplScene_ReportFault(scene, subject, vplCheckTransform(&pose)));
    }
    for (int i = 0; i < scene->moverCount; i++) {
        const vplMat4 pose = poseAt(&scene->movers[i], frame);
        stand(scene, scene->movers[i].object, &pose);
    }
    return VPL_SUCCESS;
}

// ---- parts of models

vplResult vplScene_AddPart(vplScene* scene, const vplAffine* outer, const vplModelPart* part,
                           const vplObjectDef* def)
{
    vplObjectDef object = *def;
    const vplAffine whole = vplAffine_Multiply(outer, &part->toModel);
    int index;
    object.type = VPL_OBJECT_MESH;
    object.mesh = part->mesh;
    object.transform = vplAffine_ToMat4(&whole);
    TRY(vplScene_AddObject(scene, &object, &index));
    if (part->placeCount == 0) {
        return VPL_SUCCESS;
    }
    vplTransformKey* keys = vplAlloc(scene->context, (size_t)part->placeCount, sizeof *keys);
    for (int i = 0; i < part->placeCount && keys != NULL; i++) {
        const vplAffine place = vplAffine_Multiply(outer, &part->places[i]);
        keys[i] = (vplTransformKey){(double)(part->firstFrame + i), vplAffine_ToMat4(&place)};
    }
    const vplResult result =
        keys != NULL ? vplScene_SetObjectPath(scene, index, keys, part->placeCount) : VPL_OUT_OF_MEMORY;
    vplFree(scene->context, keys);
    return result;
}
