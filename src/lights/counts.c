// SPDX-License-Identifier: MIT
// How many particles reach each step. The user types a decimal such as 0.29 and means it: 0.29 * 100 is 29,
// though in binary both 0.29 and the product lie below. Repeated multiplication in double stays within
// (k + 1) 2^-51 of the true value relative to it, so a product that near to an integer is that integer. Decimals of few
// digits cannot come that near to an integer otherwise; far out (k > 64) the band could hold one, so plain
// floor takes over.
//
// Passes of one long walk: pass after pass, the counts of all particles so far are floor(rho^k (first + N)), and a pass
// gets what that grows by. So even steps that a pass of N particles would never reach get their share now and then.
#include "lights/counts.h"

#include "base/context.h"

#include <math.h>

static int64_t countAt(double w, int step)
{
    double r = rint(w);
    if (step <= 64 && fabs(w - r) <= (step + 1) * 0x1p-51 * w) {
        return (int64_t)r;
    }
    return (int64_t)floor(w);
}

vplResult vplCountParticles(vplContext* context, int particleCount, double reflectivity, int* counts,
                            int capacity, int* stepsOut, int64_t* totalOut)
{
    return vplCountPass(context, 0, particleCount, reflectivity, counts, capacity, stepsOut, totalOut);
}

vplResult vplCountPass(vplContext* context, int64_t firstParticle, int particleCount, double reflectivity,
                       int* counts, int capacity, int* stepsOut, int64_t* totalOut)
{
    if (particleCount < 0 || particleCount > VPL_MAX_LIGHTS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "particle count is %d, must be in [0, %d]",
                       particleCount, VPL_MAX_LIGHTS);
    }
    if (!(reflectivity >= 0 && reflectivity < 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "reflectivity is %g, must be in [0, 1)", reflectivity);
    }
    double before = (double)firstParticle, after = (double)(firstParticle + particleCount);
    int64_t total = 0, count = particleCount;
    int step = 0;
    for (int64_t reached = firstParticle + particleCount; particleCount > 0 && reached > 0;
         reached = countAt(after, step), count = reached - countAt(before, step)) {
        if (step >= VPL_MAX_STEPS) {
            return vplFail(context, VPL_LIMIT, "reflectivity %.17g needs more than %d steps", reflectivity,
                           VPL_MAX_STEPS);
        }
        total += count;
        if (total > VPL_MAX_LIGHTS) {
            return vplFail(context, VPL_LIMIT,
                           "%d particles at reflectivity %.17g leave more than %d virtual lights",
                           particleCount, reflectivity, VPL_MAX_LIGHTS);
        }
        if (counts != NULL && step < capacity) {
            counts[step] = (int)count;
        }
        step++;
        before *= reflectivity;
        after *= reflectivity;
    }
    *stepsOut = step;
    *totalOut = total;
    return VPL_SUCCESS;
}
