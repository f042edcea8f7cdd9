// SPDX-License-Identifier: MIT
#ifndef VPL_LIGHTS_COUNTS_H
#define VPL_LIGHTS_COUNTS_H

#include <vpl/lights.h>

// As vplCountParticles, for the N particles that follow `firstParticle` others: floor(rho^k (first + N)) less
// floor(rho^k first). A step may have none though a later one has some.
vplResult vplCountPass(vplContext* context, int64_t firstParticle, int particleCount, double reflectivity,
                       int* counts, int capacity, int* stepsOut, int64_t* totalOut);

#endif
