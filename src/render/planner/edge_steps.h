// SPDX-License-Identifier: MIT
// What is left of a picture's error if pixels at edges are path-traced: for some numbers of them.
#ifndef VPL_RENDER_PLANNER_EDGE_STEPS_H
#define VPL_RENDER_PLANNER_EDGE_STEPS_H

#include "render/renderer.h"

enum { VPL_EDGE_STEPS = 24 };

// All but `pixels` relative to the square of the picture's mean.
typedef struct vplEdgeStep {
    int pixels;      // that are traced
    double noise;    // squared, of the other pixels
    double bias;     // squared, of the other pixels
    double square;   // the whole squared error of the other pixels, at least their noise
    double spread;   // standard error of the truth about it
    double variance; // of one path through each, as if paths were independent
    double mean;     // variance of the mean of as many paths as the truth has, which are spread evenly
} vplEdgeStep;

// A squared bias that may be chance counts for less.
static inline double vplLikelyBias(double bias, double spread)
{
    const double doubt = bias > 0 ? spread / bias : 0;
    return doubt < 1 ? bias * (1 - doubt * doubt) : 0;
}

// Fills in steps of growing numbers of pixels, up to half of all. The truth must have been asked, and no edges be traced.
vplResult vplFindEdgeSteps(vplRenderer* renderer, vplEdgeStep steps[VPL_EDGE_STEPS], int* countOut);

#endif
