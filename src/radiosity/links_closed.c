// SPDX-License-Identifier: MIT
// Which sides can send nothing out of the scene: there the sum of form factors is known before any is.
#include "base/context.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/vec.h"
#include "radiosity/links.h"
#include "radiosity/links_points.h"

enum {
    RAYS =
        32, // per side; one that has an opening of 10 % of its view is taken for closed in 3 % of all cases
    STREAM = 0x4d00,
    TASK = 64
};

typedef struct Looking {
    const vplPatchSides* sides;
    const vplLinkDef* def;
    bool* closed;
    int* rays; // per side
} Looking;

static bool meetsSide(const vplPatchSides* sides, const vplRay* ray)
{
    vplHit hit;
    return vplGeometry_ClosestHit(sides->patches->geometry, ray, &hit) &&
           vplPatchSides_Find(sides, &hit, ray->direction) >= 0;
}

// Directions are a grid of 4 x 8 over the hemisphere, so that none looks past a large opening.
static bool isClosed(const Looking* l, int i)
{
    const vplPatchSide* side = &l->sides->sides[i];
    for (int k = 0; k < RAYS; k++) {
        const vplRandom4 r = vplRandomAt(l->def->seed, STREAM + (uint32_t)k, (uint64_t)i);
        const float u = ((float)(k / 8) + vplUnitFloat(r.v[0])) / 4,
                    v = ((float)(k % 8) + vplUnitFloat(r.v[1])) / 8;
        const int cell =
            vplPatchSide_OpenCell(side, (int)(r.v[2] % (uint32_t)__builtin_popcount(side->open)));
        const vplVec3 from = vplPatchSide_SampleCell(side, cell, vplUnitFloat(r.v[2]), vplUnitFloat(r.v[3]));
        const vplHit start = vplPatchSide_HitAt(l->sides, side, from);
        const vplRay ray =
            vplGeometry_Leave(l->sides->patches->geometry, &start, vplSampleCosineAround(side->normal, u, v));
        l->rays[i]++;
        if (!meetsSide(l->sides, &ray)) {
            return false;
        }
    }
    return true;
}

static void lookTask(void* data, int task, int worker)
{
    (void)worker;
    const Looking* l = data;
    const int end = (task + 1) * TASK < l->sides->count ? (task + 1) * TASK : l->sides->count;
    for (int i = task * TASK; i < end; i++) {
        l->closed[i] = isClosed(l, i);
    }
}

vplResult vplFindClosed(const vplPatchSides* sides, const vplLinkDef* def, bool* closed, int64_t* rays)
{
    vplContext* context = sides->context;
    Looking look = {.sides = sides, .def = def, .closed = closed};
    look.rays = vplAllocZero(context, (size_t)sides->count, sizeof *look.rays);
    if (look.rays == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const vplResult result =
        vplParallelForProgress(context, (sides->count + TASK - 1) / TASK, lookTask, &look, def->progress,
                               def->progressUser, VPL_LINKS_SHARE, 1);
    for (int i = 0; i < sides->count; i++) {
        *rays += look.rays[i];
    }
    vplFree(context, look.rays);
    return result;
}
