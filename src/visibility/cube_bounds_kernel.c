// SPDX-License-Identifier: MIT
// What one tile of a cube map shows. Compiled once per instruction set; all give the same bits.
//
// A plane whose points obey plane . p = 1 has the inverse view depth plane . (s, u, 1) in direction (s, u, 1):
// linear in columns and rows. It bounds a tile where no texel's inverse depth exceeds it.
#include "visibility/cube_bounds.h"

#include <math.h>
#include <string.h>

// Change per column and per row.
typedef struct Slope {
    float column, row;
} Slope;

static inline float maxOf(float a, float b)
{
    return a > b ? a : b;
}

vplFlatTileFcn VPL_KERNEL(vplFlatTile);
vplTileRaisesFcn VPL_KERNEL(vplTileRaises);

// The largest of 16, by halves: a chain would wait for each step.
static inline float largestLane(const float* restrict values)
{
    float a[8], b[4];
    for (int l = 0; l < 8; l++) {
        a[l] = maxOf(values[l], values[l + 8]);
    }
    for (int l = 0; l < 4; l++) {
        b[l] = maxOf(a[l], a[l + 4]);
    }
    return maxOf(maxOf(b[0], b[2]), maxOf(b[1], b[3]));
}

// The inverse view depths of 16 columns. At most five roundings of 2^-24 each are made up for. Columns outside
// the face repeat the last one inside, which can only raise the bound. Returns the largest stored distance.
static float invertColumns(const vplCubeTile* t, int first, float* restrict values)
{
    const float step = 2 / (float)t->size, far = t->far;
    const bool inside = first + VPL_LANES <= t->width;
    float s2[VPL_LANES], largest[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float s = ((float)(t->column + first + l) + 0.5f) * step - 1;
        s2[l] = 1 + s * s;
        largest[l] = 0;
    }
    for (int row = 0; row < t->height; row++) {
        const float u = 1 - ((float)(t->row + row) + 0.5f) * step, u2 = u * u;
        const float* texels = t->texels + (size_t)row * (size_t)t->size;
        float* restrict out = values + row * t->side + first;
        float stored[VPL_LANES];
        if (inside) {
            memcpy(stored, texels + first, sizeof stored);
        } else {
            for (int l = 0; l < VPL_LANES; l++) {
                stored[l] = texels[first + l < t->width ? first + l : t->width - 1];
            }
        }
        for (int l = 0; l < VPL_LANES; l++) {
            largest[l] = maxOf(largest[l], stored[l]);
        }
        for (int l = 0; l < VPL_LANES; l++) {
            out[l] = sqrtf(s2[l] + u2) / (stored[l] * far) * (1 + 0x1p-21f);
        }
    }
    return largestLane(largest);
}

static float invertTile(const vplCubeTile* t, float* restrict values)
{
    float farthest = 0;
    for (int first = 0; first < t->side; first += VPL_LANES) {
        farthest = maxOf(farthest, invertColumns(t, first, values));
    }
    return farthest;
}

// From a value at the first texel and a slope to a plane in the face's axes. The slopes are rounded first; what
// that changes within the tile, and the rounding of the last step, is below 2^-23 of the terms.
static void toPlane(const vplCubeTile* t, double level, Slope slope, float plane[3])
{
    const double half = 0.5 * t->size, column = half - t->column - 0.5, row = half - t->row - 0.5;
    plane[0] = (float)(slope.column * half);
    plane[1] = (float)(-slope.row * half);
    const double middle = 0.5 * t->side, change = fabs((double)slope.column) + fabs((double)slope.row);
    const double at = level + slope.column * middle + slope.row * middle;
    const double s = (middle - column) / half, u = -(middle - row) / half;
    const double ahead = at - (double)plane[0] * s - (double)plane[1] * u;
    plane[2] = (float)(ahead + (fabs(ahead) + change * t->side) * 0x1p-23);
}

// The inverse view depth of one texel.
static float invertTexel(const vplCubeTile* t, int column, int row)
{
    const float step = 2 / (float)t->size;
    const float s = ((float)(t->column + column) + 0.5f) * step - 1;
    const float u = 1 - ((float)(t->row + row) + 0.5f) * step;
    return sqrtf(1 + s * s + u * u) / (t->texels[row * t->size + column] * t->far);
}

// The largest |c|^2 - (f D)^2, at least 0: c = (s, u, 1), D the distance and f a function on the tile.
static float findMissing(const vplCubeTile* t, float level, Slope slope, float* farthestOut)
{
    const float step = 2 / (float)t->size, far = t->far;
    float largest[VPL_LANES] = {0}, missing[VPL_LANES] = {0}, s2[VPL_LANES], across[VPL_LANES];
    for (int first = 0; first < t->width; first += VPL_LANES) {
        for (int l = 0; l < VPL_LANES; l++) {
            const float s = ((float)(t->column + first + l) + 0.5f) * step - 1;
            s2[l] = 1 + s * s;
            across[l] = level + slope.column * (float)(first + l);
        }
        for (int row = 0; row < t->height; row++) {
            const float u = 1 - ((float)(t->row + row) + 0.5f) * step, u2 = u * u;
            const float down = slope.row * (float)row;
            const float* restrict texels = t->texels + (size_t)row * (size_t)t->size + first;
            // The next tile's: a row of texels is about a page, and processors prefetch within pages.
            // 1.3x for the whole of vplCubeMap_FindBounds, 6 * 1024^2 texels.
            __builtin_prefetch(texels + t->side, 0, 2);
            for (int l = 0; l < VPL_LANES; l++) {
                const float stored = texels[l], ratio = (across[l] + down) * (stored * far);
                largest[l] = maxOf(stored, largest[l]);
                missing[l] = maxOf(s2[l] + u2 - ratio * ratio, missing[l]);
            }
        }
    }
    *farthestOut = largestLane(largest);
    return largestLane(missing);
}

