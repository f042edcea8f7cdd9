// SPDX-License-Identifier: MIT
// Linear float pictures: storage, files, tone mapping and comparison.
#ifndef VPL_IMAGE_H
#define VPL_IMAGE_H

#include <vpl/vecmath.h>

#ifdef __cplusplus
extern "C" {
#endif

// A picture of linear RGB. Row 0 is the top; pixel (x, y) starts at pixels[3 * (y * width + x)].
typedef struct vplImage {
    int width, height;   // pixels, [1, VPL_MAX_IMAGE_SIZE]
    float* pixels;       // 3 * width * height floats; radiance in W/(m^2 sr) unless said otherwise
    vplContext* context; // owner of the memory
} vplImage;

// Makes a black picture. Destroy with vplImage_Destroy.
vplResult vplImage_Create(vplContext* context, int width, int height, vplImage** imageOut);

// NULL is allowed.
void vplImage_Destroy(vplImage* image);

// 64-bit hash of size and float bits: equal hashes mean equal bits. The same on every machine.
uint64_t vplImage_Hash(const vplImage* image);

typedef enum vplToneMap {
    VPL_TONEMAP_NONE = 0, // clamp to [0, 1]
    VPL_TONEMAP_REINHARD  // vplToneMap_Reinhard with its defaults but skipBlack
} vplToneMap;

typedef struct vplWriteOptions {
    float exposure;     // stops: pixels are multiplied by 2^exposure first; [-64, 64], default 0; PNG only
    vplToneMap tonemap; // default VPL_TONEMAP_NONE; PNG only
    uint32_t cookie;    // set by vplDefaultWriteOptions
} vplWriteOptions;

vplWriteOptions vplDefaultWriteOptions(void);

// True if pictures can be written to a file of this name: it ends in .png, .hdr, .pfm, or in .exr where
// OpenEXR is built in.
bool vplImage_CanWrite(const char* path);

// The extensions that can be written, for messages: ".png, .hdr, .pfm or .exr" where OpenEXR is built in.
const char* vplImage_GetExtensions(void);

// Writes by extension: .png is 8-bit sRGB after exposure and tone map; .hdr (RGBE), .pfm and .exr are linear
// and untouched. The file appears whole or not at all. A picture with a NaN or infinity is refused, naming
// the first such pixel. `options` NULL means defaults.
vplResult vplImage_Write(const vplImage* image, const char* path, const vplWriteOptions* options);

// The bytes of the .png file that vplImage_Write would write, for pages and sockets; free with vplPng_Free.
vplResult vplImage_EncodePng(const vplImage* image, const vplWriteOptions* options, uint8_t** bytesOut,
                             size_t* sizeOut);

// Frees what vplImage_EncodePng gave. NULL is allowed.
void vplPng_Free(vplContext* context, uint8_t* bytes);

// Reads .png, .jpg, .bmp, .tga (sRGB, decoded to linear), .hdr, .pfm and, where built in, .exr.
vplResult vplImage_Read(vplContext* context, const char* path, vplImage** imageOut);

typedef struct vplReinhardDef {
    float key;      // middle grey the geometric mean maps to, (0, 1], default 0.18
    float delta;    // added before the logarithm, [0, 1], default 1e-6: keeps black pixels finite
    float white;    // smallest scaled luminance that maps to 1, > 0; 0 (default): the picture's largest;
                    // INFINITY: the plain L/(1+L)
    bool skipBlack; // pixels of no light do not count in the mean: a black background, or rooms that no light
        // gets to, do not blow out the rest; default false, as published; pictures are written with true
    uint32_t cookie; // set by vplDefaultReinhardDef
} vplReinhardDef;

vplReinhardDef vplDefaultReinhardDef(void);

// Maps luminance L = key/mean * Y to L(1 + L/white^2)/(1 + L), keeping chromaticity. The mean is geometric;
// pixels that are not finite do not count. A black picture stays black.
// Source: Reinhard, Stark, Shirley and Ferwerda, Photographic Tone Reproduction for Digital Images, SIGGRAPH
// 2002, equations 1, 2 and 4.
vplResult vplToneMap_Reinhard(vplImage* image, const vplReinhardDef* def);

// Linear value to sRGB (IEC 61966-2-1), clamped to [0, 1] first; NaN gives 0.
float vplSrgb_Encode(float linear);

// sRGB value in [0, 1] to linear.
float vplSrgb_Decode(float encoded);

// Linear value to the nearest of 256 sRGB codes.
uint8_t vplSrgb_Code(float linear);

// Copies a rectangle, which must lie inside the picture.
vplResult vplImage_Crop(const vplImage* image, int x, int y, int width, int height, vplImage** imageOut);

// How far picture A is from reference B. Sums run over all pixels and channels in row order, in double.
typedef struct vplComparison {
    double rmse;          // root of the mean of (a - b)^2, in the pictures' unit
    double relativeRmse;  // rmse / mean of B
    double relmse;        // mean of (a - b)^2 / (b + 0.01)^2
    double trimmedRelmse; // the same without the 0.1 % of the pixels where it is largest (n pixels: without
                          // floor(n / 1000)): what remains when a few fireflies are not counted
    double psnr; // 10 log10(1 / mse) of values clamped to [0, 1] and sRGB-encoded, dB; infinite if equal
    double energyRatio;   // sum of A / sum of B; 1 if both are black
    double maxDifference; // largest |a - b|
    int maxX, maxY;       // where
} vplComparison;

// Compares two pictures of one size. Here and below, a picture with a NaN or infinity is refused.
vplResult vplImage_Compare(const vplImage* a, const vplImage* b, vplComparison* comparisonOut);

// Structural similarity of values clamped to [0, 1] and sRGB-encoded: 1 where equal, around 0 where unrelated,
// at least -1; the mean of the three channels. Window: Gaussian of 11 x 11 pixels, sigma 1.5; K1 = 0.01,
// K2 = 0.03; variances are those of a population. The mean leaves out the 5 pixels along each border where the
// window would stick out; along a side shorter than 11 pixels all count, and borders are mirrored. The map
// (NULL: not wanted) has its pixel's value in each channel, borders included. Agrees with scikit-image's
// structural_similarity(gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1).
// Source: Wang, Bovik, Sheikh and Simoncelli, IEEE Transactions on Image Processing 13(4), 2004.
vplResult vplImage_Ssim(const vplImage* a, const vplImage* b, double* meanOut, vplImage** mapOut);

// Pixels per degree of vision that FLIP can be asked for, and the paper's: a screen of 3840 pixels and 0.7 m
// width seen from 0.7 m, 3840 pi / 180.
#define VPL_MIN_PPD     1
#define VPL_MAX_PPD     1000
#define VPL_DEFAULT_PPD 67.0206432765823

// FLIP of values clamped to [0, 1] (pictures of low dynamic range): the difference that a viewer sees who
// flips between them, from 0 (none) to 1. `ppd` is in [VPL_MIN_PPD, VPL_MAX_PPD]. The map (NULL: not wanted)
// has its pixel's value in each channel.
// Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild, FLIP: A Difference Evaluator
// for Alternating Images, High Performance Graphics 2020.
vplResult vplImage_Flip(const vplImage* a, const vplImage* b, double ppd, double* meanOut, vplImage** mapOut);

// One block of pixels, and how A differs from B there.
typedef struct vplRegion {
    int x, y, width, height; // pixels
    double meanA, meanB;     // over pixels and channels
    double ratio;            // meanA / meanB; 1 if equal, infinite where only B is black
    double rmse;             // as in vplComparison
} vplRegion;

// Compares in a grid of columns * rows blocks, which differ in size by one pixel at most. regionsOut has room
// for columns * rows regions: rows from the top, each from the left. columns is in [1, width], rows in
// [1, height].
vplResult vplImage_CompareRegions(const vplImage* a, const vplImage* b, int columns, int rows,
                                  vplRegion* regionsOut);

typedef enum vplHeat {
    VPL_HEAT_DIFFERENCE = 0, // mean of |a - b| over the channels
    VPL_HEAT_RELATIVE,       // mean of |a - b| / |b + 0.01| over the channels
    VPL_HEAT_SSIM,           // 1 - SSIM
    VPL_HEAT_FLIP            // FLIP, in the colours of its paper (magma)
} vplHeat;

typedef struct vplHeatmapDef {
    vplHeat of;      // default VPL_HEAT_DIFFERENCE
    float scale;     // value at the bright end; 0 (default): the largest, and 1 for SSIM and FLIP
    double ppd;      // of FLIP, default VPL_DEFAULT_PPD
    uint32_t cookie; // set by vplDefaultHeatmapDef
} vplHeatmapDef;

vplHeatmapDef vplDefaultHeatmapDef(void);

// False colours from black, for 0, to the bright end, with a numbered bar below where the picture is at least
// 160 pixels wide. Meant for 8-bit files without tone map. `def` NULL means defaults.
vplResult vplImage_HeatmapOf(const vplImage* a, const vplImage* b, const vplHeatmapDef* def,
                             vplImage** imageOut);

// Heat map of the difference: black is 0, white is `scale` and more (0: the largest difference).
vplResult vplImage_Heatmap(const vplImage* a, const vplImage* b, float scale, vplImage** imageOut);

#ifdef __cplusplus
}
#endif

#endif
