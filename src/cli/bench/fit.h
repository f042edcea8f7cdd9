// SPDX-License-Identifier: MIT
// Fits of time against the amount of work, separate from measuring so that they can be tested.
#ifndef VPL_CLI_BENCH_FIT_H
#define VPL_CLI_BENCH_FIT_H

// The exponent p of y = c x^p by least squares of log y over log x; NAN of fewer than two different x, or
// where something is not positive.
double fitExponent(const double* x, const double* y, int count);

// y = fixed + scale x^p.
typedef struct FixedFit {
    double fixed, scale;
    double worst; // largest |fit / y - 1|
} FixedFit;

// The fit for a given exponent with the least squares of fit / y - 1: relative, because short times are
// measured as well as long ones. All NAN of fewer than two different x, exponent 0, or where something is not
// positive.
FixedFit fitFixed(const double* x, const double* y, int count, double exponent);

#endif
