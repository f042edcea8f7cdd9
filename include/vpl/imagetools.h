// SPDX-License-Identifier: MIT
// Pictures from the inside: hashes, encoded files, layers, tone maps, metrics and false colours by themselves.
#ifndef VPL_IMAGETOOLS_H
#define VPL_IMAGETOOLS_H

#include <vpl/image.h>

VPL_HEADER_BEGIN

// 64-bit hash of size and float bits, the same on every machine. Equal hashes mean equal bits.
uint64_t vplImage_Hash(const vplImage* image);

// True if pictures can be written to a file of this name: its extension is .png, .hdr, .pfm or, where OpenEXR
// is built in, .exr.
bool vplImage_CanWrite(const char* path);

// The extensions that can be written, for messages: ".png, .hdr, .pfm or .exr" where OpenEXR is built in.
const char* vplImage_GetExtensions(void);

// Encodes the file that vplImage_Write would write under the name, such as ".png"; `options` NULL means defaults. Free the
// bytes with vplBytes_Free.
vplResult vplImage_Encode(const vplImage* image, const char* name, const vplWriteOptions* options,
                          uint8_t** bytesOut, size_t* sizeOut);

// Frees the bytes of an encoded file or of a piece of a picture. NULL is allowed.
void vplBytes_Free(vplContext* context, uint8_t* bytes);

// Kinds of layers of an .exr file.
typedef enum vplLayerKind {
    VPL_LAYER_COLOUR = 0, // three float channels: NAME.R, NAME.G and NAME.B, or R, G and B without a name
    VPL_LAYER_VECTOR,     // three float channels: NAME.X, NAME.Y and NAME.Z
    VPL_LAYER_NUMBER,     // one float channel, NAME
    VPL_LAYER_INDEX       // one channel of whole numbers (UINT), NAME
} vplLayerKind;

// A picture with a name, as .exr files hold several.
typedef struct vplLayer {
    const char* name; // up to VPL_MAX_LAYER_NAME bytes; "" is the picture that all programs show
    vplLayerKind kind;
    const vplImage* image; // numbers and indices are in red; indices are whole, [0, VPL_MAX_LAYER_INDEX]
    // Names of the indices 1, 2, ... nameCount, written into the header as the string vector "NAME.names"; 0:
    // they are not.
    const char** names;
    int nameCount;
} vplLayer;

// The largest index: floats hold all whole numbers up to it.
enum { VPL_MAX_LAYER_INDEX = 1 << 24, VPL_MAX_LAYER_NAME = 24 };

// Writes layers of one size into one .exr file, lossless. The file appears whole or not at all.
// VPL_INVALID_ARGUMENT for another extension, a build without OpenEXR, layers that differ in size, a channel
// that occurs twice, an index out of range, or a pixel that is NaN or infinite; VPL_FILE_ERROR;
// VPL_OUT_OF_MEMORY.
vplResult vplImage_WriteLayers(const vplLayer* layers, int count, const char* path);

// Encodes layers as the bytes of the .exr file that vplImage_WriteLayers writes. Free them with vplBytes_Free. Errors as
// vplImage_WriteLayers but VPL_FILE_ERROR; VPL_INVALID_ARGUMENT also for a count below 1.
vplResult vplImage_EncodeLayers(const vplLayer* layers, int count, uint8_t** bytesOut, size_t* sizeOut);

// Reads one layer of an .exr file: the channels R, G and B or X, Y and Z behind NAME and a dot, or the
// channel NAME alone, which all three values of the picture receive. Errors as vplImage_Read, and
// VPL_PARSE_ERROR if the file has no such layer.
vplResult vplImage_ReadLayer(vplContext* context, const char* path, const char* name, vplImage** imageOut);

