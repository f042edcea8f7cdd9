// SPDX-License-Identifier: MIT
// PNG, HDR (written) and the formats that are only read, by stb. Both stb headers are compiled into this file
// alone and static, and their global switches (vertical flip, gamma) are never touched. stb reports success on
// a full disk, so it only ever writes to memory here. Its HDR reader is not used: a run of length 0 keeps it
// busy forever (hdr.c reads them).
#include "image/image_file.h"
#include "image/srgb_table.h"
#include "math/scalar.h"

#include <limits.h>
#include <string.h>

#pragma GCC diagnostic ignored "-Wunused-function" // stb's, of which we call few
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"

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

// Exposure and tone map on a copy; the picture itself stays linear.
static vplResult applyDisplay(const vplImage* image, const vplWriteOptions* options, vplImage** displayOut)
{
    vplImage* display;
    vplResult result = vplImage_Create(image->context, image->width, image->height, &display);
    if (result != VPL_SUCCESS) {
        return result;
    }
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    float gain = (float)vplExp(options->exposure * 0.69314718055994530942);
    for (size_t i = 0; i < count; i++) {
        display->pixels[i] = options->exposure == 0 ? image->pixels[i] : gain * image->pixels[i];
    }
    if (options->tonemap == VPL_TONEMAP_REINHARD) {
        vplReinhardDef def = vplDefaultReinhardDef();
        def.skipBlack = true;
        result = vplToneMap_Reinhard(display, &def);
    }
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(display);
        return result;
    }
    *displayOut = display;
    return VPL_SUCCESS;
}

vplResult vplEncodePng(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    vplContext* context = image->context;
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    if (count > INT_MAX / 2) { // stb counts bytes in int
        return vplFail(context, VPL_LIMIT, "a PNG of %dx%d pixels is too large; write .pfm instead",
                       image->width, image->height);
    }
    vplImage* display = NULL;
    vplResult result = applyDisplay(image, options, &display);
    uint8_t* codes = result == VPL_SUCCESS ? vplAlloc(context, count, 1) : NULL;
    if (result == VPL_SUCCESS && codes == NULL) {
        result = VPL_OUT_OF_MEMORY;
    }
    if (result == VPL_SUCCESS) {
        vplSrgbTable table;
        vplSrgbTable_Fill(&table);
        vplSrgbTable_Encode(&table, display->pixels, count, codes);
        if (!stbi_write_png_to_func(append, buffer, image->width, image->height, 3, codes,
                                    3 * image->width)) {
            result = vplFail(context, VPL_OUT_OF_MEMORY, "out of memory while encoding a PNG");
        }
    }
    vplFree(context, codes);
    vplImage_Destroy(display);
    return result;
}

vplResult vplEncodeHdr(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    (void)options;
    if (!stbi_write_hdr_to_func(append, buffer, image->width, image->height, 3, image->pixels)) {
        return vplFail(image->context, VPL_OUT_OF_MEMORY, "out of memory while encoding an HDR picture");
    }
    return VPL_SUCCESS;
}

vplResult vplDecodeLdr(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                       vplImage** imageOut)
{
    int width = 0, height = 0, channels;
    uint8_t* codes =
        size <= INT_MAX ? stbi_load_from_memory(bytes, (int)size, &width, &height, &channels, 3) : NULL;
    if (codes == NULL) {
        const char* reason = stbi_failure_reason();
        return vplFail(context, VPL_PARSE_ERROR, "%s: cannot read the picture: %s", path,
                       reason != NULL && *reason != 0 ? reason : "its data is damaged");
    }
    vplImage* image;
    vplResult result = vplImage_Create(context, width, height, &image);
    if (result == VPL_SUCCESS) {
        float linear[256];
        for (int code = 0; code < 256; code++) {
            linear[code] = vplSrgb_Decode((float)code / 255.0f);
        }
        for (size_t i = 0; i < 3 * (size_t)width * (size_t)height; i++) {
            image->pixels[i] = linear[codes[i]];
        }
        *imageOut = image;
    }
    stbi_image_free(codes);
    return result;
}
