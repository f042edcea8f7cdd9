// SPDX-License-Identifier: MIT
// Pictures of linear floats: storage, files, tone mapping and comparison.
#ifndef VPL_IMAGE_H
#define VPL_IMAGE_H

#include <vpl/vecmath.h>

VPL_HEADER_BEGIN

// A picture of linear RGB. Row 0 is the top; pixel (x, y) starts at pixels[3 * (y * width + x)].
typedef struct vplImage {
    int width, height;   // pixels, [1, VPL_MAX_IMAGE_SIZE]
    float* pixels;       // 3 * width * height floats; radiance in W/(m^2 sr) unless said otherwise
    vplContext* context; // owner of the memory
} vplImage;

// Creates a black picture. VPL_INVALID_ARGUMENT for a size out of range, VPL_OUT_OF_MEMORY.
vplResult vplImage_Create(vplContext* context, int width, int height, vplImage** imageOut);

// NULL is allowed.
void vplImage_Destroy(vplImage* image);

typedef enum vplToneMap {
    VPL_TONEMAP_NONE = 0, // clamp to [0, 1]
    VPL_TONEMAP_REINHARD, // vplToneMap_Reinhard with its defaults, except skipBlack = true
    VPL_TONEMAP_ACES,     // vplToneMap_Aces
    VPL_TONEMAP_AGX       // vplToneMap_Agx
} vplToneMap;

// A vplWriteOptions.exposure: the one that vplImage_AutoExposure finds.
#define VPL_EXPOSURE_AUTO 1000.0f

typedef struct vplWriteOptions {
    // PNG only: stops; pixels are multiplied by 2^exposure before the tone map; [-64, 64] or
    // VPL_EXPOSURE_AUTO; default 0. VPL_TONEMAP_REINHARD scales by its own key, so the exposure cancels
    // there, and VPL_EXPOSURE_AUTO is 0.
    float exposure;
    // PNG only; default VPL_TONEMAP_NONE.
    vplToneMap tonemap;
    uint32_t cookie; // set by vplDefaultWriteOptions
} vplWriteOptions;

vplWriteOptions vplDefaultWriteOptions(void);

// How pixels lie in memory. Alpha is 1: pictures are opaque.
typedef enum vplPixelFormat {
    VPL_PIXELS_RGB_FLOAT = 0, // linear, as in vplImage
    VPL_PIXELS_RGBA_FLOAT,
    VPL_PIXELS_RGB_SRGB8, // a byte each, after exposure and tone map, as in a PNG
    VPL_PIXELS_RGBA_SRGB8,
    VPL_PIXELS_NUMBER_FLOAT // the red channel alone, for layers of numbers such as depth
} vplPixelFormat;

// Memory of the caller that receives a picture. Only the bytes of pixels are written, not those between them.
typedef struct vplPixelsDef {
    void* first;           // of the top left pixel
    vplPixelFormat format; // default VPL_PIXELS_RGB_FLOAT
    ptrdiff_t
        pixelStride; // bytes from a pixel to its right neighbour, at least its size; 0 (default): its size
    ptrdiff_t rowStride; // bytes from a row to the one below; negative where rows go up; 0 (default): no gap
    float exposure;      // of bytes, as vplWriteOptions.exposure; default 0
    vplToneMap tonemap;  // of bytes; default VPL_TONEMAP_NONE
    uint32_t cookie;     // set by vplDefaultPixelsDef
} vplPixelsDef;

vplPixelsDef vplDefaultPixelsDef(void);

// Copies a picture into the caller's memory. VPL_INVALID_ARGUMENT for a def out of range, VPL_OUT_OF_MEMORY.
vplResult vplImage_CopyTo(const vplImage* image, const vplPixelsDef* pixels);

// Writes a file whose format its extension chooses: .png is 8-bit sRGB after exposure and tone map; .hdr
// (RGBE), .pfm and .exr are linear. The file appears whole or not at all. `options` NULL means defaults.
// VPL_INVALID_ARGUMENT for an unknown extension, for options out of range, or for a pixel that is NaN or
// infinite, which the message names; VPL_LIMIT for a PNG of more than 2^30 bytes; VPL_FILE_ERROR;
// VPL_OUT_OF_MEMORY.
vplResult vplImage_Write(const vplImage* image, const char* path, const vplWriteOptions* options);

// Reads .png, .jpg, .bmp and .tga (sRGB, decoded to linear), .hdr, .pfm and, where OpenEXR is built in, .exr.
// VPL_INVALID_ARGUMENT for another extension, VPL_FILE_ERROR, VPL_PARSE_ERROR, VPL_OUT_OF_MEMORY.
vplResult vplImage_Read(vplContext* context, const char* path, vplImage** imageOut);

// The difference between picture A and reference B. Sums run over all pixels and channels in row order, in
// double.
typedef struct vplComparison {
    // Root of the mean of (a - b)^2, in the pictures' unit, and this divided by the mean of B.
    double rmse, relativeRmse;
    // Mean of (a - b)^2 / (b + 0.01)^2, and this without the 0.1 % of the pixels where it is largest, which
    // removes a few fireflies (n pixels: without floor(n / 1000)).
    double relmse, trimmedRelmse;
    // 10 log10(1 / mse) of values clamped to [0, 1] and sRGB-encoded, in dB; infinite if equal.
    double psnr;
    // Sum of A / sum of B; 1 if both are black.
    double energyRatio;
    // Largest |a - b|, and its pixel.
    double maxDifference;
    int maxX, maxY;
} vplComparison;

// Compares two pictures. This and the comparisons of imagetools.h fail with VPL_INVALID_ARGUMENT if the pictures
// differ in size or have a pixel that is NaN or infinite, and with VPL_OUT_OF_MEMORY.
vplResult vplImage_Compare(const vplImage* a, const vplImage* b, vplComparison* comparisonOut);

VPL_HEADER_END

#endif
