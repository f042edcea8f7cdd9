// SPDX-License-Identifier: MIT
#include "radiosity/radiosity_kernels.h"

// The Makefile compiles four instruction sets for x86-64; other machines have `scalar` and their baseline,
// `sse2`.
#define DECLARE(field, Name) extern vpl##Name##Fcn vpl##Name##_scalar, vpl##Name##_sse2;
#define SCALAR(field, Name)  .field = vpl##Name##_scalar,
#define SSE2(field, Name)    .field = vpl##Name##_sse2,
#if defined(__x86_64__)
#define DECLARE_WIDE(field, Name) extern vpl##Name##Fcn vpl##Name##_avx2, vpl##Name##_avx512;
#define AVX2(field, Name)         .field = vpl##Name##_avx2,
#define AVX512(field, Name)       .field = vpl##Name##_avx512,
VPL_RADIOSITY_KERNELS(DECLARE_WIDE)
#else
#define AVX2   SSE2
#define AVX512 SSE2
#endif
VPL_RADIOSITY_KERNELS(DECLARE)

const vplRadiosityKernels* vplGetRadiosityKernels(vplIsa isa)
{
    static const vplRadiosityKernels kernels[VPL_ISA_COUNT] = {
        [VPL_ISA_AUTO] = {VPL_RADIOSITY_KERNELS(SSE2)},
        [VPL_ISA_SCALAR] = {VPL_RADIOSITY_KERNELS(SCALAR)},
        [VPL_ISA_SSE2] = {VPL_RADIOSITY_KERNELS(SSE2)},
        [VPL_ISA_AVX2] = {VPL_RADIOSITY_KERNELS(AVX2)},
        [VPL_ISA_AVX512] = {VPL_RADIOSITY_KERNELS(AVX512)},
    };
    return &kernels[isa];
}
