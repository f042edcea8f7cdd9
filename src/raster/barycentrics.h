// SPDX-License-Identifier: MIT
// Barycentrics: perspective-correct interpolation within a triangle. Included by the tile kernel only.
// Based on: Marc Olano and Trey Greer, Triangle Scan Conversion Using 2D Homogeneous Coordinates, Graphics
// Hardware 1997: with corners (X, Y, w) in homogeneous pixels, barycentric coordinate i of the point seen at
// pixel p is proportional to (corner j x corner k) . (p, 1). Corners are neither divided by w nor snapped:
// snapping decides coverage only and moves no surface.
#ifndef VPL_RASTER_BARYCENTRICS_H
#define VPL_RASTER_BARYCENTRICS_H

#include "raster/setup.h"

#include <math.h>

typedef struct Barycentrics {
    // Weight i of a pixel is x[i] column + y[i] row + c[i]; the sum of the weights is 1/w.
    double x[3], y[3], c[3];
    _Alignas(64) double lane[3][VPL_LANES]; // growth from lane 0
    // 1/w of a pixel is inverse[0] column + inverse[1] row + inverse[2].
    double inverse[3];
    _Alignas(64) double inverseLane[VPL_LANES];
    float nearest, farthest; // bounds of w
    float leastWeight;
    // Varyings of corner 0, and the differences of corners 1 and 2 from them.
    float v0[VPL_MAX_VARYINGS], d1[VPL_MAX_VARYINGS], d2[VPL_MAX_VARYINGS];
} Barycentrics;

static inline void crossPlanes(const double p[3][3], Barycentrics* s)
{
    for (int i = 0; i < 3; i++) {
        const double *u = p[(i + 1) % 3], *v = p[(i + 2) % 3];
        s->x[i] = u[1] * v[2] - u[2] * v[1];
        s->y[i] = u[2] * v[0] - u[0] * v[2];
        s->c[i] = u[0] * v[1] - u[1] * v[0];
    }
}

// Snapping covers pixels whose centres are up to 1/362 pixel outside of a triangle. There the planes hold as
// well, and are followed as far as this part of the triangle's extent. Only a triangle thinner than 1/5 pixel
// would be left further, by any length if it is seen edge-on.
#define VPL_BEYOND (1.0 / 64)

// Bounds w by the range of the corners' 1/w, wider by VPL_BEYOND. Where all corners are equal, so are bounds.
static inline void boundW(double nearest, double farthest, Barycentrics* s)
{
    const double product = nearest * farthest, beyond = VPL_BEYOND * (farthest - nearest);
    s->nearest = (float)(product / (farthest + beyond));
    s->farthest = (float)(product / fmax(nearest - beyond, nearest / 2));
    s->leastWeight = (float)(-VPL_BEYOND / farthest);
}

