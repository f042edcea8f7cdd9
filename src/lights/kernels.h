// SPDX-License-Identifier: MIT
// All kernels of this folder: one list, from which prototypes, table and getter are made.
#ifndef VPL_LIGHTS_KERNELS_H
#define VPL_LIGHTS_KERNELS_H

#include <vpl/lights.h>

#include "visibility/blocks.h"

#include "base/isa.h"

struct vplViewBlock;

// Light of one virtual light that 16 points reflect, without shadow, as the sum of three channels.
// inverseClamp is 1 / minDistance^2, infinity for no clamp; documented lighting ignores it.
typedef void vplReflectFcn(const struct vplViewBlock* block, const vplShadeLight* light, float inverseClamp,
                           float reflectedOut[VPL_LANES]);

// Tolerance of vplReflectiveMap_Factor, in sides of a texel: something that is nearer to the emitter than
// a point and its plane by less than that does not shadow it. This removes acne where walls meet in a corner;
// more hides real shadows. In Sponza 0.36 % of the lit pixels are dark in the map only, 0.53 % by rays only;
// 0.68 and 0.46 % without tolerance (bench/rsm).
#define VPL_REFLECTIVE_TOLERANCE 0.5f

// See vplReflectiveMap_Factor.
void vplReflectiveMap_FactorBlock(const vplReflectiveMap* map, const vplSurface* surface,
                                  float factorOut[VPL_LANES]);
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
