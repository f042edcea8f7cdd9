// SPDX-License-Identifier: MIT
// The shadow of 16 fragments by a paraboloid map. Compiled once per instruction set; all give the same bits.
//
// Each of the four texels around a fragment is compared with the fragment's own plane at that texel's centre,
// and with the fragment itself, whichever is nearer: a plane never shadows itself at any angle. In texel (i,
// j) the plane is at
//     1/t = n.d / n.way, d = (2 x_i, 2 y_j, 1 - x_i^2 - y_j^2), |d| = 1 + x_i^2 + y_j^2,
// so both are sums of a number of the column and one of the row.
#include "math/scalar.h"
#include "visibility/kernels.h"
#include "visibility/map_gather.h"
#include "visibility/paraboloid_map.h"

// 16 fragments as the map sees them.
typedef struct View {
    float x[VPL_LANES], y[VPL_LANES];                  // in the map
    float nx[VPL_LANES], ny[VPL_LANES], nz[VPL_LANES]; // normals, times distance / n.way; x and y doubled
    float reach[VPL_LANES];                            // distances, less what is tolerated
    int32_t back[VPL_LANES];
} View;

static inline void findView(const vplParaboloidMap* map, const vplSurface* surface, View* restrict k)
{
    const vplVec3 o = map->position, r = map->right, u = map->up, f = map->forward;
    const float tolerance = vplParaboloidMap_Tolerance(map->size);
    for (int l = 0; l < VPL_LANES; l++) {
        const float dx = surface->px[l] - o.x, dy = surface->py[l] - o.y, dz = surface->pz[l] - o.z;
        const float mx = surface->nx[l], my = surface->ny[l], mz = surface->nz[l];
        const float x = dx * r.x + dy * r.y + dz * r.z, y = dx * u.x + dy * u.y + dz * u.z;
        const float z = dx * f.x + dy * f.y + dz * f.z;
        const float facing = dx * mx + dy * my + dz * mz;
        const float distance = sqrtf(dx * dx + dy * dy + dz * dz);
        const float inverse = 1 / vplMaxf(distance + fabsf(z), 1e-30f);
        const float scale = distance / (fabsf(facing) > 1e-30f ? facing : 1e30f);
        const float nz = mx * f.x + my * f.y + mz * f.z;
        const int32_t back = z < 0;
        k->x[l] = x * inverse;
        k->y[l] = y * inverse;
        k->nx[l] = 2 * (mx * r.x + my * r.y + mz * r.z) * scale;
        k->ny[l] = 2 * (mx * u.x + my * u.y + mz * u.z) * scale;
        k->nz[l] = (back ? -nz : nz) * scale;
        // Footprints shrink as 1 / (1 + p^2), which is 1 / 2q with q = distance / (distance + |z|) in [1/2,
        // 1], and at most 3/2 - q.
        k->reach[l] = distance * (1 - 0x1p-16f - tolerance * (1.5f - distance * inverse));
        k->back[l] = back;
    }
}

// The two texels beside a fragment, along an axis: where the first is, counted from -1, what share the second
// has, and their centres. At the sides both are one.
typedef struct Beside {
    int32_t at[VPL_LANES];
    float share[VPL_LANES], first[VPL_LANES], second[VPL_LANES];
} Beside;

static inline void findBeside(const float x[restrict VPL_LANES], int32_t size, Beside* restrict b)
{
    const float half = 0.5f * (float)size, scale = 1 / (float)size, end = 1 - scale;
    for (int l = 0; l < VPL_LANES; l++) {
        const float at = vplMinf(vplMaxf((x[l] + 1) * half, 0), (float)size) + 0.5f; // a NaN becomes 0
        const int32_t cell = (int32_t)at;
        const float begin = (float)(2 * cell - 1) * scale - 1;
        b->at[l] = cell;
        b->share[l] = at - (float)cell;
        b->first[l] = vplMaxf(begin, -end);
        b->second[l] = vplMinf(begin + 2 * scale, end);
    }
}

// The texels of one row beside each fragment, as 0 or 1 of the shares.
static inline void addRow(const View* restrict k, const Beside* restrict column,
                          const float y[restrict VPL_LANES], const float first[restrict VPL_LANES],
                          const float second[restrict VPL_LANES], float dark[restrict VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        const float x0 = column->first[l], x1 = column->second[l], xx0 = x0 * x0, xx1 = x1 * x1,
                    yy = y[l] * y[l];
        const float nx = k->nx[l], nz = k->nz[l], reach = k->reach[l], share = column->share[l];
        const float below = k->ny[l] * y[l] + nz * (1 - yy), length0 = 1 + yy + xx0, length1 = 1 + yy + xx1;
        const float plane0 = below + (nx * x0 - nz * xx0), plane1 = below + (nx * x1 - nz * xx1);
        const float at0 = first[l] * reach * length0, at1 = second[l] * reach * length1;
        const float other = 1 - share;
        dark[l] =
            (at0 > vplMaxf(length0, plane0) ? other : 0.0f) + (at1 > vplMaxf(length1, plane1) ? share : 0.0f);
    }
}

void VPL_KERNEL(vplParaboloidFactor)(const vplParaboloidMap* map, const vplSurface* surface,
                                     float factor[restrict VPL_LANES])
{
    const int32_t stride = vplParaboloidMap_Stride(map->size), backs = map->hemispheres == 2;
    const int32_t behind = backs ? stride * stride : 0;
    View k;
    Beside column, row;
    int32_t place[VPL_LANES];
    float first[VPL_LANES], second[VPL_LANES], above[VPL_LANES], below[VPL_LANES];
    findView(map, surface, &k);
    findBeside(k.x, map->size, &column);
    findBeside(k.y, map->size, &row);
    for (int l = 0; l < VPL_LANES; l++) {
        place[l] = row.at[l] * stride + column.at[l] + (k.back[l] ? behind : 0);
    }
    vplGatherPairs(map->texels, place, first, second);
    addRow(&k, &column, row.first, first, second, above);
    vplGatherPairs(map->texels + stride, place, first, second);
    addRow(&k, &column, row.second, first, second, below);
    for (int l = 0; l < VPL_LANES; l++) {
        const float share = row.share[l], dark = above[l] + share * (below[l] - above[l]);
        const int32_t drawn = (k.back[l] == 0) | backs;
        factor[l] = drawn ? dark : 1.0f;
    }
}
