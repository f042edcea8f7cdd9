// SPDX-License-Identifier: MIT
// The memory of each stage of a plan that has not run yet, from what it allocates.
#ifndef VPL_RENDER_ESTIMATE_BYTES_H
#define VPL_RENDER_ESTIMATE_BYTES_H

#include "render/plan.h"

// What a stage keeps, and what it frees before it ends.
typedef struct vplStageBytes {
    double held, scratch;
} vplStageBytes;

// The counts of a plan from which the memory of its stages follows.
typedef struct vplPlanScale {
    const vplPlan* plan;
    double workers, triangles, objects, pixels, lights, drawn, sides; // drawn: lights that shading adds up
    bool smooth;                                                      // some object has shading normals
    vplStageBytes links;                                              // 0 where they are not known
    vplSharedBytes factors;                                           // of all pairs
} vplPlanScale;

// Estimates the memory of a stage of the plan.
vplStageBytes vplEstimateStage(const vplPlanScale* scale, vplStageId id);

// Estimates the memory of layers while the last of them is drawn, besides what the render holds: their pictures and scratch memory.
vplStageBytes vplEstimateLayers(const vplPlanScale* scale);

#endif
