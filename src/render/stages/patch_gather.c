// SPDX-License-Identifier: MIT
// The radiosity that rays of the final gather meet.
#include "geometry/triangle.h"
#include "math/vec.h"
#include "radiosity/sides/side.h"
#include "render/stages/make.h"
#include "render/stages/results.h"
#include <stdlib.h>
#include <string.h>

typedef struct MetLight {
    const vplPatchSides* sides;
    const vplPatchMesh* mesh;
    const vplRgb* reflected; // per side
    const vplRgb* corners; // [vertex][front, back]: irradiance
    const int* first; // mesh triangles of patches
    const int* list;
    int mode;
} MetLight;

static void radiosityOf(const void* user, const vplHit* hit, vplVec3 direction, float out[3])
{
    const MetLight* m = user;
    const int patch = vplPatches_Find(m->sides->patches, hit->triangle, hit->position);
    const int face = vplDot(direction, hit->normal) > 0;
    const int side = patch < 0 ? -1 : vplSideOf(m->sides, patch, face);
    memset(out, 0, 3 * sizeof *out);
    if (side < 0) {
        return;
    }
    if (m->mode == 0) {
        const vplRgb b = m->reflected[side];
        out[0] = b.r;
        out[1] = b.g;
        out[2] = b.b;
        return;
    }
    double best = -1e30, w[3] = {0};
    int which = m->first[patch];
    for (int i = m->first[patch]; i < m->first[patch + 1]; i++) {
        const uint32_t* at = m->mesh->indices + 3 * (size_t)m->list[i];
        const vplTriangleCorners c = vplCornersOf(m->mesh->positions, at);
        double v[3];
        vplTriangle_Barycentrics(c.corner, hit->position, v);
        double least = v[0] < v[1] ? v[0] : v[1];
        least = least < v[2] ? least : v[2];
        if (least > best) {
            best = least;
            which = i;
            memcpy(w, v, sizeof w);
        }
    }
    const uint32_t* at = m->mesh->indices + 3 * (size_t)m->list[which];
    double sum[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) {
        vplAddRgb(sum, w[k] < 0 ? 0 : w[k], m->corners[2 * (size_t)at[k] + (size_t)face]);
    }
    const vplRgb rho = m->sides->sides[side].reflectance;
    out[0] = rho.r * (float)sum[0];
    out[1] = rho.g * (float)sum[1];
    out[2] = rho.b * (float)sum[2];
}

vplResult vplDescribeGather(const vplRun* run, vplGatherDef* defOut)
{
    const vplRadiosityOptions* o = &run->plan->options.radiosity;
    const vplPatchSides* sides = run->results[VPL_STAGE_SIDES];
    const vplPatchMesh* mesh = run->results[VPL_STAGE_PATCH_MESH];
    const vplSolution* s = run->results[VPL_STAGE_SOLUTION];
    const int patches = sides->patches->patchCount;
    MetLight* m = vplArena_Alloc(run->scratch, 1, sizeof *m);
    vplRgb* reflected = vplArena_Alloc(run->scratch, (size_t)sides->count, sizeof *reflected);
    vplRgb* all = vplArena_Alloc(run->scratch, (size_t)sides->count, sizeof *all);
    vplRgb* corners = vplArena_Alloc(run->scratch, 2 * (size_t)mesh->vertexCount, sizeof *corners);
    int* first = vplArena_AllocZero(run->scratch, (size_t)patches + 2, sizeof *first);
    int* list = vplArena_Alloc(run->scratch, (size_t)mesh->triangleCount, sizeof *list);
    TRY(vplArena_Check(run->scratch));
    vplFindReflected(sides, s->radiosity, reflected);
    TRY(vplReceive(run, s->radiosity, all));
    TRY(vplPatchMesh_Interpolate(mesh, o->vertexWeight, all, corners));
    TRY(vplPatchMesh_Sharpen(mesh, o->vertexWeight, all, getenv("GS") ? atoi(getenv("GS")) : o->sharpen, corners));
    for (int i = 0; i < mesh->triangleCount; i++) {
        first[mesh->patchOf[i] + 2]++;
    }
    for (int i = 0; i < patches; i++) {
        first[i + 2] += first[i + 1];
    }
    for (int i = 0; i < mesh->triangleCount; i++) {
        list[first[mesh->patchOf[i] + 1]++] = i;
    }
    *m = (MetLight){sides, mesh, reflected, corners, first, list, getenv("GM") ? atoi(getenv("GM")) : 0};
    *defOut = (vplGatherDef){.rayCount = o->gather,
                             .seed = run->plan->options.seed,
                             .radiosity = radiosityOf,
                             .user = m};
    return VPL_SUCCESS;
}
