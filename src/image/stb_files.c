// SPDX-License-Identifier: MIT
// PNG and HDR written, and PNG, JPEG, BMP and TGA read, by stb. Both stb headers are compiled here only, as
// static code, and their global switches (vertical flip, gamma) stay untouched. stb reports success on a full
// disk, so it writes to memory only. Its HDR reader is not used, because a run of length 0 makes it loop for
// ever; see hdr.c.
#include "base/arena.h"
#include "image/image_file.h"
#include "image/srgb.h"
#include "image/texels.h"
#include "math/scalar.h"

#include <limits.h>
#include <string.h>

#pragma GCC diagnostic ignored "-Wunused-function" // most of stb's
#ifndef __clang__
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb_image_write.h>

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_NO_STDIO
#define STBI_NO_PSD
#define STBI_NO_GIF
#define STBI_NO_PIC
#define STBI_NO_PNM
#define STBI_NO_HDR
#define STBI_NO_LINEAR
#define STBI_MAX_DIMENSIONS VPL_MAX_IMAGE_SIZE
#include <stb_image.h>

static void append(void* buffer, void* bytes, int size)
{
    vplByteBuffer_Append(buffer, bytes, (size_t)size);
}

vplResult vplEncodePng(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    if ((size_t)image->width * (size_t)image->height > INT_MAX / 6) { // stb counts bytes in int
        return vplFail(image->context, VPL_LIMIT, "a PNG of %dx%d pixels is too large; write .pfm instead",
                       image->width, image->height);
    }
    uint8_t* codes;
    TRY(vplMakeCodes(image, options, &codes));
    const int written =
        stbi_write_png_to_func(append, buffer, image->width, image->height, 3, codes, 3 * image->width);
    vplFree(image->context, codes);
    return written ? VPL_SUCCESS
                   : vplFail(image->context, VPL_OUT_OF_MEMORY, "out of memory while encoding a PNG");
}

vplResult vplEncodeHdr(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    (void)options;
    if (!stbi_write_hdr_to_func(append, buffer, image->width, image->height, 3, image->pixels)) {
        return vplFail(image->context, VPL_OUT_OF_MEMORY, "out of memory while encoding an HDR picture");
    }
    return VPL_SUCCESS;
}

// Decodes codes with `channels` channels, or with those of the file if that is 0.
static vplTexels decodeCodes(const uint8_t* bytes, size_t size, int channels)
{
    // A BMP's height is negative where rows go down; stb takes its absolute value, which -2^31 has not.
    static const uint8_t least[4] = {0, 0, 0, 0x80};
    vplTexels t = {.reason = "its data is damaged"};
    if (size >= 26 && memcmp(bytes, "BM", 2) == 0 && bytes[14] != 12 && memcmp(bytes + 22, least, 4) == 0) {
        t.reason = "its height is -2147483648";
        return t;
    }
    int found = 0;
    if (size <= INT_MAX) {
        t.codes = stbi_load_from_memory(bytes, (int)size, &t.width, &t.height, &found, channels);
    }
    t.channels = channels != 0 ? channels : found;
    const char* reason = t.codes == NULL ? stbi_failure_reason() : NULL;
    t.reason = reason != NULL && *reason != 0 ? reason : t.reason;
    return t;
}

vplTexels vplTexels_Decode(const uint8_t* bytes, size_t size)
{
    vplTexels t = decodeCodes(bytes, size, 0);
    if (t.codes != NULL && (t.width < 1 || t.height < 1)) { // stb reads TGA files of no pixels
        vplTexels_Free(&t);
        t.reason = "it has no pixels";
    }
    return t;
}

void vplTexels_Free(vplTexels* texels)
{
    stbi_image_free(texels->codes);
    texels->codes = NULL;
}

vplResult vplDecodeLdr(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                       vplImage** imageOut)
{
    vplTexels t = decodeCodes(bytes, size, 3);
    if (t.codes == NULL) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: cannot read the picture: %s", path, t.reason);
    }
    vplImage* image;
    vplResult result = vplImage_Create(context, t.width, t.height, &image);
    if (result == VPL_SUCCESS) {
        float linear[256];
        for (int code = 0; code < 256; code++) {
            linear[code] = vplSrgb_Decode((float)code / 255.0f);
        }
        for (size_t i = 0; i < 3 * (size_t)t.width * (size_t)t.height; i++) {
            image->pixels[i] = linear[t.codes[i]];
        }
        *imageOut = image;
    }
    vplTexels_Free(&t);
    return result;
}
