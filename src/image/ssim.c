// SPDX-License-Identifier: MIT
// Based on: Wang, Bovik, Sheikh and Simoncelli, Image Quality Assessment: From Error Visibility to Structural
// Similarity, IEEE Transactions on Image Processing 13(4), 2004, with its Gaussian window (11 pixels, sigma
// 1.5), K1 = 0.01 and K2 = 0.03. Departs: the paper compares grey levels. We compare each channel and take
// the mean, because colours of equal luminance may differ.
#include "base/arena.h"
#include "image/metrics.h"
#include "math/scalar.h"

#include <string.h>

enum { RADIUS = 5, MOMENTS = 5 };

typedef struct Ssim {
    const vplImage* images[2];
    float* planes[2];           // one channel, sRGB-encoded
    double* scratch;            // MOMENTS padded rows per worker
    double* rows;               // sum of the similarities of each row
    vplImage* map;              // or NULL
    double weights[RADIUS + 1]; // by distance; the whole window sums to 1
    int width, height, channel;
    int insetX, insetY; // width of the borders that do not count
} Ssim;

// Mirrors positions beyond a border, including the border pixel: -1 becomes 0, -2 becomes 1. A picture
// narrower than the window is mirrored several times.
static int mirror(int at, int count)
{
    while (at < 0 || at >= count) {
        at = at < 0 ? -1 - at : 2 * count - 1 - at;
    }
    return at;
}

static void setWeights(Ssim* s)
{
    double sum = 0;
    for (int i = 0; i <= RADIUS; i++) {
        s->weights[i] = vplExp(-0.5 * (i / 1.5) * (i / 1.5));
        sum += i == 0 ? s->weights[i] : 2 * s->weights[i];
    }
    for (int i = 0; i <= RADIUS; i++) {
        s->weights[i] /= sum;
    }
}

static void encodeRow(void* data, int y, int worker)
{
    (void)worker;
    const Ssim* s = data;
    size_t first = (size_t)y * (size_t)s->width;
    for (int i = 0; i < 2; i++) {
        const float* from = s->images[i]->pixels + 3 * first + s->channel;
        float* to = s->planes[i] + first;
        for (int x = 0; x < s->width; x++) {
            to[x] = vplSrgb_Encode(from[3 * x]);
        }
    }
}

// Computes, for every x, the weighted sums of a, b, a^2, b^2 and ab over a column of the window; then mirrors
// borders.
static void sumColumns(const Ssim* s, int y, double* moments, int stride)
{
    memset(moments, 0, sizeof *moments * MOMENTS * (size_t)stride);
    double *ma = moments + RADIUS, *mb = ma + stride, *maa = mb + stride, *mbb = maa + stride,
           *mab = mbb + stride;
    for (int k = -RADIUS; k <= RADIUS; k++) {
        size_t first = (size_t)mirror(y + k, s->height) * (size_t)s->width;
        const float *rowA = s->planes[0] + first, *rowB = s->planes[1] + first;
        double w = s->weights[k < 0 ? -k : k];
        for (int x = 0; x < s->width; x++) {
            double a = rowA[x], b = rowB[x]; // products of floats are exact in double
            ma[x] += w * a;
            mb[x] += w * b;
            maa[x] += w * (a * a);
            mbb[x] += w * (b * b);
            mab[x] += w * (a * b);
        }
    }
    for (int m = 0; m < MOMENTS; m++) {
        double* row = ma + (size_t)m * (size_t)stride;
        for (int x = 1; x <= RADIUS; x++) {
            row[-x] = row[mirror(-x, s->width)];
            row[s->width - 1 + x] = row[mirror(s->width - 1 + x, s->width)];
        }
    }
}

static double similarity(const double m[MOMENTS])
{
    const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    double squares = m[0] * m[0] + m[1] * m[1], product = m[0] * m[1];
    double variances = m[2] + m[3] - squares, covariance = m[4] - product;
    return (2 * product + c1) * (2 * covariance + c2) / ((squares + c1) * (variances + c2));
}

static void compareRow(void* data, int y, int worker)
{
    const Ssim* s = data;
    bool counts = y >= s->insetY && y < s->height - s->insetY;
    s->rows[y] = 0;
    if (!counts && s->map == NULL) {
        return;
    }
    int stride = s->width + 2 * RADIUS;
    double* moments = s->scratch + (size_t)worker * MOMENTS * (size_t)stride;
    sumColumns(s, y, moments, stride);
    for (int x = 0; x < s->width; x++) {
        double sums[MOMENTS] = {0};
        for (int m = 0; m < MOMENTS; m++) {
            const double* row = moments + (size_t)m * (size_t)stride + x;
            for (int k = 0; k <= 2 * RADIUS; k++) {
                sums[m] += s->weights[k < RADIUS ? RADIUS - k : k - RADIUS] * row[k];
            }
        }
        double value = similarity(sums);
        if (counts && x >= s->insetX && x < s->width - s->insetX) {
            s->rows[y] += value;
        }
        if (s->map != NULL) {
            float* pixel = s->map->pixels + 3 * ((size_t)y * (size_t)s->width + (size_t)x);
            pixel[s->channel] = (float)value;
        }
    }
}

// Replaces the similarities of the three channels of each pixel of the map by their mean.
static void averageMap(vplImage* map)
{
    for (size_t i = 0; i < (size_t)map->width * (size_t)map->height; i++) {
        float* p = map->pixels + 3 * i;
        p[0] = p[1] = p[2] = (float)(((double)p[0] + p[1] + p[2]) / 3);
    }
}

static double compareChannels(Ssim* s, vplContext* context)
{
    double sum = 0;
    setWeights(s);
    for (s->channel = 0; s->channel < 3; s->channel++) {
        vplParallelFor(context, s->height, encodeRow, s);
        vplParallelFor(context, s->height, compareRow, s);
        sum += vplSumInOrder(s->rows, s->height);
    }
    if (s->map != NULL) {
        averageMap(s->map);
    }
    return sum / (3.0 * (s->width - 2 * s->insetX) * (s->height - 2 * s->insetY));
}

vplResult vplImage_Ssim(const vplImage* a, const vplImage* b, double* meanOut, vplImage** mapOut)
{
    REQUIRE(CONTEXT_OF(a) ?: CONTEXT_OF(b), a, b, meanOut);
    TRY(vplRequirePair(a, b));
    vplContext* context = a->context;
    vplArena* scratch = vplArena_Create(context);
    Ssim s = {.images = {a, b}, .width = a->width, .height = a->height};
    s.insetX = a->width > 2 * RADIUS ? RADIUS : 0;
    s.insetY = a->height > 2 * RADIUS ? RADIUS : 0;
    const size_t count = (size_t)a->width * (size_t)a->height;
    const size_t padded = MOMENTS * ((size_t)a->width + 2 * RADIUS);
    s.planes[0] = vplArena_Alloc(scratch, count, sizeof(float));
    s.planes[1] = vplArena_Alloc(scratch, count, sizeof(float));
    s.rows = vplArena_Alloc(scratch, (size_t)a->height, sizeof(double));
    s.scratch = vplArena_Alloc(scratch, padded * (size_t)context->workerCount, sizeof(double));
    vplResult result = vplArena_Check(scratch);
    if (result == VPL_SUCCESS && mapOut != NULL) {
        result = vplImage_Create(context, a->width, a->height, &s.map);
    }
    if (result == VPL_SUCCESS) {
        *meanOut = compareChannels(&s, context);
        if (mapOut != NULL) {
            *mapOut = s.map;
        }
    }
    vplArena_Destroy(scratch);
    return result;
}
