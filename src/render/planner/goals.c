// SPDX-License-Identifier: MIT
// When a render ends, and which plan comes next: budgets, errors, and the planner's second thoughts.
#include "base/clock.h"
#include "render/planner/edge_steps.h"
#include "render/planner/planner.h"
#include "render/planner/time_plan.h"
#include "render/planner/ways.h"
#include "render/renderer.h"
#include "render/show.h"
#include "render/stages/make.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>

enum { MAX_TRUTH_PATHS = 2048 }; // of a pixel

// ---- what was asked for

void vplResolveQuality(vplRenderOptions* o)
{
    static const struct {
        double error, ms;
    } WORDS[] = {{0, 0}, {0.2, 1000}, {0.05, 10000}, {0.02, 120000}};
    if (o->stop.quality != VPL_QUALITY_NONE) {
        o->stop.maxError = o->stop.maxError > 0 ? o->stop.maxError : WORDS[o->stop.quality].error;
        o->stop.budgetMs = o->stop.budgetMs > 0 ? o->stop.budgetMs : WORDS[o->stop.quality].ms;
        o->stop.quality = VPL_QUALITY_NONE;
    }
}

// ---- paths

// Paths per pixel that are missing for the error that was asked for, as far as is foreseen, and a twentieth more.
static int missingPaths(const vplRenderer* r)
{
    const double asked = r->asked.stop.maxError, over = r->error.bound / asked;
    if (!(asked > 0 && over > 1)) {
        return INT_MAX;
    }
    return (int)fmin(INT_MAX, ceil(r->paths * fmax(1.05 * over * over - 1, 0.125)));
}

int vplNextPaths(const vplRenderer* r)
{
    const vplPlan* p = r->plan;
    const int left = p->options.path.samples - r->paths;
    if (p->options.method != VPL_METHOD_PATH) {
        return 0;
    }
    const int most = vplPathsOfPass(p);
    int paths = most;
    if (isfinite(r->deadline) || r->asked.stop.maxError > 0) { // at most as many as there are
        const int first = isfinite(r->deadline) ? 1 : 2;
        paths = r->paths < first ? first : r->paths;
        paths = paths < missingPaths(r) ? paths : missingPaths(r);
        paths = paths < most ? paths : most;
    }
    if (isfinite(r->deadline) && r->paths > 0) {
        const double each = r->passMs / r->paths;
        const int fit = (int)fmin(most, (vplTimeLeft(r) + 0.02 * r->asked.stop.budgetMs) / each);
        paths = fit < paths ? fit > 1 ? fit : 1 : paths;
    }
    return left <= 0 || paths < left ? paths : left;
}

// ---- errors

// Of 512 pixels few have most of the error, so its estimate is uncertain to the upper side.
static const double BOUND = 1.5; // standard errors

void vplJudgePicture(vplRenderer* r, const vplImage* picture)
{
    double sum = 0;
    const size_t values = 3 * (size_t)picture->width * (size_t)picture->height;
    r->judged = vplTruth_Judge(r->truth, picture, r->edges);
    for (size_t k = 0; k < values; k++) {
        sum += (double)picture->pixels[k];
    }
    const double mean = sum / (double)values, noise = fmax(0, r->error.noise) * mean;
    const double square = fmax(r->judged.square, noise * noise), bias = square - noise * noise;
    // Where the noise is unknown, the error is at least the spread of the truth.
    if (mean > 0) {
        r->judged.mean = mean; // better known than that of a few pixels of the truth
        const double likely = noise * noise + vplLikelyBias(bias, r->judged.spread);
        r->error.total = sqrt(r->error.noise < 0 ? fmax(likely, r->judged.spread) : likely) / mean;
        r->error.bound = sqrt(square + BOUND * r->judged.spread) / mean;
    } else {
        r->error.total = r->error.bound = r->judged.mean > 0 ? INFINITY : 0;
    }
}

// True where more paths would not change what follows from the error, or would cost more than they tell. With few paths
// the spread is underestimated where rare paths carry much light, so another plan needs more of them. `before` is the
// spread with half as many paths: where it falls no more, it is that of the choice of pixels.
static bool isClear(const vplRenderer* r, double asked, bool plansAgain, double before)
{
    const double goal = asked * r->judged.mean, square = r->judged.square, spread = r->judged.spread;
    const double spent = vplRaysOfPlan(r);
    const bool large = square - 2 * spread > goal * goal || spread < 0.15 * square || spread > 0.85 * before;
    const int paths = vplTruth_Paths(r->truth), sure = plansAgain ? VPL_SURE_PATHS : 1;
    return r->error.bound <= asked || (large && paths >= sure) || paths >= MAX_TRUTH_PATHS ||
           (double)r->judged.rays * VPL_PATH_RAY > 0.25 * spent;
}

