// SPDX-License-Identifier: MIT
// The contribution of a virtual light to a point: the arithmetic of all kernels, so that all get the same
// bits.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997, with the geometry term clamped, r^2 ->
// max(r^2, c); Franchi and Ferrante, Virtual Point Lights (documented).
#ifndef VPL_LIGHTS_LIGHT_TERM_H
#define VPL_LIGHTS_LIGHT_TERM_H

#include "math/vec.h"

#include <float.h>
#include <stdint.h>
#include <string.h>

// Larger and smaller of two numbers; `a` may be negative, `b` not. Non-negative floats are ordered like their
// bits. From AVX2 on integers are compared: on Zen 4 float comparisons share two of the four vector units
// with multiplications, integer comparisons use all four (physical lights: 5 to 6 % faster; SSE2 has no such
// instruction and would lose 16 %).
#ifdef __AVX2__
static inline int32_t vplBitsOf(float x)
{
    int32_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits;
}

static inline float vplFloatOf(int32_t bits)
{
    float x;
    memcpy(&x, &bits, sizeof x);
    return x;
}

static inline float vplLargerOf(float a, float b)
{
    return vplFloatOf(vplBitsOf(a) > vplBitsOf(b) ? vplBitsOf(a) : vplBitsOf(b));
}

static inline float vplSmallerOf(float a, float b)
{
    return vplFloatOf(vplBitsOf(a) < vplBitsOf(b) ? vplBitsOf(a) : vplBitsOf(b));
}
#else
static inline float vplLargerOf(float a, float b)
{
    return a > b ? a : b;
}

static inline float vplSmallerOf(float a, float b)
{
    return a < b ? a : b;
}
#endif

// Cosines at both ends times the distance, and 1 / distance^2.
typedef struct vplLightTerm {
    float here, there, inverse;
} vplLightTerm;

// `way` leads from the point to the light; n is the point's normal, m the light's.
static inline vplLightTerm vplLightTermOf(vplVec3 way, vplVec3 n, vplVec3 m)
{
    const float d2 = vplDot(way, way), here = vplDot(n, way), there = -vplDot(m, way);
    return (vplLightTerm){vplLargerOf(here, 0), vplLargerOf(there, 0), 1 / vplLargerOf(d2, FLT_MIN)};
}

// The factor of the light's colour. Physical: cos cos / max(d^2, c), each factor finite: 1e20 m away inverse is
// 0, not infinity / infinity. Documented: the cosine, without falloff; 0 instead of 0/0.
static inline float vplLightFactor(bool physical, vplVec3 way, vplVec3 n, vplVec3 m, float inverseClamp)
{
    if (!physical) {
        return vplLargerOf(vplDot(n, way), 0) / sqrtf(vplLargerOf(vplDot(way, way), FLT_MIN));
    }
    const vplLightTerm t = vplLightTermOf(way, n, m);
    const float bounded = vplSmallerOf(t.inverse, inverseClamp);
    return (t.here * t.inverse) * (t.there * bounded);
}

#endif
