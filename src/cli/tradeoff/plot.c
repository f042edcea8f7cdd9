// SPDX-License-Identifier: MIT
// tradeoff.svg: error against processor time, both logarithmic.
#include "cli/tradeoff/svg.h"

#include <math.h>
#include <stdio.h>

// Pixels: the plot area, its border below, and room above for two lines of words.
enum { AREA = 440, BELOW = 54, WORDS = 42, MAX_TICKS = 40 };

typedef struct Plot {
    Axis x, y;       // ms, error
    int top, bottom; // of the plot area, which begins below the legend
    const Setting* front[MAX_SETTINGS];
    int frontCount;
    Text* svg;
} Plot;

static void addGrid(const Plot* p)
{
    double ticks[MAX_TICKS];
    int count = logTicks(p->x.low, p->x.high, ticks, MAX_TICKS);
    for (int i = 0; i < count; i++) {
        double x = pixelOf(&p->x, ticks[i]);
        addText(p->svg, "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%d\" y2=\"%d\"/>", x, x, p->top,
                p->bottom);
        addText(p->svg, "<text class=\"soft\" x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", x,
                p->bottom + 18, formatTime(ticks[i]).text);
    }
    count = logTicks(p->y.low, p->y.high, ticks, MAX_TICKS);
    for (int i = 0; i < count; i++) {
        addGridLine(p->svg, pixelOf(&p->y, ticks[i]), formatPercent(ticks[i]).text);
    }
    addFrame(p->svg, p->top, p->bottom);
    addText(p->svg,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">processor time of one picture, all threads "
            "together</text>\n",
            (PLOT_LEFT + PLOT_RIGHT) / 2, p->bottom + BELOW - 12);
    addText(p->svg,
            "<text transform=\"translate(16 %d) rotate(-90)\" text-anchor=\"middle\">error: rmse / mean of "
            "the truth</text>\n",
            (p->top + p->bottom) / 2);
}

static void addKey(const Plot* p, const bool present[FAMILY_COUNT])
{
    addLegend(p->svg, present);
    addText(p->svg,
            "<text class=\"soft\" x=\"%d\" y=\"%d\">filled and numbered: no other setting is both faster and "
            "better; hollow: another one is. Crosses span the seeds.</text>\n",
            PLOT_LEFT, p->top - 28);
    if (present[FAMILY_AUTO]) {
        addText(
            p->svg,
            "<text class=\"soft\" x=\"%d\" y=\"%d\">the planner: the error asked for is below its star, the "
            "time asked for above.</text>\n",
            PLOT_LEFT, p->top - 12);
    }
}

static void addPoint(const Plot* p, const Setting* s)
{
    double x = pixelOf(&p->x, s->cpuMs), y = pixelOf(&p->y, s->error);
    addText(p->svg, "<g><title>");
    addEscaped(p->svg, s->change[0] ? s->change : "the base");
    addText(p->svg, ": %s, %s error</title>", formatTime(s->cpuMs).text, formatPercent(s->error).text);
    addText(p->svg, "<path class=\"f%d band\" d=\"M%.1f %.1fH%.1fM%.1f %.1fV%.1f\"/>", s->family,
            pixelOf(&p->x, s->cpuLow), y, pixelOf(&p->x, s->cpuHigh), x, pixelOf(&p->y, s->errorLow),
            pixelOf(&p->y, s->errorHigh));
    addMarker(p->svg, s->family, s->number > 0 || s->family == FAMILY_AUTO, x, y);
    addText(p->svg, "</g>\n");
}

// Writes beside a mark of the planner what was asked of it, errors below and times above, away from those
// that have been written.
static void addAsked(const Plot* p, const Setting* s, int count, double* xs, double* ys)
{
    const vplStopOptions* stop = &s->options.stop;
    const bool error = stop->maxError > 0;
    xs[count] = pixelOf(&p->x, s->cpuMs) + 8;
    ys[count] = pixelOf(&p->y, s->error) + (error ? 14 : -6);
    for (int i = 0; i < count; i++) {
        if (fabs(xs[i] - xs[count]) < 52 && fabs(ys[i] - ys[count]) < 12) {
            ys[count] += error ? 12 : -12;
            i = -1; // it may lie on an earlier one now
        }
    }
    addText(p->svg, "<text class=\"asked\" x=\"%.1f\" y=\"%.1f\">%s</text>\n", xs[count], ys[count],
            error ? formatPercent(stop->maxError).text : formatTime(stop->budgetMs).text);
}