// Few pixels of a picture by patches have most of its error. So the truth has more pixels for errors below 4 %, and in scenes that are
// not plain.
static int countTruthPixels(const vplRenderer* r)
{
    const vplRenderOptions* o = &r->plan->options;
    const bool many = o->method == VPL_METHOD_RADIOSITY && (o->stop.maxError < 0.04 || r->lightRays > 0);
    return many ? VPL_MANY_TRUTH_PIXELS : VPL_TRUTH_PIXELS;
}

vplResult vplRefineTruth(vplRenderer* r, double share)
{
    const double spread = r->judged.spread, start = vplClockMs();
    TRY(vplRenderer_RefreshPatches(r));
    TRY(vplTruth_Refine(&r->runner.run, r->truth, share));
    r->spreadBefore = spread;
    vplRun_AddTime(&r->runner.run, "truth", start);
    return VPL_SUCCESS;
}

void vplForgetTruth(vplRenderer* r)
{
    r->otherRays += vplTruth_Rays(r->truth);
    vplTruth_Destroy(r->truth);
    r->truth = NULL;
}

// Through all pixels.
static double countPaths(const vplTruth* truth)
{
    return (double)vplTruth_CountPixels(truth) * vplTruth_Paths(truth);
}

// Over all pixels, a wider truth has at least this share of the paths of the truth before. With a share of 1 each pixel mostly had twice as many
// paths as needed: paths double, and the pixels are a little fewer than VPL_WIDER_TRUTH times as many.
static const double AS_MANY = 0.8;

// Creates a truth of more pixels with about as many paths in all.
static vplResult createWiderTruth(const vplRenderer* r, const vplImage* image, double paths,
                                  vplTruth** widerOut)
{
    const vplRun* run = &r->runner.run;
    vplTruth* wider;
    TRY(vplTruth_Create(run, image, vplCountWiderTruth(r), &wider));
    vplResult result = VPL_SUCCESS;
    while (result == VPL_SUCCESS && countPaths(wider) < AS_MANY * paths) {
        result = vplTruth_Refine(run, wider, 1);
    }
    if (result != VPL_SUCCESS) {
        vplTruth_Destroy(wider);
        return result;
    }
    *widerOut = wider;
    return VPL_SUCCESS;
}

vplResult vplWidenTruth(vplRenderer* r)
{
    vplImage* image = NULL;
    vplTruth* wider;
    const double start = vplClockMs();
    TRY(vplRenderer_RefreshPatches(r));
    TRY(vplRenderer_Resolve(r, &image));
    const vplResult result = createWiderTruth(r, image, countPaths(r->truth), &wider);
    vplImage_Destroy(image);
    TRY(result); // a cancelled render begins the wider truth again, and so ends with the same bits
    vplLog(r->runner.run.context, VPL_LOG_INFO, "compares %d pixels with paths instead of %d",
           vplTruth_CountPixels(wider), vplTruth_CountPixels(r->truth));
    vplForgetTruth(r);
    r->truth = wider;
    r->spreadBefore = INFINITY;
    vplRun_AddTime(&r->runner.run, "truth", start);
    return VPL_SUCCESS;
}

vplResult vplJudge(vplRenderer* r, double asked, bool plansAgain, double ms)
{
    vplImage* image = NULL;
    vplRun* run = &r->runner.run;
    TRY(vplRenderer_RefreshPatches(r));
    vplResult result = vplRenderer_Resolve(r, &image);
    const double start = vplClockMs();
    if (result == VPL_SUCCESS && r->truth == NULL) {
        result = vplTruth_Create(run, image, countTruthPixels(r), &r->truth);
        vplRun_AddTime(run, "truth", start);
    }
    r->guided = result == VPL_SUCCESS && vplTruth_IsGuided(run, r->truth);
    while (result == VPL_SUCCESS) {
        vplJudgePicture(r, image);
        if (isClear(r, asked, plansAgain, r->spreadBefore) || vplClockMs() - start > ms / 3) {
            break;
        }
        result = vplRefineTruth(r, 1);
    }
    r->judgedNoise = r->error.noise;
    vplImage_Destroy(image);
    return result;
}

// A truth of 512 pixels may miss the few that have most of the error, and a picture would be taken whose pixels happened to be good. So
// an error of more than half of what was asked is confirmed by more pixels where their choice is most of the truth's spread, and beside
// traced edges of patches in scenes that are not plain. Any error is confirmed if its bound is above NEAR times what was asked. The first
// paths of the added pixels must cost less than CONFIRM times the rays of the picture.
static const double CONFIRM = 0.5, NEAR = 0.9;

