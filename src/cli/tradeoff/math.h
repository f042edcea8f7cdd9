// SPDX-License-Identifier: MIT
// Arithmetic of vpl tradeoff, separate from rendering so that it can be tested.
#ifndef VPL_CLI_TRADEOFF_MATH_H
#define VPL_CLI_TRADEOFF_MATH_H

#include <stdbool.h>
#include <stddef.h>

// Numbers the points of the Pareto front 1, 2, 3... by ascending cost, and all others 0. The front is
// thinned: the error of each of its points is less than (1 - gain) times that of the point before; gain 0
// keeps all. The first of equal points counts. A point with a NAN is never on the front. Returns the number
// of points on it.
int numberFront(const double* cost, const double* error, int count, double gain, int* numbers);

// Index of the cheapest point with error <= limit, -1 if there is none; of equal costs the first.
int cheapestWithin(const double* cost, const double* error, int count, double limit);

// The cost of halving the error on the way from point 0 to point 1: the added cost per factor of two by which
// the error falls. Negative if point 1 costs less; INFINITY if the error does not fall.
double costPerHalving(double cost0, double error0, double cost1, double error1);

// The error at which a series levels off; error[i] was measured with work[i] (ascending). NAN unless the last
// eightfold work lowered the error by less than a fifth; noise, which falls as 1/sqrt(work), loses 65 %.
double floorOf(const double* work, const double* error, int count);

// Foresees y at `at` from count > 0 points by ascending x: between points along the straight line, beyond
// them along the last one, which rises by a tenth of y in proportion to x at least; from one point in
// proportion.
double alongLine(const double* x, const double* y, int count, double at);

// The same for an error: along powers of x, between -0.7 and 0 beyond the points. Where they span less than a
// factor of 8 the power is -0.5, that of noise.
double alongPower(const double* x, const double* y, int count, double at);

// The least error of the points with cost <= most; INFINITY if there is none.
double leastWithin(const double* cost, const double* error, int count, double most);

// Chooses the ends of a logarithmic axis: a tenth of a decade beyond the positive values on each side, and at
// least one decade apart. Returns false if no value is positive and finite.
bool logRange(const double* values, int count, double* low, double* high);

// Lists 1, 2 and 5 times the powers of ten in [low, high], but the powers of ten only if the range spans more
// than four decades. Returns their number, at most `most`.
int logTicks(double low, double high, double* ticks, int most);

// The mean of (x - a)(x - b). If a and b are independent and right on average, their noise cancels and the
// mean is the squared error of x alone; (x - a)^2 would include the noise of a. The mean may be negative near
// 0.
double jointSquare(const float* x, const float* a, const float* b, size_t count);

// The standard error of jointSquare for an x without error, estimated from the difference of a and b. If
// their noise a' and b' is normal and has variance v, a'b' has variance v^2 and the mean of (a' - b')^4 is 12
// v^2. Noise with more outliers makes the estimate too large, not too small.
double jointUncertainty(const float* a, const float* b, size_t count);

// A short text by value. It can be an argument of printf: formatTime(ms).text lives until the call returns.
typedef struct Label {
    char text[32];
} Label;

// "0.83 ms", "41 ms", "1.24 s", "3 min 20 s".
Label formatTime(double ms);

// "0.83 %", "14.2 %", "130 %" from a fraction.
Label formatPercent(double fraction);

#endif
