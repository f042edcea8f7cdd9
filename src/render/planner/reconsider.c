// SPDX-License-Identifier: MIT
// Second thoughts: the noise and the bias of the picture so far say what more passes, a finer plan and path tracing would
// cost. Costs are counted in rays and not in seconds, so that the same plan is chosen on every machine.
#include "base/clock.h"
#include "render/planner/edge_steps.h"

#include <math.h>
#include <stdio.h>

// Half of the square of pixels that share lights: the square of the bias falls by half, and noise takes twice as many
// rays (room, cornell-area, sibenik, hall: 0.5 to 0.8, and 1.7 to 2.4).
static const double FINER_BIAS = 0.55, FINER_COST = 2.2;

// Passes after which the noise is known well. After fewer it is uncertain, because pixels share lights: where it is
// estimated too low, the rest of the error looks like bias.
enum { SURE_PASSES = 5 };

// A render that goes on is judged again when its noise is 0.8 of what it was, after so many rays more.
static const double LEAST_MORE = 0.56;

// Squares of errors relative to the picture's mean, and rays.
typedef struct State {
    double noise, bias; // of the picture so far; a bias that may be chance counts for less
    double square;      // the whole estimate of the error, at least the noise
    double spread;      // its standard error
    double spent;       // rays of its passes, which are in packets
    double truth;       // rays of the truth
    double truthPaths;  // through each of its pixels
    double path;        // rays of a path
    double paths;       // squared error of a picture by one ray's worth of paths
    int halvings;       // of the square of pixels that share lights, that are possible
    bool stuck;         // more paths of the truth do not make its spread smaller
} State;

// The part of the truth's spread that is noise of its paths, about. Where it is most of it, the spread may grow with the paths
// until the rare ones that carry much light are among them.
static double noiseOfTruth(const vplRenderer* r)
{
    const double each = 0.5 * vplTruth_Paths(r->truth), count = vplTruth_CountPixels(r->truth);
    return r->judged.pathVariance / each / sqrt(count);
}

static State stateOf(const vplRenderer* r)
{
    const double noise = r->error.noise > 0 ? r->error.noise : 0, mean = r->judged.mean;
    const double pixels = (double)r->asked.output.width * r->asked.output.height;
    const double pathSquare =
        r->judged.pathVariance / (mean * mean) * r->judged.pathRays * VPL_PATH_RAY * pixels;
    State s = {.noise = noise * noise,
               .spent = fmax(1, (double)r->runner.stats.rays - r->planRays),
               .paths = mean > 0 ? fmax(pathSquare, r->turn.pathSquare) : INFINITY};
    const bool refines =
        r->plan->options.pipeline.kind == VPL_ACCUMULATE_INTERLEAVED && r->asked.pipeline.interleave < 0;
    for (int side = r->plan->options.pipeline.interleave; refines && side > 2; side /= 2) {
        s.halvings++;
    }
    s.bias = fmax(0, r->error.total * r->error.total - s.noise);
    s.square = mean > 0 ? fmax(r->judged.square / (mean * mean), s.noise) : 0;
    s.spread = mean > 0 ? r->judged.spread / (mean * mean) : 0;
    s.truth = VPL_PATH_RAY * (double)r->judged.rays;
    s.truthPaths = vplTruth_Paths(r->truth);
    s.path = VPL_PATH_RAY * r->judged.pathRays;
    s.stuck = r->judged.spread > 0.85 * r->spreadBefore && r->judged.spread > 3 * noiseOfTruth(r);
    return s;
}

// ---- ways to an error

// With fewer paths through a pixel their noise is not known.
static const double FEWEST_EDGE_PATHS = 32;

// Passes, of this plan or of one whose lights are shared by fewer pixels, then paths through pixels at edges, then paths of the
// truth that prove the error.
typedef struct Way {
    double rays;   // of all
    int halvings;  // of the square of pixels that share lights
    double passes; // over those that are done: 1 is no more
    int pixels, paths;
} Way;

// Rays of paths of the truth until one and a half standard errors are as small as `margin`.
static double proofOf(const State* s, double spread, double margin)
{
    const double times = 1.5 * spread / margin;
    return times <= 1 ? 0 : s->stuck ? INFINITY : s->truth * (times - 1);
}

