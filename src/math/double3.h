// SPDX-License-Identifier: MIT
// Vectors of double, where float is not precise enough.
#ifndef VPL_MATH_DOUBLE3_H
#define VPL_MATH_DOUBLE3_H

static inline double vplDot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void vplCross3(const double a[3], const double b[3], double out[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

#endif
