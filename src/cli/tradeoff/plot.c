// SPDX-License-Identifier: MIT
// tradeoff.svg: error against processor time, both logarithmic.
#include "cli/tradeoff/tradeoff.h"

#include <math.h>
#include <stdio.h>

enum { WIDTH = 900, HEIGHT = 560, LEFT = 72, RIGHT = 24, TOP = 66, BOTTOM = 54, MAX_TICKS = 40 };

typedef struct Plot {
    double lowX, highX, lowY, highY;
    Text* svg;
} Plot;

static double atX(const Plot* p, double ms)
{
    return LEFT + (WIDTH - LEFT - RIGHT) * log(ms / p->lowX) / log(p->highX / p->lowX);
}

static double atY(const Plot* p, double error)
{
    double share = log(error / p->lowY) / log(p->highY / p->lowY);
    return HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * fmin(fmax(share, 0), 1);
}

// Okabe and Ito, Color Universal Design, 2008: told apart also by those who see fewer colours; and by shape.
void writeStyle(Text* css)
{
    static const char light[] = "--ink:#1b1b1b;--soft:#5c5c5c;--paper:#ffffff;--panel:#f4f4f1;--line:#d5d5d0;"
                                "--f0:#6f6f6f;--f1:#c77700;--f2:#0072b2;--f3:#00805c;--f4:#b3362b;--f5:#"
                                "7a5cc4;--f6:#7d8a00;--f7:#b2399a";
    static const char dark[] = "--ink:#ececec;--soft:#a8a8a8;--paper:#16181b;--panel:#212428;--line:#3a3e44;"
                               "--f0:#a5a5a5;--f1:#f0a830;--f2:#56b4e9;--f3:#2ec79a;--f4:#ff8a7a;--f5:#"
                               "b39dff;--f6:#c3d14a;--f7:#e58fd0";
    addText(css, ".vpl{%s}\n@media screen and (prefers-color-scheme:dark){.vpl{%s}}\n", light, dark);
    addText(css, "svg.vpl{font:13px system-ui,sans-serif;max-width:100%%;height:auto}\n"
                 "svg.vpl text{fill:var(--ink)} svg.vpl .soft{fill:var(--soft);font-size:12px}\n"
                 "svg.vpl .back{fill:var(--paper)} svg.vpl .grid{stroke:var(--line)}\n"
                 "svg.vpl .axis{stroke:var(--ink);fill:none}\n"
                 "svg.vpl .front{stroke:var(--ink);fill:none;stroke-width:1.5;stroke-dasharray:5 3}\n"
                 "svg.vpl .unknown{fill:var(--line);opacity:.6}\n");
    for (int i = 0; i < FAMILY_COUNT; i++) {
        addText(css, "svg.vpl .f%d{stroke:var(--f%d);fill:var(--f%d);stroke-width:1.6}\n", i, i, i);
    }
    addText(css, "svg.vpl .off{fill:var(--paper);stroke-width:1.3}\nsvg.vpl .band{opacity:.55;fill:none}\n"
                 "svg.vpl .number{font-weight:700;font-size:12px;paint-order:stroke;stroke:var(--paper);"
                 "stroke-width:3px}\n");
}

void addMarker(Text* svg, Family family, bool solid, double x, double y)
{
    static const char* const shapes[FAMILY_COUNT] = {"M-5 -5H5V5H-5Z",
                                                     "M0 -5.5A5.5 5.5 0 1 1 0 5.5A5.5 5.5 0 1 1 0 -5.5Z",
                                                     "M-6 5H6L0 -6Z",
                                                     "M0 -7L7 0L0 7L-7 0Z",
                                                     "M-2 -6H2V-2H6V2H2V6H-2V2H-6V-2H-2Z",
                                                     "M-6 -6L0 -3L6 -6L3 0L6 6L0 3L-6 6L-3 0Z",
                                                     "M-6 -2.5H6V2.5H-6Z",
                                                     "M-6 -5H6L0 6Z"};
    addText(svg, "<path class=\"f%d%s\" transform=\"translate(%.1f %.1f)\" d=\"%s\"/>", family,
            solid ? "" : " off", x, y, shapes[family]);
}

static void addGrid(const Plot* p)
{
    double ticks[MAX_TICKS];
    char label[32];
    int count = logTicks(p->lowX, p->highX, ticks, MAX_TICKS);
    for (int i = 0; i < count; i++) {
        double x = atX(p, ticks[i]);
        formatTime(ticks[i], label, sizeof label);
        addText(p->svg, "<line class=\"grid\" x1=\"%.1f\" x2=\"%.1f\" y1=\"%d\" y2=\"%d\"/>", x, x, TOP,
                HEIGHT - BOTTOM);
        addText(p->svg, "<text class=\"soft\" x=\"%.1f\" y=\"%d\" text-anchor=\"middle\">%s</text>\n", x,
                HEIGHT - BOTTOM + 18, label);
    }
    count = logTicks(p->lowY, p->highY, ticks, MAX_TICKS);
    for (int i = 0; i < count; i++) {
        double y = atY(p, ticks[i]);
        formatPercent(ticks[i], label, sizeof label);
        addText(p->svg, "<line class=\"grid\" x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/>", LEFT,
                WIDTH - RIGHT, y, y);
        addText(p->svg, "<text class=\"soft\" x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%s</text>\n", LEFT - 8,
                y + 4, label);
    }
    addText(p->svg, "<path class=\"axis\" d=\"M%d %dV%dH%d\"/>\n", LEFT, TOP, HEIGHT - BOTTOM, WIDTH - RIGHT);
    addText(p->svg,
            "<text x=\"%d\" y=\"%d\" text-anchor=\"middle\">processor time of one picture, all threads "
            "together</text>\n",
            (LEFT + WIDTH - RIGHT) / 2, HEIGHT - 12);
    addText(p->svg,
            "<text transform=\"translate(16 %d) rotate(-90)\" text-anchor=\"middle\">error: rmse / mean "
            "of the truth</text>\n",
            (TOP + HEIGHT - BOTTOM) / 2);
}

