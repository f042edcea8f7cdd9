// SPDX-License-Identifier: MIT
// The first part of the report: which settings reach 5 % error, and what do they cost?
#include "cli/tradeoff/tradeoff.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static const double LIMITS[] = {0.2, 0.1, 0.05, 0.02, 0.01};

enum { LIMIT_COUNT = sizeof LIMITS / sizeof *LIMITS };

static bool isJudged(const Tradeoff* t, double limit)
{
    return limit > t->reference.resolution;
}

void addCommand(const Tradeoff* t, const Setting* s, Text* html)
{
    addText(html, "<code class=\"copy\">vpl render ");
    addEscaped(html, t->arguments->positionals[0]);
    addText(html, " ");
    addWords(html, s->command);
    addText(html, " -o picture.png</code>");
}

// Adds the cheapest setting within a limit. Sets *above if the error of its worst seed exceeds the limit.
static void addRow(const Tradeoff* t, double limit, bool* above, Text* html)
{
    int found = findCheapest(t, FAMILY_COUNT, limit);
    addText(html, "<tr><th>%g %%</th>", 100 * limit);
    if (!isJudged(t, limit)) {
        addText(html, "<td colspan=\"4\">below what the reference can tell: not judged</td></tr>\n");
        return;
    }
    if (found < 0) {
        addText(html, "<td colspan=\"4\">not reached</td></tr>\n");
        return;
    }
    const Setting* s = &t->settings[found];
    *above = *above || s->errorHigh > limit;
    addText(html, "<td class=\"n\"><strong>%s</strong></td><td class=\"n\">%s%s</td>",
            formatTime(s->cpuMs).text, formatPercent(s->error).text,
            s->errorHigh > limit ? "<sup>a</sup>" : "");
    addText(html, "<td class=\"n\">%.3f</td><td>", s->energy);
    addCommand(t, s, html);
    addText(html, "</td></tr>\n");
}

// Returns the least error of a family, or of all for FAMILY_COUNT.
static double leastError(const Tradeoff* t, Family family)
{
    double least = INFINITY;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        least = isMeasuredOf(s, family) ? fmin(least, s->error) : least;
    }
    return least;
}

static void addFamily(const Tradeoff* t, Family family, Text* html)
{
    double least = leastError(t, family);
    if (!isfinite(least)) {
        return;
    }
    addText(html, "<tr><td><span class=\"dot d%d\"></span>%s</td>", family, FAMILY_NAMES[family]);
    for (int i = 0; i < LIMIT_COUNT; i++) {
        int found = isJudged(t, LIMITS[i]) ? findCheapest(t, family, LIMITS[i]) : -1;
        addText(html, "<td class=\"n\">%s</td>",
                found >= 0 ? formatTime(t->settings[found].cpuMs).text : "&ndash;");
    }
    addText(html, "<td class=\"n\">%s%s</td></tr>\n", least <= t->reference.resolution ? "&le; " : "",
            formatPercent(fmax(least, t->reference.resolution)).text);
}

// Adds the cheapest setting of each family, because the best of all is not always the one to use.
static void addFamilies(const Tradeoff* t, Text* html)
{
    addText(html, "<h3>The same for each method: processor time</h3>\n<table><tr><th>error at most</th>");
    for (int i = 0; i < LIMIT_COUNT; i++) {
        addText(html, "<th class=\"n\">%g %%</th>", 100 * LIMITS[i]);
    }
    addText(html, "<th class=\"n\">least error</th></tr>\n");
    for (int f = 0; f < FAMILY_COUNT; f++) {
        addFamily(t, (Family)f, html);
    }
    addText(html, "</table>\n");
}

static void addSummary(const Tradeoff* t, double limit, const Setting* s, Text* html)
{
    const Label cpu = formatTime(s->cpuMs);
    addText(html, "<p class=\"answer\">");
    if (s->error <= limit && isJudged(t, limit)) {
        addText(html, "<strong>%g %% error costs %s</strong> of processor time per %dx%d picture",
                100 * limit, cpu.text, s->options.output.width, s->options.output.height);
    } else {
        addText(html, "<strong>%g %% error %s.</strong> The least error was %s for %s of processor time",
                100 * limit,
                isJudged(t, limit)
                    ? "was not reached in the time given"
                    : "cannot be judged with this reference; more <code>--time</code> makes a better one",
                formatPercent(s->error).text, cpu.text);
    }
    addText(html, ", by %s:<br>", FAMILY_NAMES[s->family]);
    addCommand(t, s, html);
    addText(html, "</p>\n");
}

static void addFloors(const Tradeoff* t, Text* html)
{
    for (int f = FAMILY_UNSHADOWED; f <= FAMILY_RAY; f++) {
        double floor = findFloor(t, (Family)f);
        // A family does not level off there if another clamp distance or shadow map lowers its error further.
        if (floor > t->reference.resolution && leastError(t, (Family)f) > 0.85 * floor) {
            addText(html,
                    "<li>%c%s stop getting better at about <strong>%s</strong>, however many there are: "
                    "%s</li>\n",
                    toupper(FAMILY_NAMES[f][0]), FAMILY_NAMES[f] + 1, formatPercent(floor).text,
                    f == FAMILY_UNSHADOWED
                        ? "they shine through walls, so they settle on a wrong answer. No number of "
                          "particles helps; shadows or path tracing do."
                        : "what is left is the clamp near lights and the resolution of the shadow maps.");
        }
    }
}

void addAnswers(const Tradeoff* t, Text* html)
{
    int found = isJudged(t, 0.05) ? findCheapest(t, FAMILY_COUNT, 0.05) : -1;
    found = found >= 0 ? found : findCheapest(t, FAMILY_COUNT, leastError(t, FAMILY_COUNT));
    addSummary(t, 0.05, &t->settings[found], html);
    addText(html, "<ul>\n");
    addFloors(t, html);
    addText(html, "<li><em>Error</em> is the root-mean-square difference from the true picture divided by "
                  "the true picture's mean, over all pixels: the <code>relative_rmse</code> of <code>vpl "
                  "compare</code>, less the truth's own noise.</li>\n"
                  "<li><em>Energy</em> is all light in the picture divided by all light in the truth: 1 is "
                  "right, less is darker.</li>\n</ul>\n");
    addText(html,
            "<table><tr><th>error at most</th><th class=\"n\">processor time</th><th class=\"n\">measured "
            "error</th><th class=\"n\">energy</th><th>cheapest setting, to copy</th></tr>\n");
    bool above = false;
    for (int i = 0; i < LIMIT_COUNT; i++) {
        addRow(t, LIMITS[i], &above, html);
    }
    addText(html, "</table>\n%s",
            above ? "<p class=\"small\"><sup>a</sup> the median of the seeds; the worst seed lies above the "
                    "limit.</p>\n"
                  : "");
    addFamilies(t, html);
    addBest(t, html);
}
