// SPDX-License-Identifier: MIT
#include "lights/kernels.h"

#define TABLE(type, field, function) VPL_KERNEL_TABLE(function##Table, type, function);
VPL_LIGHTS_KERNELS(TABLE)

vplLightsKernels vplGetLightsKernels(vplIsa isa)
{
#define ENTRY(type, field, function) .field = function##Table[isa],
    return (vplLightsKernels){VPL_LIGHTS_KERNELS(ENTRY)};
}
