// SPDX-License-Identifier: MIT
// Measuring in vpl bench and the programs of tests/bench: clocks, medians, and runs of several ways in turn.
#ifndef VPL_CLI_BENCH_MEASURE_H
#define VPL_CLI_BENCH_MEASURE_H

#include <vpl/base.h>

enum { MAX_RUNS = 1000 };

// Milliseconds of a clock that never goes back.
double wallMs(void);

// Milliseconds of processor time of all threads.
double cpuMs(void);

// The middle value, or the mean of the two middle ones; NAN of none. `values` may be in any order.
double medianOf(const double* values, int count);

// Times of one run, or medians over several runs; ms.
typedef struct Times {
    double wall, cpu;
} Times;

// Ways of doing something, measured in turn so that a machine that slows down slows all of them.
typedef struct Measurement {
    vplResult (*run)(void* user, int way);
    void* user;
    int ways, runs;
    double seconds; // no more runs after so much wall-clock time, but three at least; 0: no limit
    double warmUp;  // seconds: the first run of all ways does not count if none takes longer; 0: it counts
} Measurement;

// Writes the medians of each way. runsOut, the number of runs that counted, may be NULL. Pauses before each
// run, so that threads which still spin after the last one go to sleep.
vplResult measureInTurn(const Measurement* measurement, Times* mediansOut, int* runsOut);

#endif
