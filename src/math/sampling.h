// SPDX-License-Identifier: MIT
// Low-discrepancy sequences, and maps from the unit square to discs and spheres.
#ifndef VPL_MATH_SAMPLING_H
#define VPL_MATH_SAMPLING_H

#include <vpl/vecmath.h>

#include <stdint.h>

// Radical inverse of k in base 2 (van der Corput), truncated to 24 bits so that it stays below 1 (X044).
float vplVanDerCorput(uint32_t k);

// Radical inverse of k in the n-th prime, n in [0, VPL_PRIME_COUNT): Halton's n-th dimension.
enum { VPL_PRIME_COUNT = 64 };
float vplHalton(uint64_t k, int dimension);

// Disc of radius 1 by r = sqrt(u), angle 2 pi v.
void vplSamplePolarDisc(float u, float v, float* x, float* y);

// Disc of radius 1 by the concentric map of Shirley and Chiu, A Low Distortion Map Between Disk and Square,
// JGT 1997. The centre of the square maps to the centre of the disc.
void vplSampleConcentricDisc(float u, float v, float* x, float* y);

// Unit sphere, uniform: z = 1 - 2u, longitude 2 pi v.
vplVec3 vplSampleSphere(float u, float v);

// Hemisphere around +z with density cos/pi: Malley's method on the polar disc.
vplVec3 vplSampleCosine(float u, float v);

// The same around the unit vector n.
vplVec3 vplSampleCosineAround(vplVec3 n, float u, float v);

#endif
