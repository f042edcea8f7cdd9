// SPDX-License-Identifier: MIT
// All kernels of this folder: one list, from which prototypes, table and getter are made.
#ifndef VPL_LIGHTS_KERNELS_H
#define VPL_LIGHTS_KERNELS_H

#include <vpl/lights.h>

#include "base/isa.h"

struct vplViewBlock;

// Light of one virtual light that 16 points reflect, without shadow, as the sum of three channels.
// inverseClamp is 1 / minDistance^2, infinity for no clamp; documented lighting ignores it.
typedef void vplReflectFcn(const struct vplViewBlock* block, const vplShadeLight* light, float inverseClamp,
                           float reflectedOut[VPL_LANES]);

// See vplReflectiveMap_FactorBlock.
typedef void vplReflectiveFactorFcn(const vplReflectiveMap* map, const vplSurface* surface,
                                    float factor[restrict VPL_LANES]);

// X(type, field, function)
#define VPL_LIGHTS_KERNELS(X)                                                                                \
    X(vplReflectFcn, reflectDocumented, vplReflectDocumented)                                                \
    X(vplReflectFcn, reflectPhysical, vplReflectPhysical)                                                    \
    X(vplReflectiveFactorFcn, reflectiveFactor, vplReflectiveFactor)

typedef struct vplLightsKernels {
    VPL_LIGHTS_KERNELS(VPL_KERNEL_FIELD)
} vplLightsKernels;

const vplLightsKernels* vplGetLightsKernels(vplIsa isa);

#ifdef VPL_KERNEL_ISA
VPL_LIGHTS_KERNELS(VPL_KERNEL_PROTOTYPE)
#endif

#endif
