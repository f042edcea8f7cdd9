// SPDX-License-Identifier: MIT
// The order of measuring: two cheap points of each curve first, then what is foreseen on or near the front,
// with a quarter of the time for the knobs, and last what is foreseen to be worse.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>

// A setting is near the front if its error is at most this many times the least of a faster one.
static const double NEAR = 1.2;

// Share of the time for knobs while there are settings near the front.
static const double KNOB_SHARE = 0.25;

// A curve is followed step by step: what is foreseen for more than this many times the largest amount
// measured beats nothing, and is not measured next.
static const double FAR = 10.1;

// Share of all the time that one mark of the planner may take before other settings had their turn.
static const double MARK_SHARE = 0.05;

// Rows of SWEEPS without a meaning are points of the plot.
bool isKnob(const Setting* s)
{
    bool knob = false, point = false;
    for (int i = 0; i < SWEEP_COUNT; i++) {
        knob = knob || (s->sweeps[i] && SWEEPS[i].meaning != NULL);
        point = point || (s->sweeps[i] && SWEEPS[i].meaning == NULL);
    }
    return knob && !point;
}

static bool isOpen(const Setting* s, int done)
{
    return s->runCount == done && s->problem[0] == 0 && s->leftOut != LEFT_LONG && !s->elsewhere;
}

// Values of measured settings of one curve, by ascending amount.
typedef struct Curve {
    double amount[MAX_SETTINGS], work[MAX_SETTINGS];
    double wallMs[MAX_SETTINGS], cpuMs[MAX_SETTINGS], error[MAX_SETTINGS];
    int count;
} Curve;

static void addToCurve(Curve* c, const Setting* s)
{
    int i = c->count++;
    for (; i > 0 && c->work[i - 1] > s->work; i--) {
        c->amount[i] = c->amount[i - 1];
        c->work[i] = c->work[i - 1];
        c->wallMs[i] = c->wallMs[i - 1];
        c->cpuMs[i] = c->cpuMs[i - 1];
        c->error[i] = c->error[i - 1];
    }
    c->amount[i] = fmax(s->amount, 1);
    c->work[i] = s->work;
    c->wallMs[i] = s->wallMs;
    c->cpuMs[i] = s->cpuMs;
    c->error[i] = fmax(s->error, 1e-9);
}

// Finds what has been measured of the setting's own curve, or else the curve of the measured setting of the
// same family and pipeline whose work is nearest.
static void findCurve(const Tradeoff* t, const Setting* s, Curve* c)
{
    const Setting* nearest = s;
    double least = INFINITY;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* other = &t->settings[i];
        double far = other->curve == s->curve ? -1 : fabs(log(other->work / s->work));
        if (isMeasured(other) && other->family == s->family &&
            other->options.pipeline.kind == s->options.pipeline.kind && far < least) {
            nearest = other;
            least = far;
        }
    }
    c->count = 0;
    for (int i = 0; i < t->settingCount; i++) {
        if (isMeasured(&t->settings[i]) && t->settings[i].curve == nearest->curve) {
            addToCurve(c, &t->settings[i]);
        }
    }
}

// A guess of the time, which only orders the kinds.
static double guessMs(const Setting* s)
{
    static const double guess[FAMILY_COUNT] = {1e-4, 1e-7, 1e-5, 1e-5, 1e-5, 1e-6, 1e-7, 1e-3, 1e-3};
    const vplRenderOptions* o = &s->options;
    const double pixels = (double)o->output.width * o->output.height;
    return guess[s->family] * pixels * s->work * (o->pipeline.kind >= VPL_ACCUMULATE_DEFERRED ? 1 : 10);
}

// Returns the time that a setting may take after a cheaper one was cancelled, or 0: one of the same curve, or
// where nothing has been measured of the family one of the family.
static double foreseeCancelled(const Tradeoff* t, const Setting* s, bool known)
{
    double most = 0;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* other = &t->settings[i];
        const bool same = other->curve == s->curve || (!known && other->family == s->family);
        if (other->leftOut == LEFT_LONG && same) {
            const double factor = other->curve == s->curve ? 4 * fmax(s->work / other->work, 1) : 1;
            most = fmax(most, factor * other->cancelledMs);
        }
    }
    return most;
}

