// SPDX-License-Identifier: MIT
// Emitters with their shadows. Compiled once per instruction set: processors forward a store only to loads
// that are not wider, so kernels that read each other's vectors have the same width.
#include "base/isa.h"
#include "lights/kernels.h"
#include "shading/shading.h"

#include <float.h>
#include <math.h>

// ---- cosines

// The vector from a point to an emitter, its squared length, its length, and the cosine towards it.
typedef struct EmitterTerm {
    float x, y, z, d2, d, cosine;
} EmitterTerm;

static inline EmitterTerm termOf(const vplSurface* surface, int l, const vplEmitterRay* e, bool parallel)
{
    const float x = parallel ? -e->direction.x : e->position.x - surface->px[l];
    const float y = parallel ? -e->direction.y : e->position.y - surface->py[l];
    const float z = parallel ? -e->direction.z : e->position.z - surface->pz[l];
    const float square = x * x + y * y + z * z;
    const float c = surface->nx[l] * x + surface->ny[l] * y + surface->nz[l] * z;
    const float d2 = square > FLT_MIN ? square : FLT_MIN, d = sqrtf(d2);
    return (EmitterTerm){x, y, z, d2, d, (c > 0 ? c : 0) / d};
}

static inline __attribute__((always_inline)) void fillCosines(const vplSurface* restrict surface,
                                                              const vplEmitterRay e, bool parallel, bool spot,
                                                              float cosine[restrict VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        const EmitterTerm t = termOf(surface, l, &e, parallel);
        cosine[l] = !parallel && e.falloff ? t.cosine / t.d2 : t.cosine;
        if (spot) {
            const float axis = -(e.direction.x * t.x + e.direction.y * t.y + e.direction.z * t.z) / t.d;
            float step = (axis - e.cosOuter) * e.inverseRing;
            step = step > 0 ? step : 0;
            step = step < 1 ? step : 1;
            cosine[l] *= step * step * (3 - 2 * step);
        }
    }
}

// Finds irradiance per unit of intensity, without shadow; false where no lane is lit. Directional: n.l.
// Point: n.l / d^2. Spot: that times the smooth step of its cone (see vplSpot_Falloff).
static bool emitterCosine(const vplSurface* restrict surface, const vplEmitterRay* emitter,
                          float cosine[restrict VPL_LANES])
{
    if (emitter->parallel) {
        fillCosines(surface, *emitter, true, false, cosine);
    } else if (emitter->spot) {
        fillCosines(surface, *emitter, false, true, cosine);
    } else {
        fillCosines(surface, *emitter, false, false, cosine);
    }
    int any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        any |= cosine[l] > 0;
    }
    return any;
}

// ---- light

// Multiplies `amount` by the unshadowed share of the emitter. The first emitter that casts rays finds their starts.
static void shadowEmitter(vplReceiver* receiver, vplRayStarts* starts, const vplDirectLight* direct,
                          int index, float amount[VPL_LANES])
{
    const vplShading* s = receiver->shading;
    const vplPoints* points = receiver->points;
    const vplEmitterRay* emitter = &direct->rays[index];
    const vplReflectiveMap* map = vplDirectLight_Map(direct, index);
    if (vplDirectLight_CastsRays(direct, index)) {
        if (receiver->starts == NULL) {
            vplFindRayStarts(s, points, starts);
            receiver->starts = starts;
        }
        vplCastEmitterRays(receiver, emitter, amount);
        return;
    }
    float factor[VPL_LANES];
    if (s->smooth) { // the plane of the triangle, not the shading normal, decides which side is lit
        float cosine[VPL_LANES];
        emitterCosine(points->plane, emitter, cosine);
        for (int l = 0; l < VPL_LANES; l++) {
            amount[l] = cosine[l] > 0 ? amount[l] : 0;
        }
    }
    if (map != NULL) {
        vplReflectiveMap_FactorBlock(map, points->plane, factor);
    } else {
        vplShadow_FactorBlock(&direct->shadows[index], points->plane, factor);
    }
    for (int l = 0; l < VPL_LANES; l++) {
        amount[l] *= 1 - factor[l];
    }
    if (s->geometry->cutOuts != NULL) { // maps show what is solid
        vplVeilFromEmitter(s->geometry, points, emitter, amount);
    }
}

void VPL_KERNEL(vplAddEmitters)(const vplShading* s, const vplDirectLight* direct, const vplPoints* points,
                                float irradiance[restrict 3][VPL_LANES], int64_t* rays)
{
    vplRayStarts starts;
    vplReceiver receiver = {s, points, NULL, rays};
    const bool chooses = direct->tree != NULL;
    if (chooses) {
        vplAddChosenEmitters(s, direct, points, irradiance, rays);
    }
    for (int i = chooses ? direct->firstParallel : 0; i < direct->emitterCount; i++) {
        float amount[VPL_LANES];
        if ((chooses && !direct->rays[i].parallel) ||
            !emitterCosine(points->surface, &direct->rays[i], amount)) {
            continue;
        }
        shadowEmitter(&receiver, &starts, direct, i, amount);
        const vplRgb intensity = direct->emitters[i].intensity;
        const float weight = direct->weight;
        const float colour[3] = {weight * intensity.r, weight * intensity.g, weight * intensity.b};
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                irradiance[c][l] += colour[c] * amount[l];
            }
        }
    }
}
