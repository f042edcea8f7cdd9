// SPDX-License-Identifier: MIT
// Parts of the particle simulation: the particles' numbers in [0, 1), and where they start.
#ifndef VPL_LIGHTS_PARTICLES_H
#define VPL_LIGHTS_PARTICLES_H

#include <vpl/lights.h>

// ---- the definition

// Documented lighting of first hits: point emitters only.
bool vplParticleDef_NeedsPoints(const vplParticleDef* def);

vplResult vplParticleDef_Check(const vplContext* context, const vplEmitterDef* emitters, int emitterCount,
                               const vplParticleDef* def);

// ---- samples

typedef struct vplSampleSource {
    vplSampler sampler; // never VPL_SAMPLER_AUTO
    uint64_t seed;
    int64_t first;  // added to the particle
    int count;      // N
    int64_t stride; // Hammersley: particle i takes point (i + 1) * stride mod N
    int reserved;   // first pairs of dimensions that are not for directions: places of Keller's particles
} vplSampleSource;

vplSampleSource vplSampleSource_Make(const vplParticleDef* def);

// Two numbers for the direction of particle i at `step`.
void vplSampleSource_Direction(const vplSampleSource* source, int particle, int step, float* u, float* v);

// One number that spreads any first few particles evenly over the emitters.
float vplSampleSource_Emitter(const vplSampleSource* source, int particle);

// Two numbers for the place where particle i starts on its source: Halton's first two dimensions in Keller's
// walk, else the sequence R2 (Roberts 2018, The Unreasonable Effectiveness of Quasirandom Sequences). Any
// first few particles are spread evenly.
void vplSampleSource_Place(const vplSampleSource* source, int particle, float* u, float* v);

// Mirrors the unit vector d at a surface of unit normal n, to the side that it comes from.
vplVec3 vplMirror(vplVec3 d, vplVec3 n);

// ---- starts

typedef struct vplStarts {
    const vplGeometry* geometry;
    const vplParticleDef* def;
    const vplEmitterDef* emitters;
    int emitterCount;
    double totalPower;           // sum of the emitters' mean intensities
    const vplEmission* emission; // everything that emits; NULL: point emitters only, as documented
    vplSampleSource samples;
} vplStarts;

// A particle before its first flight.
typedef struct vplStart {
    vplRay ray;
    vplVec3 normal; // of an area light; of other emitters, the direction
    vplRgb light;   // documented: the emitter's intensity; else flux in W; as if one particle carried all
    vplHit from;    // the position, and the surface it leaves; its object is -1 in free space
    int emitter;    // index; -1: a triangle that emits, or the environment
    bool onSky;     // it comes from the environment
} vplStart;

vplStarts vplStarts_Make(const vplGeometry* geometry, const vplEmission* emission,
                         const vplEmitterDef* emitters, int emitterCount, const vplParticleDef* def);

// The light of step 0 that a particle leaves in Keller's walk.
vplVirtualLight vplStart_Light(const vplStarts* starts, const vplStart* start);

// False where nothing emits.
bool vplStarts_Get(const vplStarts* starts, int particle, vplStart* startOut);

#endif
