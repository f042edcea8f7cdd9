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

// World to view space of a camera at `eye` that looks at `target`, which is along -z in view space.
vplMat4 vplMat4_LookAt(vplVec3 eye, vplVec3 target, vplVec3 up);

// View to clip space. Depth z / w is 0 at `near` and 1 at `far` (metres, 0 < near < far). fovY is the full
// vertical angle of view in (0, pi) radians; `aspect` is width / height.
vplMat4 vplMat4_Perspective(double fovY, double aspect, double near, double far);

// Transforms the point p, with w = 1, by the affine part of m; no perspective divide.
// Not checked, for speed: pointers must not be NULL.
vplVec3 vplMat4_TransformPoint(const vplMat4* m, vplVec3 p);

// Transforms the direction d, with w = 0: translation has no effect.
// Not checked, for speed: pointers must not be NULL.
vplVec3 vplMat4_TransformDirection(const vplMat4* m, vplVec3 d);

VPL_HEADER_END

#endif
