// SPDX-License-Identifier: MIT
#ifndef VPL_VISIBILITY_SHADOW_H
#define VPL_VISIBILITY_SHADOW_H

#include <vpl/visibility.h>

typedef void vplShadowBiasFcn(const vplShadow* shadow, const float* restrict distance,
                              const float* restrict cosine, float* restrict bias);
// Returns how many points needed no samples.
typedef int vplShadowFactorFcn(const vplShadow* shadow, const vplSurface* surface, float* restrict factor);

// 16 points as the light sees them.
typedef struct vplShadowPoints {
    float x[VPL_LANES], y[VPL_LANES], z[VPL_LANES]; // from the light
    float inverse[VPL_LANES];                       // 1 / distance
    int32_t face[VPL_LANES]; // that all samples fall on; negative where they may differ
    float limit[VPL_LANES];  // distance less bias: a sample nearer than this shadows
} vplShadowPoints;

// Sets faces, known where the map's bounds tell what all samples say, and shadowed to how many lie in shadow there.
// Returns how many are known.
typedef int vplShadowWindowFcn(const vplShadow* shadow, vplShadowPoints* restrict points,
                               int32_t known[restrict VPL_LANES], float shadowed[restrict VPL_LANES]);

// vplShadow_FactorBlock, and how many of the points needed no samples.
int vplShadow_FactorBlockTold(const vplShadow* shadow, const vplSurface* surface, float factorOut[VPL_LANES]);

#endif
