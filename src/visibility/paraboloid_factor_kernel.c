// SPDX-License-Identifier: MIT
// The shadow of 16 fragments by a paraboloid map. Compiled once per instruction set; all give the same bits.
//
// Each of the four texels around a fragment is compared with the fragment's own plane at that texel's centre, and with
// the fragment itself, whichever is nearer: a plane never shadows itself at any angle. In texel (i, j) the plane is at
//     1/t = n.d / n.way, d = (2 x_i, 2 y_j, 1 - x_i^2 - y_j^2), |d| = 1 + x_i^2 + y_j^2,
// so both are sums of a number of the column and one of the row.
#include "base/isa.h"
#include "math/scalar.h"
#include "visibility/gather.h"
#include "visibility/paraboloid_map.h"

vplParaboloidFactorFcn VPL_KERNEL(vplParaboloidFactor);

enum { WAYS = 2 };

// 16 fragments as the map sees them.
typedef struct Look {
    float x[VPL_LANES], y[VPL_LANES];                  // in the map
    float nx[VPL_LANES], ny[VPL_LANES], nz[VPL_LANES]; // normals, times distance / n.way; x and y doubled
    float distance[VPL_LANES], tolerated[VPL_LANES];
    int32_t back[VPL_LANES];
} Look;

static inline void look(const vplParaboloidMap* map, const vplSurface* surface, Look* restrict k)
{
    const vplVec3 o = map->position, r = map->right, u = map->up, f = map->forward;
    const float tolerance = vplParaboloidMap_Tolerance(map->size);
    for (int l = 0; l < VPL_LANES; l++) {
        const float dx = surface->px[l] - o.x, dy = surface->py[l] - o.y, dz = surface->pz[l] - o.z;
        const float mx = surface->nx[l], my = surface->ny[l], mz = surface->nz[l];
        const float x = dx * r.x + dy * r.y + dz * r.z, y = dx * u.x + dy * u.y + dz * u.z;
        const float z = dx * f.x + dy * f.y + dz * f.z;
        const float facing = dx * mx + dy * my + dz * mz;
        const float distance = sqrtf(x * x + y * y + z * z);
        const float inverse = 1 / vplMaxf(distance + fabsf(z), 1e-30f);
        const float scale = distance / (fabsf(facing) > 1e-30f ? facing : 1e30f);
        const float nz = mx * f.x + my * f.y + mz * f.z;
        const int32_t back = z < 0;
        k->x[l] = x * inverse;
        k->y[l] = y * inverse;
        k->nx[l] = 2 * (mx * r.x + my * r.y + mz * r.z) * scale;
        k->ny[l] = 2 * (mx * u.x + my * u.y + mz * u.z) * scale;
        k->nz[l] = (back ? -nz : nz) * scale;
        k->distance[l] = distance;
        // Footprints shrink as 1 / (1 + p^2), which is 1 / 2q with q = distance / (distance + |z|) in [1/2, 1], and at
        // most 3/2 - q.
        k->tolerated[l] = 1 + 0x1p-16f + tolerance * (1.5f - distance * inverse);
        k->back[l] = back;
    }
}

// The two texels around a fragment, along an axis: where, what share the second has, and their centres.
typedef struct Pair {
    int32_t at[WAYS][VPL_LANES];
    float share[VPL_LANES], centre[WAYS][VPL_LANES];
} Pair;

static inline void pairUp(const float x[restrict VPL_LANES], int32_t size, Pair* restrict p)
{
    const float half = 0.5f * (float)size, scale = 1 / (float)size;
    const int32_t last = size - 1;
    for (int l = 0; l < VPL_LANES; l++) {
        const float at = vplMinf(vplMaxf((x[l] + 1) * half, 0), (float)size) + 0.5f; // a NaN becomes 0
        const int32_t cell = (int32_t)at;
        const int32_t first = cell > 1 ? cell - 1 : 0, second = cell < last ? cell : last;
        p->share[l] = at - (float)cell;
        p->at[0][l] = first;
        p->at[1][l] = second;
        p->centre[0][l] = (float)(2 * first + 1) * scale - 1;
        p->centre[1][l] = (float)(2 * second + 1) * scale - 1;
    }
}

void VPL_KERNEL(vplParaboloidFactor)(const vplParaboloidMap* map, const vplSurface* surface,
                                     float factor[restrict VPL_LANES])
{
    const int32_t blocks = vplHalfMap_Blocks(map->size), backs = map->hemispheres == 2;
    const int32_t behind = backs ? (int32_t)vplParaboloidMap_Texels(map->size) : 0;
    Look k;
    Pair column, row;
    float dark[VPL_LANES] = {0};
    look(map, surface, &k);
    pairUp(k.x, map->size, &column);
    pairUp(k.y, map->size, &row);
    for (int way = 0; way < WAYS * WAYS; way++) {
        const int32_t *i = column.at[way % WAYS], *j = row.at[way / WAYS];
        const float *x = column.centre[way % WAYS], *y = row.centre[way / WAYS];
        const float across = way % WAYS ? 0.0f : 1.0f, down = way / WAYS ? 0.0f : 1.0f;
        float stored[VPL_LANES];
        int32_t place[VPL_LANES];
        for (int l = 0; l < VPL_LANES; l++) {
            place[l] = vplHalfMap_Place(blocks, i[l], j[l]) + (k.back[l] ? behind : 0);
        }
        vplGather(map->texels, place, stored);
        for (int l = 0; l < VPL_LANES; l++) {
            const float r2 = x[l] * x[l] + y[l] * y[l];
            const float plane = k.nx[l] * x[l] + k.ny[l] * y[l] + k.nz[l] * (1 - r2), length = 1 + r2;
            const float share = fabsf(across - column.share[l]) * fabsf(down - row.share[l]);
            const int32_t nearer =
                stored[l] * length * k.distance[l] > vplMaxf(length, plane) * k.tolerated[l];
            dark[l] += nearer ? share : 0.0f;
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t drawn = (k.back[l] == 0) | backs;
        const float shade = dark[l];
        factor[l] = drawn ? shade : 1.0f;
    }
}
