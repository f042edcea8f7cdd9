// SPDX-License-Identifier: MIT
// A render that has a time and not an error: which plan leaves the least error when the time is over. What it decides depends on the
// clock; the plan that it ends with can be written and replayed.
#include "base/clock.h"
#include "render/planner/patch_plan.h"
#include "render/planner/time_plan.h"
#include "render/planner/ways.h"

#include <math.h>
#include <string.h>

// Shorter times have no room for a truth.
static const double LEAST_MS = 150;

// A third of this share of the time is for a look at the truth. Patches have no noise, so that all that is known of their error is from it.
static const double SHARE_OF_TRUTH = 1.0 / 30, SHARE_FOR_PATCHES = 0.3;

static vplResult judge(vplRenderer* r, double share)
{
    return vplJudge(r, 0, true, share * r->asked.stop.budgetMs);
}

// ---- other plans

// Milliseconds spent on the truth so far.
static double timeOfTruth(const vplRenderer* r)
{
    double ms = 0;
    for (int i = 0; i < r->runner.stats.stageCount; i++) {
        const vplStageTime* stage = &r->runner.stats.stages[i];
        ms = strcmp(stage->name, "truth") == 0 ? stage->ms : ms;
    }
    return ms;
}

// The mean milliseconds of one path through one pixel, of the truth so far.
static double timeOfPath(const vplRenderer* r)
{
    return timeOfTruth(r) / vplTruth_CountPixels(r->truth) / vplTruth_Paths(r->truth);
}

// Path tracing follows only if its squared error is foreseen to be this share of that of virtual lights, both by the rays and by the time of
// the truth's paths. Rays alone promise too much where many pixels cast coherent rays to one lamp; the truth has too few paths to show all
// of the variance; and virtual lights still gain from paths at edges when the time ends. In 5 s path tracing left 8.6 % of error in
// conference-spot, 7.9 in sponza-sun, 5.5 with 1,000 lamps and 5.2 in textured-room; virtual lights leave 4.6, 3.8, 3.8 and 1.0.
static const double SHARE_FOR_PATHS = 0.5;

// The least squared error for the time that is left.
static vplResult choosePlan(vplRenderer* r, bool* doneOut)
{
    const vplErrorState s = vplErrorState_Of(r);
    const double rate = s.spent / fmax(1, vplClockMs() - r->planStart), rays = rate * vplTimeLeft(r);
    const double finish = s.bias + s.noise * s.spent / (s.spent + rays);
    const double finer =
        s.finer > 0 ? s.finerBias * s.bias + s.finerCost * s.noise * s.spent / rays : INFINITY;
    const double paths = fmax(s.paths / rays, s.paths / s.path * timeOfPath(r) / vplTimeLeft(r));
    if (paths < SHARE_FOR_PATHS * fmin(finish, finer)) {
        return vplGoOnWithPaths(r, doneOut);
    }
    return finer < 0.8 * finish ? vplGoOnFiner(r, 1, doneOut) : VPL_SUCCESS;
}

// ---- pixels at edges

enum { FIRST_PATHS = 16 };

// Where the truth is uncertain, so much of its standard error counts as error.
static const double DOUBT = 0.5;

// A way to spend the rest of the time: passes, and then paths through pixels at edges.
typedef struct Closing {
    int pixels;    // at edges; 0: none
    double ms;     // of their paths
    double square; // the squared error that is foreseen for the picture
} Closing;

// Powers of two, and half as many more, are spread most evenly.
static int morePaths(int paths)
{
    return (paths & (paths - 1)) == 0 ? paths + paths / 2 : paths / 3 * 4;
}

// The pixels and the number of their paths, in `left` milliseconds at most, that leave the least error. Passes fill the rest. `bias`: the share of
// the squared bias that more patches leave; 1: there are no more.
static Closing findClosing(const vplRenderer* r, const vplErrorState* s, const vplEdgeStep* steps, int count,
                           double bias, double left)
{
    const double pathMs = timeOfPath(r), all = s->once ? 1 : r->passMs / (r->passMs + left);
    Closing best = {0, 0, bias * (s->bias + DOUBT * s->spread) + s->noise * all};
    for (int i = 0; i < count; i++) {
        const vplEdgeStep* step = &steps[i];
        const double each = step->pixels * pathMs;
        for (int paths = FIRST_PATHS; paths <= VPL_MAX_SAMPLES && paths * each <= left;
             paths = morePaths(paths)) {
            const double passes = s->once ? 1 : 1 + (left - paths * each) / r->passMs;
            const double square = bias * (step->bias + DOUBT * step->spread) + step->noise / passes +
                                  vplVarianceOfEdges(s, step, paths);
            if (square < best.square) {
                best = (Closing){step->pixels, paths * each, square};
            }
        }
    }
    return best;
}

