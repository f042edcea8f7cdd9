// SPDX-License-Identifier: MIT
// Second thoughts of radiosity: more patches, pixels at edges, or virtual lights instead.
#include "render/planner/patch_plan.h"
#include "render/planner/ways.h"

#include <math.h>

// ---- the next plan

// Multiplies the number of patches by VPL_MORE_PATCHES: as often as the way says in plain scenes; in others once, and the rays of the
// gather, too. Keeps the error beside edges, with which that of more patches is compared.
static vplResult divide(vplRenderer* r, const vplWay* way, bool* doneOut)
{
    int patches = r->plan->options.radiosity.patches, gather = r->asked.radiosity.gather;
    for (int i = 0; i < way->finer && (i == 0 || r->lightRays == 0); i++) {
        patches *= VPL_MORE_PATCHES;
    }
    if (gather < 0 && r->lightRays > 0 && r->plan->options.radiosity.gather > 0) {
        gather = VPL_MORE_GATHER * r->plan->options.radiosity.gather;
    }
    const vplRenderOptions o = vplAskedWithPatches(r, patches, gather);
    const double spent = vplRaysOfPlan(r);
    TRY(vplGoOnWith(r, "more patches", &o, doneOut));
    r->coarserSquare = way->rest;
    vplCountVainPatches(r, spent);
    return VPL_SUCCESS;
}

// The variance of unguided paths over that of guided ones, about (bench/guide: 2 to 5).
static const double UNGUIDED = 4;

// Gives patches up. Path tracing follows if it was foreseen to be quicker than virtual lights when patches were tried. Otherwise virtual
// lights follow, and as many pixels share them as before.
static vplResult leavePatches(vplRenderer* r, bool* doneOut)
{
    if (r->turn.rays > 0) {
        return vplGoOnWithPaths(r, doneOut);
    }
    const double paths = vplErrorState_Of(r).paths;
    vplRenderOptions o = vplAskedOfLights(r);
    o.pipeline.interleave = r->turn.side > 0 ? r->turn.side : o.pipeline.interleave;
    r->turn.side = 0;
    TRY(vplGoOnWith(r, "virtual lights", &o, doneOut));
    r->lightRays = fmax(r->lightRays, 1);
    if (r->guided) {
        r->turn.pathSquare = UNGUIDED * paths;
    }
    return VPL_SUCCESS;
}

// More patches are worth their time if their number is at least this factor above that of the plan before.
static const double WORTH_MORE = 1.3;

vplResult vplFitPatches(vplRenderer* r, double share)
{
    const vplRenderOptions* kept = r->kept.plan != NULL ? &r->kept.plan->options : &r->asked;
    const int patches = (int)(share * r->plan->options.radiosity.patches);
    if (kept->method == VPL_METHOD_RADIOSITY && patches > WORTH_MORE * kept->radiosity.patches) {
        const vplRenderOptions fewer = vplAskedWithPatches(r, patches, r->plan->options.radiosity.gather);
        vplLog(r->runner.run.context, VPL_LOG_INFO, "the time is enough for %d patches", patches);
        return vplRenderer_Plan(r, &fewer, false);
    }
    const vplRenderOptions o = vplAskedOfLights(r);
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "more patches would take too long: goes on with virtual lights");
    TRY(vplRenderer_Plan(r, &o, false));
    r->lightRays = fmax(r->lightRays, 1);
    return VPL_SUCCESS;
}

// ---- the decision

// More paths of the truth are not worth it where they would cost more than this share of what is foreseen.
static const double WORTH_OF_PATCHES = 0.3;

// A way with patches may need so many times the rays that virtual lights are foreseen to need: in scenes of small triangles the error of
// 1,000 patches predicts too many patches (furnished: 9,000 where 3,000 leave less than 10 %).
static const double HOPE = 2;

