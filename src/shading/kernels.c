// SPDX-License-Identifier: MIT
#include "shading/kernels.h"

#define TABLE(type, field, function) VPL_KERNEL_TABLE(function##Table, type, function);
#define TABLES(type, field, function)                                                                        \
    VPL_KERNEL_TABLE(function##DocumentedTable, type, function##Documented);                                 \
    VPL_KERNEL_TABLE(function##PhysicalTable, type, function##Physical);
VPL_LIGHTING_KERNELS(TABLES)
VPL_SHADING_KERNELS(TABLE)

vplShadingKernels vplGetShadingKernels(vplIsa isa, vplLighting lighting)
{
#define CHOICE(type, field, function)                                                                        \
    .field =                                                                                                 \
        lighting == VPL_LIGHTING_DOCUMENTED ? function##DocumentedTable[isa] : function##PhysicalTable[isa],
#define ENTRY(type, field, function) .field = function##Table[isa],
    return (vplShadingKernels){VPL_LIGHTING_KERNELS(CHOICE) VPL_SHADING_KERNELS(ENTRY)};
}
