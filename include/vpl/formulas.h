// SPDX-License-Identifier: MIT
// The formulas of shadow bias and percentage-closer filtering, each by itself, in double. They need no scene, no map and
// no context. vplShadow_Bias and vplShadow_Factor compute the same in float, for whole pictures.
#ifndef VPL_FORMULAS_H
#define VPL_FORMULAS_H

#include <vpl/base.h>

VPL_HEADER_BEGIN

// The bias that a plane needs, in the unit of `distance`: r (1 - cos t / cos(t - a)) for a point at distance r whose normal
// is at angle t to the light and whose samples are off by a; r (1 - cos t) where a exceeds t. Angles are in radians, t in
// [0, pi/2), a in [0, pi/2). NaN for values out of range.
double vplFormula_PlaneBias(double distance, double planeAngle, double sampleAngle);

// The document's static and dynamic bias, b_s + b_dmax (1 - max(n.l, 0)). Source: Franchi and Ferrante, Virtual Point
// Lights, "Rendering the Point Light with Shadows".
double vplFormula_PairBias(double biasStatic, double biasDynamic, double cosine);

// The hard shadow test: 1 where the biased distance of a point exceeds the stored one, else 0.
double vplFormula_Shadow(double distance, double bias, double stored);

// The shadow factor of PCF, k / count: the share of `count` stored distances that shadow the point. NaN where count < 1 or
// stored is NULL.
double vplFormula_Pcf(double distance, double bias, const double* stored, int count);

// Sets of PCF offsets.
typedef enum vplPcfKernel {
    VPL_PCF_DISC = 0, // uniform on a disc perpendicular to the ray, as vplShadow_Factor places them
    VPL_PCF_SQUARE,   // uniform on a square, whose side is parallel to the edge
    VPL_PCF_BALL,     // uniform in a ball
    VPL_PCF_SPHERE    // uniform on a ball's surface
} vplPcfKernel;

// The expected shadow factor beside a straight edge at the signed distance `edge` from the ray, in radii (half sides) of the
// kernel: 1 at -1, 1/2 at 0, 0 at 1. NaN for another kernel.
double vplFormula_PcfAtEdge(vplPcfKernel kernel, double edge);

// The variance of one random sample of that factor, s (1 - s); S samples have 1/S of it.
double vplFormula_PcfVariance(vplPcfKernel kernel, double edge);

// The width of the light leak that a bias opens behind a thin wall ("peter panning"): the wall stands at x = wall > 0 on a
// floor, the light at height > 0 above x = 0. Points up to this far behind the wall are lit. Same unit for all. NaN for
// values out of range.
double vplFormula_LeakBehindWall(double height, double wall, double bias);

VPL_HEADER_END

#endif
