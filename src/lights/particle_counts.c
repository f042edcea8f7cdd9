// SPDX-License-Identifier: MIT
// Counts of the particles that reach each step. The user types a decimal such as 0.29 and means it: 0.29 * 100 is 29,
// though in binary both 0.29 and the product lie below. Repeated multiplication in double has a relative
// error below (k + 1) 2^-51, so a product that near to an integer counts as that integer. Decimals of few
// digits cannot come that near to an integer otherwise; beyond k = 64 the band could hold one, and plain
// floor takes over.
//
// Passes of one long walk: the counts of all particles so far are floor(rho^k (first + N)), and a pass gets
// the growth. So steps that a pass of N particles would never reach get their share now and then.
#include <vpl/lights.h>

#include "base/arena.h"

#include <math.h>

static int64_t countAt(double w, int step)
{
    const double r = rint(w);
    if (step <= 64 && fabs(w - r) <= (step + 1) * 0x1p-51 * w) {
        return (int64_t)r;
    }
    return (int64_t)floor(w);
}

static vplResult checkPass(const vplContext* context, const vplParticlePass* pass)
{
    if (pass->count < 0 || pass->count > VPL_MAX_LIGHTS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "particle count is %d, must be in [0, %d]", pass->count,
                       VPL_MAX_LIGHTS);
    }
    if (!(pass->reflectivity >= 0 && pass->reflectivity < 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "reflectivity is %g, must be in [0, 1)",
                       pass->reflectivity);
    }
    return VPL_SUCCESS;
}

vplResult vplCountParticles(vplContext* context, const vplParticlePass* pass, int* counts, int capacity,
                            vplStepTotals* totalsOut)
{
    REQUIRE(context, context, pass, totalsOut);
    TRY(checkPass(context, pass));
    double before = (double)pass->first, after = (double)(pass->first + pass->count);
    int64_t total = 0, count = pass->count;
    int step = 0;
    for (int64_t reached = pass->first + pass->count; pass->count > 0 && reached > 0;
         reached = countAt(after, step), count = reached - countAt(before, step)) {
        if (step >= VPL_MAX_STEPS) {
            return vplFail(context, VPL_LIMIT, "reflectivity %.17g needs more than %d steps",
                           pass->reflectivity, VPL_MAX_STEPS);
        }
        total += count;
        if (total > VPL_MAX_LIGHTS) {
            return vplFail(context, VPL_LIMIT,
                           "%d particles at reflectivity %.17g leave more than %d virtual lights",
                           pass->count, pass->reflectivity, VPL_MAX_LIGHTS);
        }
        if (counts != NULL && step < capacity) {
            counts[step] = (int)count;
        }
        step++;
        before *= pass->reflectivity;
        after *= pass->reflectivity;
    }
    *totalsOut = (vplStepTotals){step, total};
    return VPL_SUCCESS;
}
