// SPDX-License-Identifier: MIT
// The light of some randomly drawn virtual lights at a point that a ray has hit: sixteen lights at once.
#include "base/rng.h"
#include "geometry/bvh.h"
#include "geometry/paint.h"
#include "shading/compensation.h"

enum { DRAW_STREAM = 0x636f6d70 }; // of random numbers

void vplLitPoint_Face(vplLitPoint* p, const vplGeometry* g, vplVec3 direction)
{
    const bool behind = vplDot(direction, p->hit.normal) > 0;
    const vplVec3 shading = vplGeometry_ShadingNormal(g, &p->hit);
    p->plane = behind ? vplNegate(p->hit.normal) : p->hit.normal;
    p->shading = behind ? vplNegate(shading) : shading;
}

vplRgb vplLitPoint_Reflectance(const vplLitPoint* p, const vplGeometry* g)
{
    const vplFootprint footprint = vplUpright(g, p->hit.triangle, VPL_BOUNCE_SPREAD * p->hit.t);
    return vplGeometry_Reflectance(g, p->hit.triangle, p->hit.position, &footprint);
}

// Draws one light from each of `drawn` equal parts of the list. Equal steps through the list would follow the
// low-discrepancy order in which particles were shot: every 64th Halton point lies in the same sixty-fourth
// of its first dimension.
static void drawLights(const vplLightDraw* draw, const vplLitPoint* p, uint64_t seed, int first, int count,
                       int indices[VPL_LANES])
{
    for (int l = 0; l < count; l += 4) {
        const uint32_t counter[4] = {p->pixel, p->ray, p->bounce << 16 | (uint32_t)(first + l), DRAW_STREAM};
        const vplRandom4 r = vplPhilox(counter, (uint32_t)seed, (uint32_t)(seed >> 32));
        for (int i = l; i < l + 4 && i < count; i++) {
            const double place = first + i + (double)vplUnitFloat(r.v[i - l]);
            indices[i] = draw->count <= draw->drawn ? first + i : (int)(place * draw->count / draw->drawn);
        }
    }
}

// Lanes behind the last repeat the first.
static void loadLights(const vplShadeLight* lights, const int indices[VPL_LANES], int count,
                       vplLightLanes* lanes)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const vplShadeLight* light = &lights[indices[l < count ? l : 0]];
        for (int k = 0; k < 6; k++) {
            lanes->at[k][l] = vplShadeLight_Column(light, k);
        }
    }
}

// Sets amount to 0 where something is between.
static void castRays(const vplGeometry* g, const vplLitPoint* p, const vplShadeLight* lights,
                     const int indices[VPL_LANES], float amount[VPL_LANES], int64_t* rays)
{
    vplRayPacket packet;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        if (!(amount[l] > 0)) {
            continue;
        }
        const vplVec3 way = vplWayTo(&lights[indices[l]], p->hit.position);
        if (!(vplDot(way, p->plane) > 0)) {
            amount[l] = 0;
            continue;
        }
        const vplRay ray = vplGeometry_Leave(g, &p->hit, way);
        vplRayPacket_Set(&packet, l, &ray);
    }
    *rays += vplGeometry_Darken(g, &packet, 1, amount);
}

// Unshadowed contributions of the first `count` of `indices`, per unit of intensity; 0 in other lanes.
static void evaluate(const vplShading* s, const vplLightDraw* draw, const vplLitPoint* point,
                     const int indices[VPL_LANES], int count, float amount[VPL_LANES])
{
    const vplVec3 p = point->hit.position, n = point->shading;
    const float at[6] = {p.x, p.y, p.z, n.x, n.y, n.z};
    float clamps[VPL_LANES];
    vplLightLanes lanes;
    loadLights(draw->lights, indices, count, &lanes);
    for (int l = 0; l < VPL_LANES; l++) {
        clamps[l] = l < count && indices[l] < draw->areaLightCount ? s->compensation->areaLightInverseClamp
                                                                   : s->lights.inverseClamp;
    }
    s->kernels.lightPoint(&lanes, at, clamps, draw->subtracted, amount);
    for (int l = count; l < VPL_LANES; l++) {
        amount[l] = 0;
    }
}

void vplReceiveDrawnLights(const vplShading* shading, const vplLightDraw* draw, const vplLitPoint* point,
                           float irradiance[3], int64_t* rays)
{
    const vplCompensationDef* def = shading->compensation->def;
    const int total = draw->count < draw->drawn ? draw->count : draw->drawn;
    double sums[3] = {0, 0, 0};
    for (int first = 0; first < total; first += VPL_LANES) {
        const int count = total - first < VPL_LANES ? total - first : VPL_LANES;
        int indices[VPL_LANES];
        float amount[VPL_LANES];
        drawLights(draw, point, def->seed, first, count, indices);
        evaluate(shading, draw, point, indices, count, amount);
        if (def->lightRays) {
            castRays(shading->geometry, point, draw->lights, indices, amount, rays);
        }
        for (int l = 0; l < count; l++) {
            const vplShadeLight* light = &draw->lights[indices[l]];
            sums[0] += (double)(light->r * amount[l]);
            sums[1] += (double)(light->g * amount[l]);
            sums[2] += (double)(light->b * amount[l]);
        }
    }
    for (int c = 0; c < 3; c++) {
        irradiance[c] = total > 0 ? (float)(sums[c] * draw->count / total) : 0;
    }
}
