// SPDX-License-Identifier: MIT
// What follows a coarse picture: the plan that was asked for, or as much of it as the time is enough for.
#include "base/clock.h"
#include "render/planner/coarse_plan.h"
#include "render/planner/patch_plan.h"
#include "render/planner/planner.h"
#include "render/planner/time_plan.h"
#include "render/stages/results.h"

#include <math.h>

// Direct light with smooth edges takes about this many times as long as without, because many emitters have many rims of shadows: with 1,000
// lamps 3.4 s of a processor instead of 1.7. The factor is larger than 2 because foreseen times are wrong by some tenths.
static const double TIMES_OF_EDGES = 2.5;

// Sets the emitters of the picture that follows a coarse one, for which a tree chose few at each point. It has what was asked for if
// that fits into 0.7 of the time; else all emitters without smooth edges; else as many choices as fit.
static void addEmitters(const vplRenderer* r, vplRenderOptions* o)
{
    int placed;
    const int asked = vplChosenEmitters(r->plan, o->lights.emitterSamples, &placed);
    const int before = r->plan->emittersPerPoint;
    const double all = vplAskedEmitters(r->plan);
    const double spent = vplClockMs() - r->planStart;
    const double fits = before * fmax(1, 0.7 * vplTimeLeft(r) / fmax(spent, 1)),
                 rays = vplChoiceWork(placed) * fits;
    if (before == 0 || (asked > 0 ? fits >= asked : rays >= TIMES_OF_EDGES * all)) {
        return;
    }
    if (asked == 0 && rays >= all) {
        o->output.antialias = 1;
        return;
    }
    o->lights.emitterSamples = (int)fits;
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "%d of the scene's %d lights are chosen for each point in this time", o->lights.emitterSamples,
           placed);
}

// After a coarse picture of radiosity the next has as many patches as half of the time is enough for, where the time
// grows with the square of their number.
static vplResult refine(vplRenderer* r)
{
    vplRenderOptions o = r->asked;
    if (r->plan->options.method != VPL_METHOD_RADIOSITY) {
        addEmitters(r, &o);
        return vplRenderer_Replace(r, &o, false, -1);
    }
    const double spent = vplClockMs() - r->planStart, before = r->plan->options.radiosity.patches;
    const double patches = before * sqrt(fmax(1, 0.4 * vplTimeLeft(r) / fmax(spent, 1)));
    const bool coarse = patches < 0.75 * o.radiosity.patches;
    if (coarse) {
        vplCoarsen(r, patches / o.radiosity.patches, &o);
        o.output.antialias = r->asked.output.antialias;
    }
    TRY(vplRenderer_Replace(r, &o, coarse, -1));
    return coarse ? vplEnlargePixels(r, VPL_MOST_ENLARGED, &o) : VPL_SUCCESS;
}

// A first picture by patches may take SHARE_OF_PATCHES of the time, and the rays that gather their light SHARE_OF_GATHER. Pictures with a gather take
// up to 1.7 times the predicted time (flat), so the gather is left out if the prediction is more than SURE_OF_GATHER of the time left.
static const double SHARE_OF_PATCHES = 0.5, SHARE_OF_GATHER = 0.25, SURE_OF_GATHER = 0.55;

// Patches without a gather are tried even if they are foreseen to take LATEST times the time that is left: virtual lights, which would follow
// instead, are useless there, and the coarse picture stays if the patches are late.
static const double LATEST = 1.25;

// Patches that are made already stay where their number is so near to the one that fits.
static const double FEWER = 0.7;

// Options of a first picture by patches. More samples per pixel follow with more patches.
static vplRenderOptions firstPatches(const vplRenderer* r, double patches, int gather)
{
    vplRenderOptions o = vplAskedWithPatches(r, (int)patches, gather);
    o.output.antialias = r->asked.output.antialias;
    return o;
}

static vplResult planPatches(vplRenderer* r, double patches, int gather)
{
    const vplRenderOptions o = firstPatches(r, patches, gather);
    return vplRenderer_Plan(r, &o, false);
}

static double drawingMs(const vplRenderer* r)
{
    return vplShareOfPicture(r->plan) * r->plan->firstMs;
}

// The number of gather rays per pixel that fits into the time; 0 if it is less than VPL_FEWEST_GATHER.
static int fitGather(const vplRenderer* r)
{
    const double fit = fmin(1, SHARE_OF_GATHER * vplTimeLeft(r) / drawingMs(r));
    const int gather = (int)(fit * r->plan->options.radiosity.gather);
    return gather < VPL_FEWEST_GATHER ? 0 : gather;
}

// The number of patches that fits into the time beside `drawn` ms for the picture. The time of the exchange of light grows with its square.
// Groups of triangles take as long to make for fewer patches, so they stay if they are in time.
static double fitPatches(const vplRenderer* r, double drawn)
{
    const double planned = r->plan->options.radiosity.patches, exchange = vplTimeOfFirst(r) - drawingMs(r);
    const double left = vplTimeLeft(r), rest = fmax(0, SHARE_OF_PATCHES * left - drawn);
    const double fits = planned * sqrt(rest / exchange);
    const bool about = fits > FEWER * planned && fits < planned / FEWER;
    const bool inTime = r->plan->patchGroups > 0 && exchange + drawn <= VPL_SURE_SHARE * left;
    return about || (inTime && fits < planned) ? planned : fmin(fits, vplMostPatches(r->runner.run.context));
}

