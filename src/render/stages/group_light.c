// SPDX-License-Identifier: MIT
// Light at the vertices of groups of triangles, which differ more than a mean over the group tells. It is gathered by rays,
// only at vertices of triangles that the camera sees a corner of.
// Based on: Mark Reichert, A Two-Pass Radiosity Method Driven by Lights and Viewer Position, Cornell 1992 (the final
// gather, which he does at pixels).
#include "base/context.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "render/stages/results.h"

#include <math.h>

enum { CHUNK = 1024 }; // vertices per task

typedef struct Watch {
    const vplPatchMesh* mesh;
    const vplView* view;
    const float (*clip)[4];
    bool* seen; // per vertex: in: it is one of a group; out: and the camera sees it
} Watch;

// Tests whether a vertex is in the picture, or less than a twentieth of it beyond.
static bool isInPicture(const float clip[4])
{
    return clip[3] > 0 && fabsf(clip[0]) <= 1.1f * clip[3] && fabsf(clip[1]) <= 1.1f * clip[3];
}

static void watchChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Watch* w = data;
    const int end = vplMini((chunk + 1) * CHUNK, w->mesh->vertexCount);
    for (int v = chunk * CHUNK; v < end; v++) {
        if (w->seen[v]) {
            const vplRay ray = {w->view->eye, vplSub(w->mesh->positions[v], w->view->eye), {0, 0}};
            w->seen[v] = isInPicture(w->clip[v]) &&
                         !vplGeometry_IsOccluded(w->mesh->sides->patches->geometry, &ray, 1 - 0x1p-10f);
        }
    }
}

static bool isOfGroup(const vplPatchMesh* mesh, int triangle)
{
    return vplPatches_IsGroup(mesh->sides->patches, mesh->patchOf[triangle]);
}

// Finds the faces of vertices that the picture needs: [vertex][front, back].
static vplResult findNeeded(const vplRun* run, const vplPatchMesh* mesh, bool* needed)
{
    const size_t vertices = (size_t)mesh->vertexCount;
    const vplView* view = &run->plan->view;
    bool* seen = vplArena_AllocZero(run->scratch, vertices, sizeof *seen);
    float(*clip)[4] = vplArena_Alloc(run->scratch, vertices, sizeof *clip);
    TRY(vplArena_Check(run->scratch));
    vplView_ToClip(view, mesh->positions, mesh->vertexCount, clip);
    for (int i = 0; i < 3 * mesh->triangleCount; i++) {
        seen[mesh->indices[i]] |= isOfGroup(mesh, i / 3);
    }
    Watch watch = {mesh, view, (const float(*)[4])clip, seen};
    TRY(vplParallelForAsking(run->context, (mesh->vertexCount + CHUNK - 1) / CHUNK, watchChunk, &watch));
    for (int i = 0; i < mesh->triangleCount; i++) {
        const uint32_t* corner = mesh->indices + 3 * (size_t)i;
        if (isOfGroup(mesh, i) && (seen[corner[0]] || seen[corner[1]] || seen[corner[2]])) {
            const vplVec3 normal = mesh->sides->patches->geometry->normals[mesh->triangleOf[i]];
            const size_t back = vplDot(vplSub(view->eye, mesh->positions[corner[0]]), normal) < 0;
            for (int k = 0; k < 3; k++) {
                needed[2 * (size_t)corner[k] + back] = true;
            }
        }
    }
    return VPL_SUCCESS;
}

vplResult vplGatherAtGroups(const vplRun* run, const vplPatchMesh* mesh, vplRgb* corners)
{
    const vplSolution* s = run->results[VPL_STAGE_SOLUTION];
    bool* needed = vplArena_AllocZero(run->scratch, 2 * (size_t)mesh->vertexCount, sizeof *needed);
    vplRgb* reflected = vplArena_Alloc(run->scratch, (size_t)mesh->sides->count, sizeof *reflected);
    TRY(vplArena_Check(run->scratch));
    TRY(findNeeded(run, mesh, needed));
    vplFindReflected(mesh->sides, s->radiosity, reflected);
    const vplVertexGather gather = {.radiosity = reflected,
                                    .rays = VPL_VERTEX_RAYS,
                                    .only = needed,
                                    .seed = run->plan->options.seed,
                                    .progress = run->progress,
                                    .progressUser = run->runner};
    return vplPatchMesh_Gather(mesh, &gather, corners, &run->stats->rays);
}
