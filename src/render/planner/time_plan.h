// SPDX-License-Identifier: MIT
// Plans that fit into the time that is left, and what a render that has a time and no error does with it.
#ifndef VPL_RENDER_PLANNER_TIME_PLAN_H
#define VPL_RENDER_PLANNER_TIME_PLAN_H

#include "render/renderer.h"

// The time in ms that a plan, none of whose passes has begun, is foreseen to need for its first picture. Geometry, patches and their sides do not count if
// planning has made them; times of virtual lights are multiplied by the pace of the renderer.
double vplTimeOfFirst(const vplRenderer* renderer);

// A plan becomes smaller until its first picture is foreseen in this share of the time that is left: a picture that is not ready when
// the time is over is lost.
#define VPL_SURE_SHARE 0.8

// True if the first picture of the plan is foreseen in this share of the time that is left.
bool vplIsInTime(const vplRenderer* renderer, double share);

// The share of the time of the first pass that drawing the picture is foreseen to take.
double vplShareOfPicture(const vplPlan* plan);

// True if a time is given without an error, and the method is left to the planner.
static inline bool vplHasTimeAlone(const vplRenderer* r)
{
    return r->asked.method == VPL_METHOD_AUTO && r->asked.stop.budgetMs > 0 && !(r->asked.stop.maxError > 0);
}

// After a coarse picture: goes on with the plan that was asked for, or with as much of it as the time is enough for.
vplResult vplFollowCoarse(vplRenderer* renderer, bool* doneOut);

// Makes a plan that has not begun smaller, as far as options are left to the planner, until its first picture comes in time.
// *doneOut: it cannot.
vplResult vplFitPlan(vplRenderer* renderer, bool* doneOut);

// Where a pass of twice the particles would come too late: passes stay as large as the last one. True if such a pass comes in time.
bool vplStopGrowth(vplRenderer* renderer);

// After a pass of a render that has a time and not an error: goes on with a finer plan, with more patches or with path tracing where that
// promises less error, and spends the last part of the time on paths through pixels at edges where these do.
vplResult vplSpendTime(vplRenderer* renderer, bool* doneOut);

// In the time that is left, if it is too short for another pass: traces paths through pixels at edges, and then more of the truth.
vplResult vplSpendRest(vplRenderer* renderer);

#endif
