// SPDX-License-Identifier: MIT
#include "cli/tradeoff/math.h"

#include <math.h>
#include <stdio.h>

// The next point by cost, then by error, then by index, whose error is below the limit; -1: none.
static int nextOnFront(const double* cost, const double* error, int count, double limit)
{
    int next = -1;
    for (int i = 0; i < count; i++) {
        bool counts = !isnan(cost[i]) && error[i] < limit;
        if (counts &&
            (next < 0 || cost[i] < cost[next] || (cost[i] == cost[next] && error[i] < error[next]))) {
            next = i;
        }
    }
    return next;
}

// Points cheaper than a numbered one have errors above the limit, or they would have been numbered first.
int numberFront(const double* cost, const double* error, int count, double gain, int* numbers)
{
    int found = 0;
    for (int i = 0; i < count; i++) {
        numbers[i] = 0;
    }
    double limit = INFINITY;
    for (int i = nextOnFront(cost, error, count, limit); i >= 0; i = nextOnFront(cost, error, count, limit)) {
        numbers[i] = ++found;
        limit = (1 - gain) * error[i];
    }
    return found;
}

int cheapestWithin(const double* cost, const double* error, int count, double limit)
{
    int best = -1;
    for (int i = 0; i < count; i++) {
        if (error[i] <= limit && (best < 0 || cost[i] < cost[best])) {
            best = i;
        }
    }
    return best;
}

double costPerHalving(double cost0, double error0, double cost1, double error1)
{
    if (!(error1 < error0)) {
        return INFINITY;
    }
    return (cost1 - cost0) / log2(error0 / error1); // an error of 0 is infinitely many halvings
}

double floorOf(const double* work, const double* error, int count)
{
    int before = count - 2;
    while (before >= 0 && work[before] * 8 > work[count - 1]) {
        before--;
    }
    return before >= 0 && error[count - 1] > 0.8 * error[before] ? error[count - 1] : NAN;
}

// The number of points with x <= at.
static int countUpTo(const double* x, int count, double at)
{
    int below = 0;
    while (below < count && x[below] <= at) {
        below++;
    }
    return below;
}

static double between(double x0, double y0, double x1, double y1, double at)
{
    return x1 > x0 ? y0 + (y1 - y0) * (at - x0) / (x1 - x0) : y0;
}

double alongLine(const double* x, const double* y, int count, double at)
{
    const int below = countUpTo(x, count, at), last = count - 1;
    if (count == 1) {
        return y[0] * at / x[0];
    }
    if (below == 0) {
        return fmin(y[0], fmax(between(x[0], y[0], x[last], y[last], at), y[0] * at / x[0]));
    }
    if (below < count) {
        return between(x[below - 1], y[below - 1], x[below], y[below], at);
    }
    int before = last - 1;
    while (before > 0 && 3 * x[before] > x[last]) {
        before--;
    }
    const double least = y[last] * (1 + 0.1 * (at / x[last] - 1));
    return fmax(between(x[before], y[before], x[last], y[last], at), least);
}

double alongPower(const double* x, const double* y, int count, double at)
{
    const int below = countUpTo(x, count, at), last = count - 1;
    if (below > 0 && below < count) {
        const double share = log(at / x[below - 1]) / log(x[below] / x[below - 1]);
        return y[below - 1] * pow(y[below] / y[below - 1], share);
    }
    if (below == 0) {
        return y[0] * sqrt(x[0] / at);
    }
    int before = last;
    while (before >= 0 && 8 * x[before] > x[last]) {
        before--;
    }
    double power = before >= 0 ? log(y[last] / y[before]) / log(x[last] / x[before]) : -0.5;
    power = fmin(fmax(power, -0.7), 0);
    return y[last] * pow(at / x[last], power);
}

double leastWithin(const double* cost, const double* error, int count, double most)
{
    double least = INFINITY;
    for (int i = 0; i < count; i++) {
        least = cost[i] <= most && error[i] < least ? error[i] : least;
    }
    return least;
}

bool logRange(const double* values, int count, double* low, double* high)
{
    double least = INFINITY, most = 0;
    for (int i = 0; i < count; i++) {
        if (values[i] > 0 && isfinite(values[i])) {
            least = fmin(least, values[i]);
            most = fmax(most, values[i]);
        }
    }
    if (most == 0) {
        return false;
    }
    const double room = 1.2589254117941673; // a tenth of a decade
    least /= room;
    most *= room;
    double widen = most < 10 * least ? sqrt(10 * least / most) : 1;
    *low = least / widen;
    *high = most * widen;
    return true;
}

int logTicks(double low, double high, double* ticks, int most)
{
    static const double steps[] = {1, 2, 5};
    int count = 0, stride = high / low > 1e4 ? 3 : 1;
    double decade = pow(10, floor(log10(low)));
    for (int i = 0; decade * steps[i % 3] <= high && count < most; i += stride) {
        if (i % 3 == 0 && i > 0) {
            decade *= 10;
        }
        double tick = decade * steps[i % 3];
        if (tick >= low && tick <= high) {
            ticks[count++] = tick;
        }
    }
    return count;
}

double jointSquare(const float* x, const float* a, const float* b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        sum += ((double)x[i] - (double)a[i]) * ((double)x[i] - (double)b[i]);
    }
    return sum / (double)count;
}

double jointUncertainty(const float* a, const float* b, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double square = ((double)a[i] - (double)b[i]) * ((double)a[i] - (double)b[i]);
        sum += square * square;
    }
    return sqrt(sum / 12) / (double)count;
}

// Two digits below 10 ms, three below 100 s: measured times repeat no better.
Label formatTime(double ms)
{
    Label label;
    if (ms < 999.5) {
        snprintf(label.text, sizeof label.text, "%.*f ms", ms < 1 ? 2 : ms < 10 ? 1 : 0, ms);
    } else if (ms < 99950) {
        snprintf(label.text, sizeof label.text, "%.*f s", ms < 9995 ? 2 : 1, ms / 1000);
    } else {
        int seconds = (int)fmin(ms / 1000 + 0.5, 2e9);
        snprintf(label.text, sizeof label.text, "%d min %d s", seconds / 60, seconds % 60);
    }
    return label;
}

Label formatPercent(double fraction)
{
    Label label;
    double percent = 100 * fraction;
    snprintf(label.text, sizeof label.text, "%.*f %%", percent < 1 ? 2 : percent < 99.95 ? 1 : 0, percent);
    return label;
}
