// SPDX-License-Identifier: MIT
// How far one picture is from another. Sums run in row order in double: the same on every machine.
#include "base/context.h"
#include "image/draw.h"
#include "image/image_file.h"
#include "math/scalar.h"

#include <math.h>

static vplResult checkPair(const vplImage* a, const vplImage* b)
{
    if (a->width != b->width || a->height != b->height) {
        return vplFail(a->context, VPL_INVALID_ARGUMENT, "the pictures differ in size: %dx%d and %dx%d",
                       a->width, a->height, b->width, b->height);
    }
    vplResult result = vplImage_RequireFinite(a, "first picture");
    return result == VPL_SUCCESS ? vplImage_RequireFinite(b, "second picture") : result;
}

vplResult vplImage_Compare(const vplImage* a, const vplImage* b, vplComparison* comparisonOut)
{
    vplResult result = checkPair(a, b);
    if (result != VPL_SUCCESS) {
        return result;
    }
    size_t count = 3 * (size_t)a->width * (size_t)a->height;
    double square = 0, relative = 0, encoded = 0, sumA = 0, sumB = 0;
    vplComparison c = {0};
    for (size_t i = 0; i < count; i++) {
        double va = a->pixels[i], vb = b->pixels[i];
        double d = va - vb, e = (double)vplSrgb_Encode(a->pixels[i]) - vplSrgb_Encode(b->pixels[i]);
        double r = d / (vb + 0.01);
        square += d * d;
        relative += r * r;
        encoded += e * e;
        sumA += va;
        sumB += vb;
        if (fabs(d) > c.maxDifference) {
            c.maxDifference = fabs(d);
            c.maxX = (int)(i / 3 % (size_t)a->width);
            c.maxY = (int)(i / 3 / (size_t)a->width);
        }
    }
    double n = (double)count;
    c.rmse = sqrt(square / n);
    c.relativeRmse = square == 0 ? 0 : c.rmse / (sumB / n);
    c.relmse = relative / n;
    c.psnr = encoded > 0 ? -10 / 2.30258509299404568402 * vplLog1(encoded / n) : INFINITY;
    c.energyRatio = sumA == sumB ? 1 : sumA / sumB;
    *comparisonOut = c;
    return VPL_SUCCESS;
}

static float meanDifference(const vplImage* a, const vplImage* b, size_t pixel)
{
    float sum = 0;
    for (size_t c = 0; c < 3; c++) {
        sum += fabsf(a->pixels[3 * pixel + c] - b->pixels[3 * pixel + c]);
    }
    return sum / 3;
}

vplResult vplImage_Heatmap(const vplImage* a, const vplImage* b, float scale, vplImage** imageOut)
{
    vplResult result = checkPair(a, b);
    if (result != VPL_SUCCESS) {
        return result;
    }
    if (!(scale >= 0 && isfinite(scale))) {
        return vplFail(a->context, VPL_INVALID_ARGUMENT,
                       "heat map scale is %g, must be finite and not negative", (double)scale);
    }
    vplImage* image;
    int barHeight = vplColourBar_GetHeight(a->width);
    result = vplImage_Create(a->context, a->width, a->height + barHeight, &image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    size_t count = (size_t)a->width * (size_t)a->height;
    float largest = scale;
    for (size_t i = 0; scale == 0 && i < count; i++) {
        largest = vplMaxf(largest, meanDifference(a, b, i));
    }
    for (size_t i = 0; i < count; i++) {
        vplRgb c = vplFalseColour(largest > 0 ? meanDifference(a, b, i) / largest : 0);
        image->pixels[3 * i] = c.r;
        image->pixels[3 * i + 1] = c.g;
        image->pixels[3 * i + 2] = c.b;
    }
    vplColourBar_Draw(image, a->height, barHeight, largest);
    *imageOut = image;
    return VPL_SUCCESS;
}
