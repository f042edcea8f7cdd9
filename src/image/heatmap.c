// SPDX-License-Identifier: MIT
// False-colour maps of the difference between two pictures.
#include "base/arena.h"
#include "image/draw.h"
#include "image/image_file.h"
#include "image/metrics.h"
#include "math/scalar.h"

#include <math.h>

vplHeatmapDef vplDefaultHeatmapDef(void)
{
    return (vplHeatmapDef){VPL_HEAT_DIFFERENCE, 0, VPL_DEFAULT_PPD, VPL_HEATMAP_COOKIE};
}

static vplResult checkDef(const vplContext* context, const vplHeatmapDef* def)
{
    if (def->cookie != VPL_HEATMAP_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplHeatmapDef was not made by vplDefaultHeatmapDef");
    }
    if ((int)def->of < VPL_HEAT_DIFFERENCE || (int)def->of > VPL_HEAT_FLIP) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplHeatmapDef.of is %d, must be in [0, %d]",
                       (int)def->of, VPL_HEAT_FLIP);
    }
    if (!(def->scale >= 0 && isfinite(def->scale))) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "heat map scale is %g, must be finite and not negative",
                       (double)def->scale);
    }
    return VPL_SUCCESS;
}

// The mean of |a - b| over the channels, each divided by |b + 0.01| if `relative`.
static float differenceAt(const float* a, const float* b, bool relative)
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double d = fabs((double)a[c] - b[c]);
        sum += relative ? d / fabs(b[c] + 0.01) : d;
    }
    return (float)fmin(sum / 3, 3e38);
}

// Computes the values to be shown, the same in all channels.
static vplResult measureHeat(const vplImage* a, const vplImage* b, const vplHeatmapDef* def,
                             vplImage** mapOut)
{
    double mean;
    if (def->of == VPL_HEAT_FLIP) {
        return vplImage_Flip(a, b, def->ppd, &mean, mapOut);
    }
    const size_t count = (size_t)a->width * (size_t)a->height;
    if (def->of == VPL_HEAT_SSIM) {
        TRY(vplImage_Ssim(a, b, &mean, mapOut));
        for (size_t i = 0; i < 3 * count; i++) {
            (*mapOut)->pixels[i] = 1 - (*mapOut)->pixels[i];
        }
        return VPL_SUCCESS;
    }
    TRY(vplImage_Create(a->context, a->width, a->height, mapOut));
    for (size_t i = 0; i < 3 * count; i += 3) {
        float* p = (*mapOut)->pixels + i;
        p[0] = p[1] = p[2] = differenceAt(a->pixels + i, b->pixels + i, def->of == VPL_HEAT_RELATIVE);
    }
    return VPL_SUCCESS;
}

static float scaleOf(const vplImage* map, const vplHeatmapDef* def)
{
    if (def->scale > 0 || def->of == VPL_HEAT_SSIM || def->of == VPL_HEAT_FLIP) {
        return def->scale > 0 ? def->scale : 1;
    }
    float largest = 0;
    for (size_t i = 0; i < (size_t)map->width * (size_t)map->height; i++) {
        largest = vplMaxf(largest, map->pixels[3 * i]);
    }
    return largest;
}

static vplResult colour(const vplImage* map, float scale, vplColourFcn* colours, vplImage** imageOut)
{
    const int barHeight = vplColourBar_GetHeight(map->width);
    vplImage* image;
    TRY(vplImage_Create(map->context, map->width, map->height + barHeight, &image));
    for (size_t i = 0; i < (size_t)map->width * (size_t)map->height; i++) {
        vplRgb c = colours(scale > 0 ? map->pixels[3 * i] / scale : 0);
        image->pixels[3 * i] = c.r;
        image->pixels[3 * i + 1] = c.g;
        image->pixels[3 * i + 2] = c.b;
    }
    if (barHeight > 0) {
        vplColourBar_Draw(image, map->height, scale, colours);
    }
    *imageOut = image;
    return VPL_SUCCESS;
}

vplResult vplImage_HeatmapOf(const vplImage* a, const vplImage* b, const vplHeatmapDef* def,
                             vplImage** imageOut)
{
    REQUIRE(CONTEXT_OF(a) ?: CONTEXT_OF(b), a, b, imageOut);
    const vplHeatmapDef settings = def ? *def : vplDefaultHeatmapDef();
    vplImage* map;
    TRY(checkDef(a->context, &settings));
    TRY(vplRequirePair(a, b));
    TRY(measureHeat(a, b, &settings, &map));
    const vplResult result = colour(map, scaleOf(map, &settings),
                                    settings.of == VPL_HEAT_FLIP ? vplMagma : vplFalseColour, imageOut);
    vplImage_Destroy(map);
    return result;
}

vplResult vplImage_Heatmap(const vplImage* a, const vplImage* b, float scale, vplImage** imageOut)
{
    REQUIRE(CONTEXT_OF(a) ?: CONTEXT_OF(b), a, b, imageOut);
    vplHeatmapDef def = vplDefaultHeatmapDef();
    def.scale = scale;
    return vplImage_HeatmapOf(a, b, &def, imageOut);
}
