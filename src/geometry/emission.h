// SPDX-License-Identifier: MIT
// Sampling of the list of sources, shared with the folders that make virtual lights.
#ifndef VPL_GEOMETRY_EMISSION_H
#define VPL_GEOMETRY_EMISSION_H

#include <vpl/geometry.h>

// s c, computed in double and clamped to the largest float, which the product of an allowed radiance and an
// allowed area (each up to 1e15) may exceed.
vplRgb vplScaleRadiometric(double s, vplRgb c);

// The spot's solid angle weighted by its falloff, steradians.
double vplSpot_SolidAngle(const vplEmitterDef* spot);

// Samples the cosine of the angle to the axis with a density proportional to the falloff; u in [0, 1).
double vplSpot_SampleCosine(const vplEmitterDef* spot, double u);

// Chooses a source among first .. sourceCount - 1, which must not be empty, with a probability proportional
// to power. `choice` is in [0, 1); *restOut in [0, 1) is its position within the chosen source's share, a
// random number again.
int vplEmission_Choose(const vplEmission* emission, int first, double choice, double* restOut);

#endif
