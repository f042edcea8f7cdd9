// SPDX-License-Identifier: MIT
// Wall-clock and processor time, for statistics only: no result may depend on them.
#ifndef VPL_BASE_CLOCK_H
#define VPL_BASE_CLOCK_H

#include <time.h>

static inline double vplReadClockMs(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static inline double vplClockMs(void)
{
    return vplReadClockMs(CLOCK_MONOTONIC);
}

// Processor time of all threads of the process.
static inline double vplCpuMs(void)
{
    return vplReadClockMs(CLOCK_PROCESS_CPUTIME_ID);
}

#endif
