// SPDX-License-Identifier: MIT
#include "shading/kernels.h"

VPL_KERNEL_TABLE(documented, vplShadingKernels, VPL_DOCUMENTED_KERNELS);
VPL_KERNEL_TABLE(physical, vplShadingKernels, VPL_PHYSICAL_KERNELS);

const vplShadingKernels* vplGetShadingKernels(vplIsa isa, vplLighting lighting)
{
    return lighting == VPL_LIGHTING_DOCUMENTED ? &documented[isa] : &physical[isa];
}
