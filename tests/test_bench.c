// SPDX-License-Identifier: MIT
// Tests of the arithmetic of vpl bench --scaling.
#include "test.h"

#include "cli/bench/fit.h"

enum { COUNT = 8 };

// Fills x with powers of two times `first`.
static void doublings(double first, double* x)
{
    for (int i = 0; i < COUNT; i++) {
        x[i] = first * (1 << i);
    }
}

TEST_ALONE(ExponentOfAPowerIsItself)
{
    const double exponents[] = {-1, 0, 0.5, 1, 2, 3.25};
    double x[COUNT], y[COUNT];
    doublings(16, x);
    for (int e = 0; e < 6; e++) {
        for (int i = 0; i < COUNT; i++) {
            y[i] = 3e-4 * pow(x[i], exponents[e]);
        }
        assertNear(fitExponent(x, y, COUNT), exponents[e], 1e-12, "exponent", e);
        assertNear(fitExponent(x, y, 2), exponents[e], 1e-12, "two points", e);
    }
}

// The least-squares line through (0, 0), (1, 1), (2, 1) in base-2 logarithms has slope 1/2.
TEST_ALONE(ExponentIsOfLeastSquares)
{
    const double x[] = {1, 2, 4}, y[] = {1, 2, 2}, turned[] = {4, 1, 2}, with[] = {2, 1, 2};
    assertNear(fitExponent(x, y, 3), 0.5, 1e-14, "by hand", 0);
    assertNear(fitExponent(turned, with, 3), 0.5, 1e-14, "in another order", 0);
}

TEST_ALONE(ExponentDoesNotDependOnUnits)
{
    double x[COUNT], y[COUNT], scaledX[COUNT], scaledY[COUNT];
    for (uint64_t seed = 0; seed < 100; seed++) {
        for (int i = 0; i < COUNT; i++) {
            x[i] = 1 + 100 * uniformAt(seed, 2 * (uint64_t)i);
            y[i] = 1 + 100 * uniformAt(seed, 2 * (uint64_t)i + 1);
            scaledX[i] = 1e6 * x[i];
            scaledY[i] = 1e-3 * y[i];
        }
        assertNear(fitExponent(scaledX, scaledY, COUNT), fitExponent(x, y, COUNT), 1e-11, "seed", (int)seed);
    }
}

TEST_ALONE(WhatHasNoExponentIsNotANumber)
{
    const double x[] = {5, 5, 5}, y[] = {1, 2, 3}, zero[] = {0, 1, 2};
    assert_true(isnan(fitExponent(x, y, 3)));
    assert_true(isnan(fitExponent(y, x, 1)));
    assert_true(isnan(fitExponent(zero, y, 3)));
    assert_true(isnan(fitExponent(y, zero, 3)));
    assert_true(isnan(fitFixed(x, y, 3, 1).fixed));
    assert_true(isnan(fitFixed(y, x, 3, 0).fixed));
    assert_true(isnan(fitFixed(y, zero, 3, 1).worst));
    assert_true(isnan(fitFixed(y, x, 1, 1).scale));
}

TEST_ALONE(FixedPartIsFound)
{
    const double exponents[] = {-1, 1, 2};
    double x[COUNT], y[COUNT];
    doublings(256, x);
    for (int e = 0; e < 3; e++) {
        for (int i = 0; i < COUNT; i++) {
            y[i] = 7 + 1e-3 * pow(x[i] / 256, exponents[e]) * pow(256, fabs(exponents[e]));
        }
        FixedFit fit = fitFixed(x, y, COUNT, exponents[e]);
        double scale = 1e-3 * pow(256, fabs(exponents[e]) - exponents[e]);
        assertNear(fit.fixed, 7, 1e-9, "fixed", e);
        assertNear(fit.scale / scale, 1, 1e-9, "scale", e);
        assertNear(fit.worst, 0, 1e-9, "worst", e);
    }
}

// No perturbed pair of coefficients has a smaller sum of relative squares.
TEST_ALONE(FixedFitIsOfLeastRelativeSquares)
{
    double x[COUNT], y[COUNT];
    doublings(1, x);
    for (uint64_t seed = 0; seed < 50; seed++) {
        for (int i = 0; i < COUNT; i++) {
            y[i] = (2 + x[i]) * (0.9 + 0.2 * uniformAt(seed, (uint64_t)i));
        }
        FixedFit fit = fitFixed(x, y, COUNT, 1);
        double sums[3][3], worst = 0;
        for (int a = 0; a < 3; a++) {
            for (int b = 0; b < 3; b++) {
                sums[a][b] = 0;
                for (int i = 0; i < COUNT; i++) {
                    double value = fit.fixed * (0.99 + 0.01 * a) + fit.scale * (0.99 + 0.01 * b) * x[i];
                    double off = value / y[i] - 1;
                    sums[a][b] += off * off;
                    worst = a == 1 && b == 1 ? fmax(worst, fabs(off)) : worst;
                }
            }
        }
        for (int k = 0; k < 9; k++) {
            assert_true(sums[1][1] <= sums[k / 3][k % 3]);
        }
        assertNear(fit.worst, worst, 1e-12, "worst", (int)seed);
    }
}