static void addLegend(const Tradeoff* t, Text* svg)
{
    int x = LEFT, y = 18;
    for (int f = 0; f < FAMILY_COUNT; f++) {
        if (findCheapest(t, (Family)f, INFINITY) >= 0) {
            if (x > WIDTH - 250) {
                x = LEFT;
                y += 20;
            }
            addMarker(svg, (Family)f, true, x + 6, y - 4);
            addText(svg, "<text x=\"%d\" y=\"%d\">%s</text>", x + 18, y, FAMILY_NAMES[f]);
            x += 230;
        }
    }
    addText(svg,
            "<text class=\"soft\" x=\"%d\" y=\"%d\">filled and numbered: no other setting is both faster and "
            "better; hollow: another one is. Crosses span the seeds.</text>\n",
            LEFT, TOP - 10);
}

static void addPoint(const Plot* p, const Setting* s)
{
    char time[32], error[32];
    double x = atX(p, s->cpuMs), y = atY(p, s->error);
    formatTime(s->cpuMs, time, sizeof time);
    formatPercent(s->error, error, sizeof error);
    addText(p->svg, "<g><title>");
    addEscaped(p->svg, s->change[0] ? s->change : "the base");
    addText(p->svg, ": %s, %s error</title>", time, error);
    addText(p->svg, "<path class=\"f%d band\" d=\"M%.1f %.1fH%.1fM%.1f %.1fV%.1f\"/>", s->family,
            atX(p, s->cpuLow), y, atX(p, s->cpuHigh), x, atY(p, s->errorLow), atY(p, s->errorHigh));
    addMarker(p->svg, s->family, s->onFront, x, y);
    addText(p->svg, "</g>\n");
}

// Stairs through the front: what is reachable within a time. `number` is the order of cost.
static void addFront(const Tradeoff* t, const Plot* p)
{
    addText(p->svg, "<path class=\"front\" d=\"");
    bool more = true;
    for (int number = 1; more; number++) {
        more = false;
        for (int i = 0; i < t->settingCount; i++) {
            const Setting* s = &t->settings[i];
            if (s->onFront && s->number == number) {
                addText(p->svg, number == 1 ? "M%.1f %.1f" : "H%.1fV%.1f", atX(p, s->cpuMs),
                        atY(p, s->error));
                more = true;
            }
        }
    }
    addText(p->svg, "\"/>\n");
}

static void addNumbers(const Tradeoff* t, const Plot* p)
{
    for (int i = 0; i < t->settingCount; i++) {
        const Setting* s = &t->settings[i];
        if (s->onFront) {
            addText(p->svg, "<text class=\"number\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%d</text>",
                    atX(p, s->cpuMs) - 7, atY(p, s->error) + 14, s->number);
        }
    }
    addText(p->svg, "\n");
}

// Below its own error the reference cannot tell who is right.
static void addUnknown(const Tradeoff* t, const Plot* p)
{
    double y = atY(p, fmax(t->reference.resolution, p->lowY));
    if (t->reference.resolution > p->lowY) {
        addText(p->svg, "<rect class=\"unknown\" x=\"%d\" y=\"%.1f\" width=\"%d\" height=\"%.1f\"/>", LEFT, y,
                WIDTH - LEFT - RIGHT, HEIGHT - BOTTOM - y);
        addText(p->svg, "<text class=\"soft\" x=\"%d\" y=\"%.1f\">below what the reference can tell</text>\n",
                LEFT + 8, HEIGHT - BOTTOM - 6.0);
    }
}

static bool scale(const Tradeoff* t, Plot* p)
{
    double cost[3 * MAX_SETTINGS], error[3 * MAX_SETTINGS];
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
    return logRange(cost, count, &p->lowX, &p->highX) && logRange(error, count, &p->lowY, &p->highY);
}

void writePlot(const Tradeoff* t, Text* svg)
{
    Plot p = {.svg = svg};
    if (!scale(t, &p)) {
        return; // nothing differs from the reference
    }
    addText(svg,
            "<svg class=\"vpl\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
            "height=\"%d\" role=\"img\" aria-label=\"Error against processor time\">\n<style>",
            WIDTH, HEIGHT, WIDTH, HEIGHT);
    writeStyle(svg);
    addText(svg, "</style>\n<rect class=\"back\" width=\"%d\" height=\"%d\"/>\n", WIDTH, HEIGHT);
    addUnknown(t, &p);
    addGrid(&p);
    addLegend(t, svg);
    for (int pass = 0; pass < 2; pass++) { // the front on top
        for (int i = 0; i < t->settingCount; i++) {
            const Setting* s = &t->settings[i];
            if (isMeasured(s) && s->error > 0 && s->onFront == (pass == 1)) {
                addPoint(&p, s);
            }
        }
        if (pass == 0) {
            addFront(t, &p);
        }
    }
    addNumbers(t, &p);
    addText(svg, "</svg>\n");
}
