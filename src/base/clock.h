// SPDX-License-Identifier: MIT
// Time for statistics: of the wall clock and of the processors. Never for results.
#ifndef VPL_BASE_CLOCK_H
#define VPL_BASE_CLOCK_H

#include <time.h>

static inline double vplClockMs(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

// Processor time of all threads of the process.
static inline double vplCpuMs(void)
{
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

#endif
