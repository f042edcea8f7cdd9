// SPDX-License-Identifier: MIT
// Normals of a block, for kernels.
#ifndef VPL_SHADING_NORMALS_H
#define VPL_SHADING_NORMALS_H

#include "shading/shading.h"

#include <math.h>

static inline void vplSetNormals(vplVec3 n, vplSurface* surface)
{
    for (int l = 0; l < VPL_LANES; l++) {
        surface->nx[l] = n.x;
        surface->ny[l] = n.y;
        surface->nz[l] = n.z;
    }
}

// Turns raw interpolated normals into unit vectors on their triangle's side. Lanes that are not smooth, or where
// nothing is left of the interpolated normal, get the triangle's.
static inline void vplFinishNormals(const vplSurface* restrict plane,
                                    const int32_t smooth[restrict VPL_LANES], vplSurface* restrict surface)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = surface->nx[l], y = surface->ny[l], z = surface->nz[l];
        const float px = plane->nx[l], py = plane->ny[l], pz = plane->nz[l];
        const float length = sqrtf(x * x + y * y + z * z);
        const bool usable = smooth[l] && length > 0;
        const float scale = (x * px + y * py + z * pz < 0 ? -1.0f : 1.0f) / (usable ? length : 1);
        surface->nx[l] = usable ? scale * x : px;
        surface->ny[l] = usable ? scale * y : py;
        surface->nz[l] = usable ? scale * z : pz;
    }
}

#endif
