// SPDX-License-Identifier: MIT
// Functions that the stages of SSVP share.
#ifndef VPL_RENDER_STAGES_SSVP_H
#define VPL_RENDER_STAGES_SSVP_H

#include "render/stages/results.h"

// The shift of the sample patterns. It is 0, which leaves the points as published, for seed 0 in the first
// pass of frames that keep their patterns.
uint64_t vplSsvpShift(const vplRun* run);

// Measures by rays which share of each light's light stays in the scene; the shares are scratch memory.
vplResult vplMeasureLightUse(const vplRun* run, const vplLightSet* set, float** useOut);

// The first says that lights cast shadows by the maps of their clusters.
static inline bool vplSsvpSees(const vplPlan* plan)
{
    return plan->options.lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER;
}

static inline bool vplSsvpHasSecondBounce(const vplPlan* plan)
{
    return plan->options.maxBounces != 1 && plan->options.ssvp.secondBounce > 0;
}

static inline bool vplSsvpShowsClusters(const vplPlan* plan)
{
    return plan->options.output.show == VPL_SHOW_PARABOLOID || plan->options.output.show == VPL_SHOW_CLUSTERS;
}

#endif
