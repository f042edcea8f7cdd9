// SPDX-License-Identifier: MIT
// Sets triangles up for a tile, 16 at a time, so that the arithmetic of small ones is vectorised. Included by
// the tile kernel only, so that it is compiled for each instruction set.
// Based on: Juan Pineda, A Parallel Algorithm for Polygon Rasterization, SIGGRAPH 1988: edge functions. Ours
// are exact integers, so coverage cannot depend on where a block or a tile starts. Doubles hold them:
// products of 24-bit numbers and sums of a few of them stay below 2^53, and all instruction sets multiply
// doubles.
#ifndef VPL_RASTER_SETUP_H
#define VPL_RASTER_SETUP_H

#include "raster/raster.h"

enum { BATCH = VPL_LANES };

// Edge i lies opposite corner i; its function is the area at that corner.
typedef struct Batch {
    // Pixel boxes in the tile.
    _Alignas(64) int32_t left[BATCH], right[BATCH], top[BATCH], bottom[BATCH];
    // Corners, 24.8 fixed point; oriented by setUpBatch.
    _Alignas(64) int32_t x[3][BATCH], y[3][BATCH];
    _Alignas(64) float z[3][BATCH];
    // Edge functions at the point of the tile's first pixel, with the bias of setUpBatch, and their growth
    // per sub-pixel in x and y.
    _Alignas(64) double e[3][BATCH], a[3][BATCH], b[3][BATCH];
    // Depth at the same place, and its growth per pixel.
    _Alignas(64) double planeZ[BATCH], zx[BATCH], zy[BATCH];
    // e / 256, rounded down, at the first block that the box touches.
    _Alignas(64) int32_t edge[3][BATCH];
    // -1 where the triangle is clockwise on screen, before it is oriented.
    _Alignas(64) int32_t clockwise[BATCH];
    uint32_t vertex[3][BATCH];
    int32_t primitive[BATCH];
} Batch;

// Looks up the corners of triangle `ref` for place k of the batch.
static inline void fetchTriangle(const vplRaster* r, const vplShaded* s, int ref, Batch* batch, int k)
{
    const uint32_t source = r->refs[ref].source;
    const uint32_t* vertex;
    const vplScreenVertex* screen = s->screen;
    uint32_t base = 0;
    if (source & (uint32_t)VPL_CLIPPED) {
        const vplClippedTriangle* c = &r->clipped[source & ~(uint32_t)VPL_CLIPPED];
        vertex = c->vertex;
        batch->primitive[k] = c->primitive;
        screen = r->extraScreen;
        base = (uint32_t)s->mesh.vertexCount;
    } else {
        const int32_t primitive = (int32_t)source - s->firstTriangle;
        vertex = s->mesh.indices + 3 * (size_t)primitive;
        batch->primitive[k] = primitive;
    }
    for (int i = 0; i < 3; i++) {
        const vplScreenVertex* v = &screen[vertex[i] - base];
        batch->vertex[i][k] = vertex[i];
        batch->x[i][k] = v->x;
        batch->y[i][k] = v->y;
        batch->z[i][k] = v->z;
    }
}

// Finds the triangles' pixel boxes within the tile; see vplTriangle_PixelBox.
static inline void boundBatch(const vplTile* tile, vplSubPixel at, Batch* t)
{
    const int32_t left = tile->x, top = tile->y, right = tile->width - 1, bottom = tile->height - 1;
    for (int k = 0; k < BATCH; k++) {
        const int32_t x0 = ((vplMini(vplMini(t->x[0][k], t->x[1][k]), t->x[2][k]) + 127 - at.x) >> 8) - left;
        const int32_t y0 = ((vplMini(vplMini(t->y[0][k], t->y[1][k]), t->y[2][k]) + 127 - at.y) >> 8) - top;
        const int32_t x1 = ((vplMaxi(vplMaxi(t->x[0][k], t->x[1][k]), t->x[2][k]) - 128 - at.x) >> 8) - left;
        const int32_t y1 = ((vplMaxi(vplMaxi(t->y[0][k], t->y[1][k]), t->y[2][k]) - 128 - at.y) >> 8) - top;
        t->left[k] = vplMaxi(x0, 0);
        t->top[k] = vplMaxi(y0, 0);
        t->right[k] = vplMini(x1, right);
        t->bottom[k] = vplMini(y1, bottom);
    }
}

