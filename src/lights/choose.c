// SPDX-License-Identifier: MIT
// Chooses some lights of many, each with a probability of its own by which its weight is divided: unbiased
// for any probabilities.
// Based on: Georgiev and Slusallek, Eurographics 2010, who accept each light independently. Departs:
// systematic sampling along a space-filling curve, so that the number is fixed and each region keeps its
// share of lights: 0.75 (room) and 0.91 (sponza-sun) of the error in particle order. Lights of probability 1
// or more are kept as they are.
#include "lights/light_set.h"
#include "lights/placement.h"

#include "base/rng.h"
#include "math/vec.h"

#include <float.h>

enum { CHOICE_STREAM = 0x80000003u }; // of random numbers; differs from those of particles

// A tiny probability would make a weight that overflows.
static const double LEAST_PROBABILITY = 1e-30;

// ---- probabilities

static bool isDrawn(const vplVirtualLight* v)
{
    return v->object >= 0;
}

static double fluxOf(const vplVirtualLight* v)
{
    return isDrawn(v) ? vplRgbMean(v->light) * (double)v->weight : 0;
}

// Mixes shares by contribution and by flux: positive where there is flux, else 0.
static void mixShares(const vplLightSet* set, const float* contributions, double fluxShare, double* q)
{
    double contribution = 0, flux = 0;
    for (int i = 0; i < set->lightCount; i++) {
        contribution += isDrawn(&set->lights[i]) ? (double)contributions[i] : 0;
        flux += fluxOf(&set->lights[i]);
    }
    const double byFlux = contribution > 0 ? fluxShare : 1;
    for (int i = 0; i < set->lightCount; i++) {
        const double f = fluxOf(&set->lights[i]);
        q[i] = f > 0 ? byFlux * (f / flux) : 0;
        q[i] += f > 0 && contribution > 0 ? (1 - byFlux) * ((double)contributions[i] / contribution) : 0;
    }
}

// Replaces q by p = min(1, t q) with the sum `count`, or by 1 where there are not more lights than that. Each
// round sets some to 1; the others share the rest.
static void findProbabilities(double* q, int lightCount, double count)
{
    int positive = 0;
    for (int i = 0; i < lightCount; i++) {
        positive += q[i] > 0;
    }
    for (int i = 0; i < lightCount && count >= positive; i++) {
        q[i] = q[i] > 0 ? 1 : 0;
    }
    for (bool changed = true; changed;) {
        double rest = 0, wanted = count;
        for (int i = 0; i < lightCount; i++) {
            rest += q[i] < 1 ? q[i] : 0;
            wanted -= q[i] < 1 ? 0 : 1;
        }
        changed = false;
        for (int i = 0; i < lightCount && rest > 0; i++) {
            if (q[i] < 1 && q[i] > 0) {
                q[i] = wanted > 0 ? q[i] / rest * wanted : 0;
                changed = changed || q[i] >= 1;
                q[i] = q[i] > LEAST_PROBABILITY ? q[i] : LEAST_PROBABILITY;
            }
        }
    }
    for (int i = 0; i < lightCount; i++) {
        q[i] = q[i] < 1 ? q[i] : 1;
    }
}

// ---- order

typedef struct Place {
    uint32_t key; // on the curve
    int light;
} Place;

// Spreads ten bits to every third bit.
static uint32_t spread(uint32_t x)
{
    x = (x | x << 16) & 0x030000FF;
    x = (x | x << 8) & 0x0300F00F;
    x = (x | x << 4) & 0x030C30C3;
    return (x | x << 2) & 0x09249249;
}

static uint32_t cellOf(float x, float low, float size)
{
    const float cell = size > 0 ? (x - low) / size * 1024 : 0;
    return cell < 1023 ? (cell > 0 ? (uint32_t)cell : 0) : 1023;
}