// The square of the nearest distance to 0 in a column or row of the tile.
static float leastSquare(const vplCubeTile* t, int first, int count)
{
    const float step = 2 / (float)t->size, begin = (float)first * step - 1, end = begin + (float)count * step;
    return begin > 0 ? begin * begin : end < 0 ? end * end : 0;
}

// Most tiles show one plane, and need neither roots nor divisions. With f through three of their corners, no more
// than m missing, and c, D as above: f must be raised by (|c| - f D) / D = (|c|^2 - (f D)^2) f / ((|c| + f D) f D)
// at most, where that is positive, and both |c| and f D are at least sqrt(|c|^2 - m). Roundings of |c|^2 and
// (f D)^2 are below 2^-20 of them, those of f below 2^-22 of its terms. Where D is infinite and f = 0, NaN is not larger
// than anything.
bool VPL_KERNEL(vplFlatTile)(const vplCubeTile* t, vplCubeBound* boundOut)
{
    const int right = t->width - 1, last = t->height - 1;
    if (t->width % VPL_LANES > 0) {
        return false;
    }
    const float level = invertTexel(t, 0, 0), corner = invertTexel(t, right, last);
    const float middle = invertTexel(t, right / 2, last / 2);
    const Slope slope = {(invertTexel(t, right, 0) - level) / (float)right,
                         (invertTexel(t, 0, last) - level) / maxOf((float)last, 1)};
    const float across = slope.column * (float)right, down = slope.row * (float)last;
    const float same = level * 0x1p-18f;
    if (!(fabsf(level + across + down - corner) <= same) ||
        !(fabsf(level + slope.column * (float)(right / 2) + slope.row * (float)(last / 2) - middle) <=
          same)) {
        return false;
    }
    float farthest;
    const float missing = findMissing(t, level, slope, &farthest);
    const float least = level + (across < 0 ? across : 0) + (down < 0 ? down : 0);
    const float most = level + maxOf(across, 0) + maxOf(down, 0);
    if (!(missing <= 0x1p-17f) || !(least >= 0) || !(most < INFINITY)) {
        return false;
    }
    const float c2 = 1 + leastSquare(t, t->column, t->width) + leastSquare(t, t->row, t->height);
    const float raised = most * (0.5f * missing / (c2 - missing) + 0x1p-21f);
    const float rounding = (fabsf(slope.column) + fabsf(slope.row)) * (float)t->side + most;
    toPlane(t, (double)level + (double)raised + (double)rounding * 0x1p-22, slope, boundOut->planes[0]);
    memcpy(boundOut->planes[1], boundOut->planes[0], sizeof boundOut->planes[0]);
    boundOut->farthest = farthest;
    boundOut->kind = VPL_BOUND_ONE;
    return isfinite(boundOut->planes[0][0] + boundOut->planes[0][1] + boundOut->planes[0][2]);
}

// How far the values exceed the higher of two planes at most, rounded up.
static float raisePlanes(const vplCubeTile* t, const float* restrict values, const float a[3],
                         const float b[3])
{
    const float step = 2 / (float)t->size;
    float raised = 0;
    for (int first = 0; first < t->side; first += VPL_LANES) {
        float highest[VPL_LANES], s[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            highest[l] = 0;
            s[l] = ((float)(t->column + first + l) + 0.5f) * step - 1;
        }
        for (int row = 0; row < t->height; row++) {
            const float u = 1 - ((float)(t->row + row) + 0.5f) * step;
            const float a0 = a[1] * u + a[2], b0 = b[1] * u + b[2];
            const float* restrict v = values + row * t->side + first;
            for (int l = 0; l < VPL_LANES; l++) {
                highest[l] = maxOf(v[l] - maxOf(a[0] * s[l] + a0, b[0] * s[l] + b0), highest[l]);
            }
        }
        raised = maxOf(largestLane(highest), raised);
    }
    float rounding = raised;
    for (int c = 0; c < 3; c++) {
        rounding += maxOf(fabsf(a[c]), fabsf(b[c]));
    }
    return raised + rounding * 0x1p-21f;
}

float VPL_KERNEL(vplTileRaises)(const vplCubeTile* t, const float planes[][3], int count,
                                vplRaises* raisesOut)
{
    float values[VPL_MAX_CUBE_TILE * VPL_MAX_CUBE_TILE];
    const float farthest = invertTile(t, values);
    for (int i = 0; i < count; i++) {
        raisesOut->one[i] = (double)raisePlanes(t, values, planes[i], planes[i]);
        for (int k = i + 1; k < count; k++) {
            raisesOut->two[i][k] = (double)raisePlanes(t, values, planes[i], planes[k]);
        }
    }
    return farthest;
}
