// SPDX-License-Identifier: MIT
// Functions that the stages of SSVP share.
#ifndef VPL_RENDER_STAGES_SSVP_H
#define VPL_RENDER_STAGES_SSVP_H

#include "render/stages/results.h"

// The shift of the sample patterns. It is 0, which leaves the points as published, for seed 0 in the first
// pass of frames that keep their patterns.
uint64_t vplSsvpShift(const vplRun* run);

// Samples that give the lights of a step from 1 on.
int vplSsvpCountLights(const vplPlan* plan, int step);

// Candidates for so many lights of a bounce; as many where none are chosen.
int vplSsvpCountCandidates(const vplPlan* plan, int count);

// Measures by rays which share of each light's light stays in the scene; the shares are scratch memory.
vplResult vplMeasureLightUse(const vplRun* run, const vplLightSet* set, float** useOut);

// Bounce k from 0 of those whose stages have run; without lights if there is no such bounce.
vplBounceParts vplSsvpBounce(const vplRun* run, int k);

// The lights of the bounce after one, of the given step.
vplResult vplMakeNextBounce(const vplRun* run, const vplBounceParts* from, int step,
                            vplBounceLights** resultOut);

// The lights of all bounces after the second by rays, in one set.
vplResult vplShootFurtherBounces(const vplRun* run, const vplBounceParts* from, vplBounceLights** resultOut);

// Describes what the camera sees, by which lights are chosen and clusters are split.
vplPlacementDef vplSsvpView(const vplRun* run);

// Clusters of the lights of a bounce, and their maps. `last` is the result of the frame or pass before, or NULL.
vplResult vplClusterBounce(const vplRun* run, const vplBounceLights* bounce, const vplBounceClusters* last,
                           vplBounceClusters** resultOut);
// Maps have triangles where later stages need surfaces besides distances.
vplResult vplMapBounce(const vplRun* run, const vplBounceParts* bounce, const vplBounceMaps* last,
                       bool triangles, vplBounceMaps** resultOut);

// The first says that lights cast shadows by the maps of their clusters.
static inline bool vplSsvpSees(const vplPlan* plan)
{
    return plan->options.lights.shadows == VPL_LIGHT_SHADOWS_CLUSTER;
}

// More lights are made than are kept.
static inline bool vplSsvpChooses(const vplPlan* plan)
{
    return plan->options.ssvp.nextBounce == VPL_NEXT_BOUNCE_RAYS && plan->options.ssvp.oversampling > 1;
}

// The next bounce begins from clusters.
static inline bool vplSsvpSamplesMaps(const vplPlan* plan)
{
    return plan->options.ssvp.nextBounce == VPL_NEXT_BOUNCE_MAPS;
}

// Clusters are split where they see by the map of one of their lights.
static inline bool vplSsvpSplits(const vplPlan* plan)
{
    const vplSsvpOptions* o = &plan->options.ssvp;
    return o->maxClusters > o->clusters && o->place == VPL_CLUSTER_PLACE_MEMBER;
}

// Most clusters of a bounce.
static inline int vplSsvpMostClusters(const vplPlan* plan)
{
    return vplSsvpSplits(plan) ? plan->options.ssvp.maxClusters : plan->options.ssvp.clusters;
}

static inline bool vplSsvpHasSecondBounce(const vplPlan* plan)
{
    return plan->options.maxBounces != 1 && plan->options.ssvp.secondBounce > 0;
}

// The number of bounces is resolved before the first stage that asks runs.
static inline bool vplSsvpHasFurtherBounces(const vplPlan* plan)
{
    return plan->options.maxBounces > 2 && plan->options.ssvp.secondBounce > 0;
}

static inline bool vplSsvpShowsClusters(const vplPlan* plan)
{
    return plan->options.output.show == VPL_SHOW_PARABOLOID || plan->options.output.show == VPL_SHOW_CLUSTERS;
}

#endif
