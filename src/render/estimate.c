// SPDX-License-Identifier: MIT
// Counts and bytes of a plan.
#include "render/plan.h"

vplResult vplEstimatePlan(const vplRunner* runner, const vplMachine* machine, vplPlan* p)
{
    (void)runner;
    (void)machine;
    (void)p;
    return VPL_SUCCESS;
}
