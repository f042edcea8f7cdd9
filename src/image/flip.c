// SPDX-License-Identifier: MIT
// Based on: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild, FLIP: A Difference
// Evaluator for Alternating Images, High Performance Graphics 2020, for pictures of low dynamic range. Same
// formulas and constants. Each filter of the paper is a sum of products of filters along x and y (a Gaussian,
// its derivatives, or for blue-yellow two Gaussians) and is applied in that separable form.
#include "base/arena.h"
#include "image/flip_colour.h"
#include "image/metrics.h"
#include "math/scalar.h"

#include <vpl/vecmath.h>

#include <math.h>
#include <string.h>

// Contrast sensitivity functions, table 1: a sqrt(pi / b) e^(-pi^2 z^2 / b) with z in degrees.
static const double A_BY[2] = {34.1, 13.5}, B_BY[2] = {0.04, 0.025};
static const double B_ACHROMATIC = 0.0047, B_RED_GREEN = 0.0053;
static const double EDGE_WIDTH = 0.082; // degrees from peak to trough of human edge detection
static const double COLOUR_EXPONENT = 0.7, COMPRESS_FROM = 0.4, COMPRESS_TO = 0.95;

// 3 standard deviations of the widest filter at VPL_MAX_PPD.
enum { MAX_RADIUS = 136 };

typedef struct Kernel {
    int radius;
    float weights[2 * MAX_RADIUS + 1];
} Kernel;

// Filters along one axis, and the filtered pictures that they give.
enum { ACHROMATIC, RED_GREEN, BLUE_YELLOW, BLUE_YELLOW_2, BLUR, EDGE, POINT, KERNELS };
enum { OUT_Y, OUT_CX, OUT_CZ, EDGE_X, EDGE_Y, POINT_X, POINT_Y, OUTPUTS };

typedef struct Flip {
    const vplImage* images[2];
    float* planes[2]; // Y, Cx and Cz, one after the other
    float* scratch;   // per worker: KERNELS padded rows, then OUTPUTS rows for each picture
    double* rows;     // sum of the errors of each row
    vplImage* map;    // or NULL
    Kernel kernels[KERNELS];
    int width, height, pad;
    double largestColour; // HyAB distance between green and blue, to the power of COLOUR_EXPONENT
} Flip;

// ---- filters

static void setGaussian(Kernel* k, int radius, double ppd, double b, double scale)
{
    k->radius = radius;
    for (int i = -radius; i <= radius; i++) {
        double z = i / ppd;
        k->weights[radius + i] = (float)(scale * vplExp(-VPL_PI * VPL_PI * z * z / b));
    }
}

static double sumOfGaussian(int radius, double ppd, double b)
{
    double sum = 0;
    for (int i = -radius; i <= radius; i++) {
        double z = i / ppd;
        sum += vplExp(-VPL_PI * VPL_PI * z * z / b);
    }
    return sum;
}

// The blue-yellow filter is a sum of two products of Gaussians. It is normalised as a whole; the square root
// gives each axis the same factor.
static void setColourKernels(Flip* f, double ppd)
{
    int radius = (int)ceil(3 * sqrt(B_BY[0] / (2 * VPL_PI * VPL_PI)) * ppd);
    setGaussian(&f->kernels[ACHROMATIC], radius, ppd, B_ACHROMATIC,
                1 / sumOfGaussian(radius, ppd, B_ACHROMATIC));
    setGaussian(&f->kernels[RED_GREEN], radius, ppd, B_RED_GREEN,
                1 / sumOfGaussian(radius, ppd, B_RED_GREEN));
    double height[2], total = 0;
    for (int i = 0; i < 2; i++) {
        double sum = sumOfGaussian(radius, ppd, B_BY[i]);
        height[i] = A_BY[i] * sqrt(VPL_PI / B_BY[i]);
        total += height[i] * sum * sum;
    }
    for (int i = 0; i < 2; i++) {
        setGaussian(&f->kernels[BLUE_YELLOW + i], radius, ppd, B_BY[i], sqrt(height[i] / total));
    }
}

// Divides positive weights by their sum and negative weights by the magnitude of theirs.
static void setNormalised(Kernel* k, int radius, const double* weights)
{
    double positive = 0, negative = 0;
    for (int i = 0; i <= 2 * radius; i++) {
        *(weights[i] > 0 ? &positive : &negative) += fabs(weights[i]);
    }
    k->radius = radius;
    for (int i = 0; i <= 2 * radius; i++) {
        k->weights[i] = (float)(weights[i] == 0 ? 0 : weights[i] / (weights[i] > 0 ? positive : negative));
    }
}

