// SPDX-License-Identifier: MIT
// Conditions under which shadow maps and rays must agree on shadows of virtual lights. A benchmark and a test
// share them.
#ifndef VPL_BAND_H
#define VPL_BAND_H

#include "math/scalar.h"
#include "visibility/blocks.h"
#include "visibility/hemi_map.h"
#include "visibility/paraboloid_map.h"

#include <vpl/lights.h>

// 2.5 f + b, metres: the largest distance between blocker and point at which map and ray may disagree. r is
// the point's distance, f its footprint, cosT the cosine of its plane to the light.
static inline float bandAt(float r, float f, float cosT)
{
    const float sinT = sqrtf(1 - cosT * cosT);
    const float cosA = r / sqrtf(r * r + f * f), sinA = f / r * cosA;
    const float turned = sinT * cosA <= cosT * sinA ? 1 : cosT * cosA + sinT * sinA;
    return 2.5f * f + r * (1 - cosT / turned) + r * 0x1p-16f;
}

// The band of vplHemiMap_FactorBlock, metres, and the footprint f.
static inline float hemiMapBand(const vplHemiMap* map, vplVec3 point, vplVec3 normal, float* footprintOut)
{
    const vplVec3 way = vplSub(point, map->position);
    const float x = fabsf(vplDot(way, map->right)), y = fabsf(vplDot(way, map->up));
    const float r = fmaxf(vplLength(way), 1e-30f),
                f = 1.41421356f * (x + y + fabsf(vplDot(way, map->forward))) / (float)map->size;
    *footprintOut = f;
    return bandAt(r, f, fminf(fabsf(vplDot(way, normal)) / r, 1));
}

// The band of vplParaboloidMap_FactorBlock, 2.5 f + b, metres, and the footprint f, a texel's diagonal: the
// four centres around a point are no further from it.
static inline float paraboloidMapBand(const vplParaboloidMap* map, vplVec3 point, vplVec3 normal,
                                      float* footprintOut)
{
    const vplVec3 way = vplSub(point, map->position);
    const float r = fmaxf(vplLength(way), 1e-30f);
    const float f = 1.41421356f * 2 * (r + fabsf(vplDot(way, map->forward))) / (float)map->size;
    *footprintOut = f;
    return bandAt(r, f, fminf(fabsf(vplDot(way, normal)) / r, 1));
}

// Returns whether the shadow ray that shading casts finds the light hidden.
static inline bool isDark(const vplGeometry* g, const vplHit* hit, const vplShadeLight* l)
{
    const vplVec3 way =
        vplWayToLight(vplVec(l->px, l->py, l->pz), vplVec(l->nx, l->ny, l->nz), hit->position);
    const vplRay ray = vplGeometry_Leave(g, hit, way);
    return vplGeometry_IsOccluded(g, &ray, 1);
}

static inline bool isDarkBetween(const vplGeometry* g, vplVec3 eye, vplVec3 to)
{
    const vplRay ray = {eye, vplSub(to, eye), {0, 0}};
    return vplGeometry_IsOccluded(g, &ray, 1);
}

// Returns whether all rays around the one from the eye to the point agree with it (`dark`): rays to the
// point's plane within the footprint, and rays that end nearer to the eye by the band.
static inline bool isSureWithin(const vplGeometry* g, vplVec3 eye, vplVec3 point, vplVec3 normal,
                                float footprint, float band, bool dark)
{
    enum { RIM = 8, RINGS = 2 };
    const vplVec3 way = vplSub(point, eye);
    const float distance = vplLength(way);
    bool same = band < distance;
    vplVec3 t, u;
    vplTangentFrame(vplScale(1 / distance, way), &t, &u);
    for (int i = 0; i < RIM * RINGS && same; i++) {
        const double angle = (i % RIM + 0.5 * (double)(i / RIM)) * (2 * VPL_PI / RIM);
        const float size = footprint * (float)(i / RIM + 1) / RINGS;
        const vplVec3 side =
            vplAdd(vplScale(size * (float)cos(angle), t), vplScale(size * (float)sin(angle), u));
        const vplVec3 rim = vplAdd(way, side);
        const float plane = vplDot(way, normal) / vplDot(rim, normal);
        const float reach = plane > 0 && plane < 1 ? plane : 1;
        const vplVec3 far = vplScale(reach * (1 - 0x1p-14f), rim), near = vplScale(1 - band / distance, rim);
        same = isDarkBetween(g, eye, vplAdd(eye, far)) == dark &&
               isDarkBetween(g, eye, vplAdd(eye, near)) == dark;
    }
    return same;
}

static inline bool isSure(const vplGeometry* g, const vplHemiMap* map, vplVec3 point, vplVec3 normal,
                          bool dark)
{
    float footprint;
    const float band = hemiMapBand(map, point, normal, &footprint);
    return isSureWithin(g, map->position, point, normal, footprint, band, dark);
}

static inline bool isSureParaboloid(const vplGeometry* g, const vplParaboloidMap* map, vplVec3 point,
                                    vplVec3 normal, bool dark)
{
    float footprint;
    const float band = paraboloidMapBand(map, point, normal, &footprint);
    return isSureWithin(g, map->position, point, normal, footprint, band, dark);
}

#endif
