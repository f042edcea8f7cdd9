// SPDX-License-Identifier: MIT
// The state of a render between its steps.
#ifndef VPL_RENDER_RENDERER_H
#define VPL_RENDER_RENDERER_H

#include "render/plan.h"

struct vplRenderer {
    vplRunner runner;
    vplPlan* plan;
    vplImage* base;  // all of the picture; direct light alone where passes add the rest
    double* sums[2]; // of the pictures of passes with even and odd numbers; NULL without passes
    // Layers: direct light alone, or where passes add up, the sum of what their lights on area lights send,
    // which `base` lacks; NULL: there is none.
    vplImage* direct;
    int done;               // passes
    bool stale;             // results of stages are not those of the last pass
    double start, cpuStart; // ms
    double passMs;          // of all passes
};

// Makes sums of passes, all 0.
vplResult vplRenderer_OpenSums(vplRenderer* renderer);

// Tests whether the options' count of passes, error or time is reached; at least one pass is done.
vplResult vplRenderer_IsDone(vplRenderer* renderer, bool* doneOut);

// Fills in the statistics of the whole render so far. `image` may be NULL.
void vplRenderer_FinishStats(vplRenderer* renderer, const vplImage* image, vplRenderStats* statsOut);

#endif
