// SPDX-License-Identifier: MIT
#include "base/floats.h"

#if defined(__SSE__) || defined(__aarch64__)

#if defined(__SSE__)

#include <xmmintrin.h>

// Source: "MXCSR Control and Status Register" in Intel's Software Developer's Manual, volume 1, section 10.2.3.
enum { PLAIN = 0x1F80, FLAGS = 0x3F };

static uint64_t readControl(void)
{
    return _mm_getcsr();
}

static void writeControl(uint64_t control)
{
    _mm_setcsr((unsigned)control);
}

#else

enum { PLAIN = 0, FLAGS = 0 }; // flags are in another register

static uint64_t readControl(void)
{
    uint64_t control;
    __asm__ volatile("mrs %0, fpcr" : "=r"(control));
    return control;
}

static void writeControl(uint64_t control)
{
    __asm__ volatile("msr fpcr, %0" : : "r"(control));
}

#endif

vplFloats vplFloats_Set(void)
{
    const uint64_t control = readControl();
    const bool changed = (control & ~(uint64_t)FLAGS) != PLAIN;
    if (changed) {
        writeControl(PLAIN);
    }
    return (vplFloats){control, changed};
}

void vplFloats_Restore(const vplFloats* before)
{
    if (before->changed) {
        writeControl(before->control);
    }
}

#else

vplFloats vplFloats_Set(void)
{
    vplFloats before;
    fegetenv(&before.environment);
    fesetenv(FE_DFL_ENV);
    return before;
}

void vplFloats_Restore(const vplFloats* before)
{
    fesetenv(&before->environment);
}

#endif