// The variance of pixels at edges with so many paths each. Twice as many have a third of it, up to as many as the truth has, and
// half of it beyond; at most as if they were independent. Few pixels have most of it, so that it is often estimated too low; but
// evenly spread paths gain no more than about 1.5 n^(3/4) where an edge runs through the pixel (room-area, 16 to 128 paths: a
// fifth to a fortieth of the variance).
static double varianceOf(const State* s, const vplEdgeStep* step, double paths)
{
    const double times = s->truthPaths / paths, alone = step->variance / paths;
    const double most = alone / (1.5 * sqrt(paths) * sqrt(sqrt(paths)));
    return fmin(alone, fmax(most, step->mean * times * (times > 1 ? sqrt(times) : 1)));
}

// Paths through pixels at edges until their variance is half of `left`, because a handful of pixels or rare paths may have most of
// it (with 0.8 instead, two of five pictures of cornell-spot missed 5 %). Powers of two, and half as many more, are spread most
// evenly.
static double pathsFor(const State* s, const vplEdgeStep* step, double left)
{
    const double goal = 0.5 * left;
    double paths = FEWEST_EDGE_PATHS;
    while (paths < VPL_MAX_SAMPLES && varianceOf(s, step, 1.5 * paths) > goal) {
        paths *= 2;
    }
    return varianceOf(s, step, paths) > goal ? 1.5 * paths : paths;
}

// The least rays for passes and paths: N / m + V / n is `left`, and a m + c n least, for m times the passes and n paths.
static Way wayOf(const State* s, const vplEdgeStep* step, int halvings, double square)
{
    Way way = {INFINITY, halvings, 0, step->pixels, 0};
    double bias = step->bias, each = s->spent;
    for (int k = 0; k < halvings; k++) {
        bias *= FINER_BIAS;
        each *= FINER_COST;
    }
    const double left = square - bias, cost = step->pixels * s->path;
    if (!(left > 0)) {
        return way;
    }
    const double one = fmin(step->variance, step->mean * s->truthPaths);
    const double both = sqrt(each * step->noise) + sqrt(cost * one);
    way.passes = sqrt(step->noise / each) * both / left;
    if (halvings == 0) {
        way.passes = way.passes > 1       ? fmax(way.passes, 1 + LEAST_MORE)
                     : step->noise < left ? 1
                                          : 1 + LEAST_MORE;
    }
    const double rest = left - step->noise / way.passes;
    const double paths = step->pixels == 0 ? 0 : rest > 0 ? pathsFor(s, step, rest) : INFINITY;
    if (paths < VPL_MAX_SAMPLES) {
        way.paths = (int)paths;
        way.rays = each * (way.passes - (halvings == 0)) + cost * paths;
    }
    return way;
}

// Tries several shares of the error: the lower it is, the sooner it is proven.
static Way bestWayOf(const State* s, const vplEdgeStep* step, int halvings, double asked)
{
    static const double SHARES[] = {0.9, 0.75, 0.6, 0.45, 0.3};
    Way best = {.rays = INFINITY};
    for (int i = 0; i < 5; i++) {
        const double square = SHARES[i] * asked * asked;
        Way way = wayOf(s, step, halvings, square);
        way.rays += proofOf(s, step->spread, asked * asked - square);
        best = way.rays < best.rays ? way : best;
    }
    return best;
}

enum { MOST_TRIES = 2 };

// Each try that failed leaves a smaller share of the error for the next one.
static const double SHARE_OF_TRY = 0.7;

// Steps of pixels at edges; none where they may not be traced, or were in vain too often.
static vplResult findSteps(vplRenderer* r, vplEdgeStep steps[VPL_EDGE_STEPS], int* countOut)
{
    const vplRenderOptions* o = &r->asked;
    const bool may = o->method == VPL_METHOD_AUTO && o->output.show == VPL_SHOW_PICTURE &&
                     o->output.aovs == 0 && o->path.edgePixels == 0;
    *countOut = 0;
    return may && r->plan->progressive && r->edges == NULL && r->edgeTries < MOST_TRIES
               ? vplFindEdgeSteps(r, steps, countOut)
               : VPL_SUCCESS;
}

