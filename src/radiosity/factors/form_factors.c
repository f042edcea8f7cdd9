// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.3.1.
#include "radiosity/factors/form_factors.h"

#include <string.h>

enum { FORM_FACTOR_COOKIE = 0x56504cb0, MOST_SAMPLES = 1024 };

vplFormFactorDef vplDefaultFormFactorDef(void)
{
    return (vplFormFactorDef){.samples = 4, .analytic = true, .cookie = FORM_FACTOR_COOKIE};
}

static vplResult checkDef(const vplPatchSides* sides, const vplFormFactorDef* def)
{
    vplContext* context = sides->context;
    if (def->cookie != FORM_FACTOR_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplFormFactorDef was not made by vplDefaultFormFactorDef");
    }
    if ((int)def->kind < 0 || def->kind > VPL_FORM_FACTORS_INCENTRE) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplFormFactorDef.kind is %d, must be a vplFormFactorKind", (int)def->kind);
    }
    if (def->samples < 1 || def->samples > MOST_SAMPLES) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplFormFactorDef.samples is %d, must be in [1, %d]",
                       def->samples, MOST_SAMPLES);
    }
    if ((int)def->rowSums < 0 || def->rowSums > VPL_ROW_SUMS_NORMALISE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplFormFactorDef.rowSums is %d, must be a vplRowSums",
                       (int)def->rowSums);
    }
    if (sides->patches->groupCount > 0 && (def->kind == VPL_FORM_FACTORS_INCENTRE || !def->analytic)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "%d patches are groups of triangles, which have no incentre and whose unoccluded form factors "
            "are not those of the samples alone: set vplPatchDef.group to false",
            sides->patches->groupCount);
    }
    const int64_t bytes = (int64_t)sides->count * sides->count * (int64_t)sizeof(float),
                  most = vplMostFormFactorBytes(context);
    if (bytes > most && !vplHasTeam(context)) {
        return vplFail(
            context, VPL_LIMIT,
            "form factors of %d sides take %lld bytes, at most %lld are allowed: use fewer patches "
            "or the hierarchy",
            sides->count, (long long)bytes, (long long)most);
    }
    return VPL_SUCCESS;
}

static vplResult computeAll(vplFactorWork* work)
{
    const size_t count = (size_t)work->count;
    vplFormFactors* f = work->factors;
    f->rows = work->rows = vplArena_Alloc(f->arena, count * count, sizeof *work->rows);
    TRY(vplArena_Check(f->arena));
    TRY(vplClear(work->context, work->rows, count * count * sizeof *work->rows));
    TRY(vplFactorWork_MakeBlocks(work));
    TRY(vplFactorWork_FillRows(work));
    return vplFactorWork_CorrectRows(work);
}

// Copies what own rows have around the diagonal.
static void copyNearby(void* data, int own, int worker)
{
    const vplFactorWork* work = data;
    const vplSharedRows* s = work->shared;
    const int row = own * s->members + s->member, first = row - row % VPL_SWEEP_ROWS;
    const size_t columns = vplSharedRows_Columns(s), end = (size_t)first + VPL_SWEEP_ROWS;
    float* room = work->rooms + (size_t)worker * columns;
    vplSharedRows_Decode(s, row, room);
    memcpy(s->nearby + (size_t)row * VPL_SWEEP_ROWS, room + first,
           ((end < columns ? end : columns) - (size_t)first) * sizeof *room);
}

static vplResult computeShared(vplFactorWork* work)
{
    vplContext* context = work->context;
    vplSharedRows* s = work->shared;
    const size_t bytes = VPL_SWEEP_ROWS * sizeof *s->nearby;
    TRY(vplFactorWork_ShareRows(work));
    work->rooms = vplArena_Alloc(work->scratch, (size_t)context->workerCount * vplSharedRows_Columns(s),
                                 sizeof *work->rooms);
    TRY(vplFactorWork_CorrectRows(work));
    vplTeamMail mail = vplTeamMail_Alloc(context, work->scratch, work->count, bytes);
    TRY(vplTeam_Agree(context, vplArena_Check(work->scratch)));
    const vplTeamRows rows = {s->nearby, bytes, 0, work->count};
    return vplTeam_ShareRows(context, vplParallelForAsking(context, s->ownCount, copyNearby, work), &mail,
                             &rows);
}

static vplResult compute(vplFactorWork* work)
{
    vplFormFactors* f = work->factors;
    f->rowSums = work->rowSums = vplArena_Alloc(f->arena, (size_t)work->count, sizeof *work->rowSums);
    return work->shared != NULL ? vplTeam_Agree(work->context, computeShared(work)) : computeAll(work);
}

vplResult vplFormFactors_Create(const vplPatchSides* sides, const vplFormFactorDef* def,
                                vplFormFactors** factorsOut)
{
    REQUIRE(CONTEXT_OF(sides), sides, def, factorsOut);
    TRY(checkDef(sides, def));
    vplContext* context = sides->context;
    vplArena* arena = vplArena_Create(context);
    vplTeamFactors* all = vplArena_AllocZero(arena, 1, sizeof *all);
    vplFactorWork work = {.sides = sides,
                          .def = *def,
                          .kernels = vplGetRadiosityKernels(context->isa),
                          .context = context,
                          .scratch = vplArena_Create(context),
                          .count = sides->count,
                          .shared = vplHasTeam(context) && all != NULL ? &all->shared : NULL,
                          .factors = all != NULL ? &all->factors : NULL};
    if (def->kind == VPL_FORM_FACTORS_INCENTRE) { // one point per side, and factors as they are
        work.def.samples = 1;
        work.def.analytic = false;
    }
    vplResult result = vplTeam_Agree(context, vplArena_Check(arena));
    if (result == VPL_SUCCESS) {
        *work.factors = (vplFormFactors){.count = sides->count, .arena = arena, .context = context};
        result = compute(&work);
    }
    vplArena_Destroy(work.scratch);
    return vplArena_Deliver(arena, result, work.factors, factorsOut);
}

void vplFormFactors_Destroy(vplFormFactors* factors)
{
    vplArena_Destroy(factors != NULL ? factors->arena : NULL);
}
