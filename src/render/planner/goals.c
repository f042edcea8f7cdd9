// SPDX-License-Identifier: MIT
// When a render ends, and which plan comes next: budgets, errors, and the planner's second thoughts.
#include "base/clock.h"
#include "render/planner/edge_steps.h"
#include "render/planner/planner.h"
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

static double leftOf(const vplRenderer* r)
{
    return r->deadline - vplClockMs();
}

// ---- coarse plans

// Share of the time that may pass until the first picture; times are foreseen within a factor of two.
static const double FIRST_SHARE = 0.25;

// A coarse plan takes a sample of emitters only where there are more.
enum { FEW_EMITTERS = 16 };

static int countEmitters(const vplRenderer* r)
{
    const int asked = r->asked.lights.emitterSamples, all = vplScene_GetEmitterCount(r->runner.run.scene);
    return asked > 0 && asked < all ? asked : all;
}

// Fewer lights and patches by a factor, no smooth edges and small shadow maps.
static void coarsen(const vplRenderer* r, double share, vplRenderOptions* o)
{
    *o = r->asked;
    const int emitters = countEmitters(r);
    if (emitters > FEW_EMITTERS) {
        const double fits = r->plan != NULL && !r->coarse ? FIRST_SHARE * leftOf(r) / r->plan->firstMs : 1;
        o->lights.emitterSamples = (int)fmax(FEW_EMITTERS, ceil(fmin(share, fits) * emitters));
    }
    o->stop.budgetMs =
        o->method == VPL_METHOD_RADIOSITY ? o->stop.budgetMs : 0; // which it may not be able to hold
    o->stop.maxError = 0;
    o->stop.passes = o->stop.growFrom = 0;
    o->output.antialias = share < 0.2 ? 1 : o->output.antialias;
    o->output.supersample = 1;
    o->shadow.mapSize = o->shadow.mapSize < 256 ? o->shadow.mapSize : 256;
    o->shadow.rsmSize = o->shadow.rsmSize > 0 && o->shadow.rsmSize < 256 ? o->shadow.rsmSize : 256;
    o->particles.count = o->particles.count >= 0 && o->particles.count < 250 ? o->particles.count : 250;
    if (o->method == VPL_METHOD_AUTO ||
        o->method == VPL_METHOD_KELLER) { // light that is missing is better than none
        o->pipeline.kind =
            o->pipeline.kind == VPL_ACCUMULATE_USUAL ? VPL_ACCUMULATE_INTERLEAVED : o->pipeline.kind;
        o->pipeline.interleave = o->pipeline.interleave < 0 ? 8 : o->pipeline.interleave;
        o->lights.compensation = VPL_COMPENSATION_NONE;
    }
    o->ssvp.firstBounce = (int)ceil(share * o->ssvp.firstBounce);
    o->ssvp.secondBounce = (int)ceil(share * o->ssvp.secondBounce);
    o->ssvp.clusters = (int)ceil(share * o->ssvp.clusters);
    o->ssvp.maxClusters = (int)ceil(share * o->ssvp.maxClusters);
    o->radiosity.patches = (int)ceil(share * o->radiosity.patches);
    o->radiosity.iterations = o->radiosity.iterations < 20 ? o->radiosity.iterations : 20;
    o->radiosity.gather = 0;
}

// A plan is not begun if this share of the time foreseen for its first picture is more than the time that is left.
static const double HOPELESS = 0.8;

static bool comesTooLate(const vplRenderer* r)
{
    return HOPELESS * r->plan->firstMs > leftOf(r);
}

vplResult vplRenderer_PlanFirst(vplRenderer* r)
{
    const vplMethod method = r->asked.method;
    const bool patches = method == VPL_METHOD_RADIOSITY; // whose plan takes long, too
    const bool fits = isinf(r->deadline) || method == VPL_METHOD_PATH ||
                      !vplShowsLight(r->asked.output.show) || r->asked.output.aovs != 0;
    vplRenderOptions o;
    if (fits || !patches) {
        TRY(vplRenderer_Plan(r, &r->asked, false));
    }
    if (fits || (!patches && r->plan->firstMs < FIRST_SHARE * leftOf(r))) {
        return VPL_SUCCESS;
    }
    coarsen(r, patches ? 0.02 : 0.0625, &o);
    return vplRenderer_Plan(r, &o, true);
}

// After a coarse picture with a sample of the emitters the next has as many as 0.7 of the time is enough for. Its edges are
// not smooth, because few bright emitters have many rims of shadows, and short rays do not compensate the clamp, because
// all emitters are evaluated where they end: each takes several times as long.
static void addEmitters(const vplRenderer* r, vplRenderOptions* o)
{
    const double spent = vplClockMs() - r->planStart, before = r->plan->options.lights.emitterSamples;
    const double fits = before * fmax(1, 0.7 * leftOf(r) / fmax(spent, 1));
    if (before > 0 && fits < countEmitters(r)) {
        o->lights.emitterSamples = (int)fits;
        o->output.antialias = 1;
        o->lights.compensation = VPL_COMPENSATION_NONE;
        vplLog(r->runner.run.context, VPL_LOG_INFO, "%d of the scene's %d lights stand for all in this time",
               (int)fits, vplScene_GetEmitterCount(r->runner.run.scene));
    }
}