static vplResult findWay(vplRenderer* r, const State* s, double asked, Way* wayOut)
{
    const vplEdgeStep none = {0, s->noise, s->bias, s->square, s->spread, 0, 0};
    vplEdgeStep steps[VPL_EDGE_STEPS];
    int count = 0;
    double forEdges = asked;
    *wayOut = (Way){.rays = INFINITY};
    TRY(findSteps(r, steps, &count));
    for (int i = 0; i < r->edgeTries; i++) {
        forEdges *= SHARE_OF_TRY;
    }
    for (int k = 0; k <= s->halvings; k++) {
        for (int i = -1; i < count; i++) {
            const Way way = bestWayOf(s, i < 0 ? &none : &steps[i], k, i < 0 ? asked : forEdges);
            *wayOut = way.rays < wayOut->rays ? way : *wayOut;
        }
    }
    return VPL_SUCCESS;
}

// ---- the next plan

// Goes on with another plan, and tells the log why. The picture so far is kept until the new plan has one.
static vplResult goOnWith(vplRenderer* r, const char* what, const vplRenderOptions* o, bool* doneOut)
{
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "after %d passes the noise is %.3g %% and the error about %.3g %%: goes on with %s", r->done,
           100 * fmax(0, r->error.noise), 100 * r->error.total, what);
    *doneOut = false;
    return vplRenderer_Replace(r, o, false, r->error.total);
}

static vplResult trace(vplRenderer* r, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    o.method = VPL_METHOD_PATH;
    r->turn = (vplTurn){0};
    return goOnWith(r, "path tracing", &o, doneOut);
}

static vplResult refine(vplRenderer* r, int halvings, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    const vplRenderOptions* before = &r->plan->options;
    o.method = before->method;
    o.lights.shadows = before->lights.shadows;
    o.lights.compensation = before->lights.compensation;
    o.particles = before->particles;
    o.pipeline.kind = before->pipeline.kind;
    o.output.antialias =
        before->output.antialias < 16 && o.output.antialias == 8 ? 16 : before->output.antialias;
    o.pipeline.interleave = before->pipeline.interleave >> halvings;
    return goOnWith(r, "fewer pixels that share lights", &o, doneOut);
}

// All light instead of direct light alone.
static vplResult addLights(vplRenderer* r, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    o.method = VPL_METHOD_KELLER;
    o.lights.shadows = r->plan->options.lights.shadows;
    o.particles.count = 1000;
    return goOnWith(r, "reflected light", &o, doneOut);
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
    vplRenderOptions o = r->asked;
    o.pipeline.interleave = r->turn.side;
    r->turn = (vplTurn){0, pathSquare, 0};
    *doneOut = false;
    return vplRenderer_Replace(r, &o, false, r->error.total);
}

// ---- the decision

// The truth is known well enough for a decision where its standard error is this share of the squared error that was asked for;
// and more paths of it are not worth it where they would cost more than this share of what is foreseen.
static const double KNOWN = 0.1, WORTH = 0.1;

// Pixels at edges are traced. More of their paths, or of the truth, may prove that the error is met; else the picture is as before.
static vplResult proveEdges(vplRenderer* r, const State* s, double asked, bool* moreOut)
{
    const vplEdgeNoise noise = vplEdges_Noise(r->edges, r->asked.output.width * r->asked.output.height);
    const double left = asked * asked - s->square, cost = s->path * r->edgePixels * r->edgePaths;
    const bool noisy = noise.spread > 0.5 * r->judged.spread;
    *moreOut = true;
    if (left > 0 && noisy && 2 * cost < s->spent && 2 * r->edgePaths < VPL_MAX_SAMPLES) {
        return vplRenderer_TraceEdges(r, r->edgePixels, 2 * r->edgePaths);
    }
    if (left > 0 && !noisy && proofOf(s, s->spread, left) < s->spent + cost) {
        return vplRefineTruth(r);
    }
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "%d paths through each of %d pixels at edges leave an error of about %.3g %%, which is not enough",
           r->edgePaths, r->edgePixels, 100 * r->error.total);
    vplRenderer_ForgetEdges(r);
    r->edgeTries++;
    return VPL_SUCCESS;
}

static vplResult traceEdges(vplRenderer* r, const Way* way, bool* moreOut)
{
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "after %d passes the noise is %.3g %% and the error about %.3g %%: traces %d paths through each "
           "of %d pixels at edges",
           r->done, 100 * fmax(0, r->error.noise), 100 * r->error.total, way->paths, way->pixels);
    *moreOut = true;
    return vplRenderer_TraceEdges(r, way->pixels, way->paths);
}

// Edges that cost less than this share of the passes are traced before the noise is known well.
static const double CHEAP = 0.25;

