// SPDX-License-Identifier: MIT
// Parts of both plots: axes, grids, and the markers and colours of families.
#ifndef VPL_CLI_TRADEOFF_SVG_H
#define VPL_CLI_TRADEOFF_SVG_H

#include "cli/tradeoff/tradeoff.h"

// Pixels: the width of a plot, and the left and right end of its data.
enum { PLOT_WIDTH = 900, PLOT_LEFT = 72, PLOT_RIGHT = PLOT_WIDTH - 24 };

// Maps values from low to high to pixels.
typedef struct Axis {
    double low, high;
    double from, to; // pixels
    bool logarithmic;
} Axis;

double pixelOf(const Axis* axis, double value);

void beginSvg(Text* svg, int height, const char* label, bool ownStyle);

// A horizontal grid line at y, with its label on the left.
void addGridLine(Text* svg, double y, const char* label);

// The left and lower border.
void addFrame(Text* svg, double top, double bottom);

void addMarker(Text* svg, Family family, bool solid, double x, double y);

// Markers and names of families, in rows at the top. Returns the height that they take, as heightOfLegend.
int addLegend(Text* svg, const bool present[FAMILY_COUNT]);

int heightOfLegend(const bool present[FAMILY_COUNT]);

#endif