static bool mustConfirm(const vplRenderer* r, double asked)
{
    const double rays = vplCountWiderTruth(r) * VPL_FIRST_TRUTH_PATHS * r->judged.pathRays * VPL_PATH_RAY;
    const bool doubtful =
        vplPixelsLimitTruth(r) || (r->lightRays > 0 && r->edges != NULL) || r->error.bound > NEAR * asked;
    return doubtful && 2 * r->error.bound > asked &&
           vplTruth_CountPixels(r->truth) <= VPL_MANY_TRUTH_PIXELS && rays < CONFIRM * vplRaysOfPlan(r) &&
           vplHasRoomForWiderTruth(r);
}

// Errors that a first pass may reach.
static const double EARLY_ERROR = 0.03;

static vplResult reviewError(vplRenderer* r, double asked, bool* doneOut)
{
    vplImage* image = NULL;
    const vplResult result = vplRenderer_Resolve(r, &image);
    vplImage_Destroy(image);
    TRY(result);
    if (r->plan->options.method == VPL_METHOD_PATH) {
        *doneOut = *doneOut || (r->error.bound >= 0 && r->error.bound <= asked);
        return *doneOut || r->paths < 2 ? VPL_SUCCESS : vplTurnBack(r, asked, doneOut);
    }
    // The noise of the first passes may be estimated too low; later estimates then stay above 0.8 of it, although the noise falls.
    const bool doubled = r->done >= 4 && (r->done & (r->done - 1)) == 0;
    const bool again =
        r->judgedNoise <= 0 || r->error.noise < 0.8 * r->judgedNoise || doubled || r->edges != NULL;
    const bool early = r->done == 1 && asked >= EARLY_ERROR;
    const bool ready =
        !r->plan->progressive || early || (r->done >= 2 && (r->error.noise <= 0.9 * asked || r->done == 6));
    const bool decides = !early || !r->plan->progressive; // the first pass does not tell noise from bias
    for (bool more = ready && again; more;) {
        more = false;
        TRY(vplJudge(r, asked, decides, INFINITY));
        if (r->error.bound <= asked && mustConfirm(r, asked)) {
            TRY(vplWidenTruth(r));
            more = true;
        } else if (r->error.bound <= asked) {
            *doneOut = true;
        } else if (decides) {
            TRY(vplReconsider(r, asked, doneOut, &more));
        } else {
            TRY(vplReconsiderEarly(r, asked, doneOut, &more));
        }
    }
    return VPL_SUCCESS;
}

// ---- after a pass

bool vplIsComplete(const vplRenderer* r)
{
    const vplRenderOptions* o = &r->plan->options;
    return o->method == VPL_METHOD_PATH ? r->paths >= o->path.samples
           : r->plan->progressive       ? o->stop.passes > 0 && r->done >= o->stop.passes
                                        : true;
}

// True where another pass would end too late by more than half of what is allowed.
static bool isTooLate(const vplRenderer* r)
{
    const double grown = vplShareOfPass(r->plan, r->done) / vplShareOfPass(r->plan, r->done - 1);
    const double next = r->plan->options.method == VPL_METHOD_PATH
                            ? r->passMs / r->paths
                            : r->lastMs * (0.5 + 0.5 * grown); // half of the time does not grow
    return isfinite(r->deadline) && vplTimeLeft(r) + 0.05 * r->asked.stop.budgetMs < next;
}

vplResult vplReview(vplRenderer* r, bool* doneOut)
{
    const double asked = r->asked.stop.maxError;
    *doneOut = false;
    if (r->coarse) {
        return vplFollowCoarse(r, doneOut);
    }
    const bool complete = vplIsComplete(r);
    *doneOut = complete;
    if (complete && r->plan->options.path.edgePixels > 0) {
        TRY(vplRenderer_TraceEdges(r, r->plan->options.path.edgePixels, r->plan->options.path.edgePaths));
    }
    if (asked > 0 && vplShowsLight(r->asked.output.show)) {
        TRY(reviewError(r, asked, doneOut));
    } else if (vplShowsLight(r->asked.output.show)) {
        TRY(vplSpendTime(r, doneOut));
    }
    if (r->done == 0) { // another plan, of which there is no pass yet
        return *doneOut ? VPL_SUCCESS : vplFitPlan(r, doneOut);
    }
    if (!*doneOut && isTooLate(r) && !vplStopGrowth(r)) {
        *doneOut = true;
        return vplSpendRest(r);
    }
    return VPL_SUCCESS;
}
