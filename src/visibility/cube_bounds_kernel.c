// SPDX-License-Identifier: MIT
// The bound of one tile of a cube map. Compiled once per instruction set; all give the same bits.
//
// A plane whose points obey plane . p = 1 has the inverse view depth plane . (s, u, 1) in direction (s, u, 1):
// linear in columns and rows. The best single bound is a linear function that no texel's inverse depth exceeds: it
// has one of the four slopes that the tile's corners suggest, is raised until it holds, and is the lowest of these
// in the middle of the tile.
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

vplTileBoundFcn VPL_KERNEL(vplTileBound);
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

// The least value at the tile's first texel with which a function of this slope exceeds all values.
static float raise(const vplCubeTile* t, const float* restrict values, Slope slope)
{
    float level = -INFINITY;
    for (int first = 0; first < t->side; first += VPL_LANES) {
        float highest[VPL_LANES], across[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            highest[l] = -INFINITY;
            across[l] = slope.column * (float)(first + l);
        }
        for (int row = 0; row < t->height; row++) {
            const float start = slope.row * (float)row;
            const float* restrict v = values + row * t->side + first;
            for (int l = 0; l < VPL_LANES; l++) {
                highest[l] = maxOf(v[l] - (across[l] + start), highest[l]);
            }
        }
        level = maxOf(largestLane(highest), level);
    }
    float rounding = (fabsf(slope.column) + fabsf(slope.row)) * (float)t->side + fabsf(level);
    return level + rounding * 0x1p-22f;
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

bool VPL_KERNEL(vplTileBound)(const vplCubeTile* t, vplCubeBound* boundOut)
{
    float values[VPL_MAX_CUBE_TILE * VPL_MAX_CUBE_TILE];
    boundOut->farthest = invertTile(t, values);
    const int right = t->width - 1, last = t->height - 1;
    const float* bottom = values + last * t->side;
    const float columns = maxOf((float)right, 1), rows = maxOf((float)last, 1);
    const float across[2] = {(values[right] - values[0]) / columns, (bottom[right] - bottom[0]) / columns};
    const float down[2] = {(bottom[0] - values[0]) / rows, (bottom[right] - values[right]) / rows};
    // Where the corners lie on one plane, one slope will do.
    const bool flat = fabsf(across[0] - across[1]) * columns <= 0x1p-18f * values[0];
    float lowest = INFINITY, level = INFINITY;
    Slope best = {0, 0};
    for (int k = 0; k < (flat ? 1 : 4); k++) {
        const Slope slope = {across[k & 1], down[k >> 1]};
        const float from = raise(t, values, slope);
        const float middle = from + 0.5f * (slope.column * (float)right + slope.row * (float)last);
        if (middle < lowest) {
            lowest = middle;
            level = from;
            best = slope;
        }
    }
    float* plane = boundOut->planes[0];
    toPlane(t, (double)level, best, plane);
    if (!isfinite(plane[0] + plane[1] + plane[2])) { // everything lies behind it
        plane[0] = plane[1] = 0;
        plane[2] = INFINITY;
    }
    memcpy(boundOut->planes[1], plane, sizeof boundOut->planes[0]);
    boundOut->kind = VPL_BOUND_ONE;
    // A crease along columns or rows has its corners on one plane, too, but not its middle.
    const float middle = values[t->height / 2 * t->side + t->width / 2];
    const float above =
        level + best.column * (float)(t->width / 2) + best.row * (float)(t->height / 2) - middle;
    return flat && level <= values[0] * (1 + 0x1p-18f) && above <= middle * 0x1p-18f;
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

void VPL_KERNEL(vplTileRaises)(const vplCubeTile* t, const float planes[][3], int count, vplRaises* raisesOut)
{
    float values[VPL_MAX_CUBE_TILE * VPL_MAX_CUBE_TILE];
    invertTile(t, values);
    for (int i = 0; i < count; i++) {
        raisesOut->one[i] = (double)raisePlanes(t, values, planes[i], planes[i]);
        for (int k = i + 1; k < count; k++) {
            raisesOut->two[i][k] = (double)raisePlanes(t, values, planes[i], planes[k]);
        }
    }
}
