// SPDX-License-Identifier: MIT
// Cut-outs in pictures: seen through pixels, and on the way of light. Depth buffers and maps hold what is solid.
#include "geometry/cut_outs.h"

#include "geometry/triangle.h"
#include "lights/light_set.h"
#include "shading/edges.h"

#include <float.h>

// ---- on the way of light

static void veil(const vplGeometry* g, const vplPoints* points, const vplVec3 way[VPL_LANES], float tMax,
                 float amount[VPL_LANES])
{
    vplRayPacket packet;
    packet.active = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        if (amount[l] > 0 && points->triangle[l] >= 0) {
            const vplHit hit = vplHitOfPoint(g, points->triangle[l], vplSurface_At(points->plane, l));
            const vplRay ray = vplGeometry_Leave(g, &hit, way[l]);
            vplRayPacket_Set(&packet, l, &ray);
        }
    }
    vplCutOuts_Veil(g, &packet, tMax, amount);
}

void vplVeilFromPoint(const vplGeometry* g, const vplPoints* points, vplVec3 from, float amount[VPL_LANES])
{
    vplVec3 way[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        way[l] = vplSub(from, vplSurface_At(points->plane, l));
    }
    veil(g, points, way, 1, amount);
}

void vplVeilFromEmitter(const vplGeometry* g, const vplPoints* points, const vplEmitterRay* emitter,
                        float amount[VPL_LANES])
{
    vplVec3 way[VPL_LANES];
    if (!emitter->parallel) {
        vplVeilFromPoint(g, points, emitter->position, amount);
        return;
    }
    for (int l = 0; l < VPL_LANES; l++) {
        way[l] = vplNegate(emitter->direction);
    }
    veil(g, points, way, FLT_MAX, amount);
}

// ---- in pixels

// The distance along the view axis of a solid triangle in a line of sight; that of the far plane for none.
static float solidDistance(const vplShading* s, int triangle, vplVec3 sight)
{
    const vplGeometry* g = s->geometry;
    if (triangle < 0) {
        return (float)s->view->farPlane;
    }
    const vplVec3 n = g->normals[triangle];
    const vplVec3 corner = vplGeometry_Corners(g, triangle).corner[0];
    return vplDistanceOf(g, s->view, triangle, n, vplDot(n, vplSub(corner, s->view->eye)), sight);
}

// A pixel of the picture, and how many of its points show something: samples and the centre.
typedef struct Pixel {
    int x, y, points;
} Pixel;

// The cut-out that is seen before the triangle in a point of a pixel.
static bool findSeen(const vplShading* s, int triangle, const Pixel* p, int rank, vplSubPixel at, vplHit* hit)
{
    const vplView* v = s->view;
    const vplVec3 sight = vplSightOf(v, p->x, p->y, at);
    const float near = (float)v->nearPlane, offset[2] = {(float)v->offsetX, (float)v->offsetY};
    vplPixelRay ray = {.ray = {vplAdd(v->eye, vplScale(near, sight)), sight, {0, 0}},
                       .rank = (float)rank / (float)p->points};
    memcpy(ray.pixel, offset, sizeof ray.pixel); // pictures that are averaged have different offsets
    ray.pixel[0] ^= (uint32_t)p->y << 16 | (uint32_t)p->x;
    return vplCutOuts_FindSeen(s->geometry, &ray, solidDistance(s, triangle, sight) - near, hit);
}

static void putHit(const vplShading* s, const vplHit* hit, const vplTile* tile, int element)
{
    const int32_t id = hit->triangle + 1;
    memcpy(&tile->planes[VPL_PLANE_TRIANGLE][element], &id, sizeof id);
    const vplVec3 p = hit->position, n = vplGeometry_ShadingNormal(s->geometry, hit);
    const float at[3] = {p.x, p.y, p.z}, normal[3] = {n.x, n.y, n.z};
    for (int k = 0; k < 3; k++) {
        tile->planes[VPL_PLANE_POSITION + k][element] = at[k];
        if (s->smooth) {
            tile->planes[VPL_PLANE_NORMAL + k][element] = normal[k];
        }
    }
}

void vplShowCutOuts(void* data, vplTile* tile, int worker)
{
    (void)worker;
    const vplShading* s = data;
    for (int y = 0; y < tile->height; y++) {
        for (int x = 0; x < tile->width; x++) {
            const int element = vplElementOf(x, y);
            const Pixel p = {tile->x + x, tile->y + y, tile->sampleCount + 1};
            vplHit hit;
            int32_t id;
            memcpy(&id, &tile->planes[VPL_PLANE_TRIANGLE][element], sizeof id);
            if (findSeen(s, id - 1, &p, tile->sampleCount, (vplSubPixel){0, 0}, &hit)) {
                putHit(s, &hit, tile, element);
            }
            for (int i = 0; i < tile->sampleCount; i++) {
                int32_t* shown = &tile->samples[i][element];
                const vplSubPixel at = vplSubPixel_OfSample(i, tile->sampleCount);
                if (findSeen(s, *shown, &p, i, at, &hit)) {
                    *shown = hit.triangle;
                }
            }
        }
    }
}
