// SPDX-License-Identifier: MIT
#include "image/enlarge.h"

#include "base/context.h"
#include "math/scalar.h"

enum { ROWS = 16 }; // that a task makes

// The two pixels of the small picture beside the centre of a pixel of the large one, along an axis, and the second one's weight.
typedef struct Between {
    int first, second;
    float weight;
} Between;

static Between findBetween(int i, int count, int smallCount)
{
    const double at = (i + 0.5) * smallCount / count - 0.5;
    const int first = at < 0 ? 0 : vplMini((int)at, smallCount - 1),
              second = vplMini(first + 1, smallCount - 1);
    return (Between){first, second, at < 0 ? 0 : (float)(at - first)};
}

typedef struct Enlarging {
    const vplImage* from;
    vplImage* to;
    Between* columns;
} Enlarging;

static float mix(float a, float b, float weight)
{
    return a + weight * (b - a);
}

static void makeRows(void* data, int task, int worker)
{
    (void)worker;
    const Enlarging* e = data;
    const int width = e->to->width, height = e->to->height, end = vplMini((task + 1) * ROWS, height);
    for (int y = task * ROWS; y < end; y++) {
        const Between row = findBetween(y, height, e->from->height);
        const size_t stride = 3 * (size_t)e->from->width;
        const float *above = e->from->pixels + stride * (size_t)row.first,
                    *below = e->from->pixels + stride * (size_t)row.second;
        float* out = e->to->pixels + 3 * (size_t)width * (size_t)y;
        for (int x = 0; x < width; x++) {
            const Between c = e->columns[x];
            for (int k = 0; k < 3; k++) {
                const float left = mix(above[3 * c.first + k], below[3 * c.first + k], row.weight);
                const float right = mix(above[3 * c.second + k], below[3 * c.second + k], row.weight);
                out[3 * x + k] = mix(left, right, c.weight);
            }
        }
    }
}

vplResult vplImage_Enlarge(const vplImage* image, int width, int height, vplImage** enlargedOut)
{
    vplContext* context = image->context;
    Enlarging e = {.from = image, .columns = vplAlloc(context, (size_t)width, sizeof *e.columns)};
    vplResult result = e.columns != NULL ? vplImage_Create(context, width, height, &e.to) : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        for (int x = 0; x < width; x++) {
            e.columns[x] = findBetween(x, width, image->width);
        }
        vplParallelFor(context, (height + ROWS - 1) / ROWS, makeRows, &e);
        *enlargedOut = e.to;
    }
    vplFree(context, e.columns);
    return result;
}
