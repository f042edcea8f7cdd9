// SPDX-License-Identifier: MIT
// The importance of lights: their contribution to points that the camera sees.
// Based on: Georgiev and Slusallek, Simple and Robust Iterative Importance Sampling of Virtual Point Lights,
// Eurographics 2010. Departs: the points are few and the same for all lights, so that sixteen shadow rays of
// a light form one packet; importance is the root of the mean square, which gives the least error for a
// number of independently chosen lights (0.84 of the error that the mean gives; room, sponza-sun).
#include "lights/placement.h"

#include "lights/kernels.h"
#include "lights/light_set.h"

#include <float.h>

enum { CHUNK = 32 }; // lights per task

typedef struct Measuring {
    const vplGeometry* geometry;
    const vplLightSet* set;
    const vplPlacementDef* def;
    const vplViewBlock* blocks;
    int blockCount;
    vplReflectFcn* reflect;
    float inverseClamp;
    float* contributions; // per light
    int* rays;            // per chunk
} Measuring;

// Sets reflected light to 0 where something is between.
static void castShadows(const Measuring* m, const vplViewBlock* b, const vplShadeLight* light,
                        float reflected[VPL_LANES], int* rays)
{
    vplRayPacket packet = b->rays;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const vplVec3 origin = {packet.origin[0][l], packet.origin[1][l], packet.origin[2][l]};
        const vplVec3 way = vplWayTo(light, origin), plane = {b->plane[0][l], b->plane[1][l], b->plane[2][l]};
        packet.direction[0][l] = way.x;
        packet.direction[1][l] = way.y;
        packet.direction[2][l] = way.z;
        reflected[l] = vplDot(way, plane) > 0 ? reflected[l] : 0;
        packet.active |= (uint32_t)(reflected[l] > 0) << l;
    }
    *rays += vplGeometry_Darken(m->geometry, &packet, 1, reflected);
}

static float measure(const Measuring* m, const vplVirtualLight* v, int* rays)
{
    const vplShadeLight light = vplPrepareLight(v, m->set->particleCount, m->def->lighting);
    double squares = 0;
    for (int i = 0; i < m->blockCount && v->object >= 0; i++) {
        float reflected[VPL_LANES];
        m->reflect(&m->blocks[i], &light, m->inverseClamp, reflected);
        float most = 0;
        for (int l = 0; l < VPL_LANES; l++) {
            most = reflected[l] > most ? reflected[l] : most;
        }
        if (!(most > 0)) {
            continue;
        }
        if (m->def->shadows) {
            castShadows(m, &m->blocks[i], &light, reflected, rays);
        }
        for (int l = 0; l < VPL_LANES; l++) {
            squares += (double)reflected[l] * (double)reflected[l];
        }
    }
    const double root = sqrt(squares / (VPL_LANES * m->blockCount));
    return root < (double)FLT_MAX ? (float)root : FLT_MAX;
}

static void measureChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Measuring* m = data;
    m->rays[chunk] = 0;
    for (int i = chunk * CHUNK; i < (chunk + 1) * CHUNK && i < m->set->lightCount; i++) {
        m->contributions[i] = measure(m, &m->set->lights[i], &m->rays[chunk]);
    }
}

static vplResult measureAll(Measuring* m, vplArena* scratch, int64_t* raysOut)
{
    vplContext* context = m->geometry->context;
    const vplLightsKernels* kernels = vplGetLightsKernels(context->isa);
    const int chunks = (m->set->lightCount + CHUNK - 1) / CHUNK;
    const float distance = m->def->minDistance;
    TRY(vplSampleView(m->geometry, m->def, scratch, &m->blocks, &m->blockCount));
    m->reflect =
        m->def->lighting == VPL_LIGHTING_DOCUMENTED ? kernels->reflectDocumented : kernels->reflectPhysical;
    m->inverseClamp = distance > 0 ? 1 / (distance * distance) : INFINITY;
    m->rays = vplArena_Alloc(scratch, (size_t)chunks, sizeof *m->rays);
    TRY(vplArena_Check(scratch));
    TRY(vplParallelForProgress(context, chunks, measureChunk, m,
                               (vplProgressRange){m->def->progress, m->def->progressUser, 0.2, 1}));
    for (int i = 0; i < chunks; i++) {
        *raysOut += m->rays[i];
    }
    return VPL_SUCCESS;
}

vplResult vplMeasureLights(const vplGeometry* geometry, const vplLightSet* set, const vplPlacementDef* def,
                           float* contributionsOut, int64_t* raysOut)
{
    REQUIRE(CONTEXT_OF(geometry) ?: CONTEXT_OF(set), geometry, set, def, contributionsOut);
    Measuring m = {.geometry = geometry, .set = set, .def = def, .contributions = contributionsOut};
    int64_t rays = 0;
    TRY(vplPlacementDef_Check(geometry->context, def));
    vplArena* scratch = vplArena_Create(geometry->context);
    const vplResult result = measureAll(&m, scratch, &rays);
    vplArena_Destroy(scratch);
    if (raysOut != NULL && result == VPL_SUCCESS) {
        *raysOut = rays;
    }
    return result;
}
