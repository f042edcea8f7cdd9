// SPDX-License-Identifier: MIT
// How much a pixel differs from its neighbours. Errors at edges are about proportional to it.
#ifndef VPL_RENDER_PLANNER_CONTRAST_H
#define VPL_RENDER_PLANNER_CONTRAST_H

#include <vpl/image.h>

// Squared differences of value c from those of the right and the lower neighbour, where there are such.
static inline double vplContrastOf(const vplImage* image, int x, int y, size_t c)
{
    const size_t width = (size_t)image->width, at = 3 * ((size_t)y * width + (size_t)x) + c;
    const double value = (double)image->pixels[at];
    const double dx = x + 1 < image->width ? (double)image->pixels[at + 3] - value : 0;
    const double dy = y + 1 < image->height ? (double)image->pixels[at + 3 * width] - value : 0;
    return dx * dx + dy * dy;
}

// The squared difference from a neighbour, of all three values.
static inline double vplContrastBetween(const vplImage* image, int x, int y, int u, int v)
{
    double sum = 0;
    if (u >= 0 && v >= 0 && u < image->width && v < image->height) {
        const float* a = image->pixels + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
        const float* b = image->pixels + 3 * ((size_t)v * (size_t)image->width + (size_t)u);
        for (int c = 0; c < 3; c++) {
            const double d = (double)a[c] - (double)b[c];
            sum += d * d;
        }
    }
    return sum;
}

// A line between two pixels that meet at a corner cuts at most an eighth off a pixel whose centre is on the other side. One
// between neighbours may cut off half: four times the error.
static const double VPL_CONTRAST_OF_CORNER = 1 / 16.0;

// The largest sum over red, green and blue: of the pixel, its left and its upper neighbour, so that both sides of an edge have it;
// and of the pixels that meet it at a corner.
static inline double vplContrastOfPixel(const vplImage* image, int x, int y)
{
    double largest = 0;
    for (int i = 0; i < 3; i++) {
        const int u = x - (i == 1), v = y - (i == 2);
        double sum = 0;
        for (size_t c = 0; c < 3 && u >= 0 && v >= 0; c++) {
            sum += vplContrastOf(image, u, v, c);
        }
        largest = sum > largest ? sum : largest;
    }
    for (int i = 0; i < 4; i++) {
        const double corner = VPL_CONTRAST_OF_CORNER *
                              vplContrastBetween(image, x, y, x + (i & 1 ? 1 : -1), y + (i & 2 ? 1 : -1));
        largest = corner > largest ? corner : largest;
    }
    return largest;
}

#endif
