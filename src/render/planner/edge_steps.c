// SPDX-License-Identifier: MIT
#include "render/planner/edge_steps.h"

#include "render/stages/results.h"

#include <math.h>

enum { FEWEST_PIXELS = 64 };

// Sums over the pixels of a contrast; in the end, over all pixels of lower contrasts.
typedef struct Bin {
    int pixels;
    double noise;           // variance between passes
    double square, squares; // of the truth's estimate of the error, and their squares
    double path, mean;      // variance of one path, and of the mean of the truth's paths
} Bin;

static void addPixels(const vplRenderer* r, const vplImage* image, Bin* bins)
{
    const double passes = (r->done > 1 ? r->done - 1 : 1) * r->weight;
    const double values = (double)vplValueCount(image);
    size_t k = 0;
    for (int y = 0; y < image->height; y++) {
        for (int x = 0; x < image->width; x++) {
            Bin* bin = &bins[vplContrastBin(image, x, y)];
            bin->pixels++;
            for (int c = 0; c < 3 && r->sums[0] != NULL; c++, k++) {
                const double sum = r->sums[0][k];
                bin->noise += fmax(0, r->sums[1][k] - sum * sum / r->weight) / passes / values;
            }
        }
    }
}

static void addTruth(const vplRenderer* r, const vplImage* image, Bin* bins)
{
    for (int i = 0; i < vplTruth_CountPixels(r->truth); i++) {
        const vplTruthPixel p = vplTruth_GetPixel(r->truth, image, i);
        Bin* bin = &bins[vplContrastBin(image, p.x, p.y)];
        bin->square += p.square;
        bin->squares += p.square * p.square;
        bin->path += p.pathVariance;
        bin->mean += p.meanVariance;
    }
}

static vplEdgeStep stepOf(const Bin* above, const Bin* below, double mean)
{
    const double scale = 1 / (mean * mean), bias = fmax(0, below->square - below->noise),
                 spread = sqrt(below->squares);
    return (vplEdgeStep){above->pixels,
                         scale * below->noise,
                         scale * vplLikelyBias(bias, spread),
                         scale * fmax(below->square, below->noise),
                         scale * spread,
                         scale * above->path,
                         scale * above->mean};
}

static void addBin(Bin* sum, const Bin* bin)
{
    sum->pixels += bin->pixels;
    sum->noise += bin->noise;
    sum->square += bin->square;
    sum->squares += bin->squares;
    sum->path += bin->path;
    sum->mean += bin->mean;
}

// From the highest contrast down, a step wherever the number of pixels has grown by a half.
static int findSteps(const Bin* bins, double mean, int pixels, vplEdgeStep steps[VPL_EDGE_STEPS])
{
    Bin above = {0};
    double next = FEWEST_PIXELS;
    int count = 0;
    for (int i = VPL_CONTRAST_BINS - 1; i > 0 && count < VPL_EDGE_STEPS; i--) {
        addBin(&above, &bins[i]);
        if (above.pixels > pixels / 2) {
            break;
        }
        if (above.pixels >= next && bins[i].pixels > 0) {
            Bin below = {0};
            for (int j = 0; j < i; j++) {
                addBin(&below, &bins[j]);
            }
            steps[count++] = stepOf(&above, &below, mean);
            next = 1.5 * above.pixels;
        }
    }
    return count;
}

vplResult vplFindEdgeSteps(vplRenderer* r, vplEdgeStep steps[VPL_EDGE_STEPS], int* countOut)
{
    vplContext* context = r->runner.run.context;
    vplImage* image = NULL;
    *countOut = 0;
    TRY(vplRenderer_Resolve(r, &image));
    Bin* bins = vplAllocZero(context, VPL_CONTRAST_BINS, sizeof *bins);
    if (bins != NULL && r->judged.mean > 0) {
        addPixels(r, image, bins);
        addTruth(r, image, bins);
        *countOut = findSteps(bins, r->judged.mean, image->width * image->height, steps);
    }
    vplImage_Destroy(image);
    vplFree(context, bins);
    return bins != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}
