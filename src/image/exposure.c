// SPDX-License-Identifier: MIT
// Based on: Reinhard, Stark, Shirley and Ferwerda, Photographic Tone Reproduction for Digital Images,
// SIGGRAPH 2002 (the geometric mean of the luminance becomes middle grey).
// Departs: the mean leaves out black pixels, the darkest and the brightest, as histograms of games do:
// Krzysztof Narkowicz, Automatic Exposure, 2016.
#include "base/arena.h"
#include "image/tone.h"
#include "math/scalar.h"

#include <float.h>
#include <string.h>

// A bin has the floats with the same upper 16 bits: 128 bins per octave. Counts are whole numbers, so their
// sums have no rounding.
enum { BIN_SHIFT = 16, BINS_PER_OCTAVE = 1 << (23 - BIN_SHIFT), BINS = 255 * BINS_PER_OCTAVE };

// Shares of the lit pixels: DARKEST and BRIGHTEST are left out of the mean. Pixels darker than the brightest
// that are kept by DARK_OCTAVES or more stay black at any exposure, and do not count. The exposure is lowered
// by up to GUARD stops until no more than HIGHLIGHTS exceed MOST_BRIGHT, one stop below the white of AgX.
enum { DARK_OCTAVES = 10 };
static const double MIDDLE_GREY = 0.18, DARKEST = 0.10, BRIGHTEST = 0.05, HIGHLIGHTS = 0.02, MOST_BRIGHT = 8,
                    GUARD = 2;

static size_t countLuminances(const vplImage* image, uint32_t* bins)
{
    size_t lit = 0;
    const size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++) {
        const double y = vplLuminance(image->pixels + 3 * i);
        if (y > 0 && y <= (double)FLT_MAX) {
            const float rounded = (float)y;
            uint32_t bits;
            memcpy(&bits, &rounded, sizeof bits);
            bins[bits >> BIN_SHIFT]++;
            lit++;
        }
    }
    return lit;
}

// The logarithm of a bin's middle.
static double logOfBin(int bin)
{
    const uint32_t bits = ((uint32_t)bin << BIN_SHIFT) + (1u << (BIN_SHIFT - 1));
    float middle;
    memcpy(&middle, &bits, sizeof middle);
    return vplLn((double)middle);
}

// The bin below which `count` pixels are.
static int binOf(const uint32_t* bins, double count)
{
    int bin = 0;
    for (double below = bins[0]; below < count && bin < BINS - 1; bin++) {
        below += bins[bin + 1];
    }
    return bin;
}

// The mean logarithm from a bin on, of the pixels that are neither among the darkest nor among the brightest.
// A bin across one of the two limits counts in part.
static double meanLog(const uint32_t* bins, int first, double lit)
{
    const double high = lit - BRIGHTEST * lit;
    double dark = 0, sum = 0;
    for (int bin = 0; bin < first; bin++) {
        dark += bins[bin];
    }
    const double low = dark + DARKEST * (lit - dark);
    double below = dark;
    for (int bin = first; bin < BINS && below < high; bin++) {
        const double above = below + bins[bin];
        const double from = below > low ? below : low, to = above < high ? above : high;
        sum += to > from ? (to - from) * logOfBin(bin) : 0;
        below = above;
    }
    return sum / (high - low);
}

vplResult vplImage_AutoExposure(const vplImage* image, float* stopsOut)
{
    REQUIRE(CONTEXT_OF(image), image, stopsOut);
    uint32_t* bins = vplAllocZero(image->context, BINS, sizeof *bins);
    if (bins == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const double lit = (double)countLuminances(image, bins);
    double stops = 0;
    if (lit > 0) {
        const int bright = binOf(bins, lit - BRIGHTEST * lit),
                  first = bright - DARK_OCTAVES * BINS_PER_OCTAVE;
        const double grey = (vplLn(MIDDLE_GREY) - meanLog(bins, first > 0 ? first : 0, lit)) / vplLn(2);
        const double most = (vplLn(MOST_BRIGHT) - logOfBin(binOf(bins, lit - HIGHLIGHTS * lit))) / vplLn(2);
        stops = grey < most ? grey : most > grey - GUARD ? most : grey - GUARD;
    }
    *stopsOut = vplClampf((float)stops, -64, 64);
    vplFree(image->context, bins);
    return VPL_SUCCESS;
}
