// SPDX-License-Identifier: MIT
// Parts of the report: the least error within some times, and the planner's settings against the others.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>

static const double SECONDS[] = {0.1, 0.5, 1, 5, 20};

// Returns the setting without planner of the least error within a time, NULL if none is so fast. Sets
// *longest to the time of the dearest one.
static const Setting* findBest(const Tradeoff* t, double ms, double* longest)
{
    const Setting* best = NULL;
    *longest = 0;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        if (isMeasuredOf(s, FAMILY_COUNT)) {
            *longest = fmax(*longest, s->cpuMs);
            best = s->cpuMs <= ms && (best == NULL || s->error < best->error) ? s : best;
        }
    }
    return best;
}

void addBest(const Tradeoff* t, Text* html)
{
    double longest = 0;
    addText(html,
            "<h3>Best within a time, at %dx%d pixels</h3>\n<div class=\"scroll\"><table><tr><th>processor "
            "time at "
            "most</th><th class=\"n\">least error</th><th class=\"n\">measured time</th><th>setting, to "
            "copy</th></tr>\n",
            t->arguments->render.output.width, t->arguments->render.output.height);
    for (size_t i = 0; i < sizeof SECONDS / sizeof *SECONDS; i++) {
        const Setting* s = findBest(t, 1e3 * SECONDS[i], &longest);
        if (longest < 1e3 * SECONDS[i]) {
            break;
        }
        addText(html, "<tr><th>%g s</th>", SECONDS[i]);
        if (s == NULL) {
            addText(html, "<td colspan=\"3\">no setting is so fast</td></tr>\n");
            continue;
        }
        addText(html, "<td class=\"n\"><strong>%s%s</strong></td><td class=\"n\">%s</td><td>",
                s->error <= t->reference.resolution ? "&le; " : "", formatPercent(s->error).text,
                formatTime(s->cpuMs).text);
        addCommand(t, s, html);
        addText(html, "</td></tr>\n");
    }
    addText(
        html,
        "</table></div>\n<p class=\"small\">The dearest setting measured took %s; within longer times the "
        "best is that of the least error above.</p>\n",
        formatTime(longest).text);
}

static void addOver(const Tradeoff* t, const Setting* s, Text* html)
{
    const double over = overFront(t, s);
    if (isnan(over)) {
        addText(html, "<td class=\"n\">no other was so good</td>");
    } else {
        addText(html, "<td class=\"n\">%.*f times</td>", over < 10 ? 1 : 0, over);
    }
}

static void addMark(const Tradeoff* t, const Setting* s, Text* html)
{
    const vplStopOptions* stop = &s->options.stop;
    addText(html, "<tr><td>");
    addCommand(t, s, html);
    addText(html, "</td>");
    if (!isMeasured(s)) {
        char reason[SENTENCE];
        addText(html, "<td colspan=\"5\">not measured: ");
        addEscaped(html, whyLeftOut(s, reason, sizeof reason));
        addText(html, "</td></tr>\n");
        return;
    }
    addText(html, "<td class=\"n\">%s</td><td class=\"n\">%s</td><td class=\"n\">%s</td>",
            stop->maxError > 0 ? formatPercent(stop->maxError).text : formatTime(stop->budgetMs).text,
            formatPercent(s->error).text, formatTime(s->wallMs).text);
    addText(html, "<td class=\"n\">%s</td>", formatTime(s->cpuMs).text);
    addOver(t, s, html);
    addText(html, "</tr>\n");
}

void addPlanner(const Tradeoff* t, Text* html)
{
    bool any = false;
    for (int i = 0; i < t->settingCount; i++) {
        any = any || t->settings[i].family == FAMILY_AUTO;
    }
    if (!any) {
        return;
    }
    addText(
        html,
        "<h2>The planner: what was asked, and what it reached</h2>\n<p><code>--method auto</code> chooses "
        "the "
        "method and its options by <code>--max-error</code> or <code>--budget</code>. Here it is free to, "
        "but for "
        "the size, the seed and <code>--antialias</code>. A budget is wall-clock time, here of %d thread%s; "
        "the "
        "picture of a budget has other bits on a faster or slower machine. The last column is the processor "
        "time "
        "over that of the cheapest other setting with no more error: 1 is as good as the front.</p>\n"
        "<div class=\"scroll\"><table><tr><th>setting</th><th class=\"n\">asked</th><th class=\"n\">reached "
        "error</th><th class=\"n\">used time</th><th class=\"n\">processor time</th><th class=\"n\">over the "
        "front</th></tr>\n",
        vplContext_GetWorkerCount(t->context), vplContext_GetWorkerCount(t->context) == 1 ? "" : "s");
    for (int i = 0; i < t->settingCount; i++) {
        if (t->settings[i].family == FAMILY_AUTO) {
            addMark(t, &t->settings[i], html);
        }
    }
    addText(html, "</table></div>\n");
}
