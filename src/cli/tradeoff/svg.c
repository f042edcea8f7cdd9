// SPDX-License-Identifier: MIT
#include "cli/tradeoff/svg.h"

#include <math.h>

double pixelOf(const Axis* a, double value)
{
    const double share =
        a->logarithmic ? log(value / a->low) / log(a->high / a->low) : (value - a->low) / (a->high - a->low);
    return a->from + (a->to - a->from) * fmin(fmax(share, 0), 1);
}

void beginSvg(Text* svg, int height, const char* label, bool ownStyle)
{
    addText(svg,
            "<svg class=\"vpl\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 %d %d\" width=\"%d\" "
            "height=\"%d\" role=\"img\" aria-label=\"%s\">\n",
            PLOT_WIDTH, height, PLOT_WIDTH, height, label);
    if (ownStyle) {
        addText(svg, "<style>");
        writeStyle(svg);
        addText(svg, "</style>\n");
    }
    addText(svg, "<rect class=\"back\" width=\"%d\" height=\"%d\"/>\n", PLOT_WIDTH, height);
}

// Colours for readers with any colour vision: Okabe and Ito, Color Universal Design, 2008.
void writeStyle(Text* css)
{
    static const char light[] = "--ink:#1b1b1b;--soft:#5c5c5c;--paper:#ffffff;--panel:#f4f4f1;--line:#d5d5d0;"
                                "--f0:#6f6f6f;--f1:#c77700;--f2:#0072b2;--f3:#00805c;--f4:#b3362b;--f5:#"
                                "7a5cc4;--f6:#7d8a00;--f7:#b2399a;--f8:#000000";
    static const char dark[] = "--ink:#ececec;--soft:#a8a8a8;--paper:#16181b;--panel:#212428;--line:#3a3e44;"
                               "--f0:#a5a5a5;--f1:#f0a830;--f2:#56b4e9;--f3:#2ec79a;--f4:#ff8a7a;--f5:#"
                               "b39dff;--f6:#c3d14a;--f7:#e58fd0;--f8:#ffffff";
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
    addText(css,
            "svg.vpl .off{fill:var(--paper);stroke-width:1.3}\nsvg.vpl .band{opacity:.55;fill:none}\n"
            "svg.vpl "
            ".asked{fill:var(--ink);font-size:11px;paint-order:stroke;stroke:var(--paper);stroke-width:3px}\n"
            "svg.vpl .number{font-weight:700;font-size:12px;paint-order:stroke;stroke:var(--paper);"
            "stroke-width:3px}\n");
}

void addMarker(Text* svg, Family family, bool solid, double x, double y)
{
    static const char* const shapes[FAMILY_COUNT] = {
        "M-5 -5H5V5H-5Z",
        "M0 -5.5A5.5 5.5 0 1 1 0 5.5A5.5 5.5 0 1 1 0 -5.5Z",
        "M-6 5H6L0 -6Z",
        "M0 -7L7 0L0 7L-7 0Z",
        "M-2 -6H2V-2H6V2H2V6H-2V2H-6V-2H-2Z",
        "M-6 -6L0 -3L6 -6L3 0L6 6L0 3L-6 6L-3 0Z",
        "M-6 -2.5H6V2.5H-6Z",
        "M-6 -5H6L0 6Z",
        "M0 -9L2.2 -3.1L8.6 -2.8L3.6 1.2L5.3 7.3L0 3.8L-5.3 7.3L-3.6 1.2L-8.6 -2.8L-2.2 -3.1Z"};
    addText(svg, "<path class=\"f%d%s\" transform=\"translate(%.1f %.1f)\" d=\"%s\"/>", family,
            solid ? "" : " off", x, y, shapes[family]);
}

void addGridLine(Text* svg, double y, const char* label)
{
    addText(svg, "<line class=\"grid\" x1=\"%d\" x2=\"%d\" y1=\"%.1f\" y2=\"%.1f\"/>", PLOT_LEFT, PLOT_RIGHT,
            y, y);
    addText(svg, "<text class=\"soft\" x=\"%d\" y=\"%.1f\" text-anchor=\"end\">%s</text>\n", PLOT_LEFT - 8,
            y + 4, label);
}

void addFrame(Text* svg, double top, double bottom)
{
    addText(svg, "<path class=\"axis\" d=\"M%d %.1fV%.1fH%d\"/>\n", PLOT_LEFT, top, bottom, PLOT_RIGHT);
}

enum { LEGEND_ROW = 20, LEGEND_COLUMNS = 3, LEGEND_COLUMN = (PLOT_RIGHT - PLOT_LEFT) / LEGEND_COLUMNS };

int addLegend(Text* svg, const bool present[FAMILY_COUNT])
{
    int count = 0;
    for (int f = 0; f < FAMILY_COUNT; f++) {
        if (present[f]) {
            const int x = PLOT_LEFT + count % LEGEND_COLUMNS * LEGEND_COLUMN;
            const int y = LEGEND_ROW * (1 + count / LEGEND_COLUMNS);
            addMarker(svg, (Family)f, true, x + 6, y - 4);
            addText(svg, "<text x=\"%d\" y=\"%d\">%s</text>", x + 20, y, FAMILY_NAMES[f]);
            count++;
        }
    }
    return heightOfLegend(present);
}

int heightOfLegend(const bool present[FAMILY_COUNT])
{
    int count = 0;
    for (int f = 0; f < FAMILY_COUNT; f++) {
        count += present[f];
    }
    return LEGEND_ROW * ((count + LEGEND_COLUMNS - 1) / LEGEND_COLUMNS) + LEGEND_ROW / 2;
}
