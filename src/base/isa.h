// SPDX-License-Identifier: MIT
// Instruction sets and kernels. A file named *_kernel.c is compiled once per instruction set and defines its
// functions through VPL_KERNEL(name). A folder lists its kernels once, as X(type, field, function), and makes
// from that list the struct of its kernels, their prototypes, and a table from which a vplIsa picks at run time.
#ifndef VPL_BASE_ISA_H
#define VPL_BASE_ISA_H

#include <vpl/machine.h>

vplIsa vplBestIsa(void);
bool vplHasIsa(vplIsa isa);

#define VPL_JOIN2(a, b) a##_##b
#define VPL_JOIN(a, b)  VPL_JOIN2(a, b)
#ifdef VPL_KERNEL_ISA
#define VPL_KERNEL(name) VPL_JOIN(name, VPL_KERNEL_ISA)
#endif

// The members of the struct of kernels.
#define VPL_KERNEL_FIELD(type, field, function) type* field;

// In *_kernel.c: the prototypes of this instruction set.
#define VPL_KERNEL_PROTOTYPE(type, field, function) type VPL_KERNEL(function);

// x86-64 has all four variants; other machines have `scalar` and their baseline, which is called sse2.
#define VPL_KERNEL_DECLARE(type, field, function)                                                            \
    type function##_scalar, function##_sse2, function##_avx2, function##_avx512;
#define VPL_KERNEL_SCALAR(type, field, function) .field = function##_scalar,
#define VPL_KERNEL_SSE2(type, field, function)   .field = function##_sse2,
#ifdef VPL_WIDE // the Makefile defines it where it compiles AVX2 and AVX-512
#define VPL_KERNEL_AVX2(type, field, function)   .field = function##_avx2,
#define VPL_KERNEL_AVX512(type, field, function) .field = function##_avx512,
#else
#define VPL_KERNEL_AVX2   VPL_KERNEL_SSE2
#define VPL_KERNEL_AVX512 VPL_KERNEL_SSE2
#endif

// Defines `table`, an array of `Kernels` indexed by vplIsa.
#define VPL_KERNEL_TABLE(table, Kernels, LIST)                                                               \
    LIST(VPL_KERNEL_DECLARE)                                                                                 \
    static const Kernels table[VPL_ISA_COUNT] = {                                                            \
        [VPL_ISA_AUTO] = {LIST(VPL_KERNEL_SSE2)},     [VPL_ISA_SCALAR] = {LIST(VPL_KERNEL_SCALAR)},          \
        [VPL_ISA_SSE2] = {LIST(VPL_KERNEL_SSE2)},     [VPL_ISA_AVX2] = {LIST(VPL_KERNEL_AVX2)},              \
        [VPL_ISA_AVX512] = {LIST(VPL_KERNEL_AVX512)},                                                        \
    }

#endif
