// SPDX-License-Identifier: MIT
// Instruction sets and kernels. A file named *_kernel.c is compiled once per instruction set. It defines its
// functions through VPL_KERNEL(name), and a table indexed by vplIsa picks a variant at run time.
#ifndef VPL_BASE_ISA_H
#define VPL_BASE_ISA_H

#include <vpl/base.h>

vplIsa vplBestIsa(void);
bool vplHasIsa(vplIsa isa);

#define VPL_JOIN2(a, b) a##_##b
#define VPL_JOIN(a, b)  VPL_JOIN2(a, b)
#ifdef VPL_KERNEL_ISA
#define VPL_KERNEL(name) VPL_JOIN(name, VPL_KERNEL_ISA)
#endif

// Declares the variants of a kernel and defines their table: VPL_KERNEL_TABLE(myTable, MyFcn, myKernel);
// x86-64 has all four variants; other machines have `scalar` and their baseline, which is called sse2.
// VPL_NARROW_KERNEL_TABLE uses the AVX2 variant for AVX-512, too.
#if defined(__x86_64__)
#define VPL_KERNEL_TABLE(table, type, name)                                                                  \
    extern type name##_scalar, name##_sse2, name##_avx2, name##_avx512;                                      \
    static type* const table[VPL_ISA_COUNT] = {name##_sse2, name##_scalar, name##_sse2, name##_avx2,         \
                                               name##_avx512}
#define VPL_NARROW_KERNEL_TABLE(table, type, name)                                                           \
    extern type name##_scalar, name##_sse2, name##_avx2;                                                     \
    static type* const table[VPL_ISA_COUNT] = {name##_sse2, name##_scalar, name##_sse2, name##_avx2,         \
                                               name##_avx2}
#else
#define VPL_KERNEL_TABLE(table, type, name)                                                                  \
    extern type name##_scalar, name##_sse2;                                                                  \
    static type* const table[VPL_ISA_COUNT] = {name##_sse2, name##_scalar, name##_sse2, name##_sse2,         \
                                               name##_sse2}
#define VPL_NARROW_KERNEL_TABLE VPL_KERNEL_TABLE
#endif

#endif
