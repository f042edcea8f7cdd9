// SPDX-License-Identifier: MIT
// The floating-point environment: rounding, denormals and traps. Programs change it: those with Embree flush denormals to zero, some trap
// divisions by zero. Bits must not depend on it, and 1/0 is no mistake here.
#ifndef VPL_BASE_FLOATS_H
#define VPL_BASE_FLOATS_H

#include <stdbool.h>
#include <stdint.h>

#if !defined(__SSE__) && !defined(__aarch64__)
#include <fenv.h>
#endif

typedef struct vplFloats {
#if defined(__SSE__) || defined(__aarch64__)
    uint64_t control; // MXCSR or FPCR
#else
    fenv_t environment;
#endif
    bool changed;
} vplFloats;

// Rounds to the nearest, keeps denormals and masks traps in this thread. Returns what was before.
vplFloats vplFloats_Set(void);
void vplFloats_Restore(const vplFloats* before);

// Does so until the enclosing block ends.
#define PLAIN_FLOATS                                                                                         \
    const vplFloats floatsBefore __attribute__((cleanup(vplFloats_Restore))) = vplFloats_Set()

#endif
