// SPDX-License-Identifier: MIT
// The shadow factor of 16 fragments by a hemi-octahedral map. Compiled once per instruction set; all give the
// same bits.
//
// The texel's 1/t along its centre is compared with the fragment's own plane there, and with the fragment
// itself, whichever is nearer: a plane never shadows itself at any angle.
#include "math/scalar.h"
#include "visibility/kernels.h"
#include "visibility/map_gather.h"
#include "visibility/hemi_map.h"

void VPL_KERNEL(vplHemiMapFactor)(const vplHemiMap* map, const vplSurface* surface,
                                  float factor[restrict VPL_LANES])
{
    const vplVec3 o = map->position, r = map->right, u = map->up, f = map->forward;
    const int32_t size = map->size, blocks = vplHemiMap_Blocks(size);
    const float last = (float)(size - 1), half = 0.5f * (float)size, scale = 1 / (float)size;
    const float tolerated = 1 + vplHemiMap_Tolerance(size);
    float limit[VPL_LANES], stored[VPL_LANES];
    int32_t place[VPL_LANES], lit[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float dx = surface->px[l] - o.x, dy = surface->py[l] - o.y, dz = surface->pz[l] - o.z;
        const float mx = surface->nx[l], my = surface->ny[l], mz = surface->nz[l];
        const float x = dx * r.x + dy * r.y + dz * r.z, y = dx * u.x + dy * u.y + dz * u.z;
        const float z = dx * f.x + dy * f.y + dz * f.z;
        const float facing = dx * mx + dy * my + dz * mz;
        const float inverse = 1 / vplMaxf(fabsf(x) + fabsf(y) + fabsf(z), 1e-30f);
        // The maximum makes 0 of NaN.
        const int32_t column = (int32_t)vplMinf(vplMaxf(((x + y) * inverse + 1) * half, 0), last),
                      row = (int32_t)vplMinf(vplMaxf(((x - y) * inverse + 1) * half, 0), last);
        place[l] = vplHemiMap_Place(blocks, column, row);
        // The texel's centre, and 1/t of the fragment's plane there.
        const float cu = (float)(2 * column + 1) * scale - 1, cv = (float)(2 * row + 1) * scale - 1;
        const float cx = 0.5f * (cu + cv), cy = 0.5f * (cu - cv), cz = 1 - fabsf(cx) - fabsf(cy);
        const float nx = mx * r.x + my * r.y + mz * r.z, ny = mx * u.x + my * u.y + mz * u.z;
        const float nz = mx * f.x + my * f.y + mz * f.z;
        const float plane = (nx * cx + ny * cy + nz * cz) / (facing < 0 ? facing : -1e-30f);
        limit[l] = vplMaxf(inverse, plane) * tolerated;
        lit[l] = (facing < 0) & (z > 0);
    }
    vplGather(map->texels, place, stored);
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t seen = lit[l] & !(stored[l] > limit[l]);
        factor[l] = seen ? 0.0f : 1.0f;
    }
}
