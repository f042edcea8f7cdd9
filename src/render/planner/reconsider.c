// SPDX-License-Identifier: MIT
// Second thoughts: the noise and the bias of the picture so far say what more passes, a finer plan and path tracing would
// cost. Costs are counted in rays and not in seconds, so that the same plan is chosen on every machine.
#include "base/clock.h"
#include "base/numbers.h"
#include "render/planner/patch_plan.h"
#include "render/planner/ways.h"

#include <math.h>
#include <stdio.h>

// Passes after which the noise is known well. After fewer it is uncertain, because pixels share lights: where it is
// estimated too low, the rest of the error looks like bias.
enum { SURE_PASSES = 5 };

// ---- the next plan

vplResult vplGoOnWith(vplRenderer* r, const char* what, const vplRenderOptions* o, bool* doneOut)
{
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "after %d passes the noise is %.3g %% and the error about %.3g %%: goes on with %s", r->done,
           100 * fmax(0, r->error.noise), 100 * r->error.total, what);
    *doneOut = false;
    return vplRenderer_Replace(r, o, false, r->error.total);
}

vplResult vplGoOnWithPaths(vplRenderer* r, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    o.method = VPL_METHOD_PATH;
    r->turn = (vplTurn){0};
    return vplGoOnWith(r, "path tracing", &o, doneOut);
}

vplResult vplGoOnFiner(vplRenderer* r, int finer, bool* doneOut)
{
    vplRenderOptions o = vplAskedLikePlan(r);
    o.output.antialias = o.output.antialias < 16 && r->asked.output.antialias == 8 ? 16 : o.output.antialias;
    o.pipeline.interleave >>= finer;
    return vplGoOnWith(r, "fewer pixels that share lights", &o, doneOut);
}

// After some passes the planner tries patches only if the error is still more than so many times the one asked for. If it is less,
// most of the error is at edges, which patches have, too (loft at 2 %: 18 to 31 s instead of 10).
static const double FAR = 2;

// Goes on with patches if they may be quicker than both virtual lights and path tracing. `lights` and `paths`: rays that these are
// foreseen to need. `lost`: rays of the passes so far, which are discarded.
static vplResult tryPatches(vplRenderer* r, double lights, double paths, double lost, bool* doneOut)
{
    const double otherwise = fmin(lights, paths);
    const double share = VPL_SHARE_OF_PATCHES * otherwise - lost;
    const bool may = r->asked.method == VPL_METHOD_AUTO && r->lightRays == 0 && isfinite(otherwise);
    if (!may || !vplMayTryPatches(&r->runner, r->plan, &r->asked, share)) {
        return VPL_SUCCESS;
    }
    const vplPipelineOptions* pipeline = &r->plan->options.pipeline;
    const int side = pipeline->kind == VPL_ACCUMULATE_INTERLEAVED ? pipeline->interleave : 0;
    const vplRenderOptions o = vplAskedWithPatches(r, VPL_FIRST_PATCHES, r->asked.radiosity.gather);
    TRY(vplGoOnWith(r, "light that patches exchange", &o, doneOut));
    r->lightRays = otherwise;
    r->turn.rays = paths < lights ? paths : 0;
    r->turn.side = side;
    vplForgetTruth(r); // its pixels were chosen by a noisy picture
    return VPL_SUCCESS;
}

// All light instead of direct light alone.
static vplResult addLights(vplRenderer* r, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    o.method = VPL_METHOD_KELLER;
    o.lights.shadows = r->plan->options.lights.shadows;
    o.particles.count = 1000;
    return vplGoOnWith(r, "reflected light", &o, doneOut);
}

// Paths that need so many times the rays of the way that they were preferred to are given up. Rare paths that carry much light
// are not among the first, so that the paths of the truth may promise too much.
static const double GIVE_UP = 1.5;

vplResult vplTurnBack(vplRenderer* r, double asked, bool* doneOut)
{
    const double spent = VPL_PATH_RAY * (double)r->runner.stats.rays; // of the paths alone
    const double pathSquare = r->error.noise * r->error.noise * spent,
                 needed = pathSquare / (asked * asked) - spent;
    if (r->asked.method != VPL_METHOD_AUTO || r->turn.side == 0 || needed < GIVE_UP * r->turn.rays) {
        return VPL_SUCCESS;
    }
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "after %d paths per pixel the noise is %.3g %%, more than foreseen: goes back to virtual lights "
           "that %d pixels share",
           r->paths, 100 * r->error.noise, r->turn.side * r->turn.side);
    vplRenderOptions o = vplAskedOfLights(r);
    o.pipeline.interleave = r->turn.side;
    r->turn = (vplTurn){0, pathSquare, 0};
    *doneOut = false;
    return vplRenderer_Replace(r, &o, false, r->error.total);
}

// ---- the decision

// The truth is known well enough for a decision where its standard error is this share of the squared error that was asked for;
// and more paths of it are not worth it where they would cost more than this share of what is foreseen.
static const double KNOWN = 0.1, WORTH = 0.1;

