// SPDX-License-Identifier: MIT
// Based on: Franchi and Ferrante, Virtual Point Lights (bias); William Reeves, David Salesin and Robert Cook, Rendering
// Antialiased Shadows with Depth Maps, SIGGRAPH 1987 (PCF). The plane's bias is derived in shadow_kernel.c.
#include <vpl/formulas.h>

#include <math.h>

#define PI      3.14159265358979323846
#define HALF_PI (PI / 2)

double vplFormula_PlaneBias(double distance, double planeAngle, double sampleAngle)
{
    if (!(distance >= 0 && planeAngle >= 0 && planeAngle < HALF_PI && sampleAngle >= 0 &&
          sampleAngle < HALF_PI)) {
        return NAN;
    }
    return distance * (1 - cos(planeAngle) / cos(fmax(planeAngle - sampleAngle, 0)));
}

double vplFormula_PairBias(double biasStatic, double biasDynamic, double cosine)
{
    return biasStatic + biasDynamic * (1 - fmax(cosine, 0));
}

double vplFormula_Shadow(double distance, double bias, double stored)
{
    return distance - bias > stored ? 1 : 0;
}

double vplFormula_Pcf(double distance, double bias, const double* stored, int count)
{
    if (stored == NULL || count < 1) {
        return NAN;
    }
    double shadowed = 0;
    for (int i = 0; i < count; i++) {
        shadowed += vplFormula_Shadow(distance, bias, stored[i]);
    }
    return shadowed / count;
}

double vplFormula_PcfAtEdge(vplPcfKernel kernel, double edge)
{
    const double x = fmin(fmax(edge, -1), 1);
    switch (kernel) {
    case VPL_PCF_DISC: // a segment of the disc
        return (acos(x) - x * sqrt(1 - x * x)) / PI;
    case VPL_PCF_SQUARE:
    case VPL_PCF_SPHERE: // Archimedes: equal heights of a sphere have equal areas
        return (1 - x) / 2;
    case VPL_PCF_BALL: // a cap of the ball
        return (1 - x) * (1 - x) * (2 + x) / 4;
    }
    return NAN;
}

double vplFormula_PcfVariance(vplPcfKernel kernel, double edge)
{
    const double s = vplFormula_PcfAtEdge(kernel, edge);
    return s * (1 - s);
}

// Seen from the light, the floor at x = wall + gap is r away, and every texel between the wall's foot and there stores
// r wall / x. So the point is lit while r gap / x <= bias. The left side grows with the gap, and exceeds the bias where the
// gap does, because r > x: bisection of [0, bias].
double vplFormula_LeakBehindWall(double height, double wall, double bias)
{
    if (!(height > 0 && wall > 0 && bias >= 0 && isfinite(height) && isfinite(wall) && isfinite(bias))) {
        return NAN;
    }
    double low = 0, high = bias;
    for (int i = 0; i < 100; i++) {
        const double gap = low + (high - low) / 2, x = wall + gap;
        const bool lit = hypot(height, x) * gap / x <= bias;
        low = lit ? gap : low;
        high = lit ? high : gap;
    }
    return low;
}
