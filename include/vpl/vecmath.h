// SPDX-License-Identifier: MIT
// Vectors, colours and matrices. Coordinates are right-handed, in metres, with y up; angles are in radians;
// matrices are column-major and multiply column vectors.
#ifndef VPL_VECMATH_H
#define VPL_VECMATH_H

#include <vpl/base.h>

VPL_HEADER_BEGIN

#define VPL_PI 3.14159265358979323846

// A point, direction or size in metres.
typedef struct vplVec3 {
    float x, y, z;
} vplVec3;

// Linear red, green and blue with the primaries of sRGB. Each use states its quantity: reflectance, radiance,
// intensity or flux.
typedef struct vplRgb {
    float r, g, b;
} vplRgb;

// The element of row i and column j is m[4 * j + i].
typedef struct vplMat4 {
    float m[16];
} vplMat4;

vplMat4 vplMat4_Identity(void);

// a * b: b is applied first.
// Not checked, for speed: pointers must not be NULL.
vplMat4 vplMat4_Multiply(const vplMat4* a, const vplMat4* b);

// Scales, then rotates about x, y and z (radians), then translates. Quarter turns are exact: a rotation by
// VPL_PI / 2 has the elements 0 and 1 without rounding errors.
// Not checked, for speed: pointers must not be NULL.
vplMat4 vplMat4_FromParts(vplVec3 translate, const double rotate[3], vplVec3 scale);

VPL_HEADER_END

#endif