static void setFeatureKernels(Flip* f, double ppd)
{
    double deviation = 0.5 * EDGE_WIDTH * ppd;
    int radius = (int)ceil(3 * deviation);
    double blur[2 * MAX_RADIUS + 1], edge[2 * MAX_RADIUS + 1], point[2 * MAX_RADIUS + 1];
    for (int i = -radius; i <= radius; i++) {
        double t = i / deviation, g = vplExp(-0.5 * t * t);
        blur[radius + i] = g;
        edge[radius + i] = -i * g;
        point[radius + i] = (t * t - 1) * g;
    }
    setNormalised(&f->kernels[BLUR], radius, blur);
    setNormalised(&f->kernels[EDGE], radius, edge);
    setNormalised(&f->kernels[POINT], radius, point);
}

// ---- conversion to opponent colours

static void convertRow(void* data, int y, int worker)
{
    (void)worker;
    const Flip* f = data;
    size_t count = (size_t)f->width * (size_t)f->height, first = (size_t)y * (size_t)f->width;
    for (int i = 0; i < 2; i++) {
        for (size_t p = first; p < first + (size_t)f->width; p++) {
            const float* rgb = f->images[i]->pixels + 3 * p;
            float opponent[3];
            vplToOpponent(rgb, opponent);
            for (size_t c = 0; c < 3; c++) {
                f->planes[i][c * count + p] = opponent[c];
            }
        }
    }
}

// ---- filtering of a row: along columns, then along the row

static void filterColumns(const Flip* f, const float* plane, int y, const Kernel* k, float* restrict padded)
{
    float* out = padded + f->pad;
    memset(out, 0, sizeof *out * (size_t)f->width);
    for (int i = -k->radius; i <= k->radius; i++) {
        int row = vplMaxi(0, vplMini(y + i, f->height - 1)); // repeats borders
        const float* in = plane + (size_t)row * (size_t)f->width;
        float w = k->weights[k->radius + i];
        for (int x = 0; x < f->width; x++) {
            out[x] += w * in[x];
        }
    }
    for (int x = 1; x <= f->pad; x++) {
        out[-x] = out[0];
        out[f->width - 1 + x] = out[f->width - 1];
    }
}

static void filterAlong(const Flip* f, const float* padded, const Kernel* k, float* restrict out)
{
    for (int i = -k->radius; i <= k->radius; i++) {
        const float* in = padded + f->pad + i;
        float w = k->weights[k->radius + i];
        for (int x = 0; x < f->width; x++) {
            out[x] += w * in[x];
        }
    }
}

// Computes the OUTPUTS rows of one picture.
static void filterRow(const Flip* f, const float* planes, int y, float* padded, float* outputs)
{
    static const int channels[KERNELS] = {0, 1, 2, 2, 0, 0, 0}; // input of each kernel along columns
    static const int steps[][3] = {
        // kernel along columns, kernel along the row, output
        {ACHROMATIC, ACHROMATIC, OUT_Y},
        {RED_GREEN, RED_GREEN, OUT_CX},
        {BLUE_YELLOW, BLUE_YELLOW, OUT_CZ},
        {BLUE_YELLOW_2, BLUE_YELLOW_2, OUT_CZ},
        {BLUR, EDGE, EDGE_X},
        {EDGE, BLUR, EDGE_Y},
        {BLUR, POINT, POINT_X},
        {POINT, BLUR, POINT_Y},
    };
    size_t stride = (size_t)f->width + 2 * (size_t)f->pad, width = (size_t)f->width;
    size_t count = width * (size_t)f->height;
    for (size_t k = 0; k < KERNELS; k++) {
        filterColumns(f, planes + (size_t)channels[k] * count, y, &f->kernels[k], padded + k * stride);
    }
    memset(outputs, 0, sizeof *outputs * OUTPUTS * width);
    for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
        filterAlong(f, padded + (size_t)steps[i][0] * stride, &f->kernels[steps[i][1]],
                    outputs + (size_t)steps[i][2] * width);
    }
}

// ---- the error of a pixel

// Maps [0, 0.4 largest] to [0, 0.95], and the rest, which is rare, to [0.95, 1].
static double compress(double error, double largest)
{
    double knee = COMPRESS_FROM * largest;
    return error < knee ? COMPRESS_TO / knee * error
                        : COMPRESS_TO + (error - knee) / (largest - knee) * (1 - COMPRESS_TO);
}

