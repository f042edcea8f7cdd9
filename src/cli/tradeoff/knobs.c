// SPDX-License-Identifier: MIT
// The part of the report on single options: compares every sweep of one option with the base, seed by seed.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef enum Verdict { VERDICT_FREE = 0, VERDICT_BUYS, VERDICT_SAVES, VERDICT_NOTHING } Verdict;

typedef struct Knob {
    const Sweep* sweep;
    const Setting* best;
    Verdict verdict;
    double score;       // among knobs of one verdict, the least comes first: error, ms per halving, or ms
    double perHalving;  // milliseconds of processor time
    int values;         // measured, besides the base
    bool worse, dearer; // some value makes the error larger, or costs more
} Knob;

static bool comesBefore(const Knob* a, const Knob* b)
{
    return a->verdict != b->verdict ? a->verdict < b->verdict : a->score < b->score;
}

// Returns -1 or 1 if the error falls or grows by more than 2 % with every seed; else 0.
static int errorTrend(const Setting* base, const Setting* s)
{
    int common = s->runCount < base->runCount ? s->runCount : base->runCount, below = 0, above = 0;
    for (int k = 0; k < common; k++) {
        double ratio = s->runs[k].error / base->runs[k].error;
        below += ratio < 0.98;
        above += ratio > 1.02;
    }
    return below == common ? -1 : above == common ? 1 : 0;
}

// Returns -1 or 1 if the time falls or grows. Times that differ by less than a tenth, or whose bands overlap,
// count as equal because measured times are noisy.
static int costTrend(const Setting* base, const Setting* s)
{
    bool above = s->cpuMs > 1.1 * base->cpuMs && s->cpuLow > base->cpuHigh;
    bool below = s->cpuMs < 0.9 * base->cpuMs && s->cpuHigh < base->cpuLow;
    return above ? 1 : below ? -1 : 0;
}

// Compares a setting with the base; the knob keeps the best.
static void judge(Knob* knob, const Setting* base, const Setting* s)
{
    int error = errorTrend(base, s), cost = costTrend(base, s);
    bool same = s->error <= 1.02 * base->error; // seeds that disagree do not prove it
    Knob with = *knob;
    with.best = s;
    with.verdict = error < 0 && cost <= 0           ? VERDICT_FREE
                   : error < 0                      ? VERDICT_BUYS
                   : error == 0 && same && cost < 0 ? VERDICT_SAVES
                                                    : VERDICT_NOTHING;
    with.perHalving = costPerHalving(base->cpuMs, base->error, s->cpuMs, s->error);
    with.score = with.verdict == VERDICT_FREE    ? s->error
                 : with.verdict == VERDICT_SAVES ? s->cpuMs
                                                 : with.perHalving;
    if (with.verdict != VERDICT_NOTHING && comesBefore(&with, knob)) {
        *knob = with;
    }
    knob->values++;
    knob->worse |= error > 0;
    knob->dearer |= cost > 0;
}

static int findKnobs(const Tradeoff* t, Knob* knobs)
{
    int count = 0;
    for (int i = 0; i < SWEEP_COUNT; i++) {
        Knob knob = {&SWEEPS[i], NULL, VERDICT_NOTHING, INFINITY, INFINITY, 0, false, false};
        for (int j = 1; j < t->settingCount; j++) {
            const Setting* s = &t->settings[j];
            if (s->sweeps[i] && isMeasured(s) && SWEEPS[i].meaning != NULL) {
                judge(&knob, &t->settings[0], s);
            }
        }
        if (knob.values > 0) {
            knobs[count++] = knob;
        }
    }
    return count;
}

static int compareKnobs(const void* a, const void* b)
{
    return comesBefore(a, b) ? -1 : comesBefore(b, a);
}

static void addNothing(const Knob* knob, Text* html)
{
    addText(html, "<td><code>%s</code></td><td colspan=\"3\">%s</td><td class=\"n\">&ndash;</td></tr>\n",
            optionOf(knob->sweep),
            knob->worse ? "buys nothing: the base's value is best, others are worse"
            : knob->dearer
                ? "buys nothing: no value changes the error on all seeds, others than the base's cost more"
                : "buys nothing: no value changes the error on all seeds, or the cost");
}

static void addKnob(const Setting* base, const Knob* knob, Text* html)
{
    static const char* const words[] = {"less error for no more time", "less error for more time",
                                        "saves time at the same error", ""};
    addText(html, "<tr><td>%s</td>", knob->sweep->meaning);
    if (knob->best == NULL) {
        addNothing(knob, html);
        return;
    }
    addText(html, "<td><code>");
    addWords(html, knob->best->change);
    addText(html, "</code></td><td class=\"n\">%s &rarr; %s</td>", formatPercent(base->error).text,
            formatPercent(knob->best->error).text);
    addText(html, "<td class=\"n\">%s &rarr; %s</td><td>%s</td>", formatTime(base->cpuMs).text,
            formatTime(knob->best->cpuMs).text, words[knob->verdict]);
    addText(html, "<td class=\"n\">%s</td></tr>\n",
            knob->verdict == VERDICT_BUYS   ? formatTime(knob->perHalving).text
            : knob->verdict == VERDICT_FREE ? "free"
                                            : "&ndash;");
}

void addKnobs(const Tradeoff* t, Text* html)
{
    Knob knobs[MAX_SWEEPS];
    const Setting* base = &t->settings[0];
    int count = isMeasured(base) ? findKnobs(t, knobs) : 0;
    if (count == 0) {
        return;
    }
    qsort(knobs, (size_t)count, sizeof *knobs, compareKnobs);
    addText(html, "<h2>What each knob buys</h2>\n<p>One option at a time is changed from the base, <code>");
    addWords(html, base->command);
    addText(html, "</code>. The table shows the change that pays best. <em>Per halving</em> is the processor "
                  "time added for each factor of two by which the error falls. A change counts only if all "
                  "seeds agree and it is larger than 2 %% (error) or 10 %% "
                  "(time).</p>\n<table><tr><th>knob</th><th>change</th><th class=\"n\">error</th><th "
                  "class=\"n\">processor time</th><th>verdict</th><th class=\"n\">per halving</th></tr>\n");
    for (int i = 0; i < count; i++) {
        addKnob(base, &knobs[i], html);
    }
    addText(html, "</table>\n");
}
