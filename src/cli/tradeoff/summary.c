// SPDX-License-Identifier: MIT
// Summaries of runs: medians, bands, the front, the cheapest setting for an error, and a family's floor.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <string.h>

// Each point of the front lowers the error by at least this share. Less may be chance, and crowds the plot.
static const double FRONT_GAIN = 0.03;

// Returns the median over the seeds of the double at an offset in Run, and its range.
static double band(const Setting* s, size_t offset, double* low, double* high)
{
    double values[64]; // --seeds takes no more
    *low = INFINITY;
    *high = -INFINITY;
    for (int k = 0; k < s->runCount; k++) {
        memcpy(&values[k], (const char*)&s->runs[k] + offset, sizeof values[k]);
        *low = fmin(*low, values[k]);
        *high = fmax(*high, values[k]);
    }
    return medianOf(values, s->runCount);
}

void summarise(Tradeoff* t)
{
    double cost[MAX_SETTINGS] = {0}, error[MAX_SETTINGS] = {0};
    int numbers[MAX_SETTINGS];
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        double low, high;
        s->error = band(s, offsetof(Run, error), &s->errorLow, &s->errorHigh);
        s->cpuMs = band(s, offsetof(Run, stats.cpuMs), &s->cpuLow, &s->cpuHigh);
        s->wallMs = band(s, offsetof(Run, stats.totalMs), &low, &high);
        s->energy = band(s, offsetof(Run, comparison.energyRatio), &low, &high);
        cost[i] = isMeasuredOf(s, FAMILY_COUNT) ? s->cpuMs : NAN;
        error[i] = s->error;
    }
    numberFront(cost, error, t->settingCount, FRONT_GAIN, numbers);
    for (int i = 0; i < t->settingCount; i++) {
        t->settings[i].number = numbers[i];
    }
}

int findCheapest(const Tradeoff* t, Family family, double limit)
{
    double cost[MAX_SETTINGS], error[MAX_SETTINGS];
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        cost[i] = s->cpuMs;
        error[i] = isMeasuredOf(s, family) ? s->error : NAN;
    }
    return cheapestWithin(cost, error, t->settingCount, limit);
}

double overFront(const Tradeoff* t, const Setting* s)
{
    const int found = findCheapest(t, FAMILY_COUNT, s->error);
    return found >= 0 ? s->cpuMs / t->settings[found].cpuMs : NAN;
}

int listFront(const Tradeoff* t, const Setting* front[MAX_SETTINGS])
{
    int count = 0;
    for (int i = 0; i < t->settingCount; i++) {
        if (t->settings[i].number > 0) {
            front[t->settings[i].number - 1] = &t->settings[i];
            count++;
        }
    }
    return count;
}

double findFloor(const Tradeoff* t, Family family)
{
    double work[MAX_SETTINGS], error[MAX_SETTINGS];
    int count = 0;
    for (int i = 0; i < t->settingCount; i++) { // particle counts ascend
        const Setting* s = &t->settings[i];
        // The first rows of SWEEPS vary the particles without shadows, with maps, with rays and of Keller's
        // method: they are in the order of the families.
        if (isMeasured(s) && s->family == family && s->sweeps[family - FAMILY_UNSHADOWED]) {
            work[count] = s->work;
            error[count++] = s->error;
        }
    }
    return floorOf(work, error, count);
}
