// SPDX-License-Identifier: MIT
#include "visibility/kernels.h"

VPL_KERNEL_TABLE(tables, vplVisibilityKernels, VPL_VISIBILITY_KERNELS);

const vplVisibilityKernels* vplVisibilityKernels_Get(vplIsa isa)
{
    return &tables[isa];
}