// Traces paths through so many pixels at edges until the time is over; 0: none.
static vplResult traceEdges(vplRenderer* r, int pixels)
{
    const double allowed = 0.03 * r->asked.stop.budgetMs;
    double each = 0;
    int paths = FIRST_PATHS, before = 0;
    if (pixels == 0) {
        return VPL_SUCCESS;
    }
    do {
        const double start = vplClockMs();
        TRY(vplRenderer_TraceEdges(r, pixels, paths));
        each = (vplClockMs() - start) / (paths - before);
        before = paths;
        paths = morePaths(paths);
    } while (paths <= VPL_MAX_SAMPLES && (paths - before) * each < vplTimeLeft(r) + allowed);
    vplLog(r->runner.run.context, VPL_LOG_INFO, "%d paths through each of %d pixels at edges fill the time",
           before, r->edgePixels);
    return VPL_SUCCESS;
}

// ---- after a pass

// More patches are worth it if they leave at most this share of the squared error, and this share of the time.
static const double WORTHWHILE = 0.8, SHARE_AFTER = 0.3;

// The time of a picture with 16 samples per pixel instead of 8.
static const double SMOOTHER = 1.8;

// The error is as good as unknown if the truth's standard error is more than UNKNOWN times the squared error, and more than the square of
// LARGE. Then a few paths of the truth that carry much light may be all of the error, and tracing pixels like theirs would bring such light
// into the picture (corridor in 5 s, seed 1: 72 % instead of 16).
static const double UNKNOWN = 0.7, LARGE = 0.1;

static bool isUnknown(const vplRenderer* r)
{
    const double mean = r->judged.mean, spread = r->judged.spread;
    return spread > UNKNOWN * r->judged.square && spread > LARGE * LARGE * mean * mean;
}

// Finds steps of edges; none if the error is as good as unknown.
static vplResult findKnownSteps(vplRenderer* r, vplEdgeStep steps[VPL_EDGE_STEPS], int* countOut)
{
    *countOut = 0;
    return isUnknown(r) ? VPL_SUCCESS : vplFindUsefulSteps(r, steps, countOut);
}

// Judges the picture's error, and finds steps of edges.
static vplResult lookForEdges(vplRenderer* r, double share, vplEdgeStep steps[VPL_EDGE_STEPS], int* countOut)
{
    TRY(judge(r, share));
    return findKnownSteps(r, steps, countOut);
}

static bool isKnown(const vplRenderer* r)
{
    return !isUnknown(r);
}

// The bound is so near to the error that more paths hardly lower it.
static const double NEAR = 1.1;

static bool isSure(const vplRenderer* r)
{
    return r->error.bound <= NEAR * r->error.total;
}

// Further paths of the truth may take SHARE_TO_KNOW of the time that is left. If fewer fit than LEAST_MORE of those that are done, none is traced.
static const double SHARE_TO_KNOW = 0.9, LEAST_MORE = 0.1;

// Traces more paths of the truth until it is enough, or until the time is over: as many again as there are, or as many as fit.
static vplResult learnError(vplRenderer* r, bool (*isEnough)(const vplRenderer* r))
{
    while (!isEnough(r) && 2 * vplTruth_Paths(r->truth) <= VPL_MAX_SAMPLES) {
        const double share = fmin(1, SHARE_TO_KNOW * vplTimeLeft(r) / fmax(1, timeOfTruth(r)));
        if (share < LEAST_MORE) {
            break;
        }
        TRY(vplRefineTruth(r, share));
        TRY(judge(r, 0));
    }
    return VPL_SUCCESS;
}

// Spends the rest of the time on paths through those pixels at edges that leave the least error, and what these leave of it on paths of the
// truth, which lower the bound of the error.
static vplResult spendRest(vplRenderer* r, const vplEdgeStep* steps, int count)
{
    vplErrorState s = vplErrorState_Of(r);
    s.once = true; // no pass follows
    TRY(traceEdges(r, findClosing(r, &s, steps, count, 1, vplTimeLeft(r)).pixels));
    return learnError(r, isSure);
}

// Looks for pixels at edges, and spends the rest of the time.
static vplResult lookAndSpend(vplRenderer* r)
{
    vplEdgeStep steps[VPL_EDGE_STEPS];
    int count;
    TRY(lookForEdges(r, SHARE_OF_TRUTH, steps, &count));
    return spendRest(r, steps, count);
}