static void addAllAsked(const Tradeoff* t, const Plot* p)
{
    double xs[MAX_SETTINGS], ys[MAX_SETTINGS];
    int count = 0;
    for (int i = 0; i < t->settingCount; i++) {
        if (isMeasuredOf(&t->settings[i], FAMILY_AUTO) && t->settings[i].error > 0) {
            addAsked(p, &t->settings[i], count++, xs, ys);
        }
    }
}

// Draws a step line through the front: the least error within a time.
static void addFront(const Plot* p)
{
    addText(p->svg, "<path class=\"front\" d=\"");
    for (int i = 0; i < p->frontCount; i++) {
        addText(p->svg, i == 0 ? "M%.1f %.1f" : "H%.1fV%.1f", pixelOf(&p->x, p->front[i]->cpuMs),
                pixelOf(&p->y, p->front[i]->error));
    }
    addText(p->svg, "\"/>\n");
}

static void addNumbers(const Plot* p)
{
    for (int i = 0; i < p->frontCount; i++) {
        const Setting* s = p->front[i];
        addText(p->svg, "<text class=\"number\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%d</text>",
                pixelOf(&p->x, s->cpuMs) - 7, pixelOf(&p->y, s->error) + 14, s->number);
    }
    addText(p->svg, "\n");
}

// Adds the points of the front and the planner's marks, or all others.
static void addPoints(const Tradeoff* t, const Plot* p, bool front)
{
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        if (isMeasured(s) && s->error > 0 && (s->number > 0 || s->family == FAMILY_AUTO) == front) {
            addPoint(p, s);
        }
    }
}

// Shades errors below the reference's resolution.
static void addUnknown(const Tradeoff* t, const Plot* p)
{
    if (t->reference.resolution > p->y.low) {
        double y = pixelOf(&p->y, t->reference.resolution);
        addText(p->svg, "<rect class=\"unknown\" x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\"/>",
                PLOT_LEFT, y, PLOT_RIGHT - PLOT_LEFT, p->bottom - y);
        addText(p->svg, "<text class=\"soft\" x=\"%d\" y=\"%.1f\">below what the reference can tell</text>\n",
                PLOT_LEFT + 8, p->bottom - 6.0);
    }
}

static bool scale(const Tradeoff* t, Plot* p)
{
    double cost[2 * MAX_SETTINGS], error[2 * MAX_SETTINGS];
    int count = 0;
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        if (isMeasured(s)) {
            cost[count] = s->cpuLow;
            error[count++] = s->errorLow;
            cost[count] = s->cpuHigh;
            error[count++] = s->errorHigh;
        }
    }
    return logRange(cost, count, &p->x.low, &p->x.high) && logRange(error, count, &p->y.low, &p->y.high);
}

void writePlot(const Tradeoff* t, Text* svg)
{
    bool present[FAMILY_COUNT];
    for (int f = 0; f < FAMILY_COUNT; f++) {
        present[f] = findCheapest(t, (Family)f, INFINITY) >= 0;
    }
    const int top = heightOfLegend(present) + WORDS, bottom = top + AREA;
    Plot p = {.x = {.from = PLOT_LEFT, .to = PLOT_RIGHT, .logarithmic = true},
              .y = {.from = bottom, .to = top, .logarithmic = true},
              .top = top,
              .bottom = bottom,
              .svg = svg};
    p.frontCount = listFront(t, p.front);
    if (!scale(t, &p)) {
        return; // nothing differs from the reference
    }
    beginSvg(svg, bottom + BELOW, "Error against processor time", true);
    addUnknown(t, &p);
    addGrid(&p);
    addKey(&p, present);
    addPoints(t, &p, false);
    addFront(&p);
    addPoints(t, &p, true);
    addNumbers(&p);
    addAllAsked(t, &p);
    addText(svg, "</svg>\n");
}
