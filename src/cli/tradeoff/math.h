// SPDX-License-Identifier: MIT
// Arithmetic of vpl tradeoff, separate from rendering so that it can be tested.
#ifndef VPL_CLI_TRADEOFF_MATH_H
#define VPL_CLI_TRADEOFF_MATH_H

#include <stdbool.h>
#include <stddef.h>

// Marks the Pareto front, thinned: by ascending cost, each point whose error is less than (1 - gain) times
// that of all points marked before. A gain of 0 is the whole front. Of equal points the first counts; a point
// with a NAN is never marked. Returns how many are.
int markFront(const double* cost, const double* error, int count, double gain, bool* onFront);

// Index of the cheapest point with error <= limit, -1 if there is none; of equal costs the first.
int cheapestWithin(const double* cost, const double* error, int count, double limit);

// What halving the error costs when going from one point to another, in the unit of cost: the added cost per
// factor of two by which the error falls. Negative where it costs less; INFINITY where the error does not
// fall.
double costPerHalving(double cost0, double error0, double cost1, double error1);

// The error at which a series levels off; error[i] was measured with work[i] (ascending). NAN unless the last
// eightfold work lowered the error by less than a fifth: noise, which falls as 1/sqrt(work), would have lost
// 65 %.
double floorOf(const double* work, const double* error, int count);

// A low and a high end for a logarithmic axis around positive values, a tenth of a decade of room on each
// side; at least one decade apart. False if no value is positive and finite.
bool logRange(const double* values, int count, double* low, double* high);

// Positions 1, 2, 5 times powers of ten in [low, high]; returns how many of at most `most`. Only powers of
// ten where the range spans more than four decades.
int logTicks(double low, double high, double* ticks, int most);

// Mean of (x - a)(x - b). If a and b are independent and both right on average, their noise cancels: this is
// the mean squared error of x alone, where (x - a)^2 would also count the noise of a. May come out negative
// near 0.
double jointSquare(const float* x, const float* a, const float* b, size_t count);

// The standard error of jointSquare where x is right, from the difference of a and b: for noise a' and b' of
// variance v each, a'b' has variance v^2 and (a' - b')^4 a mean of 12 v^2 (if normal; more if spiky, so that
// this errs on the safe side).
double jointUncertainty(const float* a, const float* b, size_t count);

// "0.83 ms", "41 ms", "1.24 s", "3 min 20 s".
void formatTime(double ms, char* text, size_t size);

// "0.83 %", "14.2 %", "130 %" from a fraction.
void formatPercent(double fraction, char* text, size_t size);

#endif