// Swaps corners so that all areas are positive with y down: clockwise on screen.
static inline void orientBatch(Batch* t)
{
    for (int k = 0; k < BATCH; k++) {
        const int32_t x1 = t->x[1][k], x2 = t->x[2][k], y1 = t->y[1][k], y2 = t->y[2][k];
        const float z1 = t->z[1][k], z2 = t->z[2][k];
        const double area = (double)(x1 - t->x[0][k]) * (double)(y2 - t->y[0][k]) -
                            (double)(x2 - t->x[0][k]) * (double)(y1 - t->y[0][k]);
        const int32_t clockwise = area > 0 ? -1 : 0;
        t->clockwise[k] = clockwise;
        t->x[1][k] = clockwise ? x1 : x2;
        t->x[2][k] = clockwise ? x2 : x1;
        t->y[1][k] = clockwise ? y1 : y2;
        t->y[2][k] = clockwise ? y2 : y1;
        t->z[1][k] = clockwise ? z1 : z2;
        t->z[2][k] = clockwise ? z2 : z1;
    }
    for (int k = 0; k < BATCH; k++) {
        const uint32_t v1 = t->vertex[1][k], v2 = t->vertex[2][k];
        t->vertex[1][k] = t->clockwise[k] ? v1 : v2;
        t->vertex[2][k] = t->clockwise[k] ? v2 : v1;
    }
}

// Rounds an edge function to whole pixels. Within a block it grows by less than 2^28, so beyond 2^30 only the
// sign matters.
static inline int32_t edgeOf(double e)
{
    double v = e * 0x1p-8;
    v = v < 0x1p30 ? v : 0x1p30;
    v = v > -0x1p30 ? v : -0x1p30;
    const int32_t i = (int32_t)v;
    return i - ((double)i > v ? 1 : 0); // down, not towards 0
}

static inline void findFirstEdges(Batch* t)
{
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < BATCH; k++) {
            const double x = t->left[k] & ~3, y = t->top[k] & ~3;
            t->edge[i][k] = edgeOf(t->e[i][k] + 256 * (t->a[i][k] * x + t->b[i][k] * y));
        }
    }
}

// `at`: the points of the pixels that are tested.
static inline void setUpBatch(const vplTile* tile, vplSubPixel at, Batch* t)
{
    const double px = 256.0 * tile->x + 128 + at.x, py = 256.0 * tile->y + 128 + at.y;
    boundBatch(tile, at, t);
    orientBatch(t);
    for (int i = 0; i < 3; i++) {
        const int p = (i + 1) % 3, q = (i + 2) % 3;
        for (int k = 0; k < BATCH; k++) {
            const double dx = t->x[q][k] - t->x[p][k], dy = t->y[q][k] - t->y[p][k];
            t->a[i][k] = -dy;
            t->b[i][k] = dx;
            t->e[i][k] = dx * (py - t->y[p][k]) - dy * (px - t->x[p][k]);
        }
    }
    for (int k = 0; k < BATCH; k++) {
        // The sum of the three edge functions is twice the area, anywhere.
        const double inverse = 1 / (t->e[0][k] + t->e[1][k] + t->e[2][k]);
        const double z1 = (double)t->z[1][k] - t->z[0][k], z2 = (double)t->z[2][k] - t->z[0][k];
        t->zx[k] = 256 * inverse * (z1 * t->a[1][k] + z2 * t->a[2][k]);
        t->zy[k] = 256 * inverse * (z1 * t->b[1][k] + z2 * t->b[2][k]);
        t->planeZ[k] = t->z[0][k] + inverse * (z1 * t->e[1][k] + z2 * t->e[2][k]);
    }
    // Pixel centres on left and top edges are inside; on other edges they belong to the neighbour.
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < BATCH; k++) {
            const double a = t->a[i][k], b = t->b[i][k];
            const double owned = a > 0 ? 0 : 1, ownedTop = b > 0 ? 0 : 1;
            t->e[i][k] -= a == 0 ? ownedTop : owned;
        }
    }
    findFirstEdges(t);
}

// One triangle of a batch.
typedef struct Setup {
    double e[3], a[3], b[3];
    double z, zx, zy;
    _Alignas(64) double laneZ[VPL_LANES];
    double leastZ, mostZ;                     // least and largest laneZ
    _Alignas(64) int32_t steps[3][VPL_LANES]; // growth of the edges from lane 0, in whole pixels (e / 256)
} Setup;

static inline void setUp(const Batch* t, int k, Setup* s)
{
    for (int i = 0; i < 3; i++) {
        s->e[i] = t->e[i][k];
        s->a[i] = t->a[i][k];
        s->b[i] = t->b[i][k];
        const int32_t a = (int32_t)s->a[i], b = (int32_t)s->b[i];
        for (int l = 0; l < VPL_LANES; l++) {
            s->steps[i][l] = a * (l & 3) + b * (l >> 2);
        }
    }
    s->z = t->planeZ[k];
    s->zx = t->zx[k];
    s->zy = t->zy[k];
    for (int l = 0; l < VPL_LANES; l++) {
        s->laneZ[l] = s->zx * (l & 3) + s->zy * (l >> 2);
    }
}

static inline void boundDepth(Setup* s)
{
    s->leastZ = (s->zx < 0 ? s->laneZ[3] : 0) + (s->zy < 0 ? s->laneZ[12] : 0);
    s->mostZ = (s->zx > 0 ? s->laneZ[3] : 0) + (s->zy > 0 ? s->laneZ[12] : 0);
}

#endif
