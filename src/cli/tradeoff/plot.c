// SPDX-License-Identifier: MIT
// tradeoff.svg: error against processor time, both logarithmic.
#include "cli/tradeoff/svg.h"

#include <math.h>
#include <stdio.h>

enum { HEIGHT = 560, TOP = 66, BOTTOM = HEIGHT - 54, MAX_TICKS = 40 };

typedef struct Plot {
    Axis x, y; // ms, error
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
        addText(p->svg, "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%d\" y2=\"%d\"/>", x, x, TOP,
                BOTTOM);
        addText(p->svg, "<text class=\"soft\" x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", x,
                BOTTOM + 18, formatTime(ticks[i]).text);
    }
    count = logTicks(p->y.low, p->y.high, ticks, MAX_TICKS);
    for (int i = 0; i < count; i++) {
        addGridLine(p->svg, pixelOf(&p->y, ticks[i]), formatPercent(ticks[i]).text);
    }
    addFrame(p->svg, TOP, BOTTOM);
    addText(p->svg,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">processor time of one picture, all threads "
            "together</text>\n",
            (PLOT_LEFT + PLOT_RIGHT) / 2, HEIGHT - 12);
    addText(p->svg,
            "<text transform=\"translate(16 %d) rotate(-90)\" text-anchor=\"middle\">error: rmse / mean of "
            "the truth</text>\n",
            (TOP + BOTTOM) / 2);
}

static void addKey(const Tradeoff* t, Text* svg)
{
    bool present[FAMILY_COUNT];
    for (int f = 0; f < FAMILY_COUNT; f++) {
        present[f] = findCheapest(t, (Family)f, INFINITY) >= 0;
    }
    addLegend(svg, present, PLOT_LEFT, 18);
    addText(svg,
            "<text class=\"soft\" x=\"%d\" y=\"%d\">filled and numbered: no other setting is both faster and "
            "better; hollow: another one is. Crosses span the seeds.</text>\n",
            PLOT_LEFT, TOP - 10);
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
    addMarker(p->svg, s->family, s->number > 0, x, y);
    addText(p->svg, "</g>\n");
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

// Shades errors below the reference's resolution.
static void addUnknown(const Tradeoff* t, const Plot* p)
{
    if (t->reference.resolution > p->y.low) {
        double y = pixelOf(&p->y, t->reference.resolution);
        addText(p->svg, "<rect class=\"unknown\" x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\"/>",
                PLOT_LEFT, y, PLOT_RIGHT - PLOT_LEFT, BOTTOM - y);
        addText(p->svg, "<text class=\"soft\" x=\"%d\" y=\"%.1f\">below what the reference can tell</text>\n",
                PLOT_LEFT + 8, BOTTOM - 6.0);
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
    Plot p = {.x = {.from = PLOT_LEFT, .to = PLOT_RIGHT, .logarithmic = true},
              .y = {.from = BOTTOM, .to = TOP, .logarithmic = true},
              .svg = svg};
    p.frontCount = listFront(t, p.front);
    if (!scale(t, &p)) {
        return; // nothing differs from the reference
    }
    beginSvg(svg, HEIGHT, "Error against processor time", true);
    addUnknown(t, &p);
    addGrid(&p);
    addKey(t, svg);
    for (int pass = 0; pass < 2; pass++) { // the front on top
        for (int i = 0; i < t->settingCount; i++) {
            const Setting* s = &t->settings[i];
            if (isMeasured(s) && s->error > 0 && (s->number > 0) == (pass == 1)) {
                addPoint(&p, s);
            }
        }
        if (pass == 0) {
            addFront(&p);
        }
    }
    addNumbers(&p);
    addText(svg, "</svg>\n");
}
