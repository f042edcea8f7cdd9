// SPDX-License-Identifier: MIT
// The light kernels for a block of 16 points: what all ways of accumulation call, and tests alone.
#ifndef VPL_SHADING_LIGHT_BLOCK_H
#define VPL_SHADING_LIGHT_BLOCK_H

#include <vpl/shading.h>

#include "visibility/blocks.h"

typedef struct vplLightFormula {
    vplLighting lighting;
    float minDistance; // clamp distance, metres; 0: no clamp; physical only
} vplLightFormula;

// Adds lights[0 .. count) to the irradiance of 16 points, one after another.
//   documented: E += L (n.l)+                       (Franchi and Ferrante, no distance, isotropic)
//   physical:   E += I (n.l)+ (m.-l)+ / max(d^2, minDistance^2)   (Keller 1997, clamped)
// l is the unit vector to the light, m the light's normal, minDistance the clamp distance (metres, 0: no
// clamp). A point that coincides with a light receives nothing from it. Distances up to 1e18 m; below 1e-19 m
// the square underflows and the result is between 0 and the clamped value.
void vplAccumulateLights(const vplContext* context, vplLightFormula formula, const vplSurface* surface,
                         const vplShadeLight* lights, int count, float irradiance[3][VPL_LANES]);

#endif
