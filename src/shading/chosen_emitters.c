// SPDX-License-Identifier: MIT
// Light of some points and spots, and of some triangles that emit, that a tree chooses for each point, where there are too
// many to ask all.
// Based on: Alejandro Conty Estevez and Christopher Kulla, Importance Sampling of Many Lights with Adaptive Tree
// Splitting, HPG 2018. The random number of a point is here a hash of its position: no stage passes random numbers, and
// the same points have the same noise in every pipeline.
#include "base/hash.h"
#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "math/vec.h"
#include "shading/shading.h"

#include <float.h>
#include <math.h>

enum { CHOICE_SEED = 0x656d6974, ACROSS_SEED = 0x74726961 };

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

// One choice of all lanes.
typedef struct Choice {
    vplVec3 way[VPL_LANES];
    float amount[VPL_LANES]; // irradiance by a unit of the source's light, over the probability; 0: none
    vplRgb light[VPL_LANES]; // intensity or radiance
} Choice;

// Light of the chosen source at one lane; `across`, [0, 1), is a coordinate on a triangle beside the rest of the choice.
typedef void LightFcn(const vplReceiver* r, const vplDirectLight* direct, int lane, vplChosenSource chosen,
                      double across, Choice* out);

static void lightFromEmitter(const vplReceiver* r, const vplDirectLight* direct, int l, vplChosenSource c,
                             double across, Choice* out)
{
    (void)across;
    const vplSurface* s = r->points->surface;
    const vplVec3 p = vplSurface_At(s, l), n = vplVec(s->nx[l], s->ny[l], s->nz[l]);
    const int emitter = direct->trees->emission->sources[c.source].emitter;
    const vplEmitterRay* e = &direct->rays[emitter];
    out->amount[l] = (float)((double)receive(e, p, n) / (direct->perPoint * c.probability));
    out->way[l] = vplSub(e->position, r->starts->hit[l].position);
    out->light[l] = direct->emitters[emitter].intensity;
}

// Squared distances count as at least this share of the triangle's area: nearer, the point's density would blow the light up.
static const double LEAST_SQUARE = 0x1p-10;

// Samples a point on the triangle. The amount is the irradiance by a unit of radiance, over the density of the sample.
static void lightFromTriangle(const vplReceiver* r, const vplDirectLight* direct, int l, vplChosenSource c,
                              double across, Choice* out)
{
    const vplSurface* s = r->points->surface;
    const vplGeometry* g = r->shading->geometry;
    const vplVec3 p = vplSurface_At(s, l), n = vplVec(s->nx[l], s->ny[l], s->nz[l]);
    const int triangle = direct->trees->emission->sources[c.source].triangle;
    const vplHit on = vplGeometry_SampleTriangle(g, triangle, (float)c.rest * 0x1.fffffep-1f,
                                                 (float)across * 0x1.fffffep-1f);
    const vplVec3 way = vplSub(on.position, p);
    const double x = way.x, y = way.y, z = way.z, square = x * x + y * y + z * z;
    const double received = n.x * x + n.y * y + n.z * z,
                 sent = -(on.normal.x * x + on.normal.y * y + on.normal.z * z);
    if (received > 0 && sent > 0) {
        const double area = vplGeometry_TriangleArea(g, triangle), least = LEAST_SQUARE * area;
        const double falloff = 1 / (square > least ? square : least);
        out->amount[l] =
            (float)(received * sent / square * falloff * area / (direct->trianglesPerPoint * c.probability));
        out->way[l] = vplWayToLight(on.position, on.normal, r->starts->hit[l].position);
        out->light[l] = g->materials[g->triangleMaterials[triangle]].emission;
    }
}

// A number in [0, 1) for each lane.
static void hashPositions(const vplPoints* points, uint64_t seed, double out[VPL_LANES])
{
    const vplSurface* s = points->surface;
    for (int l = 0; l < VPL_LANES; l++) {
        out[l] = 0x1p-53 * (double)(vplHashPosition(seed, s->px[l], s->py[l], s->pz[l]) >> 11);
    }
}

typedef struct Choosing {
    const vplEmitterTree* tree;
    LightFcn* light;
    int count; // choices of a point
    float weight;
    bool needsAcross; // whether `light` samples a surface
} Choosing;

static void addChoices(const vplReceiver* r, const vplDirectLight* direct, const Choosing* choosing,
                       float irradiance[3][VPL_LANES])
{
    static const double GOLDEN = 0.61803398874989485;
    double start[VPL_LANES], across[VPL_LANES] = {0};
    hashPositions(r->points, CHOICE_SEED, start);
    if (choosing->needsAcross) {
        hashPositions(r->points, ACROSS_SEED, across);
    }
    for (int k = 0; k < choosing->count; k++) {
        Choice c = {.amount = {0}};
        double numbers[VPL_LANES];
        vplChosenSource chosen[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            numbers[l] = (k + start[l]) / choosing->count;
        }
        r->shading->kernels.chooseSources(choosing->tree, r->points, numbers, chosen);
        for (int l = 0; l < VPL_LANES; l++) {
            const double along = across[l] + k * GOLDEN;
            if (chosen[l].source >= 0) {
                choosing->light(r, direct, l, chosen[l], along - floor(along), &c);
            }
        }
        vplCastShadowRays(r, c.way, false, c.amount);
        for (int l = 0; l < VPL_LANES; l++) {
            irradiance[0][l] += choosing->weight * c.light[l].r * c.amount[l];
            irradiance[1][l] += choosing->weight * c.light[l].g * c.amount[l];
            irradiance[2][l] += choosing->weight * c.light[l].b * c.amount[l];
        }
    }
}

void vplAddChosenEmitters(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                          float irradiance[3][VPL_LANES], int64_t* rays)
{
    vplRayStarts starts;
    vplFindRayStarts(shading, points, &starts);
    addChoices(&(vplReceiver){shading, points, &starts, rays}, direct,
               &(Choosing){direct->tree, lightFromEmitter, direct->perPoint, direct->weight, false},
               irradiance);
}

void vplAddChosenTriangles(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                           float irradiance[3][VPL_LANES], int64_t* rays)
{
    vplRayStarts starts;
    vplFindRayStarts(shading, points, &starts);
    addChoices(&(vplReceiver){shading, points, &starts, rays}, direct,
               &(Choosing){direct->triangleTree, lightFromTriangle, direct->trianglesPerPoint, 1, true},
               irradiance);
}