static inline void setUpBarycentrics(const vplRaster* r, const Batch* t, int place, const vplShaded* shaded,
                                     Barycentrics* s)
{
    double p[3][3];
    float varyings[3][VPL_MAX_VARYINGS];
    for (int i = 0; i < 3; i++) {
        float clip[3];
        vplFetchVertex(r, shaded, t->vertex[i][place], clip, varyings[i]);
        p[i][0] = 0.5 * r->framebuffer.width * ((double)clip[2] + clip[0]);
        p[i][1] = 0.5 * r->framebuffer.height * ((double)clip[2] - clip[1]);
        p[i][2] = clip[2];
    }
    const double nearest = fmin(p[0][2], fmin(p[1][2], p[2][2])),
                 farthest = fmax(p[0][2], fmax(p[1][2], p[2][2]));
    boundW(nearest, farthest, s);
    crossPlanes(p, s);
    double determinant = p[0][0] * s->x[0] + p[0][1] * s->y[0] + p[0][2] * s->c[0];
    if (!(determinant > 0)) {
        // The triangle has an area only because of snapping: use its snapped corners.
        for (int i = 0; i < 3; i++) {
            p[i][0] = t->x[i][place] / 256.0 * p[i][2];
            p[i][1] = t->y[i][place] / 256.0 * p[i][2];
        }
        crossPlanes(p, s);
        determinant = p[0][0] * s->x[0] + p[0][1] * s->y[0] + p[0][2] * s->c[0];
    }
    // Scaled so that floats hold the planes whatever the unit of w.
    const double scale = 1 / determinant;
    for (int i = 0; i < 3; i++) {
        s->x[i] *= scale;
        s->y[i] *= scale;
        s->c[i] = s->c[i] * scale + 0.5 * (s->x[i] + s->y[i]); // pixel centres
        for (int l = 0; l < VPL_LANES; l++) {
            s->lane[i][l] = s->x[i] * (l & 3) + s->y[i] * (l >> 2);
        }
    }
    s->inverse[0] = s->x[0] + s->x[1] + s->x[2];
    s->inverse[1] = s->y[0] + s->y[1] + s->y[2];
    s->inverse[2] = s->c[0] + s->c[1] + s->c[2];
    for (int l = 0; l < VPL_LANES; l++) {
        s->inverseLane[l] = s->inverse[0] * (l & 3) + s->inverse[1] * (l >> 2);
    }
    for (int k = 0; k < shaded->varyingCount; k++) {
        s->v0[k] = varyings[0][k];
        s->d1[k] = varyings[1][k] - varyings[0][k];
        s->d2[k] = varyings[2][k] - varyings[0][k];
    }
}

// Finds w at the pixels' centres.
static inline void findW(const Barycentrics* s, int x, int y, float w[VPL_LANES])
{
    const double first = s->inverse[0] * x + (s->inverse[1] * y + s->inverse[2]);
    const float nearest = s->nearest, farthest = s->farthest, least = 1 / farthest;
    for (int l = 0; l < VPL_LANES; l++) {
        float v = (float)(first + s->inverseLane[l]);
        v = 1 / (v > least ? v : least);
        v = v > nearest ? v : nearest;
        w[l] = v < farthest ? v : farthest;
    }
}

// Weights of corner i in a block. The barycentrics are the weights divided by their sum. They are bounded, so
// that lanes that are not covered stay finite.
static inline void cornerWeights(const Barycentrics* s, int i, int x, int y, float weight[VPL_LANES])
{
    const double at = s->x[i] * x + (s->y[i] * y + s->c[i]);
    const float least = s->leastWeight;
    for (int l = 0; l < VPL_LANES; l++) {
        const float v = (float)(at + s->lane[i][l]);
        weight[l] = v > least ? v : least;
    }
}

static inline void interpolate(const Barycentrics* s, int varyingCount, int x, int y, vplFragments* f)
{
    float weight0[VPL_LANES], weight1[VPL_LANES], weight2[VPL_LANES], b1[VPL_LANES], b2[VPL_LANES];
    cornerWeights(s, 0, x, y, weight0);
    cornerWeights(s, 1, x, y, weight1);
    cornerWeights(s, 2, x, y, weight2);
    const float leastSum = 0.25f / s->farthest;
    for (int l = 0; l < VPL_LANES; l++) {
        const float sum = weight0[l] + weight1[l] + weight2[l];
        const float w = 1 / (sum > leastSum ? sum : leastSum);
        b1[l] = weight1[l] * w;
        b2[l] = weight2[l] * w;
    }
    for (int k = 0; k < varyingCount; k++) {
        // Relative to corner 0, so that a varying that is equal at all corners keeps its bits.
        const float v0 = s->v0[k], d1 = s->d1[k], d2 = s->d2[k];
        for (int l = 0; l < VPL_LANES; l++) {
            f->varying[k][l] = v0 + (b1[l] * d1 + b2[l] * d2);
        }
    }
}

#endif
