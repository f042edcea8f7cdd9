// SPDX-License-Identifier: MIT
// Makes rows sum to what they can be, by factors s_i s_j, which keep A_i F_ij = A_j F_ji.
// Based on: Richard Sinkhorn and Paul Knopp, Concerning Nonnegative Matrices and Doubly Stochastic Matrices, Pacific
// Journal of Mathematics 1967; Philip Knight and Daniel Ruiz, A Fast Algorithm for Matrix Balancing, IMA Journal of
// Numerical Analysis 2013 (symmetric: by the square root of what is missing).
#include "base/context.h"
#include "base/isa.h"
#include "math/scalar.h"
#include "radiosity/form_factors.h"

VPL_KERNEL_TABLE(DOT, vplFactorDotFcn, vplFactorDot);
VPL_KERNEL_TABLE(SCALE, vplFactorScaleFcn, vplFactorScale);

// Rounds end when no row is further than this from what it should be; or after so many, since there are matrices that
// nothing normalises.
static const double ENOUGH = 1e-6;
enum { MOST_ROUNDS = 24 };

// Room for the rounding of the scaled floats: sums in the end are not above 1.
static const double MARGIN = 1 - 0x1p-22;

typedef struct Scaling {
    vplFactorDotFcn* dot;
    vplFactorScaleFcn* multiply;
    float* rows;
    int count;
    double *factor, *sum; // per row: s_i, and the sum of F_ij s_j
} Scaling;

static void sumRow(void* data, int row, int worker)
{
    (void)worker;
    const Scaling* s = data;
    s->sum[row] = s->dot(s->rows + (size_t)row * (size_t)s->count, s->factor, s->count);
}

static void scaleRow(void* data, int row, int worker)
{
    (void)worker;
    const Scaling* s = data;
    s->multiply(s->rows + (size_t)row * (size_t)s->count, s->factor[row], s->factor, s->count);
}

// Towards 1 each row by half the way; rows of a clamp only while they are above. Returns the largest step.
static double improve(Scaling* s, bool clamp)
{
    double largest = 0;
    for (int i = 0; i < s->count; i++) {
        const double sum = s->factor[i] * s->sum[i];
        if (sum > 0) {
            const double before = s->factor[i], wanted = before / sqrt(sum);
            s->factor[i] = clamp && wanted > 1 ? 1 : wanted;
            const double step = fabs(s->factor[i] / before - 1);
            largest = step > largest ? step : largest;
        }
    }
    return largest;
}

// No factor grows, so all rows that are above 1 may take the whole step at once.
static void finish(Scaling* s)
{
    for (int i = 0; i < s->count; i++) {
        const double sum = s->factor[i] * s->sum[i];
        s->factor[i] *= sum > MARGIN ? MARGIN / sum : 1;
    }
}

static void scaleRows(vplContext* context, Scaling* s, bool clamp)
{
    for (int round = 0; round < MOST_ROUNDS; round++) {
        const double step = improve(s, clamp);
        vplParallelFor(context, s->count, sumRow, s);
        if (step < ENOUGH) {
            break;
        }
    }
    finish(s);
    vplParallelFor(context, s->count, scaleRow, s);
}

vplResult vplFormFactors_FixRows(const vplFormFactorDef* def, vplFormFactors* factors)
{
    vplContext* context = factors->context;
    const size_t count = (size_t)factors->count;
    Scaling s = {.dot = DOT[context->isa],
                 .multiply = SCALE[context->isa],
                 .rows = (float*)factors->rows,
                 .count = factors->count};
    s.factor = vplAlloc(context, count, sizeof *s.factor);
    s.sum = s.factor ? vplAlloc(context, count, sizeof *s.sum) : NULL;
    if (s.sum != NULL) {
        double most = 0;
        for (size_t i = 0; i < count; i++) {
            s.factor[i] = 1;
        }
        vplParallelFor(context, s.count, sumRow, &s);
        for (size_t i = 0; i < count; i++) {
            ((float*)factors->rowSums)[i] = (float)s.sum[i];
            most = s.sum[i] > most ? s.sum[i] : most;
        }
        const bool clamp = def->rowSums == VPL_ROW_SUMS_CLAMP ||
                           (def->rowSums == VPL_ROW_SUMS_USUAL && def->kind == VPL_FORM_FACTORS_MONTE_CARLO);
        if (def->rowSums == VPL_ROW_SUMS_NORMALISE || (clamp && most > MARGIN)) {
            scaleRows(context, &s, clamp);
        }
    }
    const vplResult result = s.sum ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    vplFree(context, s.factor);
    vplFree(context, s.sum);
    return result;
}
