// SPDX-License-Identifier: MIT
// What the public matrices do not need: inverses, singularity, frames of cube faces.
#ifndef VPL_MATH_MATRIX_H
#define VPL_MATH_MATRIX_H

#include <vpl/vecmath.h>

// Affine transform in double, row-major 3x4: m[i][3] is the translation.
typedef struct vplAffine {
    double m[3][4];
} vplAffine;

vplAffine vplAffine_FromMat4(const vplMat4* m);
vplMat4 vplAffine_ToMat4(const vplAffine* a);

// |det| / (|c0||c1||c2|) of the 3x3 part: 1 for orthogonal columns of any length, 0 for a singular matrix.
// Free of scale, unlike |det| itself (EXTREMES X002).
double vplAffine_Orthogonality(const vplAffine* a);

// The inverse, computed in double with columns scaled to unit length first. The matrix must not be singular.
vplAffine vplAffine_Inverse(const vplAffine* a);

// Scale, rotate about x, y, z by `quarters` quarter turns, translate.
vplAffine vplAffine_FromParts(vplVec3 translate, const double quarters[3], vplVec3 scale);

#endif