vplResult vplReconsiderEarly(vplRenderer* r, double asked, bool* doneOut, bool* moreOut)
{
    const vplErrorState s = vplErrorState_Of(r);
    TRY(vplTryEdges(r, &s, asked, moreOut));
    const double more = s.spent * fmax(0, s.square / (asked * asked) - 1); // as if all of the error was noise
    return *moreOut ? VPL_SUCCESS : tryPatches(r, more, s.paths / (asked * asked), 0, doneOut);
}

// Begins path tracing. Where paths need more rays than foreseen, it turns back to `way`, without the passes that are done.
static vplResult tracePaths(vplRenderer* r, const vplErrorState* s, const vplWay* way, bool* doneOut)
{
    const double rays = way->rays + (way->finer == 0 ? s->spent : 0);
    const int side = r->plan->options.pipeline.interleave >> way->finer;
    const bool turns = isfinite(rays) && r->plan->options.pipeline.kind == VPL_ACCUMULATE_INTERLEAVED;
    TRY(vplGoOnWithPaths(r, doneOut));
    r->turn = (vplTurn){turns ? rays : 0, s->paths, turns ? side : 0};
    return VPL_SUCCESS;
}

// The planner leaves a plan for a finer one, or for path tracing, only when the passes so far have cost KNOWING times what the other
// would cost, or when the squared noise is at most UNSURE times the squared bias. Where few lights reach the picture, the noise of
// the first passes is estimated far too low, and the rest of the error looks like bias (hall: 23 % after six passes, where it is
// 40 %). Without this rule two of five pictures of the hall took more than 200 s instead of 11 to 17 s, and one of furnished 87 s
// instead of 12.
static const double KNOWING = 0.5, UNSURE = 0.1;

vplResult vplLearnMore(vplRenderer* r, const vplErrorState* s, double asked, double paths, double pixels,
                       bool* moreOut)
{
    const bool unknown = s->spread > KNOWN * asked * asked;
    if (unknown && !s->stuck && s->truth < paths) {
        *moreOut = true;
        return vplRefineTruth(r, 1);
    }
    if (unknown && s->stuck && s->truth < pixels && vplHasRoomForWiderTruth(r)) {
        *moreOut = true;
        return vplWidenTruth(r);
    }
    return VPL_SUCCESS;
}

// The way that needs least for the error.
static vplResult reach(vplRenderer* r, const vplErrorState* s, double asked, bool* doneOut, bool* moreOut)
{
    vplWay way;
    if (r->plan->progressive && r->done < SURE_PASSES && r->error.total < 2 * asked) {
        return vplTryEdges(r, s, asked, moreOut);
    }
    if (r->edges != NULL) {
        return vplProveEdges(r, s, asked, moreOut);
    }
    TRY(vplFindWay(r, s, asked, &way));
    const double paths = s->paths / (0.9 * asked * asked);
    const double next = fmin(way.rays, paths), half = 0.5 * s->spent; // more passes come first
    TRY(vplLearnMore(r, s, asked, fmin(WORTH * next, half), 0.5 * fmin(next, half), moreOut));
    if (*moreOut) {
        return VPL_SUCCESS;
    }
    const bool leaves = paths < way.rays || way.finer > 0, unsure = s->noise > UNSURE * s->bias;
    if (r->error.total > FAR * asked) {
        TRY(tryPatches(r, way.rays, paths, s->spent, doneOut));
        if (r->done == 0) {
            return VPL_SUCCESS; // another plan
        }
    }
    if (leaves && unsure && s->spent < KNOWING * next) {
        return VPL_SUCCESS; // more passes
    }
    if (paths < way.rays) {
        return tracePaths(r, s, &way, doneOut);
    }
    if (way.finer > 0) {
        return vplGoOnFiner(r, way.finer, doneOut);
    }
    if (way.passes > 1 || isinf(way.rays)) {
        return VPL_SUCCESS;
    }
    return vplFinishWay(r, &way, moreOut);
}

vplResult vplReconsider(vplRenderer* r, double asked, bool* doneOut, bool* moreOut)
{
    const vplErrorState s = vplErrorState_Of(r);
    if (r->asked.method == VPL_METHOD_AUTO && r->plan->options.method == VPL_METHOD_DIRECT) {
        return addLights(r, doneOut);
    }
    if (r->asked.method == VPL_METHOD_AUTO && r->plan->options.method == VPL_METHOD_RADIOSITY) {
        return vplReachByPatches(r, &s, asked, doneOut, moreOut);
    }
    if (r->asked.method == VPL_METHOD_AUTO) {
        return reach(r, &s, asked, doneOut, moreOut);
    }
    if (s.bias > asked * asked && s.noise < 0.1 * s.bias) {
        vplFormat(r->ended, sizeof r->ended,
                  "edges, blur and light that is left out are %.3g %% of it, which more passes do not mend",
                  100 * sqrt(s.bias));
        *doneOut = true;
    }
    return VPL_SUCCESS;
}