static double featureDifference(const float* a, const float* b, size_t x, size_t width, int first)
{
    double ax = a[(size_t)first * width + x], ay = a[(size_t)(first + 1) * width + x];
    double bx = b[(size_t)first * width + x], by = b[(size_t)(first + 1) * width + x];
    // The paper filters (Y + 16) / 116. The filters sum to zero, so the 16 has no effect.
    return fabs(sqrt(ax * ax + ay * ay) - sqrt(bx * bx + by * by)) / 116;
}

static double pixelError(const Flip* f, const float* a, const float* b, size_t x)
{
    size_t w = (size_t)f->width;
    const float filteredA[3] = {a[x], a[w + x], a[2 * w + x]}, filteredB[3] = {b[x], b[w + x], b[2 * w + x]};
    double colour = vplHuntHyab(filteredA, filteredB);
    colour = compress(vplPow(colour, COLOUR_EXPONENT), f->largestColour);
    double edge = featureDifference(a, b, x, w, EDGE_X), point = featureDifference(a, b, x, w, POINT_X);
    double feature = sqrt((edge > point ? edge : point) / sqrt(2));
    return vplPow(colour, 1 - feature);
}

static void compareRow(void* data, int y, int worker)
{
    const Flip* f = data;
    size_t width = (size_t)f->width, padded = KERNELS * (width + 2 * (size_t)f->pad);
    float* scratch = f->scratch + (size_t)worker * (padded + 2 * OUTPUTS * width);
    float *a = scratch + padded, *b = a + OUTPUTS * width;
    filterRow(f, f->planes[0], y, scratch, a);
    filterRow(f, f->planes[1], y, scratch, b);
    double sum = 0;
    for (size_t x = 0; x < width; x++) {
        double error = pixelError(f, a, b, x);
        sum += error;
        if (f->map != NULL) {
            float* pixel = f->map->pixels + 3 * ((size_t)y * width + x);
            pixel[0] = pixel[1] = pixel[2] = (float)error;
        }
    }
    f->rows[y] = sum;
}

// ---- the whole picture

static vplResult prepare(Flip* f, vplArena* scratch, int workers, double ppd)
{
    setColourKernels(f, ppd);
    setFeatureKernels(f, ppd);
    f->pad = vplMaxi(f->kernels[ACHROMATIC].radius, f->kernels[BLUR].radius);
    f->largestColour = vplPow(vplHuntHyabOfGreenAndBlue(), COLOUR_EXPONENT);
    const size_t width = (size_t)f->width, count = 3 * width * (size_t)f->height;
    const size_t perWorker = KERNELS * (width + 2 * (size_t)f->pad) + 2 * OUTPUTS * width;
    f->planes[0] = vplArena_Alloc(scratch, count, sizeof(float));
    f->planes[1] = vplArena_Alloc(scratch, count, sizeof(float));
    f->rows = vplArena_Alloc(scratch, (size_t)f->height, sizeof(double));
    f->scratch = vplArena_Alloc(scratch, perWorker * (size_t)workers, sizeof(float));
    return vplArena_Check(scratch);
}

vplResult vplImage_Flip(const vplImage* a, const vplImage* b, double ppd, double* meanOut, vplImage** mapOut)
{
    REQUIRE(CONTEXT_OF(a) ?: CONTEXT_OF(b), a, b, meanOut);
    vplContext* context = a->context;
    if (!(ppd >= VPL_MIN_PPD && ppd <= VPL_MAX_PPD)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "FLIP's pixels per degree are %g, must be in [%d, %d]",
                       ppd, VPL_MIN_PPD, VPL_MAX_PPD);
    }
    TRY(vplRequirePair(a, b));
    vplArena* scratch = vplArena_Create(context);
    Flip f = {.images = {a, b}, .width = a->width, .height = a->height};
    vplResult result = prepare(&f, scratch, context->workerCount, ppd);
    if (result == VPL_SUCCESS && mapOut != NULL) {
        result = vplImage_Create(context, f.width, f.height, &f.map);
    }
    if (result == VPL_SUCCESS) {
        vplParallelFor(context, f.height, convertRow, &f);
        vplParallelFor(context, f.height, compareRow, &f);
        *meanOut = vplSumInOrder(f.rows, f.height) / f.width / f.height;
        if (mapOut != NULL) {
            *mapOut = f.map;
        }
    }
    vplArena_Destroy(scratch);
    return result;
}