// A budget is foreseen to be kept; an error to take as long as a larger one asked before, if that one was
// reached with room to spare, or else the longer the noisier that one was.
static void foreseePlanner(const Tradeoff* t, const Setting* s, Forecast* f)
{
    const vplStopOptions* stop = &s->options.stop;
    if (stop->budgetMs > 0) {
        f->wallMs = stop->budgetMs;
        f->known = true;
    }
    for (int i = 0; i < t->settingCount && stop->maxError > 0; i++) {
        const Setting* other = &t->settings[i];
        if (isMeasuredOf(other, FAMILY_AUTO) && other->options.stop.maxError > stop->maxError) {
            const double room = other->error / stop->maxError;
            f->wallMs = other->wallMs * fmax(room * room, 1);
        }
    }
}

static Forecast foresee(const Tradeoff* t, const Setting* s, Curve* c)
{
    Forecast f = {.wallMs = guessMs(s)};
    if (isMeasured(s)) {
        return (Forecast){s->wallMs, s->cpuMs, s->error, true, false};
    }
    findCurve(t, s, c);
    if (c->count > 0) {
        const double amount = fmax(s->amount, 1);
        f = (Forecast){
            alongLine(c->work, c->wallMs, c->count, s->work), alongLine(c->work, c->cpuMs, c->count, s->work),
            alongPower(c->amount, c->error, c->count, amount), true, amount > FAR * c->amount[c->count - 1]};
    }
    if (s->family == FAMILY_AUTO) {
        foreseePlanner(t, s, &f);
    }
    const double cancelled = s->options.stop.budgetMs > 0 ? 0 : foreseeCancelled(t, s, f.known);
    f.known = f.known || cancelled > 0;
    f.wallMs = fmax(f.wallMs, cancelled);
    f.cpuMs = fmax(f.cpuMs, cancelled);
    return f;
}

// Only the two cheapest settings of a curve are coarse.
static bool isCoarse(const Tradeoff* t, const Setting* s)
{
    int cheaper = 0;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* other = &t->settings[i];
        cheaper += other->work < s->work && other->curve == s->curve;
    }
    return cheaper < 2 && !isKnob(s);
}

// The kinds of settings, the most promising first.
typedef enum Rank { RANK_BASE = 0, RANK_COARSE, RANK_NEAR, RANK_KNOB, RANK_WORSE, RANK_COUNT } Rank;

typedef struct Ranking {
    double cost[MAX_SETTINGS], error[MAX_SETTINGS]; // of all but the planner, measured or foreseen; NAN: none
    Curve curve;
} Ranking;

static void foreseeAll(Tradeoff* t, Ranking* r)
{
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        s->forecast = foresee(t, s, &r->curve);
        const bool counts = s->forecast.known && !s->forecast.far && s->forecast.error > 0 &&
                            s->family != FAMILY_AUTO && s->problem[0] == 0 && s->leftOut != LEFT_LONG;
        r->cost[i] = counts ? s->forecast.cpuMs : NAN;
        r->error[i] =
            counts ? fmax(s->forecast.error, isMeasured(s) ? 0 : 1.001 * t->reference.resolution) : NAN;
    }
}

// Where a faster setting cannot be told from the truth, nothing is near the front any more.
static bool isNear(const Tradeoff* t, const Ranking* r, const Setting* s)
{
    const Forecast* f = &s->forecast;
    const double faster = leastWithin(r->cost, r->error, t->settingCount, 0.99 * f->cpuMs);
    return f->error > 0 && faster > t->reference.resolution &&
           f->error <= NEAR * leastWithin(r->cost, r->error, t->settingCount, f->cpuMs);
}

