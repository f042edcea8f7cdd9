// SPDX-License-Identifier: MIT
#include "math/matrix.h"
#include "math/double3.h"
#include "math/scalar.h"
#include "math/vec.h"

vplMat4 vplMat4_Identity(void)
{
    return (vplMat4){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}};
}

vplMat4 vplMat4_Multiply(const vplMat4* a, const vplMat4* b)
{
    vplMat4 out;
    for (int column = 0; column < 4; column++) {
        for (int row = 0; row < 4; row++) {
            double sum = 0; // products of floats are exact in double, so only the sum rounds
            for (int k = 0; k < 4; k++) {
                sum += (double)a->m[4 * k + row] * b->m[4 * column + k];
            }
            out.m[4 * column + row] = (float)sum;
        }
    }
    return out;
}

vplAffine vplAffine_FromMat4(const vplMat4* m)
{
    vplAffine a;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            a.m[row][column] = m->m[4 * column + row];
        }
    }
    return a;
}

vplMat4 vplAffine_ToMat4(const vplAffine* a)
{
    vplMat4 m = vplMat4_Identity();
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            m.m[4 * column + row] = (float)a->m[row][column];
        }
    }
    return m;
}

vplAffine vplAffine_Multiply(const vplAffine* outer, const vplAffine* inner)
{
    vplAffine a;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 4; column++) {
            double sum = column == 3 ? outer->m[row][3] : 0;
            for (int k = 0; k < 3; k++) {
                sum += outer->m[row][k] * inner->m[k][column];
            }
            a.m[row][column] = sum;
        }
    }
    return a;
}

// The cofactor matrix; row i is the cross product of the other two columns. Returns the determinant.
static double cofactors(const double c[3][3], double rows[3][3])
{
    for (int i = 0; i < 3; i++) {
        vplCross3(c[(i + 1) % 3], c[(i + 2) % 3], rows[i]);
    }
    return vplDot3(c[0], rows[0]);
}

// Divides the columns by their lengths, so that scales from 1e-30 to 1e30 neither underflow nor overflow.
static void unitColumns(const vplAffine* a, double columns[3][3], double lengths[3])
{
    for (int j = 0; j < 3; j++) {
        const double c[3] = {a->m[0][j], a->m[1][j], a->m[2][j]};
        lengths[j] = sqrt(vplDot3(c, c));
        for (int i = 0; i < 3; i++) {
            columns[j][i] = c[i] * (lengths[j] > 0 ? 1 / lengths[j] : 0);
        }
    }
}

double vplAffine_Orthogonality(const vplAffine* a)
{
    double columns[3][3], lengths[3], rows[3][3];
    unitColumns(a, columns, lengths);
    return fabs(cofactors(columns, rows));
}

vplAffine vplAffine_Inverse(const vplAffine* a)
{
    double columns[3][3], lengths[3], rows[3][3];
    unitColumns(a, columns, lengths);
    double det = cofactors(columns, rows);
    vplAffine out;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) {
            out.m[i][j] = rows[i][j] / det / lengths[i];
        }
    }
    for (int i = 0; i < 3; i++) {
        out.m[i][3] = -(out.m[i][0] * a->m[0][3] + out.m[i][1] * a->m[1][3] + out.m[i][2] * a->m[2][3]);
    }
    return out;
}

vplAffine vplAffine_FromParts(vplVec3 translate, const double quarters[3], vplVec3 scale)
{
    double s[3], c[3];
    for (int i = 0; i < 3; i++) {
        vplSinCosQuarters(quarters[i], &s[i], &c[i]);
    }
    // Rz * Ry * Rx.
    const double r[3][3] = {
        {c[2] * c[1], c[2] * s[1] * s[0] - s[2] * c[0], c[2] * s[1] * c[0] + s[2] * s[0]},
        {s[2] * c[1], s[2] * s[1] * s[0] + c[2] * c[0], s[2] * s[1] * c[0] - c[2] * s[0]},
        {-s[1], c[1] * s[0], c[1] * c[0]},
    };
    vplAffine a;
    for (int i = 0; i < 3; i++) {
        a.m[i][0] = r[i][0] * scale.x;
        a.m[i][1] = r[i][1] * scale.y;
        a.m[i][2] = r[i][2] * scale.z;
        a.m[i][3] = vplComponent(translate, i);
    }
    return a;
}

vplMat4 vplMat4_FromParts(vplVec3 translate, const double rotate[3], vplVec3 scale)
{
    double quarters[3];
    for (int i = 0; i < 3; i++) {
        quarters[i] = rotate[i] / (VPL_PI / 2);
    }
    vplAffine a = vplAffine_FromParts(translate, quarters, scale);
    return vplAffine_ToMat4(&a);
}

vplVec3 vplMat4_TransformPoint(const vplMat4* m, vplVec3 p)
{
    return vplAdd(vplMat4_TransformDirection(m, p), vplVec(m->m[12], m->m[13], m->m[14]));
}

vplVec3 vplMat4_TransformDirection(const vplMat4* m, vplVec3 d)
{
    return vplVec(m->m[0] * d.x + m->m[4] * d.y + m->m[8] * d.z,
                  m->m[1] * d.x + m->m[5] * d.y + m->m[9] * d.z,
                  m->m[2] * d.x + m->m[6] * d.y + m->m[10] * d.z);
}
