// SPDX-License-Identifier: MIT
// Objects that move: transforms at keyframes, and in between their matrices interpolated linearly. Rendering does not change
// a scene, and geometry is made of what stands in it, so moving to a frame is an edit of the scene, not part of a render.
#include "base/numbers.h"
#include "scene/scene.h"

#include <stdio.h>
#include <string.h>

static vplMat4 poseAt(const vplMover* m, double frame)
{
    const vplTransformKey* keys = m->track.keys;
    const vplKeyInterval at = vplTrack_Find(&m->track, sizeof *keys, frame);
    vplMat4 pose = keys[at.key].transform;
    for (int i = 0; i < 16; i++) {
        const double from = (double)pose.m[i], way = (double)keys[at.next].transform.m[i] - from;
        pose.m[i] = way != 0 ? (float)(from + at.t * way) : pose.m[i]; // -0 stays what it is
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
        vplArena_Free(scene->arena, m->track.keys);
        *m = scene->movers[--scene->moverCount];
    }
}

static vplFault checkTransformKey(const void* def, const void* key)
{
    (void)def;
    return vplCheckTransform(&((const vplTransformKey*)key)->transform);
}

vplResult vplScene_SetObjectPath(vplScene* scene, int object, const vplTransformKey* keys, int count)
{
    REQUIRE(CONTEXT_OF(scene), scene);
    REQUIRE_ARRAY(scene->context, keys, count);
    TRY(vplScene_CheckIndex(scene, "object", object, scene->objectCount));
    const vplKeys set = {"vplTransformKey", keys, sizeof *keys, count, checkTransformKey};
    vplTrack track = {NULL, 0};
    TRY(vplArena_Reserve(scene->arena, &scene->movers, &scene->moverCapacity, (size_t)scene->moverCount + 1,
                         sizeof *scene->movers));
    TRY(vplScene_SetKeys(scene, &set, NULL, &track));
    vplScene_DropMover(scene, object);
    if (count > 0) {
        scene->movers[scene->moverCount] = (vplMover){object, track};
        const vplMat4 pose = poseAt(&scene->movers[scene->moverCount++], 0);
        stand(scene, object, &pose);
    }
    return VPL_SUCCESS;
}

const vplTransformKey* vplScene_GetObjectPath(const vplScene* scene, int object, int* countOut)
{
    const vplMover* m = scene != NULL ? findMover(scene, object) : NULL;
    return vplTrack_GetKeys(m != NULL ? &m->track : NULL, countOut);
}

vplResult vplScene_SetFrame(vplScene* scene, double frame)
{
    REQUIRE(CONTEXT_OF(scene), scene);
    for (int i = 0; i < scene->moverCount; i++) { // a failure changes nothing
        const vplMat4 pose = poseAt(&scene->movers[i], frame);
        char subject[64];
        vplFormat(subject, sizeof subject, "object %d at frame %g: ", scene->movers[i].object, frame);
        TRY(vplScene_ReportFault(scene, subject, vplCheckTransform(&pose)));
    }
    for (int i = 0; i < scene->moverCount; i++) {
        const vplMat4 pose = poseAt(&scene->movers[i], frame);
        stand(scene, scene->movers[i].object, &pose);
    }
    return VPL_SUCCESS;
}
