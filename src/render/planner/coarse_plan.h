// SPDX-License-Identifier: MIT
// Coarse plans, whose picture only serves until a better one is there.
#ifndef VPL_RENDER_PLANNER_COARSE_PLAN_H
#define VPL_RENDER_PLANNER_COARSE_PLAN_H

#include "render/renderer.h"

// The largest side of a square of pixels that are rendered as one in a coarse picture.
enum { VPL_MOST_ENLARGED = 8 };

// Sets the options of a coarse plan: fewer lights and patches by a factor, one path for each pixel, no smooth edges and small shadow maps.
void vplCoarsen(const vplRenderer* renderer, double share, vplRenderOptions* optionsOut);

// True if the planner may light the picture by patches, and the first of them cost at most `rays` rays.
bool vplSuitsPatches(const vplRenderer* renderer, double rays, int* gatherOut);

// Doubles the pixel size of a coarse plan, up to `most`, until its picture is foreseen to come in time.
vplResult vplEnlargePixels(vplRenderer* renderer, int most, vplRenderOptions* options);

#endif