// Morton order of 1024^3 cells of the box around all lights.
static void findKeys(const vplLightSet* set, Place* places)
{
    vplVec3 low = {INFINITY, INFINITY, INFINITY}, high = {-INFINITY, -INFINITY, -INFINITY};
    for (int i = 0; i < set->lightCount; i++) {
        const vplVec3 p = set->lights[i].position;
        low = vplVec(fminf(low.x, p.x), fminf(low.y, p.y), fminf(low.z, p.z));
        high = vplVec(fmaxf(high.x, p.x), fmaxf(high.y, p.y), fmaxf(high.z, p.z));
    }
    const float size = fmaxf(high.x - low.x, fmaxf(high.y - low.y, high.z - low.z));
    for (int i = 0; i < set->lightCount; i++) {
        const vplVec3 p = set->lights[i].position;
        places[i].key = spread(cellOf(p.x, low.x, size)) | spread(cellOf(p.y, low.y, size)) << 1 |
                        spread(cellOf(p.z, low.z, size)) << 2;
        places[i].light = i;
    }
}

// Radix sort by key, then index: three rounds of ten bits. The result is in `scratch`.
static void sortPlaces(Place* places, Place* scratch, int count)
{
    for (int shift = 0; shift < 30; shift += 10) {
        int starts[1025] = {0};
        for (int i = 0; i < count; i++) {
            starts[(places[i].key >> shift & 1023) + 1]++;
        }
        for (int k = 0; k < 1024; k++) {
            starts[k + 1] += starts[k];
        }
        for (int i = 0; i < count; i++) {
            scratch[starts[places[i].key >> shift & 1023]++] = places[i];
        }
        Place* swap = places;
        places = scratch;
        scratch = swap;
    }
}

// ---- choice

// Systematic sampling: takes a light when the sum of probabilities passes a whole number plus `offset`.
// Lights that are not taken get probability 0.
static void sample(const Place* order, int count, double offset, double* p)
{
    double sum = 0;
    for (int i = 0; i < count; i++) {
        double* mine = &p[order[i].light];
        if (*mine < 1) {
            const double before = floor(sum - offset);
            sum += *mine;
            *mine = floor(sum - offset) > before ? *mine : 0;
        }
    }
}

// The lights of positive probability, in their order.
static vplResult makeSet(const vplLightSet* from, const double* p, vplLightSet** setOut)
{
    int chosen = 0;
    for (int i = 0; i < from->lightCount; i++) {
        chosen += p[i] > 0;
    }
    vplLightArrays arrays;
    vplLightSet* set;
    TRY(vplLightSet_MakeSubset(from, chosen, &arrays, &set));
    for (int i = 0; i < from->lightCount; i++) {
        if (p[i] > 0) {
            vplVirtualLight* v = &arrays.lights[set->lightCount++];
            *v = from->lights[i];
            v->weight = (float)((double)v->weight / p[i]);
            arrays.lightsInStep[v->step]++;
        }
    }
    *setOut = set;
    return VPL_SUCCESS;
}

static vplResult choose(const vplLightSet* candidates, const float* contributions, double count,
                        const vplPlacementDef* def, vplArena* scratch, vplLightSet** setOut)
{
    const size_t lights = (size_t)candidates->lightCount;
    double* p = vplArena_Alloc(scratch, lights, sizeof *p);
    Place* places = vplArena_Alloc(scratch, 2 * lights, sizeof *places);
    TRY(vplArena_Check(scratch));
    mixShares(candidates, contributions, (double)def->fluxShare, p);
    findProbabilities(p, candidates->lightCount, count);
    findKeys(candidates, places);
    sortPlaces(places, places + lights, candidates->lightCount);
    const vplRandom4 r = vplRandomAt(def->seed, CHOICE_STREAM, (uint64_t)def->index);
    sample(places + lights, candidates->lightCount, (double)vplUnitFloat(r.v[0]), p);
    return makeSet(candidates, p, setOut);
}

vplResult vplChooseLights(const vplLightSet* candidates, const float* contributions, double count,
                          const vplPlacementDef* def, vplLightSet** setOut)
{
    REQUIRE(CONTEXT_OF(candidates), candidates, contributions, def, setOut);
    vplContext* context = candidates->context;
    TRY(vplPlacementDef_Check(context, def));
    if (!(count >= 0)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "count of lights is %g, must be at least 0", count);
    }
    vplArena* scratch = vplArena_Create(context);
    const vplResult result = choose(candidates, contributions, count, def, scratch, setOut);
    vplArena_Destroy(scratch);
    return result;
}
