// SPDX-License-Identifier: MIT
// The series of vpl bench --scaling.
#ifndef VPL_CLI_BENCH_SERIES_H
#define VPL_CLI_BENCH_SERIES_H

#include "cli/bench/bench.h"

enum { MAX_POINTS = 16 };

typedef struct Series Series;

// One series at work.
typedef struct Sweep {
    const Arguments* arguments;
    const Series* series;
    Bench bench;
    double n[MAX_POINTS]; // what is varied
    int points;
    vplScene* scenes[MAX_POINTS]; // each series uses one of these
    vplGeometry* geometries[MAX_POINTS];
    vplImage* images[MAX_POINTS];
    Bench benches[MAX_POINTS];
} Sweep;

struct Series {
    const char* name;
    const char* unit; // what n counts
    double expected;  // exponent of n in the time
    const char* why;
    double least, most;                        // n goes from one to the other...
    double factor;                             // ...in such steps
    vplResult (*prepare)(Sweep* s, int point); // NULL: nothing to do; may replace n by what it really is
    vplResult (*run)(Sweep* s, int point);
};

extern const Series SERIES[];
extern const int SERIES_COUNT;

#endif
