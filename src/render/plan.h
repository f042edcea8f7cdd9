// SPDX-License-Identifier: MIT
// Plans from the inside.
#ifndef VPL_RENDER_PLAN_H
#define VPL_RENDER_PLAN_H

#include "render/runner.h"

// Plans with a runner, which keeps the results of stages that decisions needed; the plan's render finds them
// there.
vplResult vplMakePlan(vplRunner* runner, const vplRenderOptions* options, const vplMachine* machine,
                      vplPlan** planOut);

// Fills in counts and bytes: what stages hold that ran already, and what the others will.
vplResult vplEstimatePlan(const vplRunner* runner, const vplMachine* machine, vplPlan* plan);

// Adds a decision to the plan: the value of the option as it is now, and why.
void vplDecide(vplPlan* plan, const char* option, const char* format, ...) VPL_PRINTF(3, 4);

#endif