vplResult vplTryEdges(vplRenderer* r, double asked, bool* moreOut)
{
    const State s = stateOf(r);
    vplEdgeStep steps[VPL_EDGE_STEPS];
    Way best = {.rays = CHEAP * s.spent};
    int count;
    TRY(findSteps(r, steps, &count));
    for (int i = 0; i < count; i++) {
        const double left = asked * asked - steps[i].square - 1.5 * steps[i].spread;
        const double paths = left > 0 ? pathsFor(&s, &steps[i], left) : VPL_MAX_SAMPLES;
        const double rays = steps[i].pixels * s.path * paths;
        if (paths < VPL_MAX_SAMPLES && rays < best.rays) {
            best = (Way){rays, 0, 1, steps[i].pixels, (int)paths};
        }
    }
    return best.pixels > 0 ? traceEdges(r, &best, moreOut) : VPL_SUCCESS;
}

// Begins path tracing. Where paths need more rays than foreseen, it turns back to `way`, without the passes that are done.
static vplResult tracePaths(vplRenderer* r, const State* s, const Way* way, bool* doneOut)
{
    const double rays = way->rays + (way->halvings == 0 ? s->spent : 0);
    const int side = r->plan->options.pipeline.interleave >> way->halvings;
    const bool turns = isfinite(rays) && r->plan->options.pipeline.kind == VPL_ACCUMULATE_INTERLEAVED;
    TRY(trace(r, doneOut));
    r->turn = (vplTurn){turns ? rays : 0, s->paths, turns ? side : 0};
    return VPL_SUCCESS;
}

// The way that needs least for the error.
static vplResult reach(vplRenderer* r, const State* s, double asked, bool* doneOut, bool* moreOut)
{
    Way way;
    if (r->plan->progressive && r->done < SURE_PASSES && r->error.total < 2 * asked) {
        return vplTryEdges(r, asked, moreOut);
    }
    if (r->edges != NULL) {
        return proveEdges(r, s, asked, moreOut);
    }
    TRY(findWay(r, s, asked, &way));
    const double paths = s->paths / (0.9 * asked * asked);
    const bool unknown = s->spread > KNOWN * asked * asked && !s->stuck;
    if (unknown && s->truth < WORTH * fmin(way.rays, paths)) {
        *moreOut = true;
        return vplRefineTruth(r);
    }
    if (paths < way.rays) {
        return tracePaths(r, s, &way, doneOut);
    }
    if (way.halvings > 0) {
        return refine(r, way.halvings, doneOut);
    }
    if (way.passes > 1 || isinf(way.rays)) {
        return VPL_SUCCESS;
    }
    if (way.pixels > 0) {
        return traceEdges(r, &way, moreOut);
    }
    *moreOut = true; // the error is met, but not proven
    return vplRefineTruth(r);
}

// The least squared error for the rays that the time is enough for.
static vplResult spend(vplRenderer* r, const State* s, bool* doneOut)
{
    const double rate = s->spent / fmax(1, vplClockMs() - r->planStart),
                 rays = rate * (r->deadline - vplClockMs());
    const double finish = s->bias + s->noise * s->spent / (s->spent + rays);
    const double finer =
        s->halvings > 0 ? FINER_BIAS * s->bias + FINER_COST * s->noise * s->spent / rays : INFINITY;
    const double paths = s->paths / rays;
    if (paths < 0.8 * finish && paths < finer) {
        return trace(r, doneOut);
    }
    return finer < 0.8 * finish ? refine(r, 1, doneOut) : VPL_SUCCESS;
}

vplResult vplReconsider(vplRenderer* r, double asked, bool* doneOut, bool* moreOut)
{
    const State s = stateOf(r);
    if (r->asked.method == VPL_METHOD_AUTO && r->plan->options.method == VPL_METHOD_DIRECT) {
        return addLights(r, doneOut);
    }
    if (r->asked.method == VPL_METHOD_AUTO) {
        return asked > 0 ? reach(r, &s, asked, doneOut, moreOut) : spend(r, &s, doneOut);
    }
    if (asked > 0 && s.bias > asked * asked && s.noise < 0.1 * s.bias) {
        snprintf(r->ended, sizeof r->ended,
                 "edges, blur and light that is left out are %.3g %% of it, which more passes do not mend",
                 100 * sqrt(s.bias));
        *doneOut = true;
    }
    return VPL_SUCCESS;
}
