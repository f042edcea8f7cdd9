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

// The largest of the pixel's own contrast and those of its left and its upper neighbour, so that both sides of an edge have it.
static inline double vplContrastOfPixel(const vplImage* image, int x, int y)
{
    double largest = vplContrastOf(image, x, y);
    for (int i = 0; i < 2; i++) {
        const double beside = vplContrastOf(image, x - (i == 0), y - (i == 1));
        largest = beside > largest ? beside : largest;
    }
    return largest;
}

#endif
