// SPDX-License-Identifier: MIT
// Coverage: which pixels, blocks and squares of a tile a triangle covers. Included by the tile kernel only.
// Based on: Michael Abrash, Rasterization on Larrabee, Game Developers Conference 2009: levels of 4 x 4.
#ifndef VPL_RASTER_COVERAGE_H
#define VPL_RASTER_COVERAGE_H

#include "math/scalar.h"
#include "raster/setup.h"

static inline void edgesAt(const Setup* s, int x, int y, int32_t edge[3])
{
    for (int i = 0; i < 3; i++) {
        edge[i] = edgeOf(s->e[i] + 256 * (s->a[i] * x + s->b[i] * y));
    }
}

// Finds the lanes of the block at (x, y) that are inside the triangle and the picture. Returns 0 if there are
// none. `edge`: the edge functions in lane 0.
static inline int32_t cover(const vplTile* tile, const Setup* s, const int32_t edge[3], int x, int y,
                            int32_t covered[restrict VPL_LANES])
{
    int32_t any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t outside =
            (edge[0] + s->steps[0][l]) | (edge[1] + s->steps[1][l]) | (edge[2] + s->steps[2][l]);
        covered[l] = ~(outside >> 31);
        any |= covered[l];
    }
    if (any && (x + VPL_BLOCK_SIDE > tile->width || y + VPL_BLOCK_SIDE > tile->height)) {
        any = 0;
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= x + (l & 3) < tile->width && y + (l >> 2) < tile->height ? -1 : 0;
            any |= covered[l];
        }
    }
    return any;
}

// 4 x 4 cells, one bit each.
typedef struct Cells {
    uint32_t touched, filled;
} Cells;

static inline double least3(double a, double b, double c)
{
    const double ab = a < b ? a : b;
    return ab < c ? ab : c;
}

// Finds which of 4 x 4 cells of `side` pixels, the first at (x, y), a triangle touches and which it fills.
// Doubles hold these integers exactly, and unlike 64-bit integers they have a minimum in every instruction
// set.
static inline Cells classify(const Setup* s, int x, int y, int side)
{
    double e[3], right[3], down[3], most[3], least[3];
    for (int i = 0; i < 3; i++) {
        const double a = 256.0 * s->a[i], b = 256.0 * s->b[i];
        e[i] = s->e[i] + (a * x + b * y);
        right[i] = a * side;
        down[i] = b * side;
        most[i] = (side - 1) * ((a > 0 ? a : 0) + (b > 0 ? b : 0)); // from a cell's first centre
        least[i] = (side - 1) * ((a < 0 ? a : 0) + (b < 0 ? b : 0));
    }
    float highest[VPL_LANES], lowest[VPL_LANES]; // only their signs matter
    for (int l = 0; l < VPL_LANES; l++) {
        const int column = l & 3, row = l >> 2;
        const double u = e[0] + (right[0] * column + down[0] * row);
        const double v = e[1] + (right[1] * column + down[1] * row);
        const double w = e[2] + (right[2] * column + down[2] * row);
        highest[l] = (float)least3(u + most[0], v + most[1], w + most[2]);
        lowest[l] = (float)least3(u + least[0], v + least[1], w + least[2]);
    }
    Cells cells = {0, 0};
    for (int l = 0; l < VPL_LANES; l++) {
        cells.touched |= (uint32_t)(highest[l] >= 0) << l;
        cells.filled |= (uint32_t)(lowest[l] >= 0) << l;
    }
    return cells;
}

// Those of 4 x 4 cells that lie in columns x0 to x1 and rows y0 to y1.
static inline uint32_t cellsWithin(int x0, int x1, int y0, int y1)
{
    x0 = vplMaxi(x0, 0);
    y0 = vplMaxi(y0, 0);
    x1 = vplMini(x1, 3);
    y1 = vplMini(y1, 3);
    if (x1 < x0 || y1 < y0) {
        return 0;
    }
    const uint32_t row = (2u << x1) - (1u << x0);
    const uint32_t rows = (0x1111u << 4 * y0) & (0x1111u >> 4 * (3 - y1));
    return row * rows;
}

#endif
