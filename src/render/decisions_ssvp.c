// SPDX-License-Identifier: MIT
// Decisions about SSVP: the number of bounces, and the lights of each.
#include "render/plan.h"

#include "render/stages/ssvp.h"

// SSVP stops where all further bounces would add less than this share of the indirect light of a closed room.
static const double LEAST_BOUNCE_SHARE = 1.0 / 64;

// Most bounces that SSVP makes by itself: in a room that reflects 0.77 of its light they leave out a 64th.
enum { MOST_SSVP_BOUNCES = 16 };

// Of the light that is reflected k times or more in a closed room, the share rho^n is reflected n times more.
static void chooseBounces(const vplRunner* r, vplPlan* p)
{
    vplRenderOptions* o = &p->options;
    p->reflectance = vplGeometry_MeanReflectance(r->run.results[VPL_STAGE_GEOMETRY]);
    if (o->maxBounces < 0) {
        double left = p->reflectance;
        o->maxBounces = 1;
        for (; o->maxBounces < MOST_SSVP_BOUNCES && left >= LEAST_BOUNCE_SHARE; o->maxBounces++) {
            left *= p->reflectance;
        }
        vplDecide(p, "max-bounces",
                  "surfaces reflect %.2g of their light on average; further bounces would add %.2g %%",
                  p->reflectance, 100 * left);
    }
    o->maxBounces = o->maxBounces < VPL_MAX_STEPS_REPORTED ? o->maxBounces : VPL_MAX_STEPS_REPORTED;
}

// Counts the most lights that SSVP can have.
static void countSsvpLights(vplPlan* p)
{
    const vplRenderOptions* o = &p->options;
    for (int i = 0; i < o->maxBounces; i++) {
        const int lights = i == 0 ? o->ssvp.firstBounce : vplSsvpCountLights(p, i);
        p->stepCount += lights > 0;
        p->particlesPerStep[i] = lights;
        p->virtualLights += lights;
    }
}

void vplDecideBounces(const vplRunner* r, vplPlan* p)
{
    chooseBounces(r, p);
    countSsvpLights(p);
}

// The number of clusters follows from what their lights see, and most of the memory from that number.
vplResult vplForetellClusters(vplRunner* r, const vplPlan* p)
{
    const bool splits = p->options.method == VPL_METHOD_SSVP && p->showsVirtual && vplSsvpSplits(p);
    return splits ? vplRunner_RunPlan(r, p, VPL_STAGE_CLUSTERED_LIGHTS) : VPL_SUCCESS;
}
