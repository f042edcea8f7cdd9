// SPDX-License-Identifier: MIT
// Pictures as other programs hold them: 8-bit codes after exposure and tone map, and the caller's memory.
#include "base/arena.h"
#include "image/image_file.h"
#include "image/srgb.h"
#include "math/scalar.h"

#include <string.h>

// Applies exposure and tone map to `display`, a copy of the picture.
static vplResult applyDisplay(const vplImage* image, const vplWriteOptions* options, vplImage* display)
{
    const size_t count = 3 * (size_t)image->width * (size_t)image->height;
    float exposure = options->exposure;
    if (exposure == VPL_EXPOSURE_AUTO) {
        exposure = 0;
        if (options->tonemap != VPL_TONEMAP_REINHARD) {
            TRY(vplImage_AutoExposure(image, &exposure));
        }
    }
    const float gain = (float)vplExp(exposure * 0.69314718055994530942);
    for (size_t i = 0; i < count; i++) {
        display->pixels[i] = exposure == 0 ? image->pixels[i] : gain * image->pixels[i];
    }
    vplReinhardDef def = vplDefaultReinhardDef();
    def.skipBlack = true;
    if (options->tonemap == VPL_TONEMAP_REINHARD) {
        return vplToneMap_Reinhard(display, &def);
    }
    if (options->tonemap == VPL_TONEMAP_ACES) {
        vplToneMap_Aces(display);
    } else if (options->tonemap == VPL_TONEMAP_AGX) {
        vplToneMap_Agx(display);
    }
    return VPL_SUCCESS;
}

vplResult vplMakeCodes(const vplImage* image, const vplWriteOptions* options, uint8_t** codesOut)
{
    const size_t count = 3 * (size_t)image->width * (size_t)image->height;
    vplImage* display;
    TRY(vplImage_Create(image->context, image->width, image->height, &display));
    vplResult result = applyDisplay(image, options, display);
    uint8_t* codes = result == VPL_SUCCESS ? vplAlloc(image->context, count, 1) : NULL;
    if (codes != NULL) {
        vplSrgbTable table;
        vplSrgbTable_Fill(&table);
        vplSrgbTable_Encode(&table, display->pixels, count, codes);
        *codesOut = codes;
    } else if (result == VPL_SUCCESS) {
        result = VPL_OUT_OF_MEMORY;
    }
    vplImage_Destroy(display);
    return result;
}

// ---- the caller's memory

static const struct {
    int channels;
    bool codes;
} FORMATS[] = {
    [VPL_PIXELS_RGB_FLOAT] = {3, false},    [VPL_PIXELS_RGBA_FLOAT] = {4, false},
    [VPL_PIXELS_RGB_SRGB8] = {3, true},     [VPL_PIXELS_RGBA_SRGB8] = {4, true},
    [VPL_PIXELS_NUMBER_FLOAT] = {1, false},
};

static bool isFormat(vplPixelFormat format)
{
    return (int)format >= 0 && format <= VPL_PIXELS_NUMBER_FLOAT;
}

// Bytes of one pixel.
static size_t sizeOf(vplPixelFormat format)
{
    return isFormat(format) ? (size_t)FORMATS[format].channels * (FORMATS[format].codes ? 1 : sizeof(float))
                            : 0;
}

vplPixelsDef vplDefaultPixelsDef(void)
{
    return (vplPixelsDef){.cookie = VPL_PIXELS_COOKIE};
}

static vplResult checkPixels(const vplImage* image, const vplPixelsDef* p, ptrdiff_t pixelStride,
                             ptrdiff_t rowStride)
{
    vplContext* context = image->context;
    const ptrdiff_t size = (ptrdiff_t)sizeOf(p->format);
    if (p->cookie != VPL_PIXELS_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPixelsDef was not made by vplDefaultPixelsDef");
    }
    if (!isFormat(p->format)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPixelsDef.format is %d, must be a vplPixelFormat",
                       (int)p->format);
    }
    if (p->first == NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPixelsDef.first is NULL");
    }
    if (pixelStride < size) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplPixelsDef.pixelStride is %td, must be 0 or at least %td", p->pixelStride, size);
    }
    if (rowStride / image->width < pixelStride && rowStride / image->width > -pixelStride) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplPixelsDef.rowStride is %td, rows of %d pixels would overlap", p->rowStride,
                       image->width);
    }
    return vplCheckDisplay(context, "vplPixelsDef", p->exposure, p->tonemap);
}

// Copies a row of floats or codes, whichever is not NULL.
static void copyRow(const float* values, const uint8_t* codes, int width, const vplPixelsDef* p,
                    ptrdiff_t stride, unsigned char* to)
{
    static const float one = 1;
    const int channels = FORMATS[p->format].channels;
    for (int x = 0; x < width; x++, to += stride) {
        for (int c = 0; c < channels; c++) {
            if (codes != NULL) {
                to[c] = c < 3 ? codes[3 * x + c] : 255;
            } else { // the caller's memory need not be aligned
                memcpy(to + (size_t)c * sizeof(float), c < 3 ? &values[3 * x + c] : &one, sizeof(float));
            }
        }
    }
}

vplResult vplImage_CopyTo(const vplImage* image, const vplPixelsDef* pixels)
{
    REQUIRE(CONTEXT_OF(image), image, pixels);
    const ptrdiff_t size = (ptrdiff_t)sizeOf(pixels->format);
    const ptrdiff_t pixelStride = pixels->pixelStride != 0 ? pixels->pixelStride : size;
    const ptrdiff_t rowStride = pixels->rowStride != 0 ? pixels->rowStride : pixelStride * image->width;
    TRY(checkPixels(image, pixels, pixelStride, rowStride));
    uint8_t* codes = NULL;
    if (FORMATS[pixels->format].codes) {
        TRY(vplImage_RequireFinite(image, "vplImage_CopyTo"));
        vplWriteOptions display = vplDefaultWriteOptions();
        display.exposure = pixels->exposure;
        display.tonemap = pixels->tonemap;
        TRY(vplMakeCodes(image, &display, &codes));
    }
    for (int y = 0; y < image->height; y++) {
        const size_t at = 3 * (size_t)image->width * (size_t)y;
        copyRow(image->pixels + at, codes != NULL ? codes + at : NULL, image->width, pixels, pixelStride,
                (unsigned char*)pixels->first + rowStride * y);
    }
    vplFree(image->context, codes);
    return VPL_SUCCESS;
}
