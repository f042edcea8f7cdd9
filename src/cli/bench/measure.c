// SPDX-License-Identifier: MIT
#include "cli/bench/measure.h"

#include <math.h>
#include <stdlib.h>
#include <time.h>

static double readClock(clockid_t clock)
{
    struct timespec t;
    clock_gettime(clock, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

double wallMs(void)
{
    return readClock(CLOCK_MONOTONIC);
}

double cpuMs(void)
{
    return readClock(CLOCK_PROCESS_CPUTIME_ID);
}

// The value of a given rank. Counting is quadratic, which a few dozen runs do not notice.
static double ofRank(const double* values, int count, int rank)
{
    for (int i = 0; i < count; i++) {
        int below = 0, equal = 0;
        for (int j = 0; j < count; j++) {
            below += values[j] < values[i];
            equal += values[j] == values[i];
        }
        if (below <= rank && rank < below + equal) {
            return values[i];
        }
    }
    return NAN;
}

double medianOf(const double* values, int count)
{
    if (count == 0) {
        return NAN;
    }
    const double upper = ofRank(values, count, count / 2);
    return count % 2 ? upper : 0.5 * (ofRank(values, count, count / 2 - 1) + upper);
}

static vplResult runOnce(const Measurement* c, int way, double* wall, double* cpu)
{
    nanosleep(&(struct timespec){0, 10000000}, NULL); // libgomp's threads spin for some milliseconds
    *cpu = cpuMs();
    *wall = wallMs();
    const vplResult result = c->run(c->user, way);
    *wall = wallMs() - *wall;
    *cpu = cpuMs() - *cpu;
    return result;
}

vplResult measureInTurn(const Measurement* c, Times* mediansOut, int* runsOut)
{
    enum { LEAST_RUNS = 3 };
    double(*wall)[MAX_RUNS] = calloc((size_t)c->ways, sizeof *wall);
    double(*cpu)[MAX_RUNS] = calloc((size_t)c->ways, sizeof *cpu);
    vplResult result = wall != NULL && cpu != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    double spent = 0;
    int runs = 0;
    for (bool first = true; runs < c->runs && result == VPL_SUCCESS; first = false) {
        double longest = 0;
        if (c->seconds > 0 && spent > 1e3 * c->seconds && runs >= LEAST_RUNS) {
            break;
        }
        for (int way = 0; way < c->ways && result == VPL_SUCCESS; way++) {
            result = runOnce(c, way, &wall[way][runs], &cpu[way][runs]);
            spent += wall[way][runs];
            longest = fmax(longest, wall[way][runs]);
        }
        runs += !first || longest > 1e3 * c->warmUp;
    }
    for (int way = 0; way < c->ways && result == VPL_SUCCESS; way++) {
        mediansOut[way] = (Times){medianOf(wall[way], runs), medianOf(cpu[way], runs)};
    }
    if (runsOut != NULL) {
        *runsOut = runs;
    }
    free(wall);
    free(cpu);
    return result;
}
