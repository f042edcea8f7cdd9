// SPDX-License-Identifier: MIT
#include "lights/kernels.h"

VPL_KERNEL_TABLE(tables, vplLightsKernels, VPL_LIGHTS_KERNELS);

const vplLightsKernels* vplGetLightsKernels(vplIsa isa)
{
    return &tables[isa];
}