// The planner looks for other plans once, when a sixth of the time is over, and for edges in the second half of it.
static vplResult spendOnPasses(vplRenderer* r, bool* doneOut)
{
    const double budget = r->asked.stop.budgetMs, left = vplTimeLeft(r) / budget;
    if (r->truth == NULL && r->done >= 4 && left < 0.84 && left > 0.3) {
        TRY(judge(r, SHARE_OF_TRUTH));
        TRY(choosePlan(r, doneOut));
    }
    if (r->done >= 2 && left < 0.5 && r->closingMs < 0) {
        vplEdgeStep steps[VPL_EDGE_STEPS];
        int count;
        TRY(lookForEdges(r, SHARE_OF_TRUTH, steps, &count));
        const vplErrorState s = vplErrorState_Of(r);
        r->closingMs = findClosing(r, &s, steps, count, 1, vplTimeLeft(r)).ms;
    }
    if (r->closingMs > 0 && vplTimeLeft(r) - r->lastMs < r->closingMs) {
        *doneOut = true;
        return lookAndSpend(r);
    }
    return VPL_SUCCESS;
}

// Patches have no noise. Either there are more of them, whose time grows with the square of their number and whose squared error falls with
// it, and paths at edges follow in what is left of the time; or these paths come at once, after more paths of the truth if the error is unknown.
static vplResult spendOnPatches(vplRenderer* r, bool* doneOut)
{
    static const double MORE[] = {1.5, 2, 3, 4, 6};
    const int patches = r->plan->options.radiosity.patches, most = (int)vplMostPatches(r->runner.run.context);
    vplEdgeStep steps[VPL_EDGE_STEPS];
    int count;
    TRY(lookForEdges(r, SHARE_FOR_PATCHES, steps, &count));
    const vplErrorState s = vplErrorState_Of(r);
    const int gather = r->plan->options.radiosity.gather;
    const double left = vplTimeLeft(r), smoother = gather > 0 ? VPL_MORE_GATHER : SMOOTHER;
    const double picture = smoother * vplShareOfPicture(r->plan) * r->passMs;
    const double exchange = (1 - vplShareOfPicture(r->plan)) * r->passMs;
    const Closing now = findClosing(r, &s, steps, count, 1, left);
    double best = WORTHWHILE * now.square, more = 1;
    for (size_t i = 0; i < sizeof MORE / sizeof *MORE; i++) {
        const double rest = left - picture - exchange * MORE[i] * MORE[i];
        if (rest > SHARE_AFTER * left && MORE[i] * patches <= most) {
            const Closing then = findClosing(r, &s, steps, count, 1 / MORE[i], rest);
            more = then.square < best ? MORE[i] : more;
            best = fmin(best, then.square);
        }
    }
    if (more > 1) {
        const vplRenderOptions o = vplAskedWithPatches(r, (int)(more * patches), VPL_MORE_GATHER * gather);
        vplLog(r->runner.run.context, VPL_LOG_INFO, "the error is about %.3g %%: goes on with %d patches",
               100 * r->error.total, o.radiosity.patches);
        *doneOut = false;
        return vplRenderer_Replace(r, &o, false, -1);
    }
    if (isUnknown(r)) {
        TRY(learnError(r, isKnown));
        TRY(findKnownSteps(r, steps, &count));
    }
    return spendRest(r, steps, count);
}

vplResult vplSpendTime(vplRenderer* r, bool* doneOut)
{
    const bool patches = r->plan->options.method == VPL_METHOD_RADIOSITY && vplMayChoosePatches(&r->asked);
    if (!vplHasTimeAlone(r) || r->asked.stop.budgetMs < LEAST_MS) {
        return VPL_SUCCESS;
    }
    return patches                ? spendOnPatches(r, doneOut)
           : r->plan->progressive ? spendOnPasses(r, doneOut)
                                  : VPL_SUCCESS;
}

// Less of the time is not worth it.
static const double LEAST_REST = 0.1;

vplResult vplSpendRest(vplRenderer* r)
{
    const double budget = r->asked.stop.budgetMs;
    const bool enough = budget >= LEAST_MS && vplTimeLeft(r) >= LEAST_REST * budget;
    return enough && vplHasTimeAlone(r) && r->plan->progressive && r->edges == NULL ? lookAndSpend(r)
                                                                                    : VPL_SUCCESS;
}
