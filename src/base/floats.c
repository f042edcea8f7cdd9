// SPDX-License-Identifier: MIT
#include "base/floats.h"

#if defined(__SSE__)

#include <xmmintrin.h>

// Sources: "MXCSR Control and Status Register" in Intel's Software Developer's Manual, volume 1, section 10.2.3.
enum { PLAIN = 0x1F80, FLAGS = 0x3F };

vplFloats vplFloats_Set(void)
{
    const unsigned control = _mm_getcsr();
    const bool changed = (control & ~(unsigned)FLAGS) != PLAIN;
    if (changed) {
        _mm_setcsr(PLAIN);
    }
    return (vplFloats){control, changed};
}

void vplFloats_Restore(const vplFloats* before)
{
    if (before->changed) {
        _mm_setcsr((unsigned)before->control);
    }
}

#elif defined(__aarch64__)

vplFloats vplFloats_Set(void)
{
    vplFloats before;
    __asm__ volatile("mrs %0, fpcr" : "=r"(before.control));
    before.changed = before.control != 0;
    if (before.changed) {
        __asm__ volatile("msr fpcr, %0" : : "r"((uint64_t)0));
    }
    return before;
}

void vplFloats_Restore(const vplFloats* before)
{
    if (before->changed) {
        __asm__ volatile("msr fpcr, %0" : : "r"(before->control));
    }
}

#else

vplFloats vplFloats_Set(void)
{
    vplFloats before = {.changed = true};
    fegetenv(&before.environment);
    fesetenv(FE_DFL_ENV);
    return before;
}

void vplFloats_Restore(const vplFloats* before)
{
    fesetenv(&before->environment);
}

#endif