// Replaces a plan of VPL_FIRST_PATCHES patches by one with as many patches and gather rays as fit into the time, or by virtual lights if
// too few patches fit. The gather is left out if too few rays fit or the picture may be late with them: where doors hide the lights, patches
// without a gather have less error than virtual lights (320x180: corridor in 200 ms 17 % instead of 80 to 150, flat in 300 ms 13 instead of 36 to 94).
// It is kept where triangles are grouped into patches (furnished in 1 s: 16 % with a gather, 64 without). Plain scenes have no gather; if their
// patches are late, vplFitPlan makes them fewer.
static vplResult fillTime(vplRenderer* r)
{
    const vplRadiosityOptions planned = r->plan->options.radiosity;
    const vplRenderOptions lights = vplAskedOfLights(r);
    const bool gathers = planned.gather > 0, mayDrop = gathers && r->plan->patchGroups == 0;
    int gather = fitGather(r);
    if (gathers && gather == 0 && !mayDrop) {
        return vplRenderer_Plan(r, &lights, false);
    }
    double patches = fitPatches(r, gathers ? drawingMs(r) * gather / planned.gather : drawingMs(r));
    if (mayDrop && (gather == 0 || patches < VPL_FEWEST_PATCHES)) {
        gather = 0;
        TRY(planPatches(r, planned.patches, 0));
        patches = fmax(fitPatches(r, drawingMs(r)),
                       vplIsInTime(r, VPL_SURE_SHARE) ? planned.patches : VPL_FEWEST_PATCHES);
    }
    if (patches < VPL_FEWEST_PATCHES) {
        return vplRenderer_Plan(r, &lights, false);
    }
    TRY(planPatches(r, patches, gather));
    if (mayDrop && gather > 0 && !vplIsInTime(r, SURE_OF_GATHER)) {
        TRY(planPatches(r, patches, 0));
    }
    if (mayDrop && !vplIsInTime(r, r->plan->options.radiosity.gather > 0 ? VPL_SURE_SHARE : LATEST)) {
        return vplRenderer_Plan(r, &lights, false);
    }
    vplDecide(r->plan, "method", "light that patches exchange has no noise");
    vplDecide(r->plan, "patches", "as many as the time is enough for");
    return VPL_SUCCESS;
}

// Foreseen times of virtual lights are wrong by a factor of up to four.
static void notePace(vplRenderer* r)
{
    if (r->plan->showsVirtual) {
        r->pace = fmin(4, fmax(0.25, r->passMs / fmax(vplTimeOfFirst(r), 1)));
    }
}

// The size of the smallest pixels that fit into the time, if those of `size` took `spent` ms.
static int smallestPixels(const vplRenderer* r, int size, double spent)
{
    const double fits = fmax(VPL_SURE_SHARE * vplTimeLeft(r), 0.1);
    return (int)fmax(1, ceil(size * sqrt(spent / fits)));
}

// Where nothing else fits into the time, the coarse picture follows with smaller pixels. `spent`: ms that it took.
static vplResult shrinkPixels(vplRenderer* r, const vplRenderOptions* coarse, double spent, bool* doneOut)
{
    vplRenderOptions o = *coarse;
    o.maxBounces = r->asked.maxBounces; // SSVP may have left some out
    o.output.pixelSize = smallestPixels(r, coarse->output.pixelSize, spent);
    *doneOut = o.output.pixelSize >= coarse->output.pixelSize;
    return *doneOut ? VPL_SUCCESS : vplRenderer_Plan(r, &o, true);
}

// After a coarse picture of paths the next has smaller pixels, or if none fit, more paths for each of the same.
static vplResult followPaths(vplRenderer* r)
{
    vplRenderOptions o = r->plan->options;
    const int before = o.output.pixelSize;
    o.output.pixelSize = smallestPixels(r, before, r->passMs);
    if (o.output.pixelSize == 1) {
        return vplRenderer_Replace(r, &r->asked, false, -1);
    }
    if (o.output.pixelSize < before) {
        return vplRenderer_Replace(r, &o, true, -1);
    }
    r->plan->options.path.samples = r->asked.path.samples < 0 ? VPL_MAX_SAMPLES : r->asked.path.samples;
    r->coarse = false;
    return VPL_SUCCESS;
}

vplResult vplFollowCoarse(vplRenderer* r, bool* doneOut)
{
    const vplRenderOptions coarse = r->plan->options;
    const double spent = vplClockMs() - r->planStart;
    const double rays = vplTimeLeft(r) * (double)r->runner.stats.rays /
                        fmax(1, r->passMs); // at the pace of the coarse picture
    int gather;
    if (coarse.method == VPL_METHOD_PATH) {
        return followPaths(r);
    }
    notePace(r);
    if (vplSuitsPatches(r, rays, &gather)) {
        const vplRenderOptions o = firstPatches(r, VPL_FIRST_PATCHES, gather);
        TRY(vplRenderer_Replace(r, &o, false, -1));
        TRY(fillTime(r));
    } else {
        TRY(refine(r));
    }
    TRY(r->coarse ? VPL_SUCCESS : vplFitPlan(r, doneOut));
    return *doneOut && coarse.output.pixelSize > 1 ? shrinkPixels(r, &coarse, spent, doneOut) : VPL_SUCCESS;
}
