// SPDX-License-Identifier: MIT
// Keeps lights whose light meets the scene. Most of the sun on Sponza lies on the roof, which reflects it to
// the sky. A few rays per light find the useful ones as well as points that the camera sees do (both 0.023 of
// error with 256 lights, 0.035 without choice; bench/ssvp), and the lights do not change when the camera
// moves.
// Based on: Russian roulette over lights, as Segovia, Iehl, Mitanchey and Peroche (Bidirectional Instant
// Radiosity, EGSR 2006) and Georgiev and Slusallek (Eurographics 2010) use it. Departs: by the share of a
// light that meets the scene.
#include "base/arena.h"
#include "base/rng.h"
#include "geometry/bvh.h"
#include "lights/light_set.h"
#include "math/sampling.h"

enum {
    CHUNK = 32,              // lights per task
    LOT_STREAM = 0x80000006u // of random numbers
};

// Least probability to be kept: no weight grows by more than 16.
static const float LEAST = 1.0f / 16;

// ---- use

typedef struct Measuring {
    const vplGeometry* geometry;
    const vplLightSet* set;
    int rayCount;
    float* use;
} Measuring;

static float fractionOf(double x)
{
    return (float)(x - floor(x)) * 0x1.fffffep-1f;
}

// Ray i of a light, cosine-distributed. The rays of neighbouring lights are rotated against each other.
static vplRay rayOf(const vplVirtualLight* light, int i, int count)
{
    const float u = ((float)i + 0.5f) / (float)count;
    const float v =
        fractionOf((double)vplVanDerCorput((uint32_t)i) + (double)light->particle * 0.61803398874989484820);
    const vplVec3 lifted = vplScale(vplLightLift(vplLargestOf(light->position)), light->normal);
    return (vplRay){vplAdd(light->position, lifted), vplSampleCosineAround(light->normal, u, v), {0, 0}};
}

// Counts the rays of a light that meet something.
static int countHits(const Measuring* m, const vplVirtualLight* light)
{
    int hits = 0;
    for (int first = 0; first < m->rayCount; first += VPL_RAY_PACKET) {
        vplRayPacket packet;
        packet.active = 0;
        for (int i = first; i < m->rayCount && i < first + VPL_RAY_PACKET; i++) {
            const vplRay ray = rayOf(light, i, m->rayCount);
            vplRayPacket_Set(&packet, i - first, &ray);
        }
        hits += __builtin_popcount(vplGeometry_AreOccluded(m->geometry, &packet, INFINITY));
    }
    return hits;
}

static void measureChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Measuring* m = data;
    for (int i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < m->set->lightCount; i++) {
        m->use[i] = (float)countHits(m, &m->set->lights[i]) / (float)m->rayCount;
    }
}

vplResult vplMeasureUse(const vplGeometry* geometry, const vplLightSet* set, int rayCount, float* useOut)
{
    REQUIRE(CONTEXT_OF(geometry) ?: CONTEXT_OF(set), geometry, set, useOut);
    if (rayCount < 1 || rayCount > VPL_MAX_USE_RAYS) {
        return vplFail(geometry->context, VPL_INVALID_ARGUMENT, "rayCount is %d, must be in [1, %d]",
                       rayCount, VPL_MAX_USE_RAYS);
    }
    Measuring m = {geometry, set, rayCount, useOut};
    return vplParallelForAsking(geometry->context, (set->lightCount + CHUNK - 1) / CHUNK, measureChunk, &m);
}

// ---- choice

static float chanceOf(float use)
{
    return use > LEAST ? use : LEAST;
}

// Compares with the third coordinate of the sample's Hammersley point, so that kept lights are spread evenly.
static bool isKept(const vplVirtualLight* v, float use, float shift)
{
    const float lot = vplHalton((uint64_t)v->particle, 1) + shift;
    return (lot < 1 ? lot : lot - 1) < chanceOf(use);
}

double vplCountUseful(const vplLightSet* set, const float* use)
{
    if (set == NULL || use == NULL) {
        return 0;
    }
    double sum = 0;
    for (int i = 0; i < set->lightCount; i++) {
        sum += (double)chanceOf(use[i]);
    }
    return sum;
}

vplResult vplKeepUseful(const vplLightSet* set, const float* use, uint64_t shift, vplLightSet** setOut)
{
    REQUIRE(CONTEXT_OF(set), set, use, setOut);
    const float shifted = shift ? vplUnitFloat(vplRandomAt(shift, LOT_STREAM, 0).v[0]) : 0;
    vplLightArrays arrays;
    vplLightSet* kept;
    TRY(vplLightSet_MakeSubset(set, set->lightCount, &arrays, &kept));
    for (int i = 0; i < set->lightCount; i++) {
        if (isKept(&set->lights[i], use[i], shifted)) {
            vplVirtualLight* v = &arrays.lights[kept->lightCount++];
            *v = set->lights[i];
            v->weight /= chanceOf(use[i]);
            arrays.lightsInStep[v->step]++;
        }
    }
    *setOut = kept;
    return VPL_SUCCESS;
}
