// SPDX-License-Identifier: MIT
// Fits of time against the amount of work. They are separate from measuring for tests.
#ifndef VPL_CLI_BENCH_FIT_H
#define VPL_CLI_BENCH_FIT_H

// The exponent p of y = c x^p by least squares of log y over log x. NAN unless all values are positive and
// two x differ.
double fitExponent(const double* x, const double* y, int count);

// y = fixed + scale x^p.
typedef struct FixedFit {
    double fixed, scale;
    double worst; // largest |fit / y - 1|
} FixedFit;

// The fit for a given exponent that minimises the squares of fit / y - 1: short times are measured to the
// same relative accuracy as long ones. All NAN for exponent 0, or unless all values are positive and two x
// differ.
FixedFit fitFixed(const double* x, const double* y, int count, double exponent);

#endif
