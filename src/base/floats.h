// SPDX-License-Identifier: MIT
// The floating-point environment: the rounding mode, whether denormals are flushed to zero, and which exceptions trap. Programs change it:
// those with Embree flush denormals, and some trap on a division by zero. The library's bits must not depend on it, and it divides by zero on
// purpose.
#ifndef VPL_BASE_FLOATS_H
#define VPL_BASE_FLOATS_H

#include <stdbool.h>
#include <stdint.h>

#if !defined(__SSE__) && !defined(__aarch64__)
#include <fenv.h>
#endif

typedef struct vplFloats {
#if defined(__SSE__) || defined(__aarch64__)
    uint64_t control; // the register MXCSR, or FPCR
    bool changed;     // it was not the default
#else
    fenv_t environment;
#endif
} vplFloats;

// Sets the default environment in this thread: rounding to nearest, denormals kept, no traps. Returns the environment before.
vplFloats vplFloats_Set(void);
void vplFloats_Restore(const vplFloats* before);

// Sets the default environment until the enclosing block ends.
#define PLAIN_FLOATS                                                                                         \
    const vplFloats floatsBefore __attribute__((cleanup(vplFloats_Restore))) = vplFloats_Set()

#endif
