// SPDX-License-Identifier: MIT
// Some lights of many, each with a probability of its own and its weight divided by that: unbiased, whatever the
// contributions are worth.
// Based on: Georgiev and Slusallek, Eurographics 2010, who accept each light by itself. Departs: systematic sampling
// along a curve that fills space, so that the number is fixed and each region keeps its share of lights: 0.75 (room)
// and 0.91 (sponza-sun) of the error that the particles' own order leaves. Lights beyond probability 1 are kept as
// they are, not doubled.
#include "lights/light_set.h"
#include "lights/placement.h"

#include "base/context.h"
#include "base/rng.h"
#include "math/vec.h"

#include <float.h>

// Of random numbers: not those of particles.
enum { CHOICE_STREAM = 0x80000003u };

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

// q: positive where there is flux, else 0.
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

// q becomes p = min(1, t q) with the sum `count`, or 1 where there are not more lights than that. Each round finds
// some that are beyond 1; the others share what is left.
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

// Every third bit.
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

// Morton's curve through 1024^3 cells of the box around all lights.
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

// By key, then by index: three rounds of counting ten bits. The result is in `scratch`.
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

// Goes through the lights and takes one whenever the sum of their probabilities passes a whole number plus `offset`.
// What is not chosen gets probability 0.
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

// Lights of positive probability, in the order that they had.
static void take(const vplLightSet* from, const double* p, vplVirtualLight* lights, int* lightsInStep,
                 vplLightSet* set)
{
    for (int i = 0; i < from->lightCount; i++) {
        if (p[i] > 0) {
            vplVirtualLight* v = &lights[set->lightCount++];
            *v = from->lights[i];
            v->weight = (float)((double)v->weight / p[i]);
            lightsInStep[v->step]++;
        }
    }
}

static vplResult makeSet(const vplLightSet* from, const double* p, vplLightSet** setOut)
{
    vplContext* context = from->context;
    size_t chosen = 0;
    for (int i = 0; i < from->lightCount; i++) {
        chosen += p[i] > 0;
    }
    vplLightSet* set;
    const vplResult result = vplLightSet_Make(context, (int)chosen, from->stepCount, &set);
    if (result != VPL_SUCCESS) {
        return result;
    }
    set->lightCount = 0;
    set->escaped = from->escaped;
    set->rays = from->rays;
    set->rayObjectTests = from->rayObjectTests;
    set->particleCount = from->particleCount;
    for (int i = 0; i < from->stepCount; i++) {
        ((int*)set->stepCounts)[i] = from->stepCounts[i];
    }
    take(from, p, (vplVirtualLight*)set->lights, (int*)set->lightsInStep, set);
    *setOut = set;
    return VPL_SUCCESS;
}

vplResult vplChooseLights(const vplLightSet* candidates, const float* contributions, double count,
                          const vplPlacementDef* def, vplLightSet** setOut)
{
    vplContext* context = candidates->context;
    const size_t lights = (size_t)candidates->lightCount;
    vplResult result = vplPlacementDef_Check(context, def);
    if (result == VPL_SUCCESS && !(count >= 0)) {
        result = vplFail(context, VPL_INVALID_ARGUMENT, "count of lights is %g, must be at least 0", count);
    }
    if (result != VPL_SUCCESS) {
        return result;
    }
    double* p = vplAlloc(context, lights, sizeof *p);
    Place* places = p ? vplAlloc(context, 2 * lights, sizeof *places) : NULL;
    result = places ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        mixShares(candidates, contributions, (double)def->fluxShare, p);
        findProbabilities(p, candidates->lightCount, count);
        findKeys(candidates, places);
        sortPlaces(places, places + lights, candidates->lightCount);
        const vplRandom4 r = vplRandomAt(def->seed, CHOICE_STREAM, (uint64_t)def->index);
        sample(places + lights, candidates->lightCount, (double)vplUnitFloat(r.v[0]), p);
        result = makeSet(candidates, p, setOut);
    }
    vplFree(context, places);
    vplFree(context, p);
    return result;
}
