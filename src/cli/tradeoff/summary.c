// SPDX-License-Identifier: MIT
// From runs to medians, bands, the front, the cheapest setting for an error, and the floor of a family.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>

static double field(const Run* run, int which)
{
    switch (which) {
    case 0:
        return run->error;
    case 1:
        return run->stats.cpuMs;
    case 2:
        return run->stats.totalMs;
    default:
        return run->comparison.energyRatio;
    }
}

// A numbered point of the plot takes at least this share off the error: less is chance, and crowds.
static const double FRONT_GAIN = 0.03;

// The median of a figure over the seeds, and the least and the most.
static double band(const Setting* s, int which, double* low, double* high)
{
    double values[64]; // --seeds takes no more
    *low = INFINITY;
    *high = -INFINITY;
    for (int k = 0; k < s->runCount; k++) {
        values[k] = field(&s->runs[k], which);
        *low = fmin(*low, values[k]);
        *high = fmax(*high, values[k]);
    }
    return medianOf(values, s->runCount);
}

void summarise(Tradeoff* t)
{
    double cost[MAX_SETTINGS], error[MAX_SETTINGS];
    bool onFront[MAX_SETTINGS];
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        double low, high;
        s->error = band(s, 0, &s->errorLow, &s->errorHigh);
        s->cpuMs = band(s, 1, &s->cpuLow, &s->cpuHigh);
        s->wallMs = band(s, 2, &low, &high);
        s->energy = band(s, 3, &low, &high);
        cost[i] = s->cpuMs;
        error[i] = s->error;
    }
    markFront(cost, error, t->settingCount, FRONT_GAIN, onFront);
    for (int i = 0; i < t->settingCount; i++) {
        t->settings[i].onFront = onFront[i];
    }
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        s->number = 1;
        for (int j = 0; j < t->settingCount; j++) {
            s->number += onFront[j] && cost[j] < cost[i];
        }
    }
}

int findCheapest(const Tradeoff* t, Family family, double limit)
{
    double cost[MAX_SETTINGS], error[MAX_SETTINGS];
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        bool counts = isMeasured(s) && (family == FAMILY_COUNT || s->family == family);
        cost[i] = s->cpuMs;
        error[i] = counts ? s->error : NAN;
    }
    return cheapestWithin(cost, error, t->settingCount, limit);
}

int listFront(const Tradeoff* t, const Setting* front[MAX_SETTINGS])
{
    int count = 0;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        if (s->onFront) {
            int at = count++;
            for (; at > 0 && front[at - 1]->number > s->number; at--) {
                front[at] = front[at - 1];
            }
            front[at] = s;
        }
    }
    return count;
}

double findFloor(const Tradeoff* t, Family family)
{
    double work[MAX_SETTINGS], error[MAX_SETTINGS];
    int count = 0;
    for (int i = 0; i < t->settingCount; i++) { // particles stand in ascending order
        const Setting* s = &t->settings[i];
        // The first rows of SWEEPS are particles for none, map, ray and Keller, in the order of the families.
        if (isMeasured(s) && s->family == family && (s->sweeps >> (family - FAMILY_UNSHADOWED) & 1) != 0) {
            work[count] = s->work;
            error[count++] = s->error;
        }
    }
    return floorOf(work, error, count);
}
