// SPDX-License-Identifier: MIT
// Tiles with smooth edges, once their pixels are written: surfaces that centres of pixels do not show are
// added, emission at the edges of lamps is found by rays, and rims of shadows are smoothed.
#include "math/sampling.h"
#include "shading/edges.h"

// Bit l: some sample of lane l shows another triangle than its centre.
static uint32_t edgeLanes(const vplTile* tile, int element, const int centre[VPL_LANES])
{
    int32_t different[VPL_LANES] = {0};
    for (int i = 0; i < tile->sampleCount; i++) {
        const int32_t* shown = tile->samples[i] + element;
        for (int l = 0; l < VPL_LANES; l++) {
            different[l] |= shown[l] ^ centre[l];
        }
    }
    uint32_t lanes = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        lanes |= (uint32_t)(different[l] != 0) << l;
    }
    return lanes;
}

// ---- edges of lamps

// Camera rays through a pixel at the edge of a lamp, which is so bright that few samples leave steps.
enum { LAMP_RAYS = 256 };

// The light that a triangle emits towards the camera; 0 where there is none.
static void emissionOf(const vplShading* s, vplFacetCache* cache, int triangle, float out[3])
{
    memset(out, 0, 3 * sizeof *out);
    if (triangle >= 0) {
        memcpy(out, vplFacetCache_Get(s, triangle, cache)->reflector.emission, 3 * sizeof *out);
    }
}

// Tests whether another surface of a pixel emits other light than that in its centre.
static bool isLampEdge(const vplShading* s, vplFacetCache* cache, const vplEdgePixel* p, const float own[3])
{
    bool differs = false;
    for (int i = 0; i < p->count; i++) {
        float other[3];
        emissionOf(s, cache, p->others[i].triangle, other);
        differs |= memcmp(other, own, sizeof other) != 0;
    }
    return differs;
}

// Finds the mean emission in a pixel by rays. Its surfaces then count without their own.
static void findEmission(const vplShading* s, vplFacetCache* cache, vplEdgePixel* p, float emission[3])
{
    const vplView* v = s->view;
    for (int i = 0; i < LAMP_RAYS; i++) {
        double x, y;
        vplHit hit;
        vplPixelPoint(i, LAMP_RAYS, &x, &y);
        const vplSubPixel at = {(int)(256 * x) - 128, (int)(256 * y) - 128};
        const vplVec3 sight = vplSightOf(v, p->x, p->y, at);
        const vplRay ray = {vplAdd(v->eye, vplScale((float)v->nearPlane, sight)), sight, {0, 0}};
        float one[3];
        emissionOf(s, cache, vplGeometry_ClosestHit(s->geometry, &ray, &hit) ? hit.triangle : -1, one);
        for (int c = 0; c < 3; c++) {
            emission[c] += one[c] / LAMP_RAYS;
        }
    }
    for (int i = 0; i < p->count; i++) {
        p->others[i].glows = false;
    }
}

// Scales what a pixel shows by the share of the surface in its centre.
static void scaleCentre(const vplShading* s, vplFacetCache* cache, vplEdgePixel* p, int64_t* rays)
{
    float *pixel = vplPixelOf(s, p->x, p->y), own[3], emission[3] = {0, 0, 0};
    emissionOf(s, cache, p->triangle, own);
    const bool lamp = isLampEdge(s, cache, p, own);
    if (lamp) {
        findEmission(s, cache, p, emission);
        *rays += LAMP_RAYS;
    }
    for (int c = 0; c < 3; c++) {
        const float reflected = lamp ? pixel[c] - own[c] : pixel[c];
        pixel[c] = p->share * (reflected > 0 ? reflected : 0) + emission[c];
    }
}

// ---- tiles

void vplVisitEdges(const vplShading* s, const vplTile* tile, vplFacetCache* cache, vplEdgePixelFcn* visit,
                   void* user)
{
    vplTileSums* sums = tile->scratch;
    uint16_t own[VPL_TILE_SIDE * VPL_TILE_SIDE];
    for (int i = 0; i < VPL_TILE_SIDE * VPL_TILE_SIDE; i++) {
        own[i] = (uint16_t)((1u << tile->sampleCount) - 1);
    }
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        const int x0 = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE,
                  y0 = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
        if (x0 >= tile->width || y0 >= tile->height) {
            continue;
        }
        int centre[VPL_LANES];
        vplReadTriangles(tile, block * VPL_LANES, centre);
        for (uint32_t lanes = edgeLanes(tile, block * VPL_LANES, centre); lanes != 0; lanes &= lanes - 1) {
            const int l = __builtin_ctz(lanes), x = x0 + l % VPL_BLOCK_SIDE, y = y0 + l / VPL_BLOCK_SIDE;
            if (x < tile->width && y < tile->height) {
                vplEdgePixel pixel = {.x = tile->x + x, .y = tile->y + y, .triangle = centre[l]};
                vplFindEdges(s, tile, block * VPL_LANES + l, cache, &pixel);
                own[block * VPL_LANES + l] = (uint16_t)pixel.own;
                scaleCentre(s, cache, &pixel, &sums->shadowRays);
                visit(s, user, &pixel);
            }
        }
    }
    if (s->smoothsRims) {
        vplSmoothRims(s, tile, cache, own);
    }
}

static void pushEdges(const vplShading* s, void* user, const vplEdgePixel* p)
{
    (void)s;
    for (int i = 0; i < p->count; i++) {
        vplEdgeQueue_Push(user, &p->others[i], p->x, p->y);
    }
}

void vplSmoothTile(const vplShading* s, const vplTile* tile, vplFacetCache* cache,
                   vplAddToBlockFcn* addLights, void* user)
{
    vplTileSums* tileSums = tile->scratch;
    if (tile->sampleCount > 0) {
        vplEdgeQueue q = {s, cache, addLights, user, &tileSums->shadowRays, .direct = true, .indirect = true};
        vplVisitEdges(s, tile, cache, pushEdges, &q);
        vplEdgeQueue_Flush(&q);
    }
}
