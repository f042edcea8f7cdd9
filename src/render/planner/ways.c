// SPDX-License-Identifier: MIT
#include "render/planner/ways.h"

#include "render/planner/patch_plan.h"

#include <math.h>

// Compares the truth's spread with the part of it that the noise of the paths causes, about. Where that part is most of it, the spread
// may still grow when rare paths that carry much light are found.
bool vplPixelsLimitTruth(const vplRenderer* r)
{
    const double each = 0.5 * vplTruth_Paths(r->truth), count = vplTruth_CountPixels(r->truth);
    return r->judged.spread > 3 * (r->judged.pathVariance / each / sqrt(count));
}

// Half of the square of pixels that share lights: the square of the bias falls by half, and noise takes twice as many
// rays (room, cornell-area, sibenik, hall: 0.5 to 0.8, and 1.7 to 2.4).
static void countFinerPlans(const vplRenderer* r, vplErrorState* s)
{
    const vplRenderOptions* o = &r->plan->options;
    const bool refines = o->pipeline.kind == VPL_ACCUMULATE_INTERLEAVED && r->asked.pipeline.interleave < 0;
    s->once = o->method == VPL_METHOD_RADIOSITY;
    s->finerBias = s->once ? 1.0 / VPL_MORE_PATCHES : 0.55;
    s->finerCost = s->once ? VPL_MORE_PATCHES_COST : 2.2;
    if (s->once) {
        const double most = vplMostPatches(r->runner.run.context);
        for (int n = o->radiosity.patches; n * VPL_MORE_PATCHES <= most; n *= VPL_MORE_PATCHES) {
            s->finer++;
        }
        return;
    }
    for (int side = o->pipeline.interleave; refines && side > 2; side /= 2) {
        s->finer++;
    }
}

vplErrorState vplErrorState_Of(const vplRenderer* r)
{
    const double noise = r->error.noise > 0 ? r->error.noise : 0, mean = r->judged.mean;
    const double pixels = (double)r->asked.output.width * r->asked.output.height;
    const double pathSquare =
        r->judged.pathVariance / (mean * mean) * r->judged.pathRays * VPL_PATH_RAY * pixels;
    vplErrorState s = {.noise = noise * noise,
                       .spent = fmax(1, vplRaysOfPlan(r)),
                       .paths = mean > 0 ? fmax(pathSquare, r->turn.pathSquare) : INFINITY};
    countFinerPlans(r, &s);
    s.bias = fmax(0, r->error.total * r->error.total - s.noise);
    s.square = mean > 0 ? fmax(r->judged.square / (mean * mean), s.noise) : 0;
    s.spread = mean > 0 ? r->judged.spread / (mean * mean) : 0;
    const double ray = r->guided ? VPL_GUIDED_RAY : VPL_PATH_RAY;
    s.truth = ray * (double)r->judged.rays;
    s.truthPaths = vplTruth_Paths(r->truth);
    s.path = ray * r->judged.pathRays;
    s.stuck = r->judged.spread > 0.85 * r->spreadBefore && vplPixelsLimitTruth(r);
    return s;
}

// ---- ways to an error

// With fewer paths through a pixel their noise is not known.
static const double FEWEST_EDGE_PATHS = 32;

// Rays of paths of the truth until one and a half standard errors are as small as `margin`.
double vplProofOf(const vplErrorState* s, double spread, double margin)
{
    const double times = 1.5 * spread / margin;
    return times <= 1 ? 0 : s->stuck ? INFINITY : s->truth * (times - 1);
}

// The variance of pixels at edges with so many paths each. Twice as many have a third of it, up to as many as the truth has, and
// half of it beyond; at most as if they were independent. Few pixels have most of it, so that it is often estimated too low; but
// evenly spread paths gain no more than about 1.5 n^(3/4) where an edge runs through the pixel (room-area, 16 to 128 paths: a
// fifth to a fortieth of the variance).
double vplVarianceOfEdges(const vplErrorState* s, const vplEdgeStep* step, double paths)
{
    const double times = s->truthPaths / paths, alone = step->variance / paths;
    const double most = alone / (1.5 * sqrt(paths) * sqrt(sqrt(paths)));
    return fmin(alone, fmax(most, step->mean * times * (times > 1 ? sqrt(times) : 1)));
}

// Paths through pixels at edges until their variance is half of `left`, because a handful of pixels or rare paths may have most of
// it (with 0.8 instead, two of five pictures of cornell-spot missed 5 %). Powers of two, and half as many more, are spread most
// evenly.
double vplPathsForEdges(const vplErrorState* s, const vplEdgeStep* step, double left)
{
    const double goal = 0.5 * left;
    double paths = FEWEST_EDGE_PATHS;
    while (paths < VPL_MAX_SAMPLES && vplVarianceOfEdges(s, step, 1.5 * paths) > goal) {
        paths *= 2;
    }
    return vplVarianceOfEdges(s, step, paths) > goal ? 1.5 * paths : paths;
}

