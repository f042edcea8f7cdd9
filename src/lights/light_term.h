// SPDX-License-Identifier: MIT
// The contribution of a virtual light to a point: the arithmetic of all kernels, so that all get the same
// bits.
// Based on: Alexander Keller, Instant Radiosity, SIGGRAPH 1997, with the geometry term clamped, r^2 ->
// max(r^2, c); Franchi and Ferrante, Virtual Point Lights (documented).
#ifndef VPL_LIGHTS_LIGHT_TERM_H
#define VPL_LIGHTS_LIGHT_TERM_H

#include <float.h>
#include <math.h>
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

// Cosines at both ends times the distance, and 1 / distance^2. x, y, z: from the point to the light.
typedef struct vplLightTerm {
    float here, there, inverse;
} vplLightTerm;

static inline vplLightTerm vplLightTermOf(float x, float y, float z, float nx, float ny, float nz, float mx,
                                          float my, float mz)
{
    float d2 = x * x + y * y + z * z;
    float here = nx * x + ny * y + nz * z;     // d times the cosine here,
    float there = -(mx * x + my * y + mz * z); // and at the light
    here = vplLargerOf(here, 0);
    there = vplLargerOf(there, 0);
    d2 = vplLargerOf(d2, FLT_MIN);
    return (vplLightTerm){here, there, 1 / d2};
}

// cos cos / max(d^2, c), each factor finite: 1e20 m away inverse is 0, not infinity / infinity.
static inline float vplClampedGeometry(vplLightTerm t, float inverseClamp)
{
    const float bounded = vplSmallerOf(t.inverse, inverseClamp);
    return (t.here * t.inverse) * (t.there * bounded);
}

// The cosine of documented lighting, which has no falloff; 0 instead of 0/0.
static inline float vplDocumentedCosine(float x, float y, float z, float nx, float ny, float nz)
{
    float d2 = x * x + y * y + z * z;
    float cosine = nx * x + ny * y + nz * z; // times the distance
    cosine = vplLargerOf(cosine, 0);
    d2 = vplLargerOf(d2, FLT_MIN);
    return cosine / sqrtf(d2);
}

#endif
