// SPDX-License-Identifier: MIT
// Based on: Andersson and others, FLIP, High Performance Graphics 2020, section 4.1: YCxCz of Zhang and
// Wandell's S-CIELAB, CIE L*a*b*, the Hunt effect (Hunt 1952) and the HyAB distance (Abasi and others 2020).
#include "image/flip_colour.h"

#include "math/scalar.h"

#include <math.h>

// Linear sRGB to XYZ, as exact fractions: the primaries of ITU-R BT.709 and its D65 white (x 0.3127, y
// 0.3290).
static const double TO_XYZ[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382},
};

// Converts linear RGB to XYZ divided by the XYZ of white.
static void toRelativeXyz(const double rgb[3], double xyz[3])
{
    for (int i = 0; i < 3; i++) {
        const double* m = TO_XYZ[i];
        xyz[i] = (m[0] * rgb[0] + m[1] * rgb[1] + m[2] * rgb[2]) / (m[0] + m[1] + m[2]);
    }
}

// Converts back, with the inverse matrix by Cramer's rule.
static void fromRelativeXyz(const double relative[3], double rgb[3])
{
    const double(*m)[3] = TO_XYZ;
    double xyz[3];
    for (int i = 0; i < 3; i++) {
        xyz[i] = relative[i] * (m[i][0] + m[i][1] + m[i][2]);
    }
    double determinant = 0;
    for (int c = 0; c < 3; c++) {
        int d = (c + 1) % 3, e = (c + 2) % 3;
        double cofactors[3] = {m[1][d] * m[2][e] - m[1][e] * m[2][d], m[2][d] * m[0][e] - m[2][e] * m[0][d],
                               m[0][d] * m[1][e] - m[0][e] * m[1][d]};
        determinant = m[0][c] * cofactors[0] + m[1][c] * cofactors[1] + m[2][c] * cofactors[2];
        rgb[c] = (cofactors[0] * xyz[0] + cofactors[1] * xyz[1] + cofactors[2] * xyz[2]) / determinant;
    }
}

static double clampUnit(double x)
{
    return x < 0 ? 0 : x > 1 ? 1 : x;
}

void vplToOpponent(const float rgb[3], float opponent[3])
{
    const double clamped[3] = {clampUnit(rgb[0]), clampUnit(rgb[1]), clampUnit(rgb[2])};
    double xyz[3];
    toRelativeXyz(clamped, xyz);
    opponent[0] = (float)(116 * xyz[1] - 16);
    opponent[1] = (float)(500 * (xyz[0] - xyz[1]));
    opponent[2] = (float)(200 * (xyz[1] - xyz[2]));
}

// L*a*b* of a linear colour. Scales a and b by L, because dark colours look paler (Hunt).
static void toHuntLab(const double rgb[3], double lab[3])
{
    const double delta = 6.0 / 29;
    double f[3];
    toRelativeXyz(rgb, f);
    for (int i = 0; i < 3; i++) {
        f[i] = f[i] > delta * delta * delta ? vplCbrt(f[i]) : f[i] / (3 * delta * delta) + 4.0 / 29;
    }
    lab[0] = 116 * f[1] - 16;
    lab[1] = 0.01 * lab[0] * 500 * (f[0] - f[1]);
    lab[2] = 0.01 * lab[0] * 200 * (f[1] - f[2]);
}

static double hyab(const double a[3], const double b[3])
{
    double da = a[1] - b[1], db = a[2] - b[2];
    return fabs(a[0] - b[0]) + sqrt(da * da + db * db);
}

static void opponentToHuntLab(const float opponent[3], double lab[3])
{
    double y = (opponent[0] + 16.0) / 116;
    const double xyz[3] = {y + opponent[1] / 500.0, y, y - opponent[2] / 200.0};
    double rgb[3];
    fromRelativeXyz(xyz, rgb);
    for (int c = 0; c < 3; c++) {
        rgb[c] = clampUnit(rgb[c]);
    }
    toHuntLab(rgb, lab);
}

double vplHuntHyab(const float a[3], const float b[3])
{
    double labA[3], labB[3];
    opponentToHuntLab(a, labA);
    opponentToHuntLab(b, labB);
    return hyab(labA, labB);
}

double vplHuntHyabOfGreenAndBlue(void)
{
    const double green[3] = {0, 1, 0}, blue[3] = {0, 0, 1};
    double labGreen[3], labBlue[3];
    toHuntLab(green, labGreen);
    toHuntLab(blue, labBlue);
    return hyab(labGreen, labBlue);
}
