// SPDX-License-Identifier: MIT
// Light of some points and spots that a tree chooses for each point, where there are too many to ask all.
// Based on: Alejandro Conty Estevez and Christopher Kulla, Importance Sampling of Many Lights with Adaptive Tree
// Splitting, HPG 2018. The random number of a point is here a hash of its position: no stage passes random numbers, and
// the same points have the same noise in every pipeline.
#include "base/hash.h"
#include "math/vec.h"
#include "shading/shading.h"

#include <float.h>

enum { CHOICE_SEED = 0x656d6974 };

// Irradiance by a unit of intensity, without shadow: as the kernel of all emitters has it.
static float receive(const vplEmitterRay* e, vplVec3 p, vplVec3 n)
{
    const vplVec3 way = vplSub(e->position, p);
    const float square = vplDot(way, way), d2 = square > FLT_MIN ? square : FLT_MIN, d = sqrtf(d2);
    const float c = vplDot(n, way), cosine = (c > 0 ? c : 0) / d / d2;
    if (!e->spot) {
        return cosine;
    }
    float step = (-vplDot(e->direction, way) / d - e->cosOuter) * e->inverseRing;
    step = step > 0 ? (step < 1 ? step : 1) : 0;
    return cosine * (step * step * (3 - 2 * step));
}

// The emitters of one choice, of all lanes.
typedef struct Choice {
    vplVec3 way[VPL_LANES];
    float amount[VPL_LANES];
    vplRgb intensity[VPL_LANES];
} Choice;

static void choose(const vplReceiver* r, const vplDirectLight* direct, const double start[VPL_LANES], int k,
                   Choice* out)
{
    const vplSurface* s = r->points->surface;
    for (int l = 0; l < VPL_LANES; l++) {
        out->amount[l] = 0;
        out->way[l] = vplVec(0, 0, 0);
        out->intensity[l] = (vplRgb){0, 0, 0};
        if (r->points->triangle[l] < 0) {
            continue;
        }
        const vplVec3 p = vplVec(s->px[l], s->py[l], s->pz[l]), n = vplVec(s->nx[l], s->ny[l], s->nz[l]);
        const vplChosenSource c =
            vplEmitterTree_Choose(direct->tree, p, n, (k + start[l]) / direct->perPoint);
        if (c.source >= 0) {
            const int emitter = direct->emitterOf[c.source];
            const vplEmitterRay* e = &direct->rays[emitter];
            out->amount[l] = (float)((double)receive(e, p, n) / (direct->perPoint * c.probability));
            out->way[l] = vplSub(e->position, r->starts->hit[l].position);
            out->intensity[l] = direct->emitters[emitter].intensity;
        }
    }
}

void vplAddChosenEmitters(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                          float irradiance[3][VPL_LANES], int64_t* rays)
{
    vplRayStarts starts;
    const vplReceiver receiver = {shading, points, &starts, rays};
    double start[VPL_LANES];
    vplFindRayStarts(shading, points, &starts);
    for (int l = 0; l < VPL_LANES; l++) {
        const float at[3] = {points->surface->px[l], points->surface->py[l], points->surface->pz[l]};
        start[l] = 0x1p-53 * (double)(vplHashFloats(CHOICE_SEED, at, 3) >> 11);
    }
    for (int k = 0; k < direct->perPoint; k++) {
        Choice c;
        choose(&receiver, direct, start, k, &c);
        vplCastShadowRays(&receiver, c.way, false, c.amount);
        for (int l = 0; l < VPL_LANES; l++) {
            irradiance[0][l] += direct->weight * c.intensity[l].r * c.amount[l];
            irradiance[1][l] += direct->weight * c.intensity[l].g * c.amount[l];
            irradiance[2][l] += direct->weight * c.intensity[l].b * c.amount[l];
        }
    }
}
