// SPDX-License-Identifier: MIT
// Final gather: indirect light by rays from each pixel.
#ifndef VPL_SHADING_GATHER_H
#define VPL_SHADING_GATHER_H

#include "math/sobol.h"
#include "shading/compensation.h"

typedef struct vplGather {
    const vplGatherDef* def;
    vplSobol sobol;
    vplDirectLight direct; // lights near hits, each light as strong as all of its kind together
    int side;              // K of the squares of pixels that share directions; 1: none do
} vplGather;

#endif
