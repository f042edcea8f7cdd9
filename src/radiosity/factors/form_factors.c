// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.3.1.
#include "radiosity/factors/form_factors.h"

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
    const int64_t bytes = (int64_t)sides->count * sides->count * (int64_t)sizeof(float);
    if (bytes > VPL_MAX_FORM_FACTOR_BYTES) {
        return vplFail(
            context, VPL_LIMIT,
            "form factors of %d sides take %lld bytes, at most %lld are allowed: use fewer patches "
            "or the hierarchy",
            sides->count, (long long)bytes, (long long)VPL_MAX_FORM_FACTOR_BYTES);
    }
    return VPL_SUCCESS;
}

static vplResult compute(vplFactorWork* work)
{
    const size_t count = (size_t)work->count;
    vplFormFactors* f = work->factors;
    f->rows = work->rows = vplArena_Alloc(f->arena, count * count, sizeof *work->rows);
    f->rowSums = work->rowSums = vplArena_Alloc(f->arena, count, sizeof *work->rowSums);
    TRY(vplArena_Check(f->arena));
    TRY(vplClear(work->context, work->rows, count * count * sizeof *work->rows));
    TRY(vplFactorWork_MakeBlocks(work));
    TRY(vplFactorWork_FillRows(work));
    return vplFactorWork_CorrectRows(work);
}

vplResult vplFormFactors_Create(const vplPatchSides* sides, const vplFormFactorDef* def,
                                vplFormFactors** factorsOut)
{
    REQUIRE(CONTEXT_OF(sides), sides, def, factorsOut);
    TRY(checkDef(sides, def));
    vplContext* context = sides->context;
    vplArena* arena = vplArena_Create(context);
    vplFactorWork work = {.sides = sides,
                          .def = *def,
                          .kernels = vplGetRadiosityKernels(context->isa),
                          .context = context,
                          .scratch = vplArena_Create(context),
                          .count = sides->count,
                          .factors = vplArena_AllocZero(arena, 1, sizeof *work.factors)};
    if (def->kind == VPL_FORM_FACTORS_INCENTRE) { // one point per side, and factors as they are
        work.def.samples = 1;
        work.def.analytic = false;
    }
    vplResult result = vplArena_Check(arena);
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
