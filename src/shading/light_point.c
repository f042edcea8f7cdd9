// SPDX-License-Identifier: MIT
// The light of some virtual lights, chosen by chance, at a point that a ray has met: sixteen lights at once.
#include "base/rng.h"
#include "geometry/bvh.h"
#include "math/vec.h"
#include "shading/compensation.h"
#include "visibility/hemi_map.h"

#include <math.h>

enum { CHOICE_STREAM = 0x636f6d70 };

// One from each of `chosen` equal parts. Equal steps through the list would follow the low-discrepancy order that
// particles were shot in: every 64th of Halton's points lies in the same sixty-fourth of its first dimension.
static void chooseLights(const vplNearLight* near, const vplLightChoice* from, const vplLitPoint* p,
                         int first, int count, int indices[VPL_LANES])
{
    const uint64_t seed = near->def->seed;
    for (int l = 0; l < count; l += 4) {
        const uint32_t counter[4] = {p->pixel, p->ray, p->bounce << 16 | (uint32_t)(first + l),
                                     CHOICE_STREAM};
        const vplRandom4 r = vplPhilox(counter, (uint32_t)seed, (uint32_t)(seed >> 32));
        for (int i = l; i < l + 4 && i < count; i++) {
            const double place = first + i + (double)vplUnitFloat(r.v[i - l]);
            indices[i] = from->count <= from->chosen ? first + i : (int)(place * from->count / from->chosen);
        }
    }
}

static void loadLights(const vplShadeLight* lights, const int indices[VPL_LANES], int count,
                       vplLightLanes* lanes)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const vplShadeLight* light = &lights[indices[l < count ? l : 0]];
        const float values[6] = {light->px, light->py, light->pz, light->nx, light->ny, light->nz};
        for (int k = 0; k < 6; k++) {
            lanes->at[k][l] = values[k];
        }
    }
}

static vplVec3 wayTo(const vplShadeLight* light, vplVec3 from)
{
    return vplWayToLight(vplVec(light->px, light->py, light->pz), vplVec(light->nx, light->ny, light->nz),
                         from);
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
        const vplVec3 way = wayTo(&lights[indices[l]], p->hit.position);
        if (!(vplDot(way, p->plane) > 0)) {
            amount[l] = 0;
            continue;
        }
        const vplRay ray = vplGeometry_Leave(g, &p->hit, way);
        vplRayPacket_Set(&packet, l, &ray);
    }
    *rays += vplGeometry_Darken(g, &packet, 1, amount);
}

void vplLightPoint(const vplShading* shading, const vplNearLight* near, const vplLightChoice* from,
                   const vplLitPoint* point, float irradiance[3], int64_t* rays)
{
    const int total = from->count < from->chosen ? from->count : from->chosen;
    const vplVec3 p = point->hit.position, n = point->shading;
    const float at[6] = {p.x, p.y, p.z, n.x, n.y, n.z};
    double sums[3] = {0, 0, 0};
    for (int first = 0; first < total; first += VPL_LANES) {
        const int count = total - first < VPL_LANES ? total - first : VPL_LANES;
        int indices[VPL_LANES];
        vplLightLanes lanes;
        float amount[VPL_LANES], bounds[VPL_LANES];
        chooseLights(near, from, point, first, count, indices);
        loadLights(from->lights, indices, count, &lanes);
        for (int l = 0; l < VPL_LANES; l++) {
            bounds[l] =
                l < count && indices[l] < from->areaLightCount ? near->areaLightInverseBound : shading->inverseBound;
        }
        near->kernel(&lanes, at, bounds, from->taken, amount);
        for (int l = count; l < VPL_LANES; l++) {
            amount[l] = 0;
        }
        if (near->def->lightRays) {
            castRays(shading->geometry, point, from->lights, indices, amount, rays);
        }
        for (int l = 0; l < count; l++) {
            const vplShadeLight* light = &from->lights[indices[l]];
            sums[0] += (double)(light->r * amount[l]);
            sums[1] += (double)(light->g * amount[l]);
            sums[2] += (double)(light->b * amount[l]);
        }
    }
    for (int c = 0; c < 3; c++) {
        irradiance[c] = total > 0 ? (float)(sums[c] * from->count / total) : 0;
    }
}
