// SPDX-License-Identifier: MIT
// Where emitters and the camera are in the course of their paths: what is made once for all frames must do for each; and
// whether an emitter is still where it was.
#include "render/render.h"

// Poses per path, evenly spaced from its first key to its last.
enum { POSES = 9 };

static int poseCount(int keys)
{
    return keys > 1 ? POSES : 1;
}

static double frameOf(double first, double last, int i)
{
    return first + (last - first) * i / (POSES - 1);
}

static vplResult poseEmitters(const vplJob* job, vplPoses* poses)
{
    vplResult result = VPL_SUCCESS;
    for (int e = 0; e < job->emitterCount; e++) {
        int keys;
        const vplEmitterKey* path = vplScene_GetEmitterPath(job->scene, e, &keys);
        for (int i = 0; i < poseCount(keys) && result == VPL_SUCCESS; i++) {
            const double frame = keys > 1 ? frameOf(path[0].frame, path[keys - 1].frame, i) : 0;
            result = vplScene_PoseEmitter(job->scene, e, frame, &poses->emitters[poses->emitterCount++]);
        }
    }
    return result;
}

static vplResult poseEyes(const vplJob* job, vplPoses* poses)
{
    int keys;
    const vplCameraKey* path = vplScene_GetCameraPath(job->scene, job->options.output.camera, &keys);
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < poseCount(keys) && result == VPL_SUCCESS; i++) {
        vplCameraDef camera;
        const double frame = keys > 1 ? frameOf(path[0].frame, path[keys - 1].frame, i) : 0;
        result = vplScene_PoseCamera(job->scene, job->options.output.camera, frame, &camera);
        poses->eyes[poses->eyeCount++] = camera.eye;
    }
    return result;
}

vplResult vplJob_FindPoses(const vplJob* job, vplPoses* posesOut)
{
    *posesOut = (vplPoses){0};
    posesOut->emitters =
        vplAlloc(job->context, POSES * (size_t)job->emitterCount, sizeof *posesOut->emitters);
    posesOut->eyes = vplAlloc(job->context, POSES, sizeof *posesOut->eyes);
    if (posesOut->emitters == NULL || posesOut->eyes == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplResult result = poseEmitters(job, posesOut);
    return result == VPL_SUCCESS ? poseEyes(job, posesOut) : result;
}

void vplPoses_Free(vplContext* context, vplPoses* poses)
{
    vplFree(context, poses->emitters);
    vplFree(context, poses->eyes);
}

static bool isSame(vplVec3 a, vplVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

bool vplIsSameEmitter(const vplEmitterDef* a, const vplEmitterDef* b)
{
    return a->type == b->type && isSame(a->position, b->position) && isSame(a->direction, b->direction) &&
           a->intensity.r == b->intensity.r && a->intensity.g == b->intensity.g &&
           a->intensity.b == b->intensity.b && a->innerAngle == b->innerAngle &&
           a->outerAngle == b->outerAngle;
}
