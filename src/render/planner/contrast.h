// SPDX-License-Identifier: MIT
// How much a pixel differs from its neighbours. Errors at edges are about proportional to it.
#ifndef VPL_RENDER_PLANNER_CONTRAST_H
#define VPL_RENDER_PLANNER_CONTRAST_H

#include <vpl/image.h>

static inline bool vplHasPixel(const vplImage* image, int x, int y)
{
    return x >= 0 && y >= 0 && x < image->width && y < image->height;
}

// The squared difference of two pixels, summed over red, green and blue; 0 where the picture ends.
static inline double vplContrastBetween(const vplImage* image, int x, int y, int u, int v)
{
    double sum = 0;
    if (vplHasPixel(image, x, y) && vplHasPixel(image, u, v)) {
        const float* a = image->pixels + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
        const float* b = image->pixels + 3 * ((size_t)v * (size_t)image->width + (size_t)u);
        for (int c = 0; c < 3; c++) {
            const double difference = (double)a[c] - (double)b[c];
            sum += difference * difference;
        }
    }
    return sum;
}

// The sum of the squared differences of a pixel from its right and its lower neighbour.
static inline double vplContrastOf(const vplImage* image, int x, int y)
{
    return vplContrastBetween(image, x, y, x + 1, y) + vplContrastBetween(image, x, y, x, y + 1);
}

// The weight of a squared difference from a diagonal neighbour. Where no direct neighbour differs, only a bent edge or something
// small is near that corner, and covers a small part of the pixel. In seven scenes this weight instead of 0 changes the standard
// error of the truth by less than 1 %.
static const double VPL_CONTRAST_OF_CORNER = 1 / 16.0;

// The largest of the pixel's own contrast, those of its left and its upper neighbour, so that both sides of an edge have it, and the
// weighted differences from its diagonal neighbours.
static inline double vplContrastOfPixel(const vplImage* image, int x, int y)
{
    double largest = vplContrastOf(image, x, y);
    for (int i = 0; i < 2; i++) {
        const double beside = vplContrastOf(image, x - (i == 0), y - (i == 1));
        largest = beside > largest ? beside : largest;
    }
    for (int i = 0; i < 4; i++) {
        const double corner = VPL_CONTRAST_OF_CORNER *
                              vplContrastBetween(image, x, y, x + (i & 1 ? 1 : -1), y + (i & 2 ? 1 : -1));
        largest = corner > largest ? corner : largest;
    }
    return largest;
}

#endif
