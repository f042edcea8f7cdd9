// SPDX-License-Identifier: MIT
// Light and what stops it: emitters and virtual lights with shadow maps or shadow rays. The arithmetic of light
// is the kernels'; here it is only multiplied by visibility.
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/vec.h"
#include "shading/shading.h"

#include <string.h>

// Where rays leave a block, the same for all its lights.
typedef struct Starts {
    vplHit hit[VPL_LANES]; // of lanes that show a triangle
} Starts;

vplHit vplStartOf(const vplGeometry* g, int triangle, vplVec3 seen)
{
    return (vplHit){.object = g->owners[triangle],
                    .face = vplGeometry_FaceOf(g, triangle),
                    .triangle = triangle,
                    .position = vplGeometry_Inside(g, triangle, seen),
                    .normal = g->normals[triangle]};
}

static void findStarts(const vplGeometry* g, const vplPoints* points, Starts* starts)
{
    const vplSurface* s = points->surface;
    for (int l = 0; l < VPL_LANES; l++) {
        if (points->triangle[l] >= 0) {
            starts->hit[l] = vplStartOf(g, points->triangle[l], vplVec(s->px[l], s->py[l], s->pz[l]));
        }
    }
}

_Static_assert((int)VPL_RAY_PACKET == VPL_LANES, "a block of pixels is a packet of rays");

// Sets amount to 0 where something is between the point and `target` (parallel: in the direction -target), and
// where that is behind the triangle. Lanes of amount 0 cast no ray.
static void castShadowRays(const vplShading* shading, const vplPoints* points, const Starts* starts,
                           vplVec3 target, bool parallel, float amount[VPL_LANES], int64_t* rays)
{
    const vplGeometry* g = shading->geometry;
    const vplSurface* plane = points->plane;
    vplRayPacket packet;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        if (!(amount[l] > 0) || points->triangle[l] < 0) {
            continue;
        }
        const vplHit* hit = &starts->hit[l];
        const vplVec3 way = parallel ? vplNegate(target) : vplSub(target, hit->position);
        if (!(vplDot(way, vplVec(plane->nx[l], plane->ny[l], plane->nz[l])) > 0)) {
            amount[l] = 0;
            continue;
        }
        const vplRay ray = vplGeometry_Leave(g, hit, way);
        vplRayPacket_Set(&packet, l, &ray);
    }
    *rays += __builtin_popcount(packet.active);
    for (uint32_t dark = vplGeometry_AreOccluded(g, &packet, parallel ? INFINITY : 1); dark != 0;
         dark &= dark - 1) {
        amount[__builtin_ctz(dark)] = 0;
    }
}

void vplCastEmitterRays(const vplShading* shading, const vplPoints* points, const vplEmitterRay* emitter,
                        float amount[VPL_LANES], int64_t* rays)
{
    Starts starts;
    findStarts(shading->geometry, points, &starts);
    castShadowRays(shading, points, &starts, emitter->parallel ? emitter->direction : emitter->position,
                   emitter->parallel, amount, rays);
}

vplVec3 vplAimAt(const vplShadeLight* light)
{
    const float x = light->px, y = light->py, z = light->pz;
    float largest = fmaxf(fabsf(x), fmaxf(fabsf(y), fabsf(z))) * 0x1p-18f;
    return vplVec(x + largest * light->nx, y + largest * light->ny, z + largest * light->nz);
}

// What is left of the lanes of `visible` by a light's map. A map lets light through what it meets first, also
// from behind: where normals are interpolated the triangle itself says on which side the light is.
static void shadowByMap(const vplShading* s, const vplPoints* points, const vplShadeLight* light,
                        const vplShadow* map, float visible[VPL_LANES])
{
    const vplSurface* p = points->plane;
    float factor[VPL_LANES];
    vplShadow_FactorBlock(map, p, factor);
    for (int l = 0; l < VPL_LANES; l++) {
        const vplVec3 way = vplVec(light->px - p->px[l], light->py - p->py[l], light->pz - p->pz[l]);
        const bool behind = s->smooth && !(vplDot(way, vplVec(p->nx[l], p->ny[l], p->nz[l])) > 0);
        visible[l] *= behind ? 0 : 1 - factor[l];
    }
}

// Adds one light after another, each with a ray or a map of its own.
static void addShadowed(const vplShading* s, const vplPoints* points, const vplShadeLight* lights,
                        const vplShadow* maps, int count, float inverseBound, float irradiance[3][VPL_LANES],
                        int64_t* rays)
{
    Starts starts;
    if (maps == NULL) {
        findStarts(s->geometry, points, &starts);
    }
    for (int i = 0; i < count; i++) {
        float part[3][VPL_LANES] = {{0}}, visible[VPL_LANES];
        s->lightKernel(points->surface, &lights[i], 1, inverseBound, part);
        int lit = 0;
        for (int l = 0; l < VPL_LANES; l++) {
            visible[l] = part[0][l] + part[1][l] + part[2][l] > 0 ? 1.0f : 0.0f;
            lit |= visible[l] > 0;
        }
        if (!lit) {
            continue;
        }
        if (maps == NULL) {
            castShadowRays(s, points, &starts, vplAimAt(&lights[i]), false, visible, rays);
        } else {
            shadowByMap(s, points, &lights[i], &maps[i], visible);
        }
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                irradiance[c][l] += visible[l] * part[c][l];
            }
        }
    }
}

void vplDirectIrradiance(const vplShading* shading, const vplPoints* points, float irradiance[3][VPL_LANES],
                         int64_t* rays)
{
    const vplShadeDef* def = shading->def;
    memset(irradiance, 0, 3 * sizeof irradiance[0]);
    shading->addEmitters(shading, points, irradiance, rays);
    for (int first = 0; first < def->lampCount; first += VPL_LIGHT_GROUP) {
        const int count = def->lampCount - first < VPL_LIGHT_GROUP ? def->lampCount - first : VPL_LIGHT_GROUP;
        float part[3][VPL_LANES] = {{0}};
        addShadowed(shading, points, def->lamps + first, NULL, count, shading->lampInverseBound, part, rays);
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                irradiance[c][l] += part[c][l];
            }
        }
    }
}

void vplIndirectIrradiance(const vplShading* shading, const vplPoints* points, int first, int count,
                           float irradiance[3][VPL_LANES], int64_t* rays)
{
    const vplShadeDef* def = shading->def;
    const vplShadeLight* lights = def->lights + first;
    if (def->lightShadows == NULL && !def->lightRays) {
        shading->lightKernel(points->surface, lights, count, shading->inverseBound, irradiance);
    } else {
        addShadowed(shading, points, lights, def->lightShadows ? def->lightShadows + first : NULL, count,
                    shading->inverseBound, irradiance, rays);
    }
}
