// SPDX-License-Identifier: MIT
// Corrects the sums of rows by factors s_i s_j, which keep A_i F_ij = A_j F_ji.
// Based on: Richard Sinkhorn and Paul Knopp, Concerning Nonnegative Matrices and Doubly Stochastic Matrices,
// Pacific Journal of Mathematics 1967; Philip Knight, Daniel Ruiz and Bora Ucar, A Symmetry Preserving
// Algorithm for Matrix Scaling, SIAM Journal on Matrix Analysis and Applications 2014 (steps by the square
// root of the sum).
#include "math/scalar.h"
#include "radiosity/factors/form_factors.h"
#include "radiosity/sides/side.h"

// Rounds end when no scale changes by more than this or, since some matrices cannot be normalised, after so
// many.
static const double ENOUGH = 1e-6;
enum { MOST_ROUNDS = 24 };

// Leaves room for the rounding of scaled floats, so that no sum ends above 1.
static const double MARGIN = 1 - 0x1p-22;

typedef struct Scaling {
    const vplFactorWork* work;
    double *scale, *sum; // per row: s_i, and the sum of F_ij s_j
    float* target;       // the wanted sum of each row; NULL: 1
    vplTeamMail mail;
} Scaling;

static float* roomOf(const Scaling* s, int worker)
{
    return s->work->rooms + (size_t)worker * vplSharedRows_Columns(s->work->shared);
}

static void sumRow(void* data, int row, int worker)
{
    (void)worker;
    const Scaling* s = data;
    const int count = s->work->count;
    s->sum[row] = s->work->kernels->scaledSum(s->work->rows + (size_t)row * (size_t)count, s->scale, count);
}

static void sumOwnRow(void* data, int own, int worker)
{
    const Scaling* s = data;
    const vplSharedRows* shared = s->work->shared;
    const int row = own * shared->members + shared->member;
    float* room = roomOf(s, worker);
    vplSharedRows_Decode(shared, row, room);
    s->sum[row] = s->work->kernels->scaledSum(room, s->scale, s->work->count);
}

static vplResult sumRows(Scaling* s)
{
    vplContext* context = s->work->context;
    const vplSharedRows* shared = s->work->shared;
    if (shared == NULL) {
        return vplParallelForAsking(context, s->work->count, sumRow, s);
    }
    const vplTeamRows rows = {s->sum, sizeof *s->sum, 0, s->work->count};
    return vplTeam_ShareRows(context, vplParallelForAsking(context, shared->ownCount, sumOwnRow, s), &s->mail,
                             &rows);
}

static void scaleRow(void* data, int row, int worker)
{
    (void)worker;
    const Scaling* s = data;
    const int count = s->work->count;
    s->work->kernels->scaleRow(s->work->rows + (size_t)row * (size_t)count, s->scale[row], s->scale, count);
}

static void scaleOwnRow(void* data, int own, int worker)
{
    const Scaling* s = data;
    const vplSharedRows* shared = s->work->shared;
    const int row = own * shared->members + shared->member;
    float* room = roomOf(s, worker);
    vplSharedRows_Decode(shared, row, room);
    s->work->kernels->scaleRow(room, s->scale[row], s->scale, s->work->count);
    vplSharedRows_Encode(shared, row, room);
}

// Moves the sum of each row half of the way to 1; a clamp only moves rows above 1. Returns the largest change
// of a scale.
static double improve(Scaling* s, bool clamp)
{
    double largest = 0;
    for (int i = 0; i < s->work->count; i++) {
        const double sum = s->scale[i] * s->sum[i];
        if (sum > 0) {
            const double before = s->scale[i], wanted = s->target != NULL
                                                            ? before * sqrt((double)s->target[i] / sum)
                                                            : before / sqrt(sum);
            s->scale[i] = clamp && wanted > 1 ? 1 : wanted;
            const double step = fabs(s->scale[i] / before - 1);
            largest = step > largest ? step : largest;
        }
    }
    return largest;
}

// Moves all rows above 1 the whole way at once: since no scale grows, no other row rises above 1.
static void finish(Scaling* s)
{
    for (int i = 0; i < s->work->count; i++) {
        const double sum = s->scale[i] * s->sum[i];
        s->scale[i] *= sum > MARGIN ? MARGIN / sum : 1;
    }
}

static vplResult scaleRows(Scaling* s, bool clamp)
{
    vplContext* context = s->work->context;
    for (int round = 0; round < MOST_ROUNDS; round++) {
        const double step = improve(s, clamp);
        TRY(sumRows(s));
        if (step < ENOUGH) {
            break;
        }
    }
    finish(s);
    return s->work->shared != NULL ? vplParallelForAsking(context, s->work->shared->ownCount, scaleOwnRow, s)
                                   : vplParallelForAsking(context, s->work->count, scaleRow, s);
}

vplResult vplFactorWork_CorrectRows(vplFactorWork* work)
{
    const size_t count = (size_t)work->count;
    const vplFormFactorDef* def = &work->def;
    Scaling s = {.work = work,
                 .scale = vplArena_Alloc(work->scratch, count, sizeof *s.scale),
                 .sum = vplArena_Alloc(work->scratch, count, sizeof *s.sum)};
    if (work->shared != NULL) {
        s.mail = vplTeamMail_Alloc(work->context, work->scratch, work->count, sizeof *s.sum);
    }
    TRY(vplTeam_Agree(work->context, vplArena_Check(work->scratch)));
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        s.scale[i] = 1;
    }
    TRY(sumRows(&s));
    for (size_t i = 0; i < count; i++) {
        work->rowSums[i] = (float)s.sum[i];
        most = s.sum[i] > most ? s.sum[i] : most;
    }
    const bool clamp = def->rowSums == VPL_ROW_SUMS_CLAMP ||
                       (def->rowSums == VPL_ROW_SUMS_USUAL && def->kind == VPL_FORM_FACTORS_MONTE_CARLO);
    if (def->rowSums == VPL_ROW_SUMS_USUAL && work->sides->patches->groupCount > 0) {
        s.target = vplArena_Alloc(work->scratch, count, sizeof *s.target);
        vplResult result = vplArena_Check(work->scratch);
        if (result == VPL_SUCCESS) {
            result = vplPatchSides_FindHitShares(work->sides, def->seed, s.target, &work->factors->rays);
        }
        TRY(vplTeam_Agree(work->context, result));
        return scaleRows(&s, false);
    }
    if (def->rowSums == VPL_ROW_SUMS_NORMALISE || (clamp && most > MARGIN)) {
        return scaleRows(&s, clamp);
    }
    return VPL_SUCCESS;
}
