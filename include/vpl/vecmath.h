// SPDX-License-Identifier: MIT
// Vectors, colours and matrices. Right-handed, y up, metres; angles in radians; matrices are column-major and
// multiply column vectors.
#ifndef VPL_VECMATH_H
#define VPL_VECMATH_H

#include <vpl/base.h>

#ifdef __cplusplus
extern "C" {
#endif

#define VPL_PI 3.14159265358979323846

// A point, direction or size in metres.
typedef struct vplVec3 {
    float x, y, z;
} vplVec3;

// Linear red, green and blue with the primaries of sRGB. What is measured (reflectance, radiance, intensity,
// flux) is said where it is used.
typedef struct vplRgb {
    float r, g, b;
} vplRgb;

// Element of row i and column j is m[4 * j + i].
typedef struct vplMat4 {
    float m[16];
} vplMat4;

vplMat4 vplMat4_Identity(void);

// a * b: b is applied first.
vplMat4 vplMat4_Multiply(const vplMat4* a, const vplMat4* b);

// Scale, then rotate about x, then y, then z (radians), then translate. Quarter turns are exact: a rotation by
// VPL_PI / 2 has elements 0 and 1 without rounding dust.
vplMat4 vplMat4_FromParts(vplVec3 translate, const double rotate[3], vplVec3 scale);

// World to view of a camera at `eye` that looks at `target`; view space looks down -z.
vplMat4 vplMat4_LookAt(vplVec3 eye, vplVec3 target, vplVec3 up);

// View to clip: depth z/w is 0 at `near` and 1 at `far` (metres, 0 < near < far); fovY in (0, pi) radians.
vplMat4 vplMat4_Perspective(double fovY, double aspect, double near, double far);

// The point p with w = 1 through the affine part of m; no perspective divide.
vplVec3 vplMat4_TransformPoint(const vplMat4* m, vplVec3 p);

// The direction d with w = 0: translation does not move it.
vplVec3 vplMat4_TransformDirection(const vplMat4* m, vplVec3 d);

#ifdef __cplusplus
}
#endif

#endif
