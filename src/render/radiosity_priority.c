// SPDX-License-Identifier: MIT
// What says where a round of adaptive patches wants more of them: light at vertices, where means of patches would hide how
// dark a corner is, and how direct light changes.
#include "render/radiosity.h"

// From each vertex. With 64 to 1024 the pictures' error differs by less than their noise, a tenth.
enum { GATHER_RAYS = 128 };

// Direct light of sides, of lamps as well as of emitters.
static vplResult findDirect(vplJob* job, const vplRadiosityState* s, vplRgb* direct)
{
    const size_t count = (size_t)s->sides->count;
    vplRgb* emission = vplAlloc(job->context, count, sizeof *emission);
    if (emission == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (size_t i = 0; i < count; i++) {
        emission[i] = s->sides->sides[i].emission;
    }
    const vplResult result = vplRadiosity_Receive(s, emission, direct);
    vplFree(job->context, emission);
    return result;
}

typedef struct Known {
    vplRgb *reflected, *direct;              // one per side
    vplRgb *vertexIrradiance, *vertexDirect; // [vertex][front, back]
} Known;

static vplResult find(vplJob* job, const vplRadiosityState* s, Known* k, float* priorityOut)
{
    const vplRenderOptions* o = &job->options;
    vplRadiosity_FindReflected(s, k->reflected);
    const vplVertexGather gather = {k->reflected, GATHER_RAYS, o->seed, vplJob_GetProgress(job), job};
    vplResult result = vplPatchMesh_Gather(s->mesh, &gather, k->vertexIrradiance, &job->stats.rays);
    if (result == VPL_SUCCESS) {
        result = findDirect(job, s, k->direct);
    }
    if (result == VPL_SUCCESS) {
        result = vplPatchMesh_Interpolate(s->mesh, o->vertexWeight, k->direct, k->vertexDirect);
    }
    if (result == VPL_SUCCESS) {
        vplPatchPriorityDef def = vplDefaultPatchPriorityDef();
        def.irradiance = s->irradiance;
        def.vertexIrradiance = k->vertexIrradiance;
        def.vertexDirect = k->vertexDirect;
        def.directSpread = s->spread;
        result = vplFindPatchPriority(s->mesh, &def, priorityOut);
    }
    return result;
}

vplResult vplRadiosity_FindPriority(vplJob* job, const vplRadiosityState* s, float* priorityOut)
{
    const size_t sides = (size_t)s->sides->count, corners = 2 * (size_t)s->mesh->vertexCount;
    Known k = {.reflected = vplAlloc(job->context, sides, sizeof *k.reflected),
               .direct = vplAlloc(job->context, sides, sizeof *k.direct),
               .vertexIrradiance = vplAlloc(job->context, corners, sizeof *k.vertexIrradiance),
               .vertexDirect = vplAlloc(job->context, corners, sizeof *k.vertexDirect)};
    void* const arrays[] = {k.reflected, k.direct, k.vertexIrradiance, k.vertexDirect};
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < 4; i++) {
        result = arrays[i] != NULL ? result : VPL_OUT_OF_MEMORY;
    }
    vplJob_BeginStage(job, 0.72);
    if (result == VPL_SUCCESS) {
        result = find(job, s, &k, priorityOut);
    }
    vplJob_EndStage(job, "worth of patches");
    for (int i = 0; i < 4; i++) {
        vplFree(job->context, arrays[i]);
    }
    return result;
}
