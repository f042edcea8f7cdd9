// SPDX-License-Identifier: MIT
// Based on: Reinhard, Stark, Shirley and Ferwerda, Photographic Tone Reproduction for Digital Images,
// SIGGRAPH 2002.
// Departs: the paper prints the log average with 1/N outside the exponential. We use the geometric mean,
// because otherwise a uniform picture would not map to the key.
#include "base/arena.h"
#include "image/image_file.h"
#include "image/tone.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <math.h>

vplReinhardDef vplDefaultReinhardDef(void)
{
    return (vplReinhardDef){.key = 0.18f, .delta = 1e-6f, .cookie = VPL_REINHARD_COOKIE};
}

static vplResult checkReinhard(const vplContext* context, const vplReinhardDef* def)
{
    if (def->cookie != VPL_REINHARD_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplReinhardDef was not made by vplDefaultReinhardDef");
    }
    if (!(def->key > 0 && def->key <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplReinhardDef.key is %g, must be in (0, 1]",
                       (double)def->key);
    }
    if (!(def->delta >= 0 && def->delta <= 1)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplReinhardDef.delta is %g, must be in [0, 1]",
                       (double)def->delta);
    }
    if (!(def->white >= 0)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplReinhardDef.white is %g, must not be negative",
                       (double)def->white);
    }
    return VPL_SUCCESS;
}

// Rows per parallel section. Sums over pixels are taken after it, in the order of the pixels.
enum { BAND = 64 };

typedef struct Row {
    double largest;
    int counted;
} Row;

typedef struct Reinhard {
    vplImage* image;
    double delta, scale, white;
    bool skipBlack;
    int firstRow;
    double* logs; // of a band's pixels; 0 for those that do not count
    Row rows[BAND];
} Reinhard;

static void findLogs(void* data, int row, int worker)
{
    (void)worker;
    Reinhard* r = data;
    const int width = r->image->width;
    const float* pixels = r->image->pixels + 3 * (size_t)(r->firstRow + row) * (size_t)width;
    double* logs = r->logs + (size_t)row * (size_t)width;
    Row found = {0, 0};
    for (int x = 0; x < width; x++) {
        const double y = vplLuminance(pixels + 3 * (size_t)x);
        const bool counts = isfinite(y) && y + (r->skipBlack ? 0 : r->delta) > 0;
        logs[x] = counts ? vplLn(y + r->delta) : 0;
        found.counted += counts;
        found.largest = counts && y > found.largest ? y : found.largest;
    }
    r->rows[row] = found;
}

static void mapRow(void* data, int row, int worker)
{
    (void)worker;
    const Reinhard* r = data;
    const int width = r->image->width;
    for (int x = 0; x < width; x++) {
        float* pixel = r->image->pixels + 3 * ((size_t)row * (size_t)width + (size_t)x);
        const double y = vplLuminance(pixel);
        if (!(y > 0 && isfinite(y))) {
            pixel[0] = pixel[1] = pixel[2] = 0;
            continue;
        }
        const double l = r->scale * y;
        // Divides twice by `white` and once by 1 + l: squares of large values would overflow.
        const double mapped = l / (1 + l) * (1 + l / r->white / r->white);
        for (int c = 0; c < 3; c++) {
            pixel[c] = (float)(pixel[c] * (mapped / y));
        }
    }
}

typedef struct Sums {
    double log, largest;
    size_t counted;
} Sums;

static void sumBand(Reinhard* r, Sums* sums)
{
    const vplImage* image = r->image;
    const int rows = image->height - r->firstRow < BAND ? image->height - r->firstRow : BAND;
    vplParallelFor(image->context, rows, findLogs, r);
    for (int row = 0; row < rows; row++) {
        sums->largest = r->rows[row].largest > sums->largest ? r->rows[row].largest : sums->largest;
        sums->counted += (size_t)r->rows[row].counted;
    }
    for (size_t i = 0; i < (size_t)rows * (size_t)image->width; i++) {
        sums->log += r->logs[i];
    }
}

vplResult vplToneMap_Reinhard(vplImage* image, const vplReinhardDef* def)
{
    REQUIRE(CONTEXT_OF(image), image);
    const vplReinhardDef settings = def ? *def : vplDefaultReinhardDef();
    TRY(checkReinhard(image->context, &settings));
    Reinhard r = {.image = image, .delta = settings.delta, .skipBlack = settings.skipBlack};
    r.logs = vplAlloc(image->context, (size_t)BAND * (size_t)image->width, sizeof *r.logs);
    if (r.logs == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    Sums sums = {0, 0, 0};
    for (; r.firstRow < image->height; r.firstRow += BAND) {
        sumBand(&r, &sums);
    }
    vplFree(image->context, r.logs);
    if (sums.counted > 0 && sums.largest > 0) { // a black picture stays black
        r.scale = settings.key / vplExp(sums.log / (double)sums.counted);
        r.white = settings.white > 0 ? settings.white : r.scale * sums.largest;
        vplParallelFor(image->context, image->height, mapRow, &r);
    }
    return VPL_SUCCESS;
}