// The rays that virtual lights are foreseen to need are those of their passes. For small errors paths that prove the error and paths through edges need
// more, and no patches guide these: flat at 5 % takes 26, 15 and 100 s if this is not counted, 17, 16 and 18 s if it is (96x54, three seeds). For an
// error of 20 % shade would take 20 s instead of 4.
static const double SMALL_GOAL = 0.08, TIMES_OF_SMALL = 3;

// Rays that virtual lights are foreseen to need with all that follows.
static double raysOfLights(const vplRenderer* r, double asked)
{
    const bool counts = asked < SMALL_GOAL && r->guided;
    return (counts ? TIMES_OF_SMALL : 1) * r->lightRays;
}

// True if the planner gives patches up: no way reaches the error, or virtual lights are foreseen to need far fewer rays.
static bool isHopeless(const vplRenderer* r, const vplErrorState* s, double asked, const vplWay* way)
{
    const double lights = raysOfLights(r, asked);
    const bool over =
        way->rays > HOPE * lights || (way->finer > 0 && VPL_MORE_PATCHES_COST * s->spent > lights);
    return isinf(way->rays) || (lights > 0 && over);
}

// More patches come before patches are given up if they cost at most this share of what virtual lights are foreseen to need: 1,000 patches tell
// little about what more of them leave (corridor at 2 %).
static const double SHARE_TO_DIVIDE = 0.1;

static bool isDividedCheaply(const vplRenderer* r, const vplErrorState* s)
{
    return s->finer > 0 && s->finerCost * s->spent < SHARE_TO_DIVIDE * r->lightRays;
}

// Where virtual lights may take over, a squared error is surely too large if it is above the one asked for by so many standard errors of the
// truth. If it is not, more paths of the truth come before patches are given up or divided, as long as they are worth it. With 1 instead,
// 32 paths through each pixel of the corridor made 1,000 patches look hopeless at 10 % (96x54, one of four seeds), and nothing else ended
// within 150 s; with more paths the picture took 44 s.
static const double SURE_ERRORS = 2;

// More patches come before pixels at edges are traced if they cost at most this share of that. Corridor at 5 % would trace 16,384 paths through each of
// 819 pixels beside 3,000 patches, and then half as many more (200 s were not enough at 96x54).
static const double SHARE_OF_EDGES = 0.2;

vplResult vplReachByPatches(vplRenderer* r, const vplErrorState* s, double asked, bool* doneOut,
                            bool* moreOut)
{
    vplWay way;
    if (r->edges != NULL) {
        return vplProveEdges(r, s, asked, moreOut);
    }
    TRY(vplFindWay(r, s, asked, &way));
    // In plain scenes, where nothing limits the rays, the truth is cheap beside the patches that it may spare.
    const bool limited = r->lightRays > 0,
               far = way.rest - (limited ? SURE_ERRORS * s->spread : 0) > asked * asked;
    const bool inVain = r->coarserSquare > 0 && far && way.rest > 0.5 * r->coarserSquare;
    // Where there is no way, the truth may cost what virtual lights do.
    const double rays = limited && isinf(way.rays) ? r->lightRays : way.rays;
    const double next = limited && s->finer > 0 ? fmin(rays, s->finerCost * s->spent) : rays;
    if (!limited || inVain || !far) {
        TRY(vplLearnMore(r, s, asked, WORTH_OF_PATCHES * next, limited ? 0.5 * next : 0, moreOut));
    }
    if (*moreOut) {
        return VPL_SUCCESS;
    }
    if (inVain || isHopeless(r, s, asked, &way)) {
        if (inVain || !isDividedCheaply(r, s)) {
            return leavePatches(r, doneOut);
        }
        way.finer = 1;
    }
    const bool edgesAreDear = way.pixels > 0 && s->finerCost * s->spent < SHARE_OF_EDGES * way.rays;
    if (way.finer > 0 || (limited && s->finer > 0 && edgesAreDear)) {
        way.finer = way.finer > 0 ? way.finer : 1;
        return divide(r, &way, doneOut);
    }
    return vplFinishWay(r, &way, moreOut);
}
