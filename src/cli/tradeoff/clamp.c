// SPDX-License-Identifier: MIT
// Error and energy against --min-distance: the larger the bound, the fewer bright blotches, the less light.
#include "cli/tradeoff/report.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { WIDTH = 900, PANEL = 200, GAP = 34, LEFT = 72, RIGHT = 24, TOP = 26, BOTTOM = 56, MAX_POINTS = 32 };

typedef struct Clamp {
    const Setting* points[MAX_POINTS]; // by ascending distance
    int column[MAX_POINTS];            // points of one distance stand in one column
    int count, columns;
    Text* svg;
} Clamp;

static double distanceOf(const Setting* s)
{
    return (double)s->runs[0].stats.minDistance;
}

static void findPoints(const Tradeoff* t, Clamp* clamp)
{
    uint64_t bits = 0;
    for (int i = 0; i < SWEEP_COUNT; i++) {
        bits |= strcmp(SWEEPS[i].name, "min-distance") == 0 ? UINT64_C(1) << i : 0;
    }
    for (int i = 0; i < t->settingCount && clamp->count < MAX_POINTS; i++) {
        const Setting* s = &t->settings[i];
        if ((s->sweeps & bits) != 0 && isMeasured(s)) {
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

// Evenly spaced: the distances run over decades and begin with 0.
static double atX(const Clamp* c, int i)
{
    return LEFT + (WIDTH - LEFT - RIGHT) * (c->column[i] + 0.5) / c->columns;
}

typedef struct Range {
    double low, high, bottom; // of the values; pixel of the low end
} Range;

static double atY(const Range* r, double value)
{
    return r->bottom - PANEL * (value - r->low) / (r->high - r->low);
}

// A round step that makes three to eight of them.
static double stepOf(double span)
{
    double step = pow(10, floor(log10(span / 2)));
    return span / step > 8 ? (span / step > 16 ? 5 * step : 2 * step) : step;
}

static void addPanel(const Clamp* c, const Range* r, const char* title, bool percent)
{
    addText(c->svg, "<text x=\"%d\" y=\"%.1f\">%s</text>\n", LEFT, r->bottom - PANEL - 8, title);
    double step = stepOf(r->high - r->low);
    for (double value = step * ceil(r->low / step - 1e-9); value <= r->high * (1 + 1e-9); value += step) {
        double y = atY(r, value);
        addText(c->svg, "<line class=\"grid\" x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/>", LEFT,
                WIDTH - RIGHT, y, y);
        addText(c->svg, "<text class=\"soft\" x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%.4g%s</text>\n",
                LEFT - 8, y + 4, 0 + (percent ? 100 * value : value), percent ? " %" : "");
    }
    addText(c->svg, "<path class=\"axis\" d=\"M%d %.1fV%.1fH%d\"/>\n", LEFT, r->bottom - PANEL, r->bottom,
            WIDTH - RIGHT);
}

static void addLine(const Clamp* c, const Range* r, Family family, bool energy)
{
    const char* command = "M";
    addText(c->svg, "<path class=\"f%d band\" d=\"", family);
    for (int i = 0; i < c->count; i++) {
        const Setting* s = c->points[i];
        if (s->family == family) {
            addText(c->svg, "%s%.1f %.1f", command, atX(c, i), atY(r, energy ? s->energy : s->error));
            command = "L";
        }
    }
    addText(c->svg, "\"/>\n");
    for (int i = 0; i < c->count; i++) {
        const Setting* s = c->points[i];
        if (s->family == family) {
            addMarker(c->svg, family, true, atX(c, i), atY(r, energy ? s->energy : s->error));
        }
        if (s->family == family && !energy) {
            addText(c->svg, "<path class=\"f%d band\" d=\"M%.1f %.1fV%.1f\"/>", family, atX(c, i),
                    atY(r, s->errorLow), atY(r, s->errorHigh));
        }
    }
}

static void addLegend(const Clamp* c)
{
    int x = LEFT + 150;
    for (int f = 0; f < FAMILY_COUNT; f++) {
        bool present = false;
        for (int i = 0; i < c->count; i++) {
            present |= c->points[i]->family == (Family)f;
        }
        if (present) {
            addMarker(c->svg, (Family)f, true, x, TOP - 12);
            addText(c->svg, "<text x=\"%d\" y=\"%d\">%s</text>\n", x + 12, TOP - 8, FAMILY_NAMES[f]);
            x += 250;
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
    Range error = {0, 0, TOP + PANEL}, energy = {1, 1, TOP + 2 * PANEL + GAP};
    for (int i = 0; i < c->count; i++) {
        error.high = fmax(error.high, 1.05 * c->points[i]->errorHigh);
        energy.low = fmin(energy.low, c->points[i]->energy);
        energy.high = fmax(energy.high, c->points[i]->energy);
    }
    double room = fmax(0.05 * (energy.high - energy.low), 0.01);
    energy.low -= room;
    energy.high += room;
    int height = TOP + 2 * PANEL + GAP + BOTTOM;
    addText(
        c->svg,
        "<svg class=\"vpl\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
        "height=\"%d\" role=\"img\" aria-label=\"Error and energy against the clamp\">\n<rect class=\"back\" "
        "width=\"%d\" height=\"%d\"/>\n",
        WIDTH, height, WIDTH, height, WIDTH, height);
    addPanel(c, &error, "error", true);
    addPanel(c, &energy, "energy: all light / all light of the truth", false);
    addText(c->svg, "<path class=\"front\" d=\"M%d %.1fH%d\"/>\n", LEFT, atY(&energy, 1), WIDTH - RIGHT);
    for (int f = 0; f < FAMILY_COUNT; f++) {
        addLine(c, &error, (Family)f, false);
        addLine(c, &energy, (Family)f, true);
    }
    addLegend(c);
    addDistances(c, height - BOTTOM + 18);
    addText(c->svg, "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">--min-distance D</text>\n</svg>\n",
            (LEFT + WIDTH - RIGHT) / 2, height - 12);
}

void addClamp(const Tradeoff* t, Text* html)
{
    Clamp clamp = {.svg = html};
    findPoints(t, &clamp);
    if (clamp.count < 2) {
        return;
    }
    findColumns(&clamp);
    char command[SENTENCE];
    writeCommand(&t->settings[0], command, sizeof command);
    addText(
        html,
        "<h2>The clamp: blotches against lost light</h2>\n<p>A virtual light lights what is nearer than D "
        "only as if it were D away. A small D leaves bright blotches around the lights, a large one "
        "loses light, in corners first. All else as in the base, <code>");
    addWords(html, command);
    addText(html, "</code>.</p>\n");
    drawClamp(&clamp);
}
