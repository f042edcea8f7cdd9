// SPDX-License-Identifier: MIT
// Second thoughts: the noise and the bias of the picture so far say what more passes, a finer plan and path tracing would
// cost. Costs are counted in rays and not in seconds, so that the same plan is chosen on every machine.
#include "base/clock.h"
#include "render/renderer.h"

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
    double noise, bias; // of the picture so far
    double spent;       // rays of its passes, which are in packets
    double paths;       // squared error of a picture by one ray's worth of paths
    int halvings;       // of the square of pixels that share lights, that are possible
} State;

static State stateOf(const vplRenderer* r)
{
    const double noise = r->error.noise > 0 ? r->error.noise : 0, mean = r->judged.mean;
    const double pixels = (double)r->asked.output.width * r->asked.output.height;
    State s = {.noise = noise * noise,
               .spent = fmax(1, (double)r->runner.stats.rays - r->planRays),
               .paths = mean > 0 ? r->judged.pathVariance / (mean * mean) * r->judged.pathRays *
                                       VPL_PATH_RAY * pixels
                                 : INFINITY};
    const bool refines =
        r->plan->options.pipeline.kind == VPL_ACCUMULATE_INTERLEAVED && r->asked.pipeline.interleave < 0;
    for (int side = r->plan->options.pipeline.interleave; refines && side > 2; side /= 2) {
        s.halvings++;
    }
    s.bias = fmax(0, r->error.total * r->error.total - s.noise);
    return s;
}

// ---- rays that each way needs for an error

static double toFinish(const State* s, double square)
{
    const double left = square - s->bias;
    return left > 0 ? s->spent * fmax(LEAST_MORE, s->noise / left - 1) : INFINITY;
}

// *halvingsOut: of the square of pixels that share lights.
static double toRefine(const State* s, double square, int* halvingsOut)
{
    double least = INFINITY, bias = s->bias, spent = s->spent;
    *halvingsOut = 1;
    for (int k = 1; k <= s->halvings; k++) {
        bias *= FINER_BIAS;
        spent *= FINER_COST;
        const double rays = square > bias ? spent * s->noise / (square - bias) : INFINITY;
        *halvingsOut = rays < least ? k : *halvingsOut;
        least = fmin(least, rays);
    }
    return least;
}

static double toTrace(const State* s, double square)
{
    return s->paths / square;
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

// The way that needs least for the error.
static vplResult reach(vplRenderer* r, const State* s, double asked, bool* doneOut)
{
    const double square = 0.9 * asked * asked;
    if (r->plan->progressive && r->done < SURE_PASSES && r->error.total < 2 * asked) {
        return VPL_SUCCESS;
    }
    State upper = *s;
    // Where the error is low enough and its bound is not, the bound does not come much closer to it.
    if (r->error.total <= asked && vplTruth_Paths(r->truth) >= VPL_SURE_PATHS) {
        upper.bias = fmax(s->bias, r->error.bound * r->error.bound - s->noise);
    }
    int halvings;
    const double finish = toFinish(&upper, square), finer = toRefine(&upper, square, &halvings),
                 paths = toTrace(s, square);
    if (paths < finish && paths < finer) {
        return trace(r, doneOut);
    }
    return finer < finish ? refine(r, halvings, doneOut) : VPL_SUCCESS;
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

vplResult vplReconsider(vplRenderer* r, double asked, bool* doneOut)
{
    const State s = stateOf(r);
    if (r->asked.method == VPL_METHOD_AUTO && r->plan->options.method == VPL_METHOD_DIRECT) {
        return addLights(r, doneOut);
    }
    if (r->asked.method == VPL_METHOD_AUTO) {
        return asked > 0 ? reach(r, &s, asked, doneOut) : spend(r, &s, doneOut);
    }
    if (asked > 0 && s.bias > asked * asked && s.noise < 0.1 * s.bias) {
        snprintf(r->ended, sizeof r->ended,
                 "edges, blur and light that is left out are %.3g %% of it, which more passes do not mend",
                 100 * sqrt(s.bias));
        *doneOut = true;
    }
    return VPL_SUCCESS;
}
