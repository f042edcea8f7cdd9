// SPDX-License-Identifier: MIT
// Inline vector arithmetic. Each sum has one fixed order, so all callers get the same bits.
#ifndef VPL_MATH_VEC_H
#define VPL_MATH_VEC_H

#include "math/scalar.h"

#include <vpl/vecmath.h>

#include <math.h>

static inline vplVec3 vplVec(float x, float y, float z)
{
    return (vplVec3){x, y, z};
}

static inline vplVec3 vplAdd(vplVec3 a, vplVec3 b)
{
    return vplVec(a.x + b.x, a.y + b.y, a.z + b.z);
}

static inline vplVec3 vplSub(vplVec3 a, vplVec3 b)
{
    return vplVec(a.x - b.x, a.y - b.y, a.z - b.z);
}

static inline vplVec3 vplScale(float s, vplVec3 a)
{
    return vplVec(s * a.x, s * a.y, s * a.z);
}

static inline vplVec3 vplNegate(vplVec3 a)
{
    return vplVec(-a.x, -a.y, -a.z);
}

static inline float vplDot(vplVec3 a, vplVec3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static inline vplVec3 vplCross(vplVec3 a, vplVec3 b)
{
    return vplVec(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}

static inline float vplLength(vplVec3 a)
{
    return sqrtf(vplDot(a, a));
}

// The largest magnitude of a component. (fmaxf is a call to libm.)
static inline float vplLargestOf(vplVec3 a)
{
    return vplMaxf(fabsf(a.x), vplMaxf(fabsf(a.y), fabsf(a.z)));
}

// The length of a cross product of edges, whose square leaves float's range above 4e9 m and below 1e-9 m.
static inline double vplCrossLength(vplVec3 a)
{
    const float square = vplDot(a, a);
    if (square > 0x1p-100f && square < INFINITY) {
        return sqrt((double)square);
    }
    const double x = (double)a.x, y = (double)a.y, z = (double)a.z;
    return sqrt(x * x + y * y + z * z);
}

// The unit vector along a; 0 for the zero vector. Scales the largest component to 1 first, so that the
// squares of tiny and huge vectors neither underflow nor overflow.
static inline vplVec3 vplNormalize(vplVec3 a)
{
    float largest = vplLargestOf(a);
    if (!(largest > 0) || largest > 3.4e38f) {
        return vplVec(0, 0, 0);
    }
    a = vplVec(a.x / largest, a.y / largest, a.z / largest);
    float length = vplLength(a);
    return vplVec(a.x / length, a.y / length, a.z / length);
}

static inline float vplComponent(vplVec3 a, int axis)
{
    return axis == 0 ? a.x : axis == 1 ? a.y : a.z;
}

static inline bool vplIsFiniteVec(vplVec3 a)
{
    return isfinite(a.x) && isfinite(a.y) && isfinite(a.z);
}

static inline vplRgb vplRgbAdd(vplRgb a, vplRgb b)
{
    return (vplRgb){a.r + b.r, a.g + b.g, a.b + b.b};
}

static inline vplRgb vplRgbScale(float s, vplRgb a)
{
    return (vplRgb){s * a.r, s * a.g, s * a.b};
}

static inline vplRgb vplRgbMul(vplRgb a, vplRgb b)
{
    return (vplRgb){a.r * b.r, a.g * b.g, a.b * b.b};
}

// The mean of the channels: the weight by which emitters are sampled.
static inline double vplRgbMean(vplRgb c)
{
    return ((double)c.r + c.g + c.b) / 3;
}

// A right-handed orthonormal basis: tangent, bitangent and the unit vector n.
// Based on: Duff, Burgess, Christensen, Hery, Kensler, Liani and Villemin, Building an Orthonormal Basis,
// Revisited, JCGT 2017, which never divides by a number near 0.
static inline void vplTangentFrame(vplVec3 n, vplVec3* tangent, vplVec3* bitangent)
{
    float sign = copysignf(1.0f, n.z);
    float a = -1.0f / (sign + n.z);
    float b = n.x * n.y * a;
    *tangent = vplVec(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
    *bitangent = vplVec(b, sign + n.y * n.y * a, -n.y);
}

#endif
