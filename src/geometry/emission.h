// SPDX-License-Identifier: MIT
// The list of sources from the inside.
#ifndef VPL_GEOMETRY_EMISSION_H
#define VPL_GEOMETRY_EMISSION_H

#include <vpl/geometry.h>

// s c in double, cut at the largest float: radiances and sizes of up to 1e15 reach beyond it together.
vplRgb vplScaleRadiometric(double s, vplRgb c);

// Steradians, weighted by the falloff.
double vplSpot_SolidAngle(const vplEmitterDef* spot);

// Cosine of the angle to the axis with a density proportional to the falloff, for u in [0, 1).
double vplSpot_SampleCosine(const vplEmitterDef* spot, double u);

// The source among first .. sourceCount - 1, of which there must be one, that `choice` in [0, 1) takes, with
// probability by power; *restOut in [0, 1) is how far it went into that source, as good as a fresh number.
int vplEmission_Choose(const vplEmission* emission, int first, double choice, double* restOut);

#endif
