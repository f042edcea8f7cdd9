// SPDX-License-Identifier: MIT
// The mean of pictures of passes, and how far it is from the truth.
#ifndef VPL_RENDER_PASSES_H
#define VPL_RENDER_PASSES_H

#include "render/stage.h"

// Direct light, and sums of the passes with even and odd numbers.
typedef struct vplPasses {
    vplContext* context;
    vplImage* base; // all of the picture, unless it is the mean of several passes
    double* sums[2];
} vplPasses;

void vplPasses_Free(vplPasses* passes);

// Memory for sums.
vplResult vplPasses_Open(vplPasses* passes, const vplImage* base);

void vplPasses_Add(vplPasses* passes, int pass, const vplImage* image);

// The mean of `count` passes as a new picture, with error estimates.
vplResult vplPasses_Resolve(const vplPasses* passes, int count, vplImage** imageOut, vplRenderStats* stats);

#endif
