// SPDX-License-Identifier: MIT
// Differences between two pictures. Sums run in row order in double, so they are the same on every machine.
// Based on: relmse by Rousselle, Knaus and Zwicker, Adaptive Sampling and Reconstruction using Greedy Error
// Minimization, SIGGRAPH Asia 2011. Departs: we add 0.01, in the pictures' unit, to b before squaring.
#include "image/metrics.h"

#include "base/arena.h"
#include "image/image_file.h"
#include "math/scalar.h"

#include <math.h>

vplResult vplRequirePair(const vplImage* a, const vplImage* b)
{
    if (a->width != b->width || a->height != b->height) {
        return vplFail(a->context, VPL_INVALID_ARGUMENT, "the pictures differ in size: %dx%d and %dx%d",
                       a->width, a->height, b->width, b->height);
    }
    TRY(vplImage_RequireFinite(a, "first picture"));
    return vplImage_RequireFinite(b, "second picture");
}

double vplSumInOrder(const double* values, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++) {
        sum += values[i];
    }
    return sum;
}

// A sum without its `capacity` largest terms. A min-heap holds these, so that they never enter the sum,
// however large.
typedef struct TrimmedSum {
    double* heap;
    size_t capacity, size;
    double sum;
} TrimmedSum;

static void siftUp(double* heap, size_t at, double value)
{
    for (; at > 0 && heap[(at - 1) / 2] > value; at = (at - 1) / 2) {
        heap[at] = heap[(at - 1) / 2];
    }
    heap[at] = value;
}

static void siftDown(double* heap, size_t size, double value)
{
    size_t at = 0;
    for (size_t child = 1; child < size; child = 2 * at + 1) {
        child += child + 1 < size && heap[child + 1] < heap[child];
        if (heap[child] >= value) {
            break;
        }
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = value;
}

static void addTrimmed(TrimmedSum* t, double value)
{
    if (t->size < t->capacity) {
        siftUp(t->heap, t->size++, value);
    } else if (t->capacity > 0 && value > t->heap[0]) {
        t->sum += t->heap[0];
        siftDown(t->heap, t->size, value);
    } else {
        t->sum += value;
    }
}

static vplComparison compare(const vplImage* a, const vplImage* b, TrimmedSum* trimmed)
{
    size_t count = 3 * (size_t)a->width * (size_t)a->height;
    double square = 0, relative = 0, encoded = 0, sumA = 0, sumB = 0, pixelSum = 0;
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
        pixelSum = i % 3 == 0 ? r * r : pixelSum + r * r;
        if (i % 3 == 2) {
            addTrimmed(trimmed, pixelSum);
        }
    }
    double n = (double)count;
    c.rmse = sqrt(square / n);
    c.relativeRmse = square == 0 ? 0 : c.rmse / (sumB / n);
    c.relmse = relative / n;
    c.trimmedRelmse = trimmed->sum / (n - 3 * (double)trimmed->capacity);
    c.psnr = encoded > 0 ? -10 / 2.30258509299404568402 * vplLn(encoded / n) : INFINITY;
    c.energyRatio = sumA == sumB ? 1 : sumA / sumB;
    return c;
}

vplResult vplImage_Compare(const vplImage* a, const vplImage* b, vplComparison* comparisonOut)
{
    REQUIRE(CONTEXT_OF(a) ?: CONTEXT_OF(b), a, b, comparisonOut);
    TRY(vplRequirePair(a, b));
    TrimmedSum trimmed = {.capacity = (size_t)a->width * (size_t)a->height / 1000};
    trimmed.heap = vplAlloc(a->context, trimmed.capacity, sizeof(double));
    if (trimmed.heap == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    *comparisonOut = compare(a, b, &trimmed);
    vplFree(a->context, trimmed.heap);
    return VPL_SUCCESS;
}
