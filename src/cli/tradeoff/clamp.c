// SPDX-License-Identifier: MIT
// Error and energy against --min-distance: a larger clamp distance removes bright blotches, but also light.
#include "cli/tradeoff/svg.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { PANEL = 200, GAP = 34, TOP = 26, BOTTOM = 56, MAX_POINTS = 32 };

typedef struct Clamp {
    const Setting* points[MAX_POINTS]; // by ascending distance
    int column[MAX_POINTS];            // points of one distance share a column
    int count, columns;
    Text* svg;
} Clamp;

static double distanceOf(const Setting* s)
{
    return (double)s->runs[0].stats.minDistance;
}

static void findPoints(const Tradeoff* t, Clamp* clamp)
{
    for (int i = 0; i < t->settingCount && clamp->count < MAX_POINTS; i++) {
        const Setting* s = &t->settings[i];
        if (isOfSweep(s, "min-distance") && isMeasured(s)) {
            int j = clamp->count++;
            for (; j > 0 && distanceOf(clamp->points[j - 1]) > distanceOf(s); j--) {
                clamp->points[j] = clamp->points[j - 1];
            }
            clamp->points[j] = s;
        }
    }
}

static void findColumns(Clamp* c)
{
    for (int i = 0; i < c->count; i++) {
        bool another = i > 0 && distanceOf(c->points[i]) > distanceOf(c->points[i - 1]) * 1.02;
        c->column[i] = i == 0 ? 0 : c->column[i - 1] + another;
        c->columns = c->column[i] + 1;
    }
}

// Columns are evenly spaced, because distances span decades and begin with 0.
static double atX(const Clamp* c, int i)
{
    return PLOT_LEFT + (PLOT_RIGHT - PLOT_LEFT) * (c->column[i] + 0.5) / c->columns;
}

// Chooses a round step between grid lines, for two to eight of them.
static double stepOf(double span)
{
    double step = pow(10, floor(log10(span / 2)));
    return span / step > 8 ? (span / step > 16 ? 5 * step : 2 * step) : step;
}

static void addPanel(const Clamp* c, const Axis* a, const char* title, bool percent)
{
    addText(c->svg, "<text x=\"%d\" y=\"%.1f\">%s</text>\n", PLOT_LEFT, a->to - 8, title);
    double step = stepOf(a->high - a->low);
    for (double value = step * ceil(a->low / step - 1e-9); value <= a->high * (1 + 1e-9); value += step) {
        char label[32];
        snprintf(label, sizeof label, "%.4g%s", 0 + (percent ? 100 * value : value), percent ? " %" : "");
        addGridLine(c->svg, pixelOf(a, value), label);
    }
    addFrame(c->svg, a->to, a->from);
}

static void addLine(const Clamp* c, const Axis* a, Family family, bool energy)
{
    const char* command = "M";
    addText(c->svg, "<path class=\"f%d band\" d=\"", family);
    for (int i = 0; i < c->count; i++) {
        const Setting* s = c->points[i];
        if (s->family == family) {
            addText(c->svg, "%s%.1f %.1f", command, atX(c, i), pixelOf(a, energy ? s->energy : s->error));
            command = "L";
        }
    }
    addText(c->svg, "\"/>\n");
    for (int i = 0; i < c->count; i++) {
        const Setting* s = c->points[i];
        if (s->family == family) {
            addMarker(c->svg, family, true, atX(c, i), pixelOf(a, energy ? s->energy : s->error));
        }
        if (s->family == family && !energy) {
            addText(c->svg, "<path class=\"f%d band\" d=\"M%.1f %.1fV%.1f\"/>", family, atX(c, i),
                    pixelOf(a, s->errorLow), pixelOf(a, s->errorHigh));
        }
    }
}

static void addDistances(const Clamp* c, int y)
{
    for (int i = 0; i < c->count; i++) {
        bool automatic = c->points[i]->options.lights.minDistance < 0;
        if (i > 0 && c->column[i] == c->column[i - 1]) {
            continue;
        }
        addText(c->svg, "<text class=\"soft\" x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%.2g m%s</text>\n",
                atX(c, i), y, distanceOf(c->points[i]),
                automatic                       ? " (auto)"
                : distanceOf(c->points[i]) == 0 ? " (none)"
                                                : "");
    }
}

static void drawClamp(const Clamp* c)
{
    Axis error = {0}, energy = {1, 1, 0, 0, false};
    bool present[FAMILY_COUNT] = {false};
    for (int i = 0; i < c->count; i++) {
        error.high = fmax(error.high, 1.05 * c->points[i]->errorHigh);
        energy.low = fmin(energy.low, c->points[i]->energy);
        energy.high = fmax(energy.high, c->points[i]->energy);
        present[c->points[i]->family] = true;
    }
    const int top = TOP + heightOfLegend(present), height = top + 2 * PANEL + GAP + BOTTOM;
    error.from = top + PANEL;
    error.to = top;
    energy.from = top + 2 * PANEL + GAP;
    energy.to = top + PANEL + GAP;
    double room = fmax(0.05 * (energy.high - energy.low), 0.01);
    energy.low -= room;
    energy.high += room;
    beginSvg(c->svg, height, "Error and energy against the clamp", false);
    addLegend(c->svg, present);
    addPanel(c, &error, "error", true);
    addPanel(c, &energy, "energy: all light / all light of the truth", false);
    addText(c->svg, "<path class=\"front\" d=\"M%d %.1fH%d\"/>\n", PLOT_LEFT, pixelOf(&energy, 1),
            PLOT_RIGHT);
    for (int f = 0; f < FAMILY_COUNT; f++) {
        addLine(c, &error, (Family)f, false);
        addLine(c, &energy, (Family)f, true);
    }
    addDistances(c, height - BOTTOM + 18);
    addText(c->svg, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">--min-distance D</text>\n</svg>\n",
            (PLOT_LEFT + PLOT_RIGHT) / 2, height - 12);
}

void addClamp(const Tradeoff* t, Text* html)
{
    Clamp clamp = {.svg = html};
    findPoints(t, &clamp);
    if (clamp.count < 2) {
        return;
    }
    findColumns(&clamp);
    addText(html, "<h2>The clamp: blotches against lost light</h2>\n<p>A virtual light lights what is nearer "
                  "than D only as if it were D away. A small D leaves bright blotches around the lights, a "
                  "large one loses light, in corners first. All else as in the base, <code>");
    addWords(html, t->settings[0].command);
    addText(html, "</code>.</p>\n");
    addText(html, "<div class=\"scroll\">\n");
    drawClamp(&clamp);
    addText(html, "</div>\n");
}