typedef struct vplReinhardDef {
    // The value to which the geometric mean of the luminance maps (middle grey); (0, 1], default 0.18.
    float key;
    // Added to the luminance before the logarithm, so that black pixels stay finite; [0, 1], default 1e-6.
    float delta;
    // Smallest scaled luminance that maps to 1, > 0. 0 (default): the picture's largest. INFINITY: L / (1 +
    // L).
    float white;
    // Black pixels do not count in the mean, so that a black background does not overexpose the rest. Default
    // false, as published; vplImage_Write uses true.
    bool skipBlack;
    uint32_t cookie; // set by vplDefaultReinhardDef
} vplReinhardDef;

vplReinhardDef vplDefaultReinhardDef(void);

// Maps the luminance Y of each pixel to L (1 + L / white^2) / (1 + L), where L = key / mean * Y, and keeps
// its chromaticity. The mean is geometric. Pixels that are not finite do not count in it and become black. A
// black picture stays black. `def` NULL means defaults. VPL_INVALID_ARGUMENT, VPL_OUT_OF_MEMORY.
// Source: Reinhard, Stark, Shirley and Ferwerda, Photographic Tone Reproduction for Digital Images, SIGGRAPH
// 2002, equations 1, 2 and 4.
vplResult vplToneMap_Reinhard(vplImage* image, const vplReinhardDef* def);

// Finds the exposure, in stops in [-64, 64], at which the geometric mean of the luminance becomes middle
// grey, 0.18. Not all pixels count: those that are black or not finite are left out first; then the brightest
// 5 %, as lamps; then all that are 1024 times darker than the darkest of these, as a dark background; then
// the darkest 10 % of the rest. If more than 2 % of the picture would still exceed 8, half of the white of
// AgX, the exposure is lowered by up to two stops, so that a sunlit floor keeps its detail. Luminances are
// counted in bins of 1/128 octave. A black picture gives 0. VPL_OUT_OF_MEMORY.
// Source: Reinhard and others, as above, equations 1 and 2, for the mean; Krzysztof Narkowicz, Automatic
// Exposure, 2016, for the histogram without its ends.
vplResult vplImage_AutoExposure(const vplImage* image, float* stopsOut);

// Maps a picture as the reference rendering of ACES does for a screen, by a fit with curves in a wide gamut:
// bright saturated colours turn pale instead of clipping. Greys up to 0.0019 become black, middle grey 0.18
// becomes 0.213, and 15.4 and more white. NaN becomes black. Values are divided by 0.6 before the fit, as in
// three.js and Khronos' glTF viewer, because the fit itself makes middle grey 0.106.
// Source: Stephen Hill, ACES.hlsl in Matt Pettineo and David Neubelt's BakingLab, 2016. Krzysztof Narkowicz'
// curve (ACES Filmic Tone Mapping Curve, 2015) maps the channels one by one, which clips saturated lights.
void vplToneMap_Aces(vplImage* image);

// Maps a picture by AgX with its base look: 16.5 stops, from 10 below middle grey to 6.5 above, to [0, 1];
// the brighter a colour the paler, its hue hardly changes. Black stays black, middle grey 0.18 becomes 0.214,
// and 16.3 and more white. NaN becomes black. Results are linear: encoded as sRGB they are AgX's codes.
// Source: Troy Sobotka, AgX, 2022 (its curve AgX_Default_Contrast, in closed form), with the matrices of
// Benjamin Wrensch, Minimal AgX Implementation, 2023.
void vplToneMap_Agx(vplImage* image);

// Linear value, clamped to [0, 1], to sRGB (IEC 61966-2-1). NaN gives 0.
float vplSrgb_Encode(float linear);

// sRGB value, clamped to [0, 1], to linear.
float vplSrgb_Decode(float encoded);

// Linear value to the nearest of 256 sRGB codes.
uint8_t vplSrgb_Code(float linear);

// Copies a rectangle. VPL_INVALID_ARGUMENT unless it lies inside the picture; VPL_OUT_OF_MEMORY.
vplResult vplImage_Crop(const vplImage* image, int x, int y, int width, int height, vplImage** imageOut);

