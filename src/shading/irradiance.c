// SPDX-License-Identifier: MIT
// Light and what stops it: emitters and virtual lights with shadow maps or shadow rays. The arithmetic of light
// is the kernels'; here it is only multiplied by visibility.
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/vec.h"
#include "shading/shading.h"
#include "visibility/hemi_map.h"

#include <string.h>

vplHit vplStartOf(const vplGeometry* g, int triangle, vplVec3 seen)
{
    return (vplHit){.object = g->owners[triangle],
                    .face = vplGeometry_FaceOf(g, triangle),
                    .triangle = triangle,
                    .position = vplGeometry_Inside(g, triangle, seen),
                    .normal = g->normals[triangle]};
}

void vplFindRayStarts(const vplShading* shading, const vplPoints* points, vplRayStarts* starts)
{
    const vplGeometry* g = shading->geometry;
    const vplSurface* s = points->surface;
    for (int l = 0; l < VPL_LANES; l++) {
        if (points->triangle[l] >= 0) {
            starts->hit[l] = vplStartOf(g, points->triangle[l], vplVec(s->px[l], s->py[l], s->pz[l]));
        }
    }
}

_Static_assert((int)VPL_RAY_PACKET == VPL_LANES, "a block of pixels is a packet of rays");

// Sets amount to 0 where something is on the way from the point, of no more than 1 (parallel: any) time its length, and
// where that leads behind the triangle. Lanes of amount 0 cast no ray.
static void castShadowRays(const vplShading* shading, const vplPoints* points, const vplRayStarts* starts,
                           const vplVec3 way[VPL_LANES], bool parallel, float amount[VPL_LANES],
                           int64_t* rays)
{
    const vplGeometry* g = shading->geometry;
    const vplSurface* plane = points->plane;
    vplRayPacket packet;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        if (!(amount[l] > 0) || points->triangle[l] < 0) {
            continue;
        }
        if (!(vplDot(way[l], vplVec(plane->nx[l], plane->ny[l], plane->nz[l])) > 0)) {
            amount[l] = 0;
            continue;
        }
        const vplRay ray = vplGeometry_Leave(g, &starts->hit[l], way[l]);
        vplRayPacket_Set(&packet, l, &ray);
    }
    *rays += vplGeometry_Darken(g, &packet, parallel ? INFINITY : 1, amount);
}

void vplCastEmitterRays(const vplShading* shading, const vplPoints* points, const vplEmitterRay* emitter,
                        float amount[VPL_LANES], int64_t* rays)
{
    vplRayStarts starts;
    vplFindRayStarts(shading, points, &starts);
    vplVec3 way[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const bool asks = amount[l] > 0 && points->triangle[l] >= 0;
        way[l] = emitter->parallel ? vplNegate(emitter->direction)
                 : asks            ? vplSub(emitter->position, starts.hit[l].position)
                                   : vplVec(0, 0, 0);
    }
    castShadowRays(shading, points, &starts, way, emitter->parallel, amount, rays);
}

static void castLightRays(const vplShading* shading, const vplPoints* points, const vplRayStarts* starts,
                          const vplShadeLight* light, float visible[VPL_LANES], int64_t* rays)
{
    const vplVec3 place = {light->px, light->py, light->pz}, normal = {light->nx, light->ny, light->nz};
    vplVec3 way[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const bool asks = visible[l] > 0 && points->triangle[l] >= 0;
        way[l] = asks ? vplWayToLight(place, normal, starts->hit[l].position) : vplVec(0, 0, 0);
    }
    castShadowRays(shading, points, starts, way, false, visible, rays);
}

bool vplLightVisibly(const vplShading* s, const vplPoints* points, const vplRayStarts* starts,
                     const vplHemiMap* map, const vplShadeLight* light, float inverseBound,
                     float part[3][VPL_LANES], float visible[VPL_LANES], int64_t* rays)
{
    memset(part, 0, 3 * sizeof part[0]);
    s->lightKernel(points->surface, light, 1, inverseBound, part);
    int lit = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        visible[l] = part[0][l] + part[1][l] + part[2][l] > 0 ? 1.0f : 0.0f;
        lit |= visible[l] > 0;
    }
    if (!lit) {
        return false;
    }
    if (starts != NULL) {
        castLightRays(s, points, starts, light, visible, rays);
    } else if (map != NULL) {
        float factor[VPL_LANES];
        vplHemiMap_FactorBlock(map, points->plane, factor);
        for (int l = 0; l < VPL_LANES; l++) {
            visible[l] *= 1 - factor[l];
        }
    }
    return true;
}

// Adds one light after another, each with a ray or a map of its own.
static void addShadowed(const vplShading* s, const vplPoints* points, const vplShadeLight* lights,
                        const vplHemiMap* maps, int count, float inverseBound, float irradiance[3][VPL_LANES],
                        int64_t* rays)
{
    vplRayStarts starts;
    if (maps == NULL) {
        vplFindRayStarts(s, points, &starts);
    }
    for (int i = 0; i < count; i++) {
        float part[3][VPL_LANES], visible[VPL_LANES];
        if (!vplLightVisibly(s, points, maps ? NULL : &starts, maps ? &maps[i] : NULL, &lights[i],
                             inverseBound, part, visible, rays)) {
            continue;
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
    for (int first = 0; first < def->areaLightCount; first += VPL_LIGHT_GROUP) {
        const int count = def->areaLightCount - first < VPL_LIGHT_GROUP ? def->areaLightCount - first : VPL_LIGHT_GROUP;
        float part[3][VPL_LANES] = {{0}};
        addShadowed(shading, points, def->areaLights + first, NULL, count, shading->areaLightInverseBound, part, rays);
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
