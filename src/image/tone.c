// SPDX-License-Identifier: MIT
// Based on: IEC 61966-2-1 (sRGB); Reinhard, Stark, Shirley and Ferwerda, Photographic Tone Reproduction for
// Digital Images, SIGGRAPH 2002. Departs: the paper prints the log average with 1/N outside the exponential;
// the geometric mean is meant, or a flat picture would not map to the key.
#include "base/context.h"
#include "image/image_file.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <math.h>

static double encode(double linear)
{
    if (!(linear > 0)) {
        return 0;
    }
    if (linear >= 1) {
        return 1;
    }
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * vplPow(linear, 1 / 2.4) - 0.055;
}

static double decode(double encoded)
{
    return encoded <= 0.04045 ? encoded / 12.92 : vplPow((encoded + 0.055) / 1.055, 2.4);
}

float vplSrgb_Encode(float linear)
{
    return (float)encode(linear);
}

float vplSrgb_Decode(float encoded)
{
    return (float)decode(vplClampf(encoded, 0, 1));
}

uint8_t vplSrgb_Code(float linear)
{
    return (uint8_t)(255 * encode(linear) + 0.5);
}

vplReinhardDef vplDefaultReinhardDef(void)
{
    return (vplReinhardDef){0.18f, 1e-6f, 0, VPL_REINHARD_COOKIE};
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

static double luminance(const float* pixel)
{
    return 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
}

vplResult vplToneMap_Reinhard(vplImage* image, const vplReinhardDef* def)
{
    vplReinhardDef settings = def ? *def : vplDefaultReinhardDef();
    vplResult result = checkReinhard(image->context, &settings);
    if (result != VPL_SUCCESS) {
        return result;
    }
    size_t count = (size_t)image->width * (size_t)image->height;
    double logSum = 0, largest = 0;
    size_t counted = 0;
    for (size_t i = 0; i < count; i++) {
        double y = luminance(image->pixels + 3 * i);
        if (isfinite(y) && y + settings.delta > 0) {
            logSum += vplLog1(y + settings.delta);
            largest = y > largest ? y : largest;
            counted++;
        }
    }
    if (counted == 0 || largest == 0) {
        return VPL_SUCCESS; // black stays black
    }
    double scale = settings.key / vplExp(logSum / (double)counted);
    double white = settings.white > 0 ? settings.white : scale * largest;
    for (size_t i = 0; i < count; i++) {
        float* pixel = image->pixels + 3 * i;
        double y = luminance(pixel);
        if (!(y > 0 && isfinite(y))) {
            pixel[0] = pixel[1] = pixel[2] = 0;
            continue;
        }
        double l = scale * y;
        // Each factor divided by 1 + l on its own: l can be 1e30, and its square beyond double after more.
        double mapped = l / (1 + l) * (1 + l / white / white);
        for (int c = 0; c < 3; c++) {
            pixel[c] = (float)(pixel[c] * (mapped / y));
        }
    }
    return VPL_SUCCESS;
}
