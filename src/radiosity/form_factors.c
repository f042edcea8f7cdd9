// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.3.1.
#include "radiosity/form_factors.h"

#include "base/context.h"

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

// An incentre is one point, and its factors are kept as they come.
static vplFormFactorDef usedDef(const vplFormFactorDef* def)
{
    vplFormFactorDef used = *def;
    if (def->kind == VPL_FORM_FACTORS_INCENTRE) {
        used.samples = 1;
        used.analytic = false;
    }
    return used;
}

vplResult vplFormFactors_Create(const vplPatchSides* sides, const vplFormFactorDef* def,
                                vplFormFactors** factorsOut)
{
    vplResult result = checkDef(sides, def);
    vplContext* context = sides->context;
    vplFormFactors* factors = result == VPL_SUCCESS ? vplAllocZero(context, 1, sizeof *factors) : NULL;
    if (factors == NULL) {
        return result == VPL_SUCCESS ? VPL_OUT_OF_MEMORY : result;
    }
    const vplFormFactorDef used = usedDef(def);
    const size_t count = (size_t)sides->count;
    vplFactorBlock* blocks = NULL;
    factors->context = context;
    factors->count = sides->count;
    factors->rows = vplAllocZero(context, count * count, sizeof *factors->rows);
    factors->rowSums = factors->rows ? vplAlloc(context, count, sizeof *factors->rowSums) : NULL;
    result = factors->rowSums ? vplFactorBlocks_Create(sides, &used, &blocks) : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        result = vplFormFactors_Fill(sides, &used, blocks, factors);
    }
    if (result == VPL_SUCCESS) {
        result = vplFormFactors_FixRows(&used, factors);
    }
    vplFree(context, blocks);
    if (result != VPL_SUCCESS) {
        vplFormFactors_Destroy(factors);
        return result;
    }
    *factorsOut = factors;
    return VPL_SUCCESS;
}

void vplFormFactors_Destroy(vplFormFactors* factors)
{
    if (factors != NULL) {
        vplFree(factors->context, (void*)factors->rows);
        vplFree(factors->context, (void*)factors->rowSums);
        vplFree(factors->context, factors);
    }
}
