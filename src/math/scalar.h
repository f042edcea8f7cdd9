// SPDX-License-Identifier: MIT
// Elementary functions made of + - * / and sqrt only, so that every machine gives the same bits. They compute
// in double; tests compare them with libm: their errors are a few units in the last place.
#ifndef VPL_MATH_SCALAR_H
#define VPL_MATH_SCALAR_H

#include <math.h>
#include <stdint.h>

// Sine and cosine of `quarters` quarter turns. Exact at whole quarters; |quarters| <= 2^31.
void vplSinCosQuarters(double quarters, double* sine, double* cosine);

// Sine and cosine of an angle in radians; exact 0 and 1 at multiples of VPL_PI / 2.
void vplSinCos(double radians, double* sine, double* cosine);

// e^x: 0 below -745, +infinity above 709.78.
double vplExp(double x);

// Natural logarithm: -infinity at 0, NaN below.
double vplLn(double x);

// x^y for x > 0; 0 for x <= 0.
double vplPow(double x, double y);

// Cube root of x; 0 for x <= 0.
double vplCbrt(double x);

// Angle of (y, x) in (-pi, pi]; 0 at the origin.
double vplAtan2(double y, double x);

// Arc cosine of x, which is clamped to [-1, 1].
double vplAcos(double x);

static inline float vplMinf(float a, float b)
{
    return a < b ? a : b;
}

static inline float vplMaxf(float a, float b)
{
    return a > b ? a : b;
}

static inline float vplClampf(float x, float low, float high)
{
    return x < low ? low : x > high ? high : x;
}

static inline int vplMini(int a, int b)
{
    return a < b ? a : b;
}

static inline int vplMaxi(int a, int b)
{
    return a > b ? a : b;
}

#endif
