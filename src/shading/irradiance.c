// SPDX-License-Identifier: MIT
// Light and visibility: the contributions that kernels compute, multiplied by what shadow maps or shadow rays
// let through.
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "shading/light_block.h"
#include "shading/shading.h"

#include <string.h>

_Static_assert((int)VPL_RAY_PACKET == VPL_LANES, "a block of pixels is a packet of rays");

// ---- the public kernel

void vplAccumulateLights(const vplContext* context, vplLightFormula formula, const vplSurface* surface,
                         const vplShadeLight* lights, int count, float irradiance[3][VPL_LANES])
{
    vplGetShadingKernels(context->isa, formula.lighting)
        ->addLights(surface, lights, count, vplInverseSquare(formula.minDistance), irradiance);
}

int vplPrepareLights(const vplLightSet* set, vplLighting lighting, vplShadeLight* out)
{
    if (set == NULL || out == NULL) {
        return 0;
    }
    int count = 0;
    for (int i = 0; i < set->lightCount; i++) {
        if (set->lights[i].object >= 0) {
            out[count++] = vplPrepareLight(&set->lights[i], set->particleCount, lighting);
        }
    }
    return count;
}

// ---- shadow rays

vplHit vplHitOfPoint(const vplGeometry* g, int triangle, vplVec3 position)
{
    return (vplHit){.object = g->owners[triangle],
                    .face = vplGeometry_FaceOf(g, triangle),
                    .triangle = triangle,
                    .position = vplGeometry_Inside(g, triangle, position),
                    .normal = g->normals[triangle]};
}

void vplFindRayStarts(const vplShading* shading, const vplPoints* points, vplRayStarts* starts)
{
    const vplSurface* s = points->surface;
    for (int l = 0; l < VPL_LANES; l++) {
        if (points->triangle[l] >= 0) {
            starts->hit[l] =
                vplHitOfPoint(shading->geometry, points->triangle[l], vplVec(s->px[l], s->py[l], s->pz[l]));
        }
    }
}

void vplCastShadowRays(const vplReceiver* r, const vplVec3 way[VPL_LANES], bool parallel,
                       float amount[VPL_LANES])
{
    const vplGeometry* g = r->shading->geometry;
    const vplSurface* plane = r->points->plane;
    vplRayPacket packet;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        if (!(amount[l] > 0) || r->points->triangle[l] < 0) {
            continue;
        }
        if (!(vplDot(way[l], vplVec(plane->nx[l], plane->ny[l], plane->nz[l])) > 0)) {
            amount[l] = 0;
            continue;
        }
        const vplRay ray = vplGeometry_Leave(g, &r->starts->hit[l], way[l]);
        vplRayPacket_Set(&packet, l, &ray);
    }
    *r->rays += vplGeometry_Darken(g, &packet, parallel ? INFINITY : 1, amount);
}

void vplCastEmitterRays(const vplReceiver* receiver, const vplEmitterRay* emitter, float amount[VPL_LANES])
{
    vplVec3 way[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const bool needed = amount[l] > 0 && receiver->points->triangle[l] >= 0;
        way[l] = emitter->parallel ? vplNegate(emitter->direction)
                 : needed          ? vplSub(emitter->position, receiver->starts->hit[l].position)
                                   : vplVec(0, 0, 0);
    }
    vplCastShadowRays(receiver, way, emitter->parallel, amount);
}

static void castLightRays(const vplReceiver* r, const vplShadeLight* light, float visible[VPL_LANES])
{
    vplVec3 way[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const bool needed = visible[l] > 0 && r->points->triangle[l] >= 0;
        way[l] = needed ? vplWayTo(light, r->starts->hit[l].position) : vplVec(0, 0, 0);
    }
    vplCastShadowRays(r, way, false, visible);
}

// ---- lights with shadows of their own