// Structural similarity of values clamped to [0, 1] and sRGB-encoded, as the mean of the three channels: 1
// where equal, around 0 where unrelated, at least -1. The window is a Gaussian of 11 x 11 pixels with sigma
// 1.5; K1 = 0.01, K2 = 0.03; variances are those of a population. The mean leaves out the borders of 5
// pixels, where the window would extend beyond the picture. Along a side shorter than 11 pixels all pixels
// count, and borders are mirrored. mapOut (may be NULL) receives each pixel's value in all channels,
// including borders.
// Agrees with scikit-image's structural_similarity(gaussian_weights=True, sigma=1.5,
// use_sample_covariance=False, data_range=1).
// Source: Wang, Bovik, Sheikh and Simoncelli, Image Quality Assessment: From Error Visibility to Structural
// Similarity, IEEE Transactions on Image Processing 13(4), 2004.
vplResult vplImage_Ssim(const vplImage* a, const vplImage* b, double* meanOut, vplImage** mapOut);

// Range and default of the pixels per degree of vision for FLIP. The default is the paper's: a screen of 3840
// pixels and 0.7 m width seen from 0.7 m, 3840 pi / 180.
#define VPL_MIN_PPD     1
#define VPL_MAX_PPD     1000
#define VPL_DEFAULT_PPD 67.0206432765823

// FLIP of values clamped to [0, 1] (low dynamic range): the difference that a viewer perceives when
// alternating between the pictures, from 0 (none) to 1. `ppd` is in [VPL_MIN_PPD, VPL_MAX_PPD]. mapOut (may
// be NULL) receives each pixel's value in all channels.
// Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astroem and Fairchild, FLIP: A Difference Evaluator
// for Alternating Images, High Performance Graphics 2020.
vplResult vplImage_Flip(const vplImage* a, const vplImage* b, double ppd, double* meanOut, vplImage** mapOut);

// A block of pixels, and the difference between A and B there.
typedef struct vplRegion {
    int x, y, width, height; // pixels
    double meanA, meanB;     // over pixels and channels
    double ratio;            // meanA / meanB; 1 if equal, infinite if only B is black
    double rmse;             // as in vplComparison
} vplRegion;

// Compares two pictures in a grid of columns * rows blocks, whose sizes differ by one pixel at most.
// regionsOut must have room for all of them: rows from the top, each from the left. columns is in [1, width],
// rows in [1, height].
vplResult vplImage_CompareRegions(const vplImage* a, const vplImage* b, int columns, int rows,
                                  vplRegion* regionsOut);

// A quantity of the difference between two pictures at each pixel.
typedef enum vplHeat {
    VPL_HEAT_DIFFERENCE = 0, // mean of |a - b| over the channels
    VPL_HEAT_RELATIVE,       // mean of |a - b| / |b + 0.01| over the channels
    VPL_HEAT_SSIM,           // 1 - SSIM
    VPL_HEAT_FLIP            // FLIP, in the colours of its paper (magma)
} vplHeat;

typedef struct vplHeatmapDef {
    // The quantity to show; default VPL_HEAT_DIFFERENCE.
    vplHeat of;
    // The value of the brightest colour, >= 0. 0 (default): the picture's largest value, or 1 for SSIM and
    // FLIP.
    float scale;
    // Pixels per degree, for FLIP; default VPL_DEFAULT_PPD.
    double ppd;
    uint32_t cookie; // set by vplDefaultHeatmapDef
} vplHeatmapDef;

vplHeatmapDef vplDefaultHeatmapDef(void);

// Shows a difference in false colours, from black for 0 to the brightest colour. A picture at least 160
// pixels wide has a numbered colour bar below. Write it as PNG without tone map. `def` NULL means defaults.
vplResult vplImage_HeatmapOf(const vplImage* a, const vplImage* b, const vplHeatmapDef* def,
                             vplImage** imageOut);

// The same for VPL_HEAT_DIFFERENCE: black is 0, white is `scale` and more (0: the largest difference).
vplResult vplImage_Heatmap(const vplImage* a, const vplImage* b, float scale, vplImage** imageOut);

VPL_HEADER_END

#endif
