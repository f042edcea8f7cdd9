// SPDX-License-Identifier: MIT
// Bounds the regions of level 0 of a cube map. Compiled once per instruction set; all give the same bits.
#include "visibility/cube_bounds.h"
#include "visibility/kernels.h"

#include <string.h>

// Regions side by side whose directions are found at once, for all six faces.
enum { GROUP = 4, GROUP_TEXELS = GROUP * VPL_REGION_SIDE };

// Rows of texels that are added together: the bounds are loaded and stored once.
enum { ROWS = 4 };

// Directions of a group's texels: (s, u, 1) and the depth per distance. Texels outside of the face repeat the
// last ones.
typedef struct Directions {
    _Alignas(64) float s[GROUP_TEXELS], z[VPL_REGION_SIDE][GROUP_TEXELS];
    float u[VPL_REGION_SIDE];
    int column, row, rows;
} Directions;

static void findDirections(int size, Directions* restrict d)
{
    const float step = 2 / (float)size;
    for (int l = 0; l < GROUP_TEXELS; l++) {
        d->s[l] = ((float)vplMini(d->column + l, size - 1) + 0.5f) * step - 1;
    }
    for (int j = 0; j < d->rows; j++) {
        const float u = 1 - ((float)(d->row + j) + 0.5f) * step;
        d->u[j] = u;
        for (int l = 0; l < GROUP_TEXELS; l++) {
            d->z[j][l] = 1 / sqrtf(1 + d->s[l] * d->s[l] + u * u);
        }
    }
}

// Sixteen texels of a row from `column` on; those outside of the face repeat the last one.
static inline void loadTexels(const float* restrict row, int size, int column,
                              float stored[restrict VPL_LANES])
{
    if (column + VPL_LANES <= size) {
        // The next region's: a row of texels is about a page, and processors prefetch within pages.
        __builtin_prefetch(row + column + VPL_LANES, 0, 2);
        memcpy(stored, row + column, VPL_LANES * sizeof *stored);
        return;
    }
    for (int l = 0; l < VPL_LANES; l++) {
        stored[l] = row[vplMini(column + l, size - 1)];
    }
}

// Rounds down by more than the roundings of x, y and z: six of their value, and one of z because s and u are
// differences.
static void roundDown(vplCubeRegion* region)
{
    const float deepest = -region->least[VPL_LEAST_NEGATED + 2];
    for (int k = 0; k < VPL_LEAST_DISTANCE && deepest > 0; k++) {
        region->least[k] -= fabsf(region->least[k]) * 0x1p-21f + deepest * 0x1p-23f;
    }
}

// The point of a texel, and its stored distance.
typedef struct Texel {
    float value[4];
} Texel;

static inline Texel texelOf(float stored, float far, float z, float s, float u)
{
    const float distance = stored * far;
    const float depth = distance < INFINITY ? distance * z : NAN; // NaN leaves minima and maxima as they are
    return (Texel){{s * depth, u * depth, depth, stored}};
}

static vplCubeRegion boundRegion(const vplCubeMap* map, int face, int offset, const Directions* d)
{
    const int size = map->size;
    const float far = map->farPlane;
    const float* texels = map->texels + ((size_t)face * (size_t)size + (size_t)d->row) * (size_t)size;
    // Bounds of x, y, z and the stored distance.
    _Alignas(64) float least[4][VPL_LANES], most[4][VPL_LANES];
    vplCubeRegion region;
    for (int k = 0; k < 4; k++) {
        for (int l = 0; l < VPL_LANES; l++) {
            least[k][l] = INFINITY;
            most[k][l] = -INFINITY;
        }
    }
    const float* restrict s = d->s + offset;
    for (int j = 0; j < d->rows; j += ROWS) {
        const int last = d->rows - 1; // it may count several times
        const int j1 = vplMini(j + 1, last), j2 = vplMini(j + 2, last), j3 = vplMini(j + 3, last);
        const float* restrict z0 = d->z[j] + offset, * restrict z1 = d->z[j1] + offset;
        const float* restrict z2 = d->z[j2] + offset, * restrict z3 = d->z[j3] + offset;
        const float u0 = d->u[j], u1 = d->u[j1], u2 = d->u[j2], u3 = d->u[j3];
        float stored[ROWS][VPL_LANES];
        loadTexels(texels + (size_t)j * (size_t)size, size, d->column + offset, stored[0]);
        loadTexels(texels + (size_t)j1 * (size_t)size, size, d->column + offset, stored[1]);
        loadTexels(texels + (size_t)j2 * (size_t)size, size, d->column + offset, stored[2]);
        loadTexels(texels + (size_t)j3 * (size_t)size, size, d->column + offset, stored[3]);
        for (int l = 0; l < VPL_LANES; l++) {
            const Texel t0 = texelOf(stored[0][l], far, z0[l], s[l], u0);
            const Texel t1 = texelOf(stored[1][l], far, z1[l], s[l], u1);
            const Texel t2 = texelOf(stored[2][l], far, z2[l], s[l], u2);
            const Texel t3 = texelOf(stored[3][l], far, z3[l], s[l], u3);
            for (int k = 0; k < 4; k++) {
                const float low = vplMinf(t1.value[k], vplMinf(t0.value[k], least[k][l]));
                const float high = vplMaxf(t1.value[k], vplMaxf(t0.value[k], most[k][l]));
                least[k][l] = vplMinf(t3.value[k], vplMinf(t2.value[k], low));
                most[k][l] = vplMaxf(t3.value[k], vplMaxf(t2.value[k], high));
            }
        }
    }
    for (int k = 0; k < 4; k++) {
        for (int l = 0; l < VPL_LANES; l++) {
            most[k][l] = -most[k][l];
        }
        region.least[k < 3 ? VPL_LEAST_POINT + k : VPL_LEAST_DISTANCE] = vplLeastLane(least[k]);
        region.least[k < 3 ? VPL_LEAST_NEGATED + k : VPL_LEAST_NEGATED_DISTANCE] = vplLeastLane(most[k]);
    }
    roundDown(&region);
    return region;
}

void VPL_KERNEL(vplBoundRegions)(const vplCubeMap* map, int row, vplCubeBounds* restrict bounds)
{
    const int side = bounds->side[0], first = row * VPL_REGION_SIDE;
    Directions d = {.row = first, .rows = vplMini(VPL_REGION_SIDE, map->size - first)};
    for (int group = 0; group < side; group += GROUP) {
        d.column = group * VPL_REGION_SIDE;
        findDirections(map->size, &d);
        for (int face = 0; face < 6; face++) {
            for (int i = 0; i < vplMini(GROUP, side - group); i++) {
                bounds->regions[(face * side + row) * side + group + i] =
                    boundRegion(map, face, i * VPL_REGION_SIDE, &d);
            }
        }
    }
}
