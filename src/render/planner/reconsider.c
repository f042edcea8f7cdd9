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

// Pixels share lights, so the noise of few passes may happen to be larger than it is on average, and look like bias.
enum { SURE_PASSES = 5 };

// Squares of errors relative to the picture's mean, and rays.
typedef struct State {
    double noise, bias; // of the picture so far
    double spent;       // rays of its passes, which are in packets
    double paths;       // squared error of a picture by one ray's worth of paths
    bool canRefine;
} State;

static State stateOf(const vplRenderer* r)
{
    const double noise = r->error.noise > 0 ? r->error.noise : 0, mean = r->judged.mean;
    const double pixels = (double)r->asked.output.width * r->asked.output.height;
    State s = {.noise = noise * noise,
               .spent = fmax(1, (double)r->runner.stats.rays - r->planRays),
               .paths = mean > 0 ? r->judged.pathVariance / (mean * mean) * r->judged.pathRays *
                                       VPL_PATH_RAY * pixels
                                 : INFINITY,
               .canRefine = r->plan->options.pipeline.kind == VPL_ACCUMULATE_INTERLEAVED &&
                            r->plan->options.pipeline.interleave > 2 && r->asked.pipeline.interleave < 0};
    s.bias = fmax(0, r->error.total * r->error.total - s.noise);
    return s;
}

// ---- rays that each way needs for an error

static double toFinish(const State* s, double square)
{
    const double left = square - s->bias;
    return left > 0 ? s->spent * fmax(0, s->noise / left - 1) : INFINITY;
}

static double toRefine(const State* s, double square)
{
    const double left = square - FINER_BIAS * s->bias;
    return s->canRefine && left > 0 ? FINER_COST * s->spent * s->noise / left : INFINITY;
}

static double toTrace(const State* s, double square)
{
    return s->paths / square;
}

// ---- the next plan

// Tells the log why the plan changes.
static void tell(const vplRenderer* r, const char* next)
{
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "after %d passes the noise is %.3g %% and the error about %.3g %%: goes on with %s", r->done,
           100 * fmax(0, r->error.noise), 100 * r->error.total, next);
}

static vplResult trace(vplRenderer* r, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    tell(r, "path tracing");
    o.method = VPL_METHOD_PATH;
    *doneOut = false;
    TRY(vplRenderer_Keep(r, r->error.total));
    return vplRenderer_Plan(r, &o, false);
}

static vplResult refine(vplRenderer* r, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    const int finer = r->plan->options.pipeline.interleave / 2;
    tell(r, "fewer pixels that share lights");
    o.method = r->plan->options.method;
    o.lights.shadows = r->plan->options.lights.shadows;
    o.particles = r->plan->options.particles;
    o.output.antialias = r->plan->options.output.antialias < 16 && o.output.antialias == 8
                             ? 16
                             : r->plan->options.output.antialias;
    o.pipeline.interleave = finer;
    *doneOut = false;
    TRY(vplRenderer_Keep(r, r->error.total));
    return vplRenderer_Plan(r, &o, false);
}

// All light instead of direct light alone.
static vplResult addLights(vplRenderer* r, bool* doneOut)
{
    vplRenderOptions o = r->asked;
    tell(r, "reflected light");
    o.method = VPL_METHOD_KELLER;
    o.lights.shadows = r->plan->options.lights.shadows;
    o.particles.count = 1000;
    *doneOut = false;
    TRY(vplRenderer_Keep(r, r->error.total));
    return vplRenderer_Plan(r, &o, false);
}

// The way that needs least for the error.
static vplResult reach(vplRenderer* r, const State* s, double asked, bool* doneOut)
{
    const double square = 0.9 * asked * asked;
    if (r->plan->progressive && r->done < SURE_PASSES && r->error.total < 2 * asked) {
        return VPL_SUCCESS;
    }
    const double finish = toFinish(s, square), finer = toRefine(s, square), paths = toTrace(s, square);
    if (paths < finish && paths < finer) {
        return trace(r, doneOut);
    }
    return finer < finish ? refine(r, doneOut) : VPL_SUCCESS;
}

// The least squared error for the rays that the time is enough for.
static vplResult spend(vplRenderer* r, const State* s, bool* doneOut)
{
    const double rate = s->spent / fmax(1, vplClockMs() - r->planStart),
                 rays = rate * (r->deadline - vplClockMs());
    const double finish = s->bias + s->noise * s->spent / (s->spent + rays);
    const double finer =
        s->canRefine ? FINER_BIAS * s->bias + FINER_COST * s->noise * s->spent / rays : INFINITY;
    const double paths = s->paths / rays;
    if (paths < 0.8 * finish && paths < finer) {
        return trace(r, doneOut);
    }
    return finer < 0.8 * finish ? refine(r, doneOut) : VPL_SUCCESS;
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
