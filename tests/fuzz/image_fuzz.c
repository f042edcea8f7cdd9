// SPDX-License-Identifier: MIT
// Passes arbitrary bytes to each image decoder: it must either log one sentence, or return a picture that can
// be compared, hashed and encoded again.
#include "fuzz.h"

#include "image/image_file.h"
#include "scene/scene.h"
#include "scene/texture.h"
#include "scene/texture_load.h"

#include <math.h>
#include <string.h>

// Requires that a picture of floats survives PFM and EXR bit for bit.
static void requireRoundTrip(vplContext* context, const vplImage* image, vplEncodeFcn* encode,
                             vplDecodeFcn* decode)
{
    vplWriteOptions options = vplDefaultWriteOptions();
    vplByteBuffer buffer = {.context = context};
    vplImage* again = NULL;
    MUST(encode(image, &options, &buffer) == VPL_SUCCESS && !buffer.failed);
    MUST(decode(context, "again", buffer.bytes, buffer.size, &again) == VPL_SUCCESS);
    size_t bytes = 3 * sizeof(float) * (size_t)image->width * (size_t)image->height;
    MUST(again->width == image->width && again->height == image->height);
    MUST(memcmp(again->pixels, image->pixels, bytes) == 0);
    vplImage_Destroy(again);
    vplFree(context, buffer.bytes);
}

// Requires that a picture equals itself, or is refused because a pixel is not finite.
static void requireComparison(const vplImage* image)
{
    vplComparison comparison;
    bool finite = true;
    for (size_t i = 0; i < 3 * (size_t)image->width * (size_t)image->height; i++) {
        finite = finite && isfinite(image->pixels[i]);
    }
    vplResult result = vplImage_Compare(image, image, &comparison);
    MUST(result == (finite ? VPL_SUCCESS : VPL_INVALID_ARGUMENT));
    MUST(result != VPL_SUCCESS || (comparison.rmse == 0 && comparison.relmse == 0));
    if ((size_t)image->width * (size_t)image->height > 256) {
        return; // the two checks below are slow
    }
    double ssim = 1, flip = 0;
    MUST(vplImage_Ssim(image, image, &ssim, NULL) == result && ssim == 1);
    MUST(vplImage_Flip(image, image, VPL_DEFAULT_PPD, &flip, NULL) == result && flip == 0);
}

// Requires that any bytes become a texture, maybe a grey one, whose look-ups are reflectances.
static void tryTexture(const char* name, const uint8_t* bytes, size_t size)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    vplScene* scene = NULL;
    int index = -1;
    const vplTextureFile file = {.path = name,
                                 .bytes = bytes,
                                 .size = size,
                                 .where = "fuzz:1:1",
                                 .wrapV = VPL_WRAP_MIRROR,
                                 .otherwise = 0.5f};
    MUST(vplScene_Create(context, &scene) == VPL_SUCCESS);
    const vplResult result = vplScene_LoadTexture(scene, &file, &index);
    MUST(result == VPL_OUT_OF_MEMORY || (result == VPL_SUCCESS && index == 0)); // memory is limited
    for (int i = 0; i < 8 && result == VPL_SUCCESS; i++) {
        float rgba[4];
        const vplTextureArea area = {
            .u = 0.37 * i, .v = -0.21 * i, .longU = 0.01f * (float)(i * i), .shortV = 0.03f};
        vplTexture_Lookup(scene->textures[0].decoded, &area, rgba);
        for (int c = 0; c < 4; c++) {
            MUST(rgba[c] >= 0 && rgba[c] <= 1);
        }
    }
    vplScene_Destroy(scene);
    closeFuzzContext(context);
}

static void tryDecoder(vplDecodeFcn* decoder, const uint8_t* bytes, size_t size)
{
    FuzzLog log = {{0}, 0};
    vplContext* context = openFuzzContext(&log);
    vplImage* image = NULL;
    vplResult result = decoder(context, "picture", bytes, size, &image);
    if (result == VPL_SUCCESS) {
        MUST(log.errors == 0 && image->width >= 1 && image->height >= 1);
        vplImage_Hash(image);
        if ((size_t)image->width * (size_t)image->height <= 4096) {
            requireRoundTrip(context, image, vplEncodePfm, vplDecodePfm);
            if (vplHasExr()) {
                requireRoundTrip(context, image, vplEncodeExr, vplDecodeExr);
            }
            requireComparison(image);
        }
        vplImage_Destroy(image);
    } else {
        MUST(image == NULL && log.errors == 1 && isPrintable(log.message));
        MUST(result == VPL_PARSE_ERROR || result == VPL_OUT_OF_MEMORY || result == VPL_INVALID_ARGUMENT);
    }
    closeFuzzContext(context);
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    static vplDecodeFcn* const decoders[] = {vplDecodePfm, vplDecodeHdr, vplDecodeLdr, vplDecodeExr};
    for (size_t i = 0; i < sizeof decoders / sizeof *decoders; i++) {
        tryDecoder(decoders[i], bytes, size);
    }
    tryTexture("picture.png", bytes, size);
    tryTexture("picture.hdr", bytes, size);
    return 0;
}
