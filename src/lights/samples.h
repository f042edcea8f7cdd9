// SPDX-License-Identifier: MIT
// The numbers in [0, 1) that particles are made of.
#ifndef VPL_LIGHTS_SAMPLES_H
#define VPL_LIGHTS_SAMPLES_H

#include <vpl/lights.h>

typedef struct vplSampleSource {
    vplSampler sampler; // never VPL_SAMPLER_AUTO
    uint64_t seed;
    int64_t first;  // added to the particle
    int count;      // N
    int64_t stride; // Hammersley: particle i takes point i * stride mod N
    int reserved;   // pairs of dimensions that are not for directions: Halton places of Keller's particles
} vplSampleSource;

vplSampleSource vplSampleSource_Make(const vplParticleDef* def);

// Two numbers for the direction that particle i takes at `step`.
void vplSampleSource_Direction(const vplSampleSource* source, int particle, int step, float* u, float* v);

// One number that spreads any first few particles evenly over the emitters.
float vplSampleSource_Emitter(const vplSampleSource* source, int particle);

// Two numbers for the place where particle i starts on its source: Halton's first two dimensions in Keller's walk;
// otherwise the sequence R2 (Roberts 2018, The Unreasonable Effectiveness of Quasirandom Sequences), whose first few
// points are spread out, too.
void vplSampleSource_Place(const vplSampleSource* source, int particle, float* u, float* v);

#endif
