// SPDX-License-Identifier: MIT
#include "radiosity/radiosity_kernels.h"

VPL_KERNEL_TABLE(tables, vplRadiosityKernels, VPL_RADIOSITY_KERNELS);

const vplRadiosityKernels* vplGetRadiosityKernels(vplIsa isa)
{
    return &tables[isa];
}
