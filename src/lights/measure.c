// SPDX-License-Identifier: MIT
// Based on: Georgiev and Slusallek, Simple and Robust Iterative Importance Sampling of Virtual Point Lights,
// Eurographics 2010: a light is worth what it gives to points that the camera sees. Departs: the points are few and
// the same for all lights, so that light by light sixteen shadow rays go as one packet; a light's worth is the root
// of its mean square, because the error of a picture is: the least error for a number of independently chosen
// lights has probabilities like that (0.84 of the error that the mean leaves; room, sponza-sun).
#include "lights/placement.h"

#include "base/context.h"
#include "base/isa.h"
#include "lights/prepare.h"
#include "math/vec.h"
#include "visibility/hemi_map.h"

#include <float.h>

VPL_KERNEL_TABLE(DOCUMENTED, vplReflectFcn, vplReflectDocumented);
VPL_KERNEL_TABLE(PHYSICAL, vplReflectFcn, vplReflectPhysical);

enum { CHUNK = 32 }; // lights per task

typedef struct Measuring {
    const vplGeometry* geometry;
    const vplLightSet* set;
    const vplPlacementDef* def;
    const vplSeenBlock* blocks;
    int blockCount;
    vplReflectFcn* reflect;
    float inverseClamp;
    float* contributions; // per light
    int* rays;            // per chunk
} Measuring;

// Sets what does not arrive to 0.
static void castShadows(const Measuring* m, const vplSeenBlock* b, const vplShadeLight* light,
                        float reflected[VPL_LANES], int* rays)
{
    const vplVec3 n = {light->nx, light->ny, light->nz}, at = {light->px, light->py, light->pz};
    vplRayPacket packet = b->rays;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const vplVec3 origin = {packet.origin[0][l], packet.origin[1][l], packet.origin[2][l]};
        const vplVec3 way = vplWayToLight(at, n, origin),
                      plane = {b->plane[0][l], b->plane[1][l], b->plane[2][l]};
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

vplResult vplMeasureLights(const vplGeometry* geometry, const vplLightSet* set, const vplPlacementDef* def,
                           float* contributionsOut, int64_t* raysOut)
{
    vplContext* context = geometry->context;
    const bool documented = def->lighting == VPL_LIGHTING_DOCUMENTED;
    const int chunks = (set->lightCount + CHUNK - 1) / CHUNK;
    Measuring m = {.geometry = geometry, .set = set, .def = def, .contributions = contributionsOut};
    vplResult result = vplPlacementDef_Check(context, def);
    if (result != VPL_SUCCESS) {
        return result;
    }
    vplSeenBlock* blocks;
    result = vplFindSeen(geometry, def, &blocks, &m.blockCount);
    if (result != VPL_SUCCESS) {
        return result;
    }
    m.blocks = blocks;
    m.reflect = documented ? DOCUMENTED[context->isa] : PHYSICAL[context->isa];
    m.inverseClamp = def->minDistance > 0 ? 1 / (def->minDistance * def->minDistance) : INFINITY;
    m.rays = vplAlloc(context, (size_t)chunks, sizeof *m.rays);
    result = m.rays ? vplParallelForProgress(context, chunks, measureChunk, &m, def->progress,
                                             def->progressUser, 0.2, 1)
                    : VPL_OUT_OF_MEMORY;
    int64_t rays = 0;
    for (int i = 0; i < chunks && result == VPL_SUCCESS; i++) {
        rays += m.rays[i];
    }
    if (raysOut != NULL && result == VPL_SUCCESS) {
        *raysOut = rays;
    }
    vplFree(context, m.rays);
    vplFree(context, blocks);
    return result;
}
