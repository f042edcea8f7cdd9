// SPDX-License-Identifier: MIT
// Draws triangles whose pixel box has at most 2 x 2 centres: the lanes are 16 triangles, because a block of
// 16 pixels would use 4 of its lanes at most. Included by the tile kernel only.
#ifndef VPL_RASTER_TINY_H
#define VPL_RASTER_TINY_H

#include "raster/setup.h"

enum { TINY_SIDE = 2, TINY_PIXELS = TINY_SIDE * TINY_SIDE };

typedef struct Tiny {
    _Alignas(64) float depth[TINY_PIXELS][BATCH];     // at the pixels of the box
    _Alignas(64) int32_t inside[TINY_PIXELS][BATCH];  // -1 where a pixel's centre is in the triangle
    _Alignas(64) int32_t element[TINY_PIXELS][BATCH]; // of the pixel in the tile
} Tiny;

static inline bool isTiny(const Batch* t, int k)
{
    return t->right[k] - t->left[k] < TINY_SIDE && t->bottom[k] - t->top[k] < TINY_SIDE;
}

// True if any of the first `count` triangles is tiny.
static inline bool hasTiny(const Batch* t, int count)
{
    bool any = false;
    for (int k = 0; k < count; k++) {
        any |= isTiny(t, k);
    }
    return any;
}

// least: 0, or -1 where depth is reversed.
static inline float clampDepth(double z, float least)
{
    float v = (float)z;
    v = v > least ? v : least;
    return v < least + 1 ? v : least + 1;
}

static inline void testTinyPixel(const Batch* t, int column, int row, float least, float* restrict depth,
                                 int32_t* restrict inside, int32_t* restrict element)
{
    for (int k = 0; k < BATCH; k++) {
        const int32_t px = t->left[k] + column, py = t->top[k] + row;
        const double x = px, y = py;
        const double u = t->e[0][k] + 256 * (t->a[0][k] * x + t->b[0][k] * y);
        const double v = t->e[1][k] + 256 * (t->a[1][k] * x + t->b[1][k] * y);
        const double w = t->e[2][k] + 256 * (t->a[2][k] * x + t->b[2][k] * y);
        const double uv = u < v ? u : v, inner = uv < w ? uv : w;
        const int32_t within = (px <= t->right[k]) & (py <= t->bottom[k]);
        inside[k] = (inner >= 0 ? -1 : 0) & -within;
        // The same bits as in a block: depth of its first pixel, then the growth to the lane.
        const double z = t->planeZ[k] + (t->zx[k] * (px & ~3) + t->zy[k] * (py & ~3));
        depth[k] = clampDepth(z + (t->zx[k] * (px & 3) + t->zy[k] * (py & 3)), least);
        element[k] = vplTile_Element(px, py);
    }
}

static inline void testTiny(const Batch* t, float least, Tiny* tiny)
{
    for (int i = 0; i < TINY_PIXELS; i++) {
        testTinyPixel(t, i % TINY_SIDE, i / TINY_SIDE, least, tiny->depth[i], tiny->inside[i],
                      tiny->element[i]);
    }
}

// Draws depth and (unless `owners` is NULL) owner of triangle k. Returns how many fragments passed.
static inline int drawTiny(const Tiny* tiny, int k, float* depth, int32_t* owners, int32_t owner)
{
    int passed = 0;
    for (int i = 0; i < TINY_PIXELS; i++) {
        if (tiny->inside[i][k]) {
            float* there = depth + tiny->element[i][k];
            const float drawn = tiny->depth[i][k], kept = *there;
            *there = drawn < kept ? drawn : kept;
            passed += drawn < kept;
            if (owners != NULL && drawn < kept) {
                owners[tiny->element[i][k]] = owner;
            }
        }
    }
    return passed;
}

#endif
