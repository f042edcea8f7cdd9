// SPDX-License-Identifier: MIT
// What the stages of SSVP share.
#ifndef VPL_RENDER_STAGES_SSVP_H
#define VPL_RENDER_STAGES_SSVP_H

#include "render/stages/results.h"

// Shift of the sample patterns: 0, the points as published, for seed 0, the first pass and frames that keep
// their patterns.
uint64_t vplSsvpShift(const vplRun* run);

// Measures by rays which share of each light's light stays in the scene; the shares are scratch memory.
vplResult vplMeasureLightUse(const vplRun* run, const vplLightSet* set, float** useOut);

// Whether lights see by the maps of their clusters, whether there is a second bounce, and whether clusters
// are shown.
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
