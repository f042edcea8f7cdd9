// SPDX-License-Identifier: MIT
// A look at the scene: some hundred rays and virtual lights tell what light does in it.
#ifndef VPL_RENDER_PLANNER_LOOK_H
#define VPL_RENDER_PLANNER_LOOK_H

#include "render/plan.h"

// Takes the look, once for all plans of a runner; the geometry must be there, with its ray tree.
vplResult vplTakeLook(vplRunner* runner, const vplPlan* plan, vplLook* lookOut);

#endif
