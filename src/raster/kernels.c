// SPDX-License-Identifier: MIT
#include "raster/kernels.h"

#define ENTRY(type, field, function, isa) .field = VPL_JOIN(function, isa),
#define TABLE(isa)                                                                                           \
    {                                                                                                        \
        VPL_RASTER_KERNELS(ENTRY, isa)                                                                       \
    }

VPL_RASTER_KERNELS(VPL_PROTOTYPE, scalar)
VPL_RASTER_KERNELS(VPL_PROTOTYPE, sse2)
#if defined(__x86_64__)
VPL_RASTER_KERNELS(VPL_PROTOTYPE, avx2)
VPL_RASTER_KERNELS(VPL_PROTOTYPE, avx512)
#endif

const vplRasterKernels* vplRasterKernels_Get(vplIsa isa)
{
    static const vplRasterKernels tables[VPL_ISA_COUNT] = {
        [VPL_ISA_AUTO] = TABLE(sse2),
        [VPL_ISA_SCALAR] = TABLE(scalar),
        [VPL_ISA_SSE2] = TABLE(sse2),
#if defined(__x86_64__)
        [VPL_ISA_AVX2] = TABLE(avx2),
        [VPL_ISA_AVX512] = TABLE(avx512),
#else
        [VPL_ISA_AVX2] = TABLE(sse2),
        [VPL_ISA_AVX512] = TABLE(sse2),
#endif
    };
    return &tables[isa];
}
