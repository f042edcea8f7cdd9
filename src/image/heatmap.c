// SPDX-License-Identifier: MIT
// Pictures of where two pictures differ.
#include "base/context.h"
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

// Mean of |a - b| over the channels, each divided by |b + 0.01| if it is relative.
static float differenceAt(const float* a, const float* b, bool relative)
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double d = fabs((double)a[c] - b[c]);
        sum += relative ? d / fabs(b[c] + 0.01) : d;
    }
    return (float)fmin(sum / 3, 3e38);
}

static vplResult measureDifference(const vplImage* a, const vplImage* b, bool relative, vplImage** mapOut)
{
    vplResult result = vplImage_Create(a->context, a->width, a->height, mapOut);
    for (int y = 0; result == VPL_SUCCESS && y < a->height; y++) {
        for (int x = 0; x < a->width; x++) {
            size_t at = 3 * ((size_t)y * (size_t)a->width + (size_t)x);
            vplSetGrey(*mapOut, x, y, differenceAt(a->pixels + at, b->pixels + at, relative));
        }
    }
    return result;
}

// The values to be shown, the same in all channels.
static vplResult measureHeat(const vplImage* a, const vplImage* b, const vplHeatmapDef* def,
                             vplImage** mapOut)
{
    double mean;
    if (def->of == VPL_HEAT_FLIP) {
        return vplImage_Flip(a, b, def->ppd, &mean, mapOut);
    }
    if (def->of != VPL_HEAT_SSIM) {
        return measureDifference(a, b, def->of == VPL_HEAT_RELATIVE, mapOut);
    }
    vplResult result = vplImage_Ssim(a, b, &mean, mapOut);
    size_t count = result == VPL_SUCCESS ? 3 * (size_t)a->width * (size_t)a->height : 0;
    for (size_t i = 0; i < count; i++) {
        (*mapOut)->pixels[i] = 1 - (*mapOut)->pixels[i];
    }
    return result;
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

static void colour(const vplImage* map, float scale, vplColourFcn* colours, vplImage* image)
{
    for (size_t i = 0; i < (size_t)map->width * (size_t)map->height; i++) {
        vplRgb c = colours(scale > 0 ? map->pixels[3 * i] / scale : 0);
        image->pixels[3 * i] = c.r;
        image->pixels[3 * i + 1] = c.g;
        image->pixels[3 * i + 2] = c.b;
    }
    vplColourBar_Draw(image, map->height, image->height - map->height, scale, colours);
}

vplResult vplImage_HeatmapOf(const vplImage* a, const vplImage* b, const vplHeatmapDef* def,
                             vplImage** imageOut)
{
    vplHeatmapDef settings = def ? *def : vplDefaultHeatmapDef();
    vplResult result = checkDef(a->context, &settings);
    if (result == VPL_SUCCESS) {
        result = vplRequirePair(a, b);
    }
    vplImage *map = NULL, *image;
    if (result == VPL_SUCCESS) {
        result = measureHeat(a, b, &settings, &map);
    }
    if (result == VPL_SUCCESS) {
        int barHeight = vplColourBar_GetHeight(a->width);
        result = vplImage_Create(a->context, a->width, a->height + barHeight, &image);
    }
    if (result == VPL_SUCCESS) {
        colour(map, scaleOf(map, &settings), settings.of == VPL_HEAT_FLIP ? vplMagma : vplFalseColour, image);
        *imageOut = image;
    }
    vplImage_Destroy(map);
    return result;
}

vplResult vplImage_Heatmap(const vplImage* a, const vplImage* b, float scale, vplImage** imageOut)
{
    vplHeatmapDef def = vplDefaultHeatmapDef();
    def.scale = scale;
    return vplImage_HeatmapOf(a, b, &def, imageOut);
}
