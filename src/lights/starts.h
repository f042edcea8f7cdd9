// SPDX-License-Identifier: MIT
// Where particles begin.
#ifndef VPL_LIGHTS_STARTS_H
#define VPL_LIGHTS_STARTS_H

#include "lights/samples.h"

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
    vplVec3 normal; // of the lamp; of other emitters, the direction
    vplRgb light;   // documented: the emitter's intensity; else flux in W; as if one particle carried all
    vplHit from;    // what it leaves; its object is -1 in free space
    int emitter;    // index; -1: a triangle that emits
} vplStart;

vplStarts vplStarts_Make(const vplGeometry* geometry, const vplEmission* emission,
                         const vplEmitterDef* emitters, int emitterCount, const vplParticleDef* def);

// False where nothing emits.
bool vplStarts_Get(const vplStarts* starts, int particle, vplStart* startOut);

#endif