// After a coarse picture of radiosity the next has as many patches as half of the time is enough for, where the time
// grows with the square of their number.
static vplResult refine(vplRenderer* r)
{
    vplRenderOptions o = r->asked;
    bool coarse = false;
    if (r->plan->options.method == VPL_METHOD_RADIOSITY) {
        const double spent = vplClockMs() - r->planStart, before = r->plan->options.radiosity.patches;
        const double patches = before * sqrt(fmax(1, 0.4 * leftOf(r) / fmax(spent, 1)));
        coarse = patches < 0.75 * o.radiosity.patches;
        if (coarse) {
            coarsen(r, patches / o.radiosity.patches, &o);
            o.output.antialias = r->asked.output.antialias;
        }
    } else {
        addEmitters(r, &o);
    }
    return vplRenderer_Replace(r, &o, coarse, -1);
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
        const int fit = (int)fmin(most, (leftOf(r) + 0.02 * r->asked.stop.budgetMs) / each);
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
    const double spent = (double)r->runner.stats.rays - r->planRays;
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

vplResult vplRefineTruth(vplRenderer* r)
{
    const double spread = r->judged.spread, start = vplClockMs();
    TRY(vplTruth_Refine(&r->runner.run, r->truth));
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

vplResult vplWidenTruth(vplRenderer* r)
{
    vplImage* image = NULL;
    vplTruth* wider;
    const double start = vplClockMs();
    TRY(vplRenderer_Resolve(r, &image));
    const vplResult result =
        vplTruth_Create(&r->runner.run, image, VPL_WIDER_TRUTH * vplTruth_CountPixels(r->truth), &wider);
    vplImage_Destroy(image);
    TRY(result);
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
    vplResult result = vplRenderer_Resolve(r, &image);
    const double start = vplClockMs();
    if (result == VPL_SUCCESS && r->truth == NULL) {
        result = vplTruth_Create(run, image, countTruthPixels(r), &r->truth);
        vplRun_AddTime(run, "truth", start);
    }
    while (result == VPL_SUCCESS) {
        vplJudgePicture(r, image);
        if (isClear(r, asked, plansAgain, r->spreadBefore) || vplClockMs() - start > ms / 3) {
            break;
        }
        result = vplRefineTruth(r);
    }
    r->judgedNoise = r->error.noise;
    vplImage_Destroy(image);
    return result;
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
    const bool again = r->judgedNoise <= 0 || r->error.noise < 0.8 * r->judgedNoise || r->edges != NULL;
    const bool early = r->done == 1 && asked >= EARLY_ERROR;
    const bool ready =
        !r->plan->progressive || early || (r->done >= 2 && (r->error.noise <= 0.9 * asked || r->done == 6));
    const bool decides = !early || !r->plan->progressive; // the first pass does not tell noise from bias
    for (bool more = ready && again; more;) {
        more = false;
        TRY(vplJudge(r, asked, decides, INFINITY));
        if (r->error.bound <= asked) {
            *doneOut = true;
        } else if (decides) {
            TRY(vplReconsider(r, asked, doneOut, &more));
        } else {
            TRY(vplReconsiderEarly(r, asked, doneOut, &more));
        }
    }
    return VPL_SUCCESS;
}

// A render that has a time and not an error looks at its error once, when a sixth of the time is over, and takes no more
// than a thirtieth of the time for it.
static vplResult reviewTime(vplRenderer* r, bool* doneOut)
{
    const double budget = r->asked.stop.budgetMs;
    const bool asks = r->asked.method == VPL_METHOD_AUTO && r->plan->progressive && budget >= 300;
    bool more;
    if (asks && r->truth == NULL && r->done >= 4 && leftOf(r) < 0.84 * budget && leftOf(r) > 0.3 * budget) {
        TRY(vplJudge(r, 0, true, budget / 30));
        return vplReconsider(r, 0, doneOut, &more);
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
    return isfinite(r->deadline) && leftOf(r) + 0.05 * r->asked.stop.budgetMs < next;
}

vplResult vplReview(vplRenderer* r, bool* doneOut)
{
    const double asked = r->asked.stop.maxError;
    *doneOut = false;
    if (r->coarse) {
        TRY(refine(r));
        *doneOut = !r->coarse && comesTooLate(r);
        return VPL_SUCCESS;
    }
    const bool complete = vplIsComplete(r);
    *doneOut = complete;
    if (complete && r->plan->options.path.edgePixels > 0) {
        TRY(vplRenderer_TraceEdges(r, r->plan->options.path.edgePixels, r->plan->options.path.edgePaths));
    }
    if (asked > 0 && vplShowsLight(r->asked.output.show)) {
        TRY(reviewError(r, asked, doneOut));
    } else if (vplShowsLight(r->asked.output.show)) {
        TRY(reviewTime(r, doneOut));
    }
    const bool changed = r->done == 0; // another plan, of which there is no pass yet
    if (changed && comesTooLate(r) && r->asked.method == VPL_METHOD_AUTO &&
        r->plan->options.method == VPL_METHOD_RADIOSITY) {
        TRY(vplFitPatches(r, leftOf(r) / r->plan->firstMs));
    }
    *doneOut = *doneOut || (changed ? comesTooLate(r) : isTooLate(r));
    return VPL_SUCCESS;
}
