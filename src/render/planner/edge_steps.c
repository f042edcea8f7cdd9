// SPDX-License-Identifier: MIT
#include "render/planner/patch_plan.h"
#include "render/planner/ways.h"

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

// ---- tries

static int pixelsOf(const vplRenderer* r)
{
    return r->asked.output.width * r->asked.output.height;
}

int vplCountWiderTruth(const vplRenderer* r)
{
    const int wider = VPL_WIDER_TRUTH * vplTruth_CountPixels(r->truth);
    return wider < pixelsOf(r) ? wider : pixelsOf(r);
}

bool vplHasRoomForWiderTruth(const vplRenderer* r)
{
    return vplCountWiderTruth(r) <= VPL_MOST_TRUTH_PIXELS &&
           2 * vplTruth_CountPixels(r->truth) <= pixelsOf(r);
}

vplResult vplProveEdges(vplRenderer* r, const vplErrorState* s, double asked, bool* moreOut)
{
    const vplEdgeNoise noise = vplEdges_Noise(r->edges, pixelsOf(r));
    const double left = asked * asked - s->square, cost = s->path * r->edgePixels * r->edgePaths;
    const bool noisy = noise.spread > 0.5 * r->judged.spread;
    *moreOut = true;
    if (left > 0 && noisy && 2 * cost < s->spent && 2 * r->edgePaths < VPL_MAX_SAMPLES) {
        return vplRenderer_TraceEdges(r, r->edgePixels, 2 * r->edgePaths);
    }
    if (left > 0 && !noisy && vplProofOf(s, s->spread, left) < s->spent + cost) {
        return vplRefineTruth(r, 1);
    }
    if (left > 0 && !noisy && s->stuck && s->truth < s->spent + cost && vplHasRoomForWiderTruth(r)) {
        return vplWidenTruth(r);
    }
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "%d paths through each of %d pixels at edges leave an error of about %.3g %%, which is not enough",
           r->edgePaths, r->edgePixels, 100 * r->error.total);
    vplRenderer_ForgetEdges(r);
    vplCountVainPatches(r, cost);
    r->edgeTries++;
    return VPL_SUCCESS;
}

static vplResult traceEdges(vplRenderer* r, const vplWay* way, bool* moreOut)
{
    vplLog(r->runner.run.context, VPL_LOG_INFO,
           "after %d passes the noise is %.3g %% and the error about %.3g %%: traces %d paths through each "
           "of %d pixels at edges",
           r->done, 100 * fmax(0, r->error.noise), 100 * r->error.total, way->paths, way->pixels);
    *moreOut = true;
    return vplRenderer_TraceEdges(r, way->pixels, way->paths);
}

vplResult vplFinishWay(vplRenderer* r, const vplWay* way, bool* moreOut)
{
    if (way->pixels > 0) {
        return traceEdges(r, way, moreOut);
    }
    *moreOut = true;
    return vplRefineTruth(r, 1);
}

// Edges that cost less than this share of the passes are traced before the noise is known well.
static const double CHEAP = 0.25;

vplResult vplTryEdges(vplRenderer* r, const vplErrorState* s, double asked, bool* moreOut)
{
    vplEdgeStep steps[VPL_EDGE_STEPS];
    vplWay best = {.rays = CHEAP * s->spent};
    int count;
    TRY(vplFindUsefulSteps(r, steps, &count));
    for (int i = 0; i < count; i++) {
        const double left = asked * asked - steps[i].square - 1.5 * steps[i].spread;
        const double paths = left > 0 ? vplPathsForEdges(s, &steps[i], left) : VPL_MAX_SAMPLES;
        const double rays = steps[i].pixels * s->path * paths;
        if (paths < VPL_MAX_SAMPLES && rays < best.rays) {
            best = (vplWay){rays, 0, 1, steps[i].pixels, (int)paths, 0};
        }
    }
    return best.pixels > 0 ? traceEdges(r, &best, moreOut) : VPL_SUCCESS;
}
