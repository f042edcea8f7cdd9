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

enum { CHOICE_SEED = 0x656d6974, TRIANGLE_SEED = 0x74726961 };

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
            const int emitter = direct->trees->emission->sources[c.source].emitter;
            const vplEmitterRay* e = &direct->rays[emitter];
            out->amount[l] = (float)((double)receive(e, p, n) / (direct->perPoint * c.probability));
            out->way[l] = vplSub(e->position, r->starts->hit[l].position);
            out->intensity[l] = direct->emitters[emitter].intensity;
        }
    }
}

// A number in [0, 1) for each lane.
static void hashPositions(const vplPoints* points, uint64_t seed, double out[VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        const float at[3] = {points->surface->px[l], points->surface->py[l], points->surface->pz[l]};
        out[l] = 0x1p-53 * (double)(vplHashFloats(seed, at, 3) >> 11);
    }
}

void vplAddChosenEmitters(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                          float irradiance[3][VPL_LANES], int64_t* rays)
{
    vplRayStarts starts;
    const vplReceiver receiver = {shading, points, &starts, rays};
    double start[VPL_LANES];
    vplFindRayStarts(shading, points, &starts);
    hashPositions(points, CHOICE_SEED, start);
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

// ---- triangles

// Nearer than this share of the square root of its area, a triangle is as an endless plane, and its light is clamped.
static const double LEAST_SQUARE = 0x1p-10;

// A choice of a lane: a point on a triangle, and the irradiance by a unit of radiance over the density of the point.
static void chooseTriangle(const vplReceiver* r, const vplDirectLight* direct, int l, double choice,
                           double across, Choice* out)
{
    const vplSurface* s = r->points->surface;
    const vplGeometry* g = r->shading->geometry;
    const vplVec3 p = vplSurface_At(s, l), n = vplVec(s->nx[l], s->ny[l], s->nz[l]);
    const vplChosenSource c = vplEmitterTree_Choose(direct->triangleTree, p, n, choice);
    if (c.source < 0) {
        return;
    }
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
        out->intensity[l] = g->materials[g->triangleMaterials[triangle]].emission;
    }
}

void vplAddChosenTriangles(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                           float irradiance[3][VPL_LANES], int64_t* rays)
{
    static const double GOLDEN = 0.61803398874989485;
    vplRayStarts starts;
    const vplReceiver receiver = {shading, points, &starts, rays};
    double start[VPL_LANES], across[VPL_LANES];
    vplFindRayStarts(shading, points, &starts);
    hashPositions(points, CHOICE_SEED, start);
    hashPositions(points, TRIANGLE_SEED, across);
    for (int k = 0; k < direct->trianglesPerPoint; k++) {
        Choice c = {.amount = {0}};
        for (int l = 0; l < VPL_LANES; l++) {
            if (points->triangle[l] >= 0) {
                const double along = across[l] + k * GOLDEN;
                chooseTriangle(&receiver, direct, l, (k + start[l]) / direct->trianglesPerPoint,
                               along - floor(along), &c);
            }
        }
        vplCastShadowRays(&receiver, c.way, false, c.amount);
        for (int l = 0; l < VPL_LANES; l++) {
            irradiance[0][l] += c.intensity[l].r * c.amount[l];
            irradiance[1][l] += c.intensity[l].g * c.amount[l];
            irradiance[2][l] += c.intensity[l].b * c.amount[l];
        }
    }
}