// Marks of the planner go with the coarse points if they take little of all the time.
static Rank rankOf(const Tradeoff* t, const Ranking* r, const Setting* s)
{
    const bool trial = s->forecast.wallMs <= 1e3 * TRIAL_SHARE * (t->deadline - 1e-3 * wallMs());
    if (s == &t->settings[0]) {
        return RANK_BASE;
    }
    if (s->family == FAMILY_AUTO) {
        const bool cheap = s->forecast.wallMs <= 1e3 * MARK_SHARE * (t->deadline - t->start);
        return cheap ? RANK_COARSE : RANK_KNOB;
    }
    if (isCoarse(t, s) && trial) {
        return RANK_COARSE;
    }
    if (isKnob(s)) {
        return RANK_KNOB;
    }
    return s->forecast.known && !s->forecast.far && isNear(t, r, s) ? RANK_NEAR : RANK_WORSE;
}

// The time for each factor of e by which the error falls below that of the measured settings that are as
// fast: of equal rank the least goes first. Where little is gained, the cheapest.
static double priceOf(const Tradeoff* t, const Setting* s, Rank rank)
{
    double least = INFINITY;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* other = &t->settings[i];
        const bool faster = isMeasuredOf(other, FAMILY_COUNT) && other->cpuMs <= s->forecast.cpuMs;
        least = faster && other->error < least ? other->error : least;
    }
    return rank == RANK_NEAR && !isMeasured(s)
               ? s->forecast.wallMs / fmin(fmax(log(least / s->forecast.error), 0.05), 1)
               : s->forecast.wallMs;
}

Setting* chooseNext(Tradeoff* t, int done, double end)
{
    static const Rank SEEDS[RANK_COUNT] = {RANK_BASE, RANK_NEAR, RANK_NEAR, RANK_NEAR, RANK_WORSE};
    Ranking r;
    Setting* best[RANK_COUNT] = {NULL};
    double prices[RANK_COUNT];
    const double left = end - 1e-3 * wallMs();
    foreseeAll(t, &r);
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        if (isOpen(s, done) && s->forecast.wallMs <= 1e3 * left) {
            // Of settings with a seed already the cheap ones that are no worse than others, and knobs, go
            // first.
            Rank rank = rankOf(t, &r, s);
            rank = done > 0 ? (isNear(t, &r, s) ? RANK_NEAR : SEEDS[rank]) : rank;
            const double price = priceOf(t, s, rank);
            if (best[rank] == NULL || price < prices[rank]) {
                best[rank] = s;
                prices[rank] = price;
            }
        }
    }
    t->coarse = done == 0 && (best[RANK_BASE] != NULL || best[RANK_COARSE] != NULL);
    if (done == 0 && !t->coarse && t->knobs < KNOB_SHARE * t->spent && best[RANK_KNOB] != NULL) {
        return best[RANK_KNOB];
    }
    for (int rank = 0; rank < RANK_COUNT; rank++) {
        if (best[rank] != NULL) {
            return best[rank];
        }
    }
    return NULL;
}

const char* whyLeftOut(const Setting* s, char* text, size_t size)
{
    const Label ms = formatTime(s->forecast.wallMs), error = formatPercent(s->forecast.error);
    switch (s->leftOut) {
    case LEFT_LATE:
        snprintf(text, size, "no time left");
        break;
    case LEFT_DEAR:
        snprintf(text, size, "foreseen to take %s", ms.text);
        break;
    case LEFT_WORSE:
        snprintf(text, size, "no time left; foreseen to take %s for %s error, worse than others", ms.text,
                 error.text);
        break;
    case LEFT_LONG:
        snprintf(text, size, "cancelled after %s", formatTime(s->cancelledMs).text);
        break;
    }
    return s->problem[0] != 0 ? s->problem : text;
}

void explainLeftOut(Tradeoff* t)
{
    Ranking r;
    foreseeAll(t, &r);
    for (int i = 0; i < t->settingCount; i++) {
        Setting* s = &t->settings[i];
        if (isOpen(s, 0)) {
            const bool worse = s->forecast.error > 0 && s->family != FAMILY_AUTO && !isNear(t, &r, s);
            const bool dear = s->forecast.known && s->forecast.wallMs > 1e3 * (t->deadline - t->start);
            s->leftOut = dear ? LEFT_DEAR : worse ? LEFT_WORSE : LEFT_LATE;
        }
    }
}
