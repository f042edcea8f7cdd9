// SPDX-License-Identifier: MIT
// Shadow factors of 16 points at once. The functions of one point in <vpl/visibility.h> are the same for a block of equal
// points.
#ifndef VPL_VISIBILITY_BLOCKS_H
#define VPL_VISIBILITY_BLOCKS_H

#include <vpl/visibility.h>

// The positions, in metres, and unit normals of a block of points.
typedef struct vplSurface {
    float px[VPL_LANES], py[VPL_LANES], pz[VPL_LANES];
    float nx[VPL_LANES], ny[VPL_LANES], nz[VPL_LANES];
} vplSurface;

// The same point in all lanes.
static inline vplSurface vplSurface_OfPoint(vplVec3 position, vplVec3 normal)
{
    vplSurface surface;
    for (int l = 0; l < VPL_LANES; l++) {
        surface.px[l] = position.x;
        surface.py[l] = position.y;
        surface.pz[l] = position.z;
        surface.nx[l] = normal.x;
        surface.ny[l] = normal.y;
        surface.nz[l] = normal.z;
    }
    return surface;
}

// See vplShadow_Factor, vplHemiMap_Factor and vplParaboloidMap_Factor.
void vplShadow_FactorBlock(const vplShadow* shadow, const vplSurface* surface, float factorOut[VPL_LANES]);
void vplHemiMap_FactorBlock(const vplHemiMap* map, const vplSurface* surface, float factorOut[VPL_LANES]);
void vplParaboloidMap_FactorBlock(const vplParaboloidMap* map, const vplSurface* surface,
                                  float factorOut[VPL_LANES]);

#endif