bool vplReceiveLight(const vplReceiver* r, const vplShadeLight* light, const vplHemiMap* map,
                     float inverseClamp, vplReceived* out)
{
    memset(out->open, 0, sizeof out->open);
    r->shading->kernels.addLights(r->points->surface, light, 1, inverseClamp, out->open);
    int lit = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        out->visible[l] = out->open[0][l] + out->open[1][l] + out->open[2][l] > 0 ? 1.0f : 0.0f;
        lit |= out->visible[l] > 0;
    }
    if (!lit) {
        return false;
    }
    if (r->starts != NULL) {
        castLightRays(r, light, out->visible);
    } else if (map != NULL) {
        float factor[VPL_LANES];
        vplHemiMap_FactorBlock(map, r->points->plane, factor);
        for (int l = 0; l < VPL_LANES; l++) {
            out->visible[l] *= 1 - factor[l];
        }
        if (r->shading->geometry->cutOuts != NULL) { // maps show what is solid
            vplVeilFromPoint(r->shading->geometry, r->points, map->position, out->visible);
        }
    }
    return true;
}

// Lights that each have a ray or a map; NULL maps: rays.
typedef struct ShadowedLights {
    const vplShadeLight* lights;
    const vplHemiMap* maps;
    int count;
    float inverseClamp;
} ShadowedLights;

static void addShadowed(const vplShading* s, const vplPoints* points, const ShadowedLights* from,
                        float irradiance[3][VPL_LANES], int64_t* rays)
{
    vplRayStarts starts;
    const vplReceiver receiver = {s, points, from->maps == NULL ? &starts : NULL, rays};
    if (from->maps == NULL) {
        vplFindRayStarts(s, points, &starts);
    }
    for (int i = 0; i < from->count; i++) {
        const vplHemiMap* map = from->maps != NULL ? &from->maps[i] : NULL;
        vplReceived received;
        if (!vplReceiveLight(&receiver, &from->lights[i], map, from->inverseClamp, &received)) {
            continue;
        }
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                irradiance[c][l] += received.visible[l] * received.open[c][l];
            }
        }
    }
}

void vplAddAreaLights(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                      float irradiance[3][VPL_LANES], int64_t* rays)
{
    if (direct->triangleTree != NULL) {
        vplAddChosenTriangles(shading, direct, points, irradiance, rays);
    }
    for (int first = 0; first < direct->areaLightCount; first += VPL_LIGHT_GROUP) {
        const int left = direct->areaLightCount - first;
        const ShadowedLights group = {direct->areaLights + first, NULL,
                                      left < VPL_LIGHT_GROUP ? left : VPL_LIGHT_GROUP,
                                      direct->areaLightInverseClamp};
        float part[3][VPL_LANES] = {{0}};
        addShadowed(shading, points, &group, part, rays);
        for (int c = 0; c < 3; c++) {
            for (int l = 0; l < VPL_LANES; l++) {
                irradiance[c][l] += part[c][l];
            }
        }
    }
}

void vplDirectIrradiance(const vplShading* shading, const vplDirectLight* direct, const vplPoints* points,
                         float irradiance[3][VPL_LANES], int64_t* rays)
{
    memset(irradiance, 0, 3 * sizeof irradiance[0]);
    shading->kernels.addEmitters(shading, direct, points, irradiance, rays);
    vplAddAreaLights(shading, direct, points, irradiance, rays);
}

void vplIndirectIrradiance(const vplShading* shading, const vplPoints* points, int first, int count,
                           float irradiance[3][VPL_LANES], int64_t* rays)
{
    const vplLightList* list = &shading->lights;
    const vplShadeLight* lights = list->lights + first;
    if (list->maps == NULL && !list->castsRays) {
        shading->kernels.addLights(points->surface, lights, count, list->inverseClamp, irradiance);
        return;
    }
    const ShadowedLights shadowed = {lights, list->maps ? list->maps + first : NULL, count,
                                     list->inverseClamp};
    addShadowed(shading, points, &shadowed, irradiance, rays);
}
