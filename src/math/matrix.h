// SPDX-License-Identifier: MIT
// Affine transforms in double: inverses and singularity.
#ifndef VPL_MATH_MATRIX_H
#define VPL_MATH_MATRIX_H

#include <vpl/vecmath.h>

// A row-major 3x4 matrix; m[i][3] is the translation.
typedef struct vplAffine {
    double m[3][4];
} vplAffine;

vplAffine vplAffine_FromMat4(const vplMat4* m);
vplMat4 vplAffine_ToMat4(const vplAffine* a);

// outer * inner: `inner` is applied first.
vplAffine vplAffine_Multiply(const vplAffine* outer, const vplAffine* inner);

// |det| / (|c0||c1||c2|) of the 3x3 part: 1 for orthogonal columns of any length, 0 for a singular matrix.
// Independent of scale, unlike |det|.
double vplAffine_Orthogonality(const vplAffine* a);

// The inverse of a matrix that is not singular. Scales the columns to unit length first.
vplAffine vplAffine_Inverse(const vplAffine* a);

// Scales, then rotates about x, y and z by `quarters` quarter turns, then translates.
vplAffine vplAffine_FromParts(vplVec3 translate, const double quarters[3], vplVec3 scale);

// Transforms the point p, with w = 1, by the affine part of m; no perspective divide.
vplVec3 vplMat4_TransformPoint(const vplMat4* m, vplVec3 p);

// Transforms the direction d, with w = 0: translation has no effect.
vplVec3 vplMat4_TransformDirection(const vplMat4* m, vplVec3 d);

#endif
