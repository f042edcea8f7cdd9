// SPDX-License-Identifier: MIT
#include "raster/kernels.h"

VPL_KERNEL_TABLE(tables, vplRasterKernels, VPL_RASTER_KERNELS);

const vplRasterKernels* vplRasterKernels_Get(vplIsa isa)
{
    return &tables[isa];
}
