// SPDX-License-Identifier: MIT
#ifndef VPL_VISIBILITY_SHADOW_H
#define VPL_VISIBILITY_SHADOW_H

#include <vpl/visibility.h>

typedef void vplShadowBiasFcn(const vplShadow* shadow, const float* restrict distance,
                              const float* restrict cosine, float* restrict bias);
typedef void vplShadowFactorFcn(const vplShadow* shadow, const vplSurface* surface, float* restrict factor);

#endif
