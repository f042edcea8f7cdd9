// SPDX-License-Identifier: MIT
// Lights of which the scene gets something. Of the sun's light on a roof most goes back to the sky, and a light there
// costs as much as one in the courtyard below: 56 of the 256 texels that SSVP samples of Sponza's reflective map lie
// where the camera's rooms are.
// Based on: Russian roulette over lights, as Segovia, Iehl, Mitanchey and Peroche (Bidirectional Instant Radiosity, EGSR
// 2006) and Georgiev and Slusallek (Eurographics 2010) use it. Departs: a light's worth is the share of its light that
// meets the scene, which, unlike what the camera sees of it, stays while the camera moves.
#include "base/context.h"
#include "base/rng.h"
#include "geometry/bvh.h"
#include "lights/light_set.h"
#include "math/sampling.h"
#include "math/vec.h"
#include "visibility/half_map.h"

enum { RAYS = VPL_RAY_PACKET, TURN_STREAM = 0x80000005u, LOT_STREAM = 0x80000006u };

// None is less likely to stay, or it would weigh more than this many.
static const float LEAST = 1.0f / 16;

// ---- worth

typedef struct Measuring {
    const vplGeometry* geometry;
    const vplLightSet* set;
    float* use;
} Measuring;

// Sixteen cosine-distributed rays, turned for each light.
static void measureLight(void* data, int index, int worker)
{
    (void)worker;
    const Measuring* m = data;
    const vplVirtualLight* v = &m->set->lights[index];
    const float turn = vplUnitFloat(vplRandomAt(0, TURN_STREAM, (uint64_t)v->particle).v[0]);
    vplRay ray = {.origin =
                      vplAdd(v->position, vplScale(vplLightLift(vplLargestOf(v->position)), v->normal))};
    vplRayPacket packet;
    packet.active = 0;
    for (int l = 0; l < RAYS; l++) {
        const float at = vplVanDerCorput((uint32_t)l) + turn;
        ray.direction = vplSampleCosineAround(v->normal, ((float)l + 0.5f) / RAYS, at < 1 ? at : at - 1);
        vplRayPacket_Set(&packet, l, &ray);
    }
    const uint32_t met = vplGeometry_AreOccluded(m->geometry, &packet, INFINITY);
    m->use[index] = (float)__builtin_popcount(met) / RAYS;
}

vplResult vplMeasureUse(const vplGeometry* geometry, const vplLightSet* set, float* useOut)
{
    const vplResult result = vplGeometry_PrepareRays(geometry);
    if (result == VPL_SUCCESS) {
        Measuring m = {geometry, set, useOut};
        vplParallelFor(geometry->context, set->lightCount, measureLight, &m);
    }
    return result;
}

// ---- choice

static float chanceOf(float use)
{
    return use > LEAST ? use : LEAST;
}

// The third number of each sample's Hammersley point: what stays is spread as evenly as what was sampled.
static bool isKept(const vplVirtualLight* v, float use, float shift)
{
    const float lot = vplHalton((uint64_t)v->particle, 1) + shift;
    return (lot < 1 ? lot : lot - 1) < chanceOf(use);
}

double vplCountUseful(const vplLightSet* set, const float* use)
{
    double sum = 0;
    for (int i = 0; i < set->lightCount; i++) {
        sum += (double)chanceOf(use[i]);
    }
    return sum;
}

vplResult vplKeepUseful(const vplLightSet* set, const float* use, uint64_t shift, vplLightSet** setOut)
{
    const float shifted = shift ? vplUnitFloat(vplRandomAt(shift, LOT_STREAM, 0).v[0]) : 0;
    vplLightSet* kept;
    const vplResult result = vplLightSet_Make(set->context, set->lightCount, set->stepCount, &kept);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplVirtualLight* lights = (vplVirtualLight*)kept->lights;
    kept->lightCount = 0;
    for (int i = 0; i < set->lightCount; i++) {
        if (isKept(&set->lights[i], use[i], shifted)) {
            vplVirtualLight* v = &lights[kept->lightCount++];
            *v = set->lights[i];
            v->weight /= chanceOf(use[i]);
            ((int*)kept->lightsInStep)[v->step]++;
        }
    }
    for (int i = 0; i < set->stepCount; i++) {
        ((int*)kept->stepCounts)[i] = set->stepCounts[i];
    }
    kept->escaped = set->escaped;
    kept->rays = set->rays + (int64_t)RAYS * set->lightCount;
    kept->particleCount = set->particleCount;
    *setOut = kept;
    return VPL_SUCCESS;
}
