// SPDX-License-Identifier: MIT
// Bounds the regions of level 0 of a cube map. Compiled once per instruction set; all give the same bits.
#include "visibility/cube_bounds.h"
#include "visibility/kernels.h"

#include <string.h>

// Regions side by side whose directions are found at once, for all six faces.
enum { GROUP = 4, GROUP_TEXELS = GROUP * VPL_REGION_SIDE };

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

static vplCubeRegion boundRegion(const vplCubeMap* map, int face, int offset, const Directions* d)
{
    const int size = map->size;
    const float far = map->far;
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
    for (int j = 0; j < d->rows; j++) {
        const float* restrict rowZ = d->z[j] + offset;
        const float u = d->u[j];
        float stored[VPL_LANES];
        loadTexels(texels + (size_t)j * (size_t)size, size, d->column + offset, stored);
        for (int l = 0; l < VPL_LANES; l++) {
            const float distance = stored[l] * far;
            // NaN leaves minima and maxima as they are.
            const float z = distance < INFINITY ? distance * rowZ[l] : NAN, x = d->s[offset + l] * z,
                        y = u * z;
            const float value[4] = {x, y, z, stored[l]};
            for (int k = 0; k < 4; k++) {
                least[k][l] = vplMinf(value[k], least[k][l]);
                most[k][l] = vplMaxf(value[k], most[k][l]);
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
