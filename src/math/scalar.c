// SPDX-License-Identifier: MIT
// Each function reduces its argument to a small interval and sums a Taylor series there. Minimax polynomials
// would save a few terms, but Taylor coefficients can be checked by eye.
#include "math/scalar.h"

#include <vpl/vecmath.h>

#include <float.h>
#include <string.h>

static const double LN2_HIGH = 0x1.62e42fefa0000p-1; // the low 17 bits are 0, so k * LN2_HIGH is exact
static const double LN2_LOW = 0x1.cf79abc9e3b3ap-40;

void vplSinCosQuarters(double quarters, double* sine, double* cosine)
{
    double nearest = rint(quarters);
    double x = (quarters - nearest) * (VPL_PI / 2); // |x| <= pi/4
    double x2 = x * x;
    double s = 0, c = 0;
    for (int k = 17; k >= 3; k -= 2) { // sin x = x - x^3/3! + ...; (pi/4)^19/19! < 1e-19
        s = (1 + s) * (-x2 / ((k - 1) * k));
        c = (1 + c) * (-x2 / ((k - 2) * (k - 1)));
    }
    s = x + x * s;
    c = 1 + c;
    switch ((int64_t)nearest & 3) {
    case 0:
        *sine = s, *cosine = c;
        break;
    case 1:
        *sine = c, *cosine = -s;
        break;
    case 2:
        *sine = -s, *cosine = -c;
        break;
    default:
        *sine = -c, *cosine = s;
        break;
    }
    *sine += 0.0; // -0 to 0
    *cosine += 0.0;
}

void vplSinCos(double radians, double* sine, double* cosine)
{
    vplSinCosQuarters(radians / (VPL_PI / 2), sine, cosine);
}

double vplExp(double x)
{
    if (!(x > -745.2)) {
        return x != x ? x : 0;
    }
    if (x > 709.79) {
        return INFINITY;
    }
    double k = rint(x * (1 / 0.69314718055994530942));
    double r = (x - k * LN2_HIGH) - k * LN2_LOW; // |r| <= ln(2)/2
    double sum = 0;
    for (int i = 14; i >= 1; i--) { // 0.35^15/15! < 2e-19
        sum = (1 + sum) * (r / i);
    }
    int half = (int)k / 2; // scales in two steps: 2^k itself may overflow
    return ldexp(ldexp(1 + sum, half), (int)k - half);
}

double vplLn(double x)
{
    if (!(x > 0)) {
        return x == 0 ? -INFINITY : NAN;
    }
    if (x > DBL_MAX) {
        return x;
    }
    int exponent;
    double m = frexp(x, &exponent); // [0.5, 1)
    if (m < 0.70710678118654752440) {
        m *= 2;
        exponent--;
    }
    double s = (m - 1) / (m + 1); // |s| <= 0.172; log m = 2 atanh s
    double s2 = s * s;
    double sum = 0;
    for (int k = 23; k >= 3; k -= 2) { // 0.172^24 < 1e-18
        sum = (sum + 1.0 / k) * s2;
    }
    return exponent * LN2_HIGH + (2 * s + (2 * s * sum + exponent * LN2_LOW));
}

double vplPow(double x, double y)
{
    return x > 0 ? vplExp(y * vplLn(x)) : 0;
}

// Dividing the bits of x by three gives a guess within 6 %. Halley's method cubes the error in each step, so
// three steps reach rounding error. The constant is two thirds of the exponent's bias, adjusted to centre the
// error of the guess.
double vplCbrt(double x)
{
    if (!(x > 0) || x > DBL_MAX) {
        return x > 0 ? x : 0;
    }
    if (x < DBL_MIN || x > 0x1p1020) { // denormal, or 3x overflows below
        return x < 1 ? vplCbrt(x * 0x1p54) * 0x1p-18 : vplCbrt(x * 0x1p-54) * 0x1p18;
    }
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = bits / 3 + ((uint64_t)715094163 << 32);
    double y;
    memcpy(&y, &bits, sizeof y);
    for (int i = 0; i < 3; i++) {
        double cube = y * y * y;
        y *= (cube + 2 * x) / (2 * cube + x);
    }
    return y;
}

// atan x for 0 <= x <= 1. Two half-angle steps bring x below 0.2, where the series is short.
static double atanUnit(double x)
{
    for (int i = 0; i < 2; i++) {
        x = x / (1 + sqrt(1 + x * x)); // atan x = 2 atan(x / (1 + sqrt(1 + x^2)))
    }
    double x2 = x * x;
    double sum = 0;
    for (int k = 25; k >= 3; k -= 2) {
        sum = (1.0 / k - sum) * x2; // alternating series, smallest terms first
    }
    return 4 * (x - x * sum);
}

double vplAtan2(double y, double x)
{
    double ax = fabs(x), ay = fabs(y);
    if (ax == 0 && ay == 0) {
        return 0;
    }
    double angle = ay <= ax ? atanUnit(ay / ax) : VPL_PI / 2 - atanUnit(ax / ay);
    angle = x < 0 ? VPL_PI - angle : angle;
    return y < 0 ? -angle : angle;
}

double vplAcos(double x)
{
    x = x < -1 ? -1 : x > 1 ? 1 : x;
    return vplAtan2(sqrt((1 - x) * (1 + x)), x);
}
