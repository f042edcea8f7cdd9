// SPDX-License-Identifier: MIT
// Corrects the sums of rows of form factors that links stand for.
// Based on: Sinkhorn and Knopp, Concerning Nonnegative Matrices and Doubly Stochastic Matrices, 1967, as in
// factors/row_sums.c.
#include "base/rng.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "radiosity/links/links.h"
#include "radiosity/sides/side.h"

enum {
    // Per side. A side that sees an opening in 10 % of its hemisphere counts as enclosed in 3 % of all cases.
    RAYS = 32,
    STREAM = 0x4d00, // of random numbers; one per ray
    TASK = 64,       // sides
    ROUNDS = 10      // always the same number, since a gather over links costs little
};

// Leaves room for the rounding of scales and sums, so that no sum ends above 1.
static const double MARGIN = 1 - 0x1p-21;

// Sides whose form factors sum to less are not enclosed, even if rays missed the opening: links of closed rooms
// err by less. Without, cornell-area's error is 1.1 times as large (4,000 patches).
static const double CLOSED = 0.97;

// ---- enclosed sides: their form factors sum to 1

typedef struct EnclosedTest {
    const vplPatchSides* sides;
    const vplLinkDef* def;
    bool* enclosed;
    float* target; // the wanted sum of each row; NULL where groups are none: 1 if enclosed, else at most 1
    int* rays;     // per side
} EnclosedTest;

// Directions are stratified on a grid of 4 x 8 cells over the hemisphere, so that none misses a large
// opening.
static bool isEnclosed(const EnclosedTest* t, int i)
{
    const vplPatchSide* side = &t->sides->sides[i];
    for (int k = 0; k < RAYS; k++) {
        const vplRandom4 r = vplRandomAt(t->def->seed, STREAM + (uint32_t)k, (uint64_t)i);
        const float u = ((float)(k / 8) + vplUnitFloat(r.v[0])) / 4,
                    v = ((float)(k % 8) + vplUnitFloat(r.v[1])) / 8;
        const int cell =
            vplPatchSide_OpenCell(side, (int)(r.v[2] % (uint32_t)__builtin_popcount(side->open)));
        const vplSidePoint from =
            vplPatchSide_SampleCell(t->sides, side, cell, vplUnitFloat(r.v[2]), vplUnitFloat(r.v[3]));
        const vplRay ray = vplPatchSides_Leave(t->sides, &from, vplSampleCosineAround(from.normal, u, v));
        t->rays[i]++;
        if (vplPatchSides_Hit(t->sides, &ray) < 0) {
            return false;
        }
    }
    return true;
}

static void testTask(void* data, int task, int worker)
{
    (void)worker;
    const EnclosedTest* t = data;
    for (int i = task * TASK; i < vplMini((task + 1) * TASK, t->sides->count); i++) {
        t->enclosed[i] = isEnclosed(t, i);
    }
}

static vplResult findEnclosed(EnclosedTest* t, vplArena* scratch, int64_t* rays)
{
    const int count = t->sides->count;
    t->rays = vplArena_AllocZero(scratch, (size_t)count, sizeof *t->rays);
    TRY(vplArena_Check(scratch));
    const vplResult result = vplParallelForProgress(
        t->sides->context, (count + TASK - 1) / TASK, testTask, t,
        (vplProgressRange){t->def->progress, t->def->progressUser, VPL_LINKS_PROGRESS, 1});
    for (int i = 0; i < count; i++) {
        *rays += t->rays[i];
    }
    return result;
}

// ---- scales

// The largest scale of a row. The links of a side may cancel to a sum that is only rounding, although rays say that the side
// receives light; scaling such a row to that light made radiosity in Sibenik diverge.
static const double MOST_SCALE = 1024;

// One round: moves the sum of each row half of the way to 1; sides that are not enclosed only move if above
// 1. The last round moves rows above 1 the whole way, which leaves none above, since no scale grows.
static void fitScales(struct vplLinkTree* tree, double (*sums)[3], int count, const EnclosedTest* test,
                      bool last)
{
    for (int i = 0; i < count; i++) {
        const double sum = sums[i][0], scale = (double)tree->scale[i];
        if (last) {
            tree->scale[i] = (float)(sum > MARGIN ? scale * MARGIN / sum : scale);
        } else if (sum > 0) {
            const double target = test->target != NULL ? (double)test->target[i] : 1;
            const double most = test->target != NULL || test->enclosed[i] ? MOST_SCALE : 1;
            tree->scale[i] = (float)fmin(scale * sqrt(target / sum), most);
        }
    }
}

static vplResult fitRows(vplLinks* links, vplArena* scratch, const EnclosedTest* test, float* rowSums)
{
    const vplRowSums rows = test->def->rowSums;
    const int count = links->sideCount, rounds = rows == VPL_ROW_SUMS_KEEP ? 0 : ROUNDS;
    vplPlanes ones = vplPlanes_Alloc(scratch, count);
    const vplLinkScratch nodes = vplLinkScratch_Alloc(scratch, links);
    double(*sums)[3] = vplArena_Alloc(scratch, (size_t)count, sizeof *sums);
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < count; i++) {
        ones.c[0][i] = 1;
        links->tree->scale[i] = 1;
    }
    for (int round = 0; round <= rounds; round++) {
        TRY(vplLinks_Gather(links, &ones, &nodes, sums));
        for (int i = 0; i < count && round == 0; i++) {
            rowSums[i] = (float)sums[i][0];
            test->enclosed[i] = test->enclosed[i] && (rows != VPL_ROW_SUMS_USUAL || sums[i][0] >= CLOSED);
        }
        if (rounds > 0) {
            fitScales(links->tree, sums, count, test, round == rounds);
        }
    }
    return VPL_SUCCESS;
}

static vplResult findAndFit(vplLinks* links, EnclosedTest* test, vplArena* scratch, float* rowSums)
{
    const vplRowSums rows = test->def->rowSums;
    test->enclosed = vplArena_Alloc(scratch, (size_t)links->sideCount, sizeof *test->enclosed);
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < links->sideCount; i++) {
        test->enclosed[i] = rows == VPL_ROW_SUMS_NORMALISE;
    }
    if (rows == VPL_ROW_SUMS_USUAL && test->sides->patches->groupCount > 0) {
        test->target = vplArena_Alloc(scratch, (size_t)links->sideCount, sizeof *test->target);
        TRY(vplArena_Check(scratch));
        TRY(vplPatchSides_FindHitShares(test->sides, test->def->seed, test->target, &links->rays));
    } else if (rows == VPL_ROW_SUMS_USUAL) {
        TRY(findEnclosed(test, scratch, &links->rays));
    }
    return fitRows(links, scratch, test, rowSums);
}

vplResult vplLinks_FitRows(vplLinks* links, const vplPatchSides* sides, const vplLinkDef* def,
                           float* rowSumsOut)
{
    EnclosedTest test = {.sides = sides, .def = def};
    vplArena* scratch = vplArena_Create(links->context);
    const vplResult result = findAndFit(links, &test, scratch, rowSumsOut);
    vplArena_Destroy(scratch);
    return result;
}
