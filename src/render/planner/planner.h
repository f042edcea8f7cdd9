// SPDX-License-Identifier: MIT
// The planner: what --method auto stands for.
#ifndef VPL_RENDER_PLANNER_PLANNER_H
#define VPL_RENDER_PLANNER_PLANNER_H

#include "render/plan.h"

// VPL_USE_... of the methods that use every option that is not as in vplDefaultRenderOptions, and that can show
// what the options show.
int vplMethodsFor(const vplRenderOptions* options);

// The method that comes first among those, without a look at the scene; Keller's where there is none.
vplMethod vplFirstMethodFor(const vplRenderOptions* options);

// True where 8 pixels are so large a part of a surface that what they share, lights or the rays of a gather, blurs much.
bool vplIsTinyPicture(const vplRenderOptions* options);

// The largest share of all surfaces that area lights may be for 64 points to stand for them.
#define VPL_MOST_LAMPS 0.1

// Replaces --method auto by a method and its options.
vplResult vplChooseMethod(vplRunner* runner, vplPlan* plan);

#endif
