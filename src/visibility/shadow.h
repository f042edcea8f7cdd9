// SPDX-License-Identifier: MIT
#ifndef VPL_VISIBILITY_SHADOW_H
#define VPL_VISIBILITY_SHADOW_H

#include <vpl/visibility.h>

// vplShadow_FactorBlock. Returns how many of the points the map's bounds decided, without samples.
int vplShadow_FactorBlockCounted(const vplShadow* shadow, const vplSurface* surface,
                                 float factorOut[VPL_LANES]);

#endif
