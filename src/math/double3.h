// SPDX-License-Identifier: MIT
// Vectors of double, where float is not precise enough.
#ifndef VPL_MATH_DOUBLE3_H
#define VPL_MATH_DOUBLE3_H

#include "math/vec.h"

static inline void vplToDouble3(vplVec3 a, double out[3])
{
    out[0] = (double)a.x;
    out[1] = (double)a.y;
    out[2] = (double)a.z;
}

static inline vplVec3 vplRound3(const double a[3])
{
    return vplVec((float)a[0], (float)a[1], (float)a[2]);
}

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
