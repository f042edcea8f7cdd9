// SPDX-License-Identifier: MIT
#include "cli/bench/fit.h"

#include <math.h>
#include <stdbool.h>

static bool arePositive(const double* values, int count)
{
    for (int i = 0; i < count; i++) {
        if (!(values[i] > 0)) {
            return false;
        }
    }
    return true;
}

double fitExponent(const double* x, const double* y, int count)
{
    if (count < 2 || !arePositive(x, count) || !arePositive(y, count)) {
        return NAN;
    }
    double meanX = 0, meanY = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; i++) {
        meanX += log(x[i]) / count;
        meanY += log(y[i]) / count;
    }
    for (int i = 0; i < count; i++) {
        double dx = log(x[i]) - meanX;
        xx += dx * dx;
        xy += dx * (log(y[i]) - meanY);
    }
    return xx > 1e-20 ? xy / xx : NAN;
}

// Minimises the sum of (fixed u + scale v - 1)^2 with u = 1/y, v = x^p/y, which is linear in fixed and scale.
FixedFit fitFixed(const double* x, const double* y, int count, double exponent)
{
    const FixedFit none = {NAN, NAN, NAN};
    if (count < 2 || !arePositive(x, count) || !arePositive(y, count)) {
        return none;
    }
    double uu = 0, uv = 0, vv = 0, u1 = 0, v1 = 0;
    for (int i = 0; i < count; i++) {
        double u = 1 / y[i], v = pow(x[i] / x[0], exponent) / y[i];
        uu += u * u;
        uv += u * v;
        vv += v * v;
        u1 += u;
        v1 += v;
    }
    double determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-12 * uu * vv)) {
        return none;
    }
    FixedFit fit = {(u1 * vv - v1 * uv) / determinant, (v1 * uu - u1 * uv) / determinant, 0};
    for (int i = 0; i < count; i++) {
        double value = fit.fixed + fit.scale * pow(x[i] / x[0], exponent);
        fit.worst = fmax(fit.worst, fabs(value / y[i] - 1));
    }
    fit.scale /= pow(x[0], exponent);
    return fit;
}
