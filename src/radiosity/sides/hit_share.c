// SPDX-License-Identifier: MIT
// How much of what a side emits arrives at sides, measured by rays: the sum that its form factors should have. Those of
// groups are sampled, and their errors do not cancel where sums above 1 are cut off and those below are left.
#include "base/context.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "radiosity/sides/side.h"

// Rays per side, in 8 x 8 strata of the hemisphere, and sides per task.
enum { RAYS = 64, TASK = 64, STREAM = 0x68697473 };

typedef struct Shares {
    const vplPatchSides* sides;
    uint64_t seed;
    float* out;
} Shares;

static float shareOf(const Shares* s, int i)
{
    const vplPatchSide* side = &s->sides->sides[i];
    int hits = 0;
    for (int k = 0; k < RAYS; k++) {
        const vplRandom4 r = vplRandomAt(s->seed, STREAM, (uint64_t)i * RAYS + (uint64_t)k);
        const float u = ((float)(k / 8) + vplUnitFloat(r.v[0])) / 8,
                    v = ((float)(k % 8) + vplUnitFloat(r.v[1])) / 8;
        const int cell = vplPatchSide_OpenCell(side, k * 5 % __builtin_popcount(side->open));
        const vplSidePoint from =
            vplPatchSide_SampleCell(s->sides, side, cell, vplUnitFloat(r.v[2]), vplUnitFloat(r.v[3]));
        const vplRay ray = vplPatchSides_Leave(s->sides, &from, vplSampleCosineAround(from.normal, u, v));
        hits += vplPatchSides_Hit(s->sides, &ray) >= 0;
    }
    return (float)hits / RAYS;
}

static void shareTask(void* data, int task, int worker)
{
    (void)worker;
    const Shares* s = data;
    for (int i = task * TASK; i < vplMini((task + 1) * TASK, s->sides->count); i++) {
        s->out[i] = shareOf(s, i);
    }
}

vplResult vplPatchSides_FindHitShares(const vplPatchSides* sides, uint64_t seed, float* sharesOut,
                                      int64_t* rays)
{
    Shares s = {sides, seed, sharesOut};
    *rays += (int64_t)RAYS * sides->count;
    return vplParallelForAsking(sides->context, (sides->count + TASK - 1) / TASK, shareTask, &s);
}