// The least rays for passes and paths: N / m + V / n is `left`, and a m + c n least, for m times the passes and n paths.
// `each` is the rays of one time the passes.
static vplWay wayOf(const vplErrorState* s, const vplEdgeStep* step, int finer, double each, double square)
{
    vplWay way = {INFINITY, finer, 0, step->pixels, 0, 0};
    const double left = square - step->bias, cost = step->pixels * s->path;
    if (!(left > 0)) {
        return way;
    }
    const double one = fmin(step->variance, step->mean * s->truthPaths);
    const double both = sqrt(each * step->noise) + sqrt(cost * one);
    way.passes = sqrt(step->noise / each) * both / left;
    if (s->once) {
        way.passes = 1;
    } else if (finer == 0) {
        way.passes = way.passes > 1       ? fmax(way.passes, 1 + VPL_LEAST_MORE)
                     : step->noise < left ? 1
                                          : 1 + VPL_LEAST_MORE;
    }
    const double rest = left - step->noise / way.passes;
    const double paths = step->pixels == 0 ? 0 : rest > 0 ? vplPathsForEdges(s, step, rest) : INFINITY;
    if (paths < VPL_MAX_SAMPLES) {
        way.paths = (int)paths;
        way.rays = each * (way.passes - (finer == 0)) + cost * paths;
    }
    return way;
}

// The cheapest way that traces the pixels of `step`, after the plan was made finer `finer` times. Passes and paths aim at a share of
// the error that was asked for: a smaller share needs more of them, but fewer paths of the truth to prove the error.
static vplWay bestWayOf(const vplErrorState* s, const vplEdgeStep* step, int finer, double asked)
{
    static const double SHARES[] = {0.9, 0.75, 0.6, 0.45, 0.3};
    vplWay best = {.rays = INFINITY};
    vplEdgeStep then = *step;
    double each = s->spent;
    for (int k = 0; k < finer; k++) {
        each *= s->finerCost;
        then.bias *= s->finerBias;
        then.spread *= s->once ? s->finerBias : 1; // without noise the spread is that of the bias
    }
    for (int i = 0; i < 5; i++) {
        const double square = SHARES[i] * asked * asked;
        vplWay way = wayOf(s, &then, finer, each, square);
        way.rays += vplProofOf(s, then.spread, asked * asked - square);
        best = way.rays < best.rays ? way : best;
    }
    return best;
}

// Edges are traced at most so often, and each try may use only this share of the error of the try before. Patches get more and
// closer tries: they have no noise, so that a few more pixels are often enough, and other ways cost far more.
enum { MOST_TRIES = 2, MOST_TRIES_ONCE = 4 };
static const double SHARE_OF_TRY = 0.7, SHARE_OF_TRY_ONCE = 0.85;

// Steps of pixels at edges; none where they may not be traced, or were in vain too often.
vplResult vplFindUsefulSteps(vplRenderer* r, vplEdgeStep steps[VPL_EDGE_STEPS], int* countOut)
{
    const vplRenderOptions* o = &r->asked;
    const bool may = o->method == VPL_METHOD_AUTO && o->output.show == VPL_SHOW_PICTURE &&
                     o->output.aovs == 0 && o->path.edgePixels == 0;
    *countOut = 0;
    const bool once = r->plan->options.method == VPL_METHOD_RADIOSITY;
    return may && (once || r->plan->progressive) && r->edges == NULL &&
                   r->edgeTries < (once ? MOST_TRIES_ONCE : MOST_TRIES)
               ? vplFindEdgeSteps(r, steps, countOut)
               : VPL_SUCCESS;
}

// The squared error beside edges: what is left if at most a fiftieth of the picture's pixels is traced.
static double restOf(const vplRenderer* r, const vplErrorState* s, const vplEdgeStep* steps, int count)
{
    const int most = r->asked.output.width * r->asked.output.height / 50;
    double rest = s->square;
    for (int i = 0; i < count && steps[i].pixels <= most; i++) {
        rest = fmin(rest, steps[i].square);
    }
    return rest;
}

// Edges are left as they are where less than this share of the squared error would go with them: paths of the truth prove as much (corridor at
// 20 %, 96x54, three of seven seeds: 3.7, 3.6 and 2.2 s instead of 12, 4.5 and 3.0).
static const double LEAST_AT_EDGES = 0.15;

vplResult vplFindWay(vplRenderer* r, const vplErrorState* s, double asked, vplWay* wayOut)
{
    const vplEdgeStep none = {0, s->noise, s->bias, s->square, s->spread, 0, 0};
    vplEdgeStep steps[VPL_EDGE_STEPS];
    int count = 0;
    double forEdges = asked;
    *wayOut = (vplWay){.rays = INFINITY};
    TRY(vplFindUsefulSteps(r, steps, &count));
    for (int i = 0; i < r->edgeTries; i++) {
        forEdges *= s->once ? SHARE_OF_TRY_ONCE : SHARE_OF_TRY;
    }
    for (int k = 0; k <= s->finer; k++) {
        for (int i = -1; i < count; i++) {
            if (i >= 0 && steps[i].square > (1 - LEAST_AT_EDGES) * s->square) {
                continue;
            }
            const vplWay way = bestWayOf(s, i < 0 ? &none : &steps[i], k, i < 0 ? asked : forEdges);
            *wayOut = way.rays < wayOut->rays ? way : *wayOut;
        }
    }
    wayOut->rest = restOf(r, s, steps, count);
    return VPL_SUCCESS;
}
