// SPDX-License-Identifier: MIT
// Tone maps that take exposed values to a screen's, pixel by pixel.
// Based on: Stephen Hill's fit of ACES, and Troy Sobotka's AgX; see vpl/image.h.
// Departs: AgX's curve is evaluated at points that straight lines connect.
#include "base/context.h"
#include "image/tone.h"
#include "math/scalar.h"

#include <float.h>
#include <string.h>

// Returns M * (r, g, b).
static void transform(const double m[3][3], const double in[3], double out[3])
{
    for (int i = 0; i < 3; i++) {
        out[i] = m[i][0] * in[0] + m[i][1] * in[1] + m[i][2] * in[2];
    }
}

// Clamps a pixel's values to [0, high]; NaN gives 0.
static void load(const float* pixel, double high, double out[3])
{
    for (int c = 0; c < 3; c++) {
        const double x = (double)pixel[c];
        out[c] = x > 0 ? (x < high ? x : high) : 0;
    }
}

// ---- ACES

static const double ACES_IN[3][3] = {
    {0.59719, 0.35458, 0.04823}, {0.07600, 0.90834, 0.01566}, {0.02840, 0.13383, 0.83777}};
static const double ACES_OUT[3][3] = {
    {1.60475, -0.53108, -0.07367}, {-0.10208, 1.10813, -0.00605}, {-0.00327, -0.07276, 1.07602}};
static const double ACES_EXPOSURE = 0.6; // is divided by

static void mapAcesRow(void* data, int row, int worker)
{
    (void)worker;
    const vplImage* image = data;
    float* pixel = image->pixels + 3 * (size_t)row * (size_t)image->width;
    for (int x = 0; x < image->width; x++, pixel += 3) {
        double in[3], v[3], out[3];
        load(pixel, (double)FLT_MAX, in);
        transform(ACES_IN, in, v);
        for (int c = 0; c < 3; c++) {
            const double l = v[c] / ACES_EXPOSURE;
            v[c] = (l * (l + 0.0245786) - 0.000090537) / (l * (0.983729 * l + 0.4329510) + 0.238081);
        }
        transform(ACES_OUT, v, out);
        for (int c = 0; c < 3; c++) {
            pixel[c] = vplClampf((float)out[c], 0, 1);
        }
    }
}

void vplToneMap_Aces(vplImage* image)
{
    if (image == NULL) {
        return;
    }
    vplParallelFor(image->context, image->height, mapAcesRow, image);
}

// ---- AgX

static const double AGX_IN[3][3] = {{0.842479062253094, 0.0784335999999992, 0.0792237451477643},
                                    {0.0423282422610123, 0.878468636469772, 0.0791661274605434},
                                    {0.0423756549057051, 0.0784336, 0.879142973793104}};
static const double AGX_OUT[3][3] = {{1.19687900512017, -0.0980208811401368, -0.0990297440797205},
                                     {-0.0528968517574562, 1.15190312990417, -0.0989611768448433},
                                     {-0.0529716355144438, -0.0980434501171241, 1.15107367264116}};

// The table of AgX's curve has 128 points per octave, the floats with the same upper 16 bits between two.
// That of the decoding has points at equal distances. Both are within 1e-5 of the functions.
enum {
    SLOT_SHIFT = 16,
    FIRST_SLOT = (127 - 13) << (23 - SLOT_SHIFT), // 2^-13
    SLOTS = 18 << (23 - SLOT_SHIFT),              // up to 2^5
    DECODED = 1024
};

typedef struct Agx {
    vplImage* image;
    float curve[SLOTS + 1], decoded[DECODED + 1];
} Agx;

// AgX's contrast curve between (0, 0) and (1, 1): a sigmoid on each side of the pivot, where middle grey
// becomes 0.5 with slope 2.
static double contrast(double x)
{
    const double pivot = 10 / 16.5;
    const bool toe = x < pivot;
    const double power = toe ? 3 : 3.25, side = toe ? pivot : 1 - pivot;
    const double bend = (vplPow(4 * side, power) - 1) / vplPow(side, power); // through the corner
    const double t = toe ? pivot - x : x - pivot;
    const double rise = 2 * t / vplPow(1 + bend * vplPow(t, power), 1 / power);
    return toe ? 0.5 - rise : 0.5 + rise;
}

// AgX's code of a linear value: 10 stops below middle grey to 6.5 above.
static double agxCode(double linear)
{
    const double stops = vplLn(linear / 0.18) / vplLn(2);
    return stops <= -10 ? 0 : stops >= 6.5 ? 1 : contrast((stops + 10) / 16.5);
}

static void fillTables(Agx* agx)
{
    for (uint32_t slot = 0; slot <= SLOTS; slot++) {
        const uint32_t bits = (FIRST_SLOT + slot) << SLOT_SHIFT;
        float linear;
        memcpy(&linear, &bits, sizeof linear);
        agx->curve[slot] = (float)agxCode((double)linear);
    }
    for (int i = 0; i <= DECODED; i++) {
        agx->decoded[i] = vplSrgb_Decode((float)i / DECODED);
    }
}

// Interpolates; `t` is in [0, 1).
static double between(const float* point, double t)
{
    return (double)point[0] + t * ((double)point[1] - (double)point[0]);
}

static double lookUpCurve(const Agx* agx, double linear)
{
    float x = (float)linear;
    x = vplClampf(x, 0x1p-13f, 32 - 0x1p-19f);
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    const double t = (bits & ((1u << SLOT_SHIFT) - 1)) * (1.0 / (1 << SLOT_SHIFT));
    return between(agx->curve + ((bits >> SLOT_SHIFT) - FIRST_SLOT), t);
}

static double lookUpDecoded(const Agx* agx, double code)
{
    const double x = code > 0 ? code * DECODED : 0;
    const int i = x < DECODED ? (int)x : DECODED - 1;
    return between(agx->decoded + i, x < DECODED ? x - i : 1);
}

static void mapAgxRow(void* data, int row, int worker)
{
    (void)worker;
    const Agx* agx = data;
    const int width = agx->image->width;
    float* pixel = agx->image->pixels + 3 * (size_t)row * (size_t)width;
    for (int x = 0; x < width; x++, pixel += 3) {
        double in[3], v[3], code[3];
        load(pixel, 0x1p100, in);
        transform(AGX_IN, in, v);
        for (int c = 0; c < 3; c++) {
            v[c] = lookUpCurve(agx, v[c]);
        }
        transform(AGX_OUT, v, code);
        for (int c = 0; c < 3; c++) {
            pixel[c] = (float)lookUpDecoded(agx, code[c]);
        }
    }
}

void vplToneMap_Agx(vplImage* image)
{
    if (image == NULL) {
        return;
    }
    Agx agx = {.image = image};
    fillTables(&agx);
    vplParallelFor(image->context, image->height, mapAgxRow, &agx);
}
