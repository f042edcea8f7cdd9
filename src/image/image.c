// SPDX-License-Identifier: MIT
#include "base/arena.h"
#include "base/file_kind.h"
#include "base/hash.h"
#include "image/image_file.h"

#include <math.h>
#include <string.h>
#include <strings.h>

vplResult vplImage_Create(vplContext* context, int width, int height, vplImage** imageOut)
{
    REQUIRE(context, context, imageOut);
    if (width < 1 || width > VPL_MAX_IMAGE_SIZE || height < 1 || height > VPL_MAX_IMAGE_SIZE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "image size is %dx%d, each side must be in [1, %d]",
                       width, height, VPL_MAX_IMAGE_SIZE);
    }
    vplImage* image = vplAlloc(context, 1, sizeof *image);
    const size_t count = 3 * (size_t)width * (size_t)height;
    float* pixels = image ? vplAlloc(context, count, sizeof *pixels) : NULL;
    const vplResult result =
        pixels != NULL ? vplClear(context, pixels, count * sizeof *pixels) : VPL_OUT_OF_MEMORY;
    if (result != VPL_SUCCESS) {
        vplFree(context, pixels);
        vplFree(context, image);
        return result;
    }
    *image = (vplImage){width, height, pixels, context};
    *imageOut = image;
    return VPL_SUCCESS;
}

void vplImage_Destroy(vplImage* image)
{
    if (image != NULL) {
        vplFree(image->context, image->pixels);
        vplFree(image->context, image);
    }
}

uint64_t vplImage_Hash(const vplImage* image)
{
    if (image == NULL) {
        return 0;
    }
    const uint32_t size[2] = {(uint32_t)image->width, (uint32_t)image->height};
    uint64_t state = vplHashWords(0, size, 2);
    return vplHashFloats(state, image->pixels, 3 * (size_t)image->width * (size_t)image->height);
}

vplResult vplImage_RequireFinite(const vplImage* image, const char* what)
{
    size_t count = 3 * (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(image->pixels[i])) {
            size_t pixel = i / 3;
            return vplFail(image->context, VPL_INVALID_ARGUMENT,
                           "%s: pixel (%d, %d) channel %d is %g, must be finite", what,
                           (int)(pixel % (size_t)image->width), (int)(pixel / (size_t)image->width),
                           (int)(i % 3), (double)image->pixels[i]);
        }
    }
    return VPL_SUCCESS;
}

vplWriteOptions vplDefaultWriteOptions(void)
{
    return (vplWriteOptions){0, VPL_TONEMAP_NONE, VPL_WRITE_COOKIE};
}

typedef struct Format {
    const char* extension;
    vplEncodeFcn* encode; // NULL: read only
    vplDecodeFcn* decode;
    const char* contents; // the endings of all formats that `decode` reads; NULL: TGA has no mark of its own
    const char* what;
} Format;

static const Format FORMATS[] = {
    {".png", vplEncodePng, vplDecodeLdr, ".png.jpg", "a PNG picture"},
    {".hdr", vplEncodeHdr, vplDecodeHdr, ".hdr", "a Radiance HDR picture"},
    {".pfm", vplEncodePfm, vplDecodePfm, ".pfm", "a PFM picture"},
    {".exr", vplEncodeExr, vplDecodeExr, ".exr", "an OpenEXR picture"},
    {".jpg", NULL, vplDecodeLdr, ".png.jpg", "a JPEG picture"},
    {".jpeg", NULL, vplDecodeLdr, ".png.jpg", "a JPEG picture"},
    {".bmp", NULL, vplDecodeLdr, ".png.jpg", "a BMP picture"},
    {".tga", NULL, vplDecodeLdr, NULL, "a TGA picture"},
};

static const Format* findFormat(const char* path)
{
    size_t length = strlen(path);
    for (size_t i = 0; i < sizeof FORMATS / sizeof *FORMATS; i++) {
        size_t n = strlen(FORMATS[i].extension);
        if (length >= n && strcasecmp(path + length - n, FORMATS[i].extension) == 0) {
            return &FORMATS[i];
        }
    }
    return NULL;
}

bool vplImage_CanWrite(const char* path)
{
    if (path == NULL) {
        return false;
    }
    const Format* format = findFormat(path);
    return format != NULL && format->encode != NULL && (format->encode != vplEncodeExr || vplHasExr());
}

const char* vplImage_GetExtensions(void)
{
    return vplHasExr() ? ".png, .hdr, .pfm or .exr" : ".png, .hdr or .pfm (this build has no OpenEXR)";
}

vplResult vplCheckDisplay(vplContext* context, const char* type, float exposure, vplToneMap tonemap)
{
    if (!(fabsf(exposure) <= 64 || exposure == VPL_EXPOSURE_AUTO)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "%s.exposure is %g, must be in [-64, 64] or VPL_EXPOSURE_AUTO", type,
                       (double)exposure);
    }
    return (int)tonemap >= 0 && tonemap <= VPL_TONEMAP_AGX
               ? VPL_SUCCESS
               : vplFail(context, VPL_INVALID_ARGUMENT, "%s.tonemap is %d, no vplToneMap", type,
                         (int)tonemap);
}

static vplResult encode(const Format* format, const vplImage* image, const char* what,
                        const vplWriteOptions* options, vplByteBuffer* buffer)
{
    vplWriteOptions settings = options ? *options : vplDefaultWriteOptions();
    if (settings.cookie != VPL_WRITE_COOKIE) {
        return vplFail(image->context, VPL_INVALID_ARGUMENT,
                       "vplWriteOptions was not made by vplDefaultWriteOptions");
    }
    TRY(vplCheckDisplay(image->context, "vplWriteOptions", settings.exposure, settings.tonemap));
    TRY(vplImage_RequireFinite(image, what));
    TRY(format->encode(image, &settings, buffer));
    return buffer->failed ? VPL_OUT_OF_MEMORY : VPL_SUCCESS;
}

// Gives the caller the bytes of a file that was encoded.
static vplResult deliver(vplResult result, vplByteBuffer* buffer, uint8_t** bytesOut, size_t* sizeOut)
{
    if (result != VPL_SUCCESS) {
        vplFree(buffer->context, buffer->bytes);
        return result;
    }
    *bytesOut = buffer->bytes;
    *sizeOut = buffer->size;
    return VPL_SUCCESS;
}

vplResult vplImage_Encode(const vplImage* image, const char* name, const vplWriteOptions* options,
                          uint8_t** bytesOut, size_t* sizeOut)
{
    REQUIRE(CONTEXT_OF(image), image, name, bytesOut, sizeOut);
    if (!vplImage_CanWrite(name)) {
        return vplFail(image->context, VPL_INVALID_ARGUMENT,
                       "%s: unknown picture format; the name must end in %s", name, vplImage_GetExtensions());
    }
    vplByteBuffer buffer = {.context = image->context};
    return deliver(encode(findFormat(name), image, name, options, &buffer), &buffer, bytesOut, sizeOut);
}

void vplBytes_Free(vplContext* context, uint8_t* bytes)
{
    if (context == NULL || bytes == NULL) {
        return;
    }
    vplFree(context, bytes);
}

static vplResult writeAndFree(vplContext* context, const char* path, uint8_t* bytes, size_t size)
{
    const vplResult result = vplWriteFile(context, path, bytes, size);
    vplFree(context, bytes);
    return result;
}

vplResult vplImage_Write(const vplImage* image, const char* path, const vplWriteOptions* options)
{
    REQUIRE(CONTEXT_OF(image), image, path);
    uint8_t* bytes;
    size_t size;
    TRY(vplImage_Encode(image, path, options, &bytes, &size));
    return writeAndFree(image->context, path, bytes, size);
}

// ---- layers

static vplResult checkLayer(const vplLayer* layer, const vplLayer* first)
{
    const vplImage* image = layer->image;
    const size_t count = 3 * (size_t)image->width * (size_t)image->height;
    if (image->width != first->image->width || image->height != first->image->height) {
        return vplFail(image->context, VPL_INVALID_ARGUMENT, "layer \"%s\" is %dx%d, must be %dx%d as \"%s\"",
                       layer->name, image->width, image->height, first->image->width, first->image->height,
                       first->name);
    }
    if (strlen(layer->name) > VPL_MAX_LAYER_NAME) {
        return vplFail(image->context, VPL_INVALID_ARGUMENT,
                       "layer \"%.60s\" has a name of %zu bytes, may have %d", layer->name,
                       strlen(layer->name), VPL_MAX_LAYER_NAME);
    }
    for (size_t i = 0; layer->kind == VPL_LAYER_INDEX && i < count; i += 3) {
        const float index = image->pixels[i];
        if (!(index >= 0 && index <= VPL_MAX_LAYER_INDEX && index == floorf(index))) {
            return vplFail(image->context, VPL_INVALID_ARGUMENT,
                           "layer \"%s\" has %g, must have whole numbers in [0, %d]", layer->name,
                           (double)index, VPL_MAX_LAYER_INDEX);
        }
    }
    return vplImage_RequireFinite(image, layer->name);
}

vplResult vplImage_EncodeLayers(const vplLayer* layers, int count, uint8_t** bytesOut, size_t* sizeOut)
{
    REQUIRE(NULL, bytesOut, sizeOut);
    REQUIRE_ARRAY(NULL, layers, count);
    if (count < 1) {
        return vplFail(NULL, VPL_INVALID_ARGUMENT, "vplImage_EncodeLayers: count is %d, must be at least 1",
                       count);
    }
    vplContext* context = layers[0].image->context;
    for (int i = 0; i < count; i++) {
        TRY(checkLayer(&layers[i], &layers[0]));
    }
    vplByteBuffer buffer = {.context = context};
    vplResult result = vplEncodeExrLayers(layers, count, &buffer);
    result = result == VPL_SUCCESS && buffer.failed ? VPL_OUT_OF_MEMORY : result;
    return deliver(result, &buffer, bytesOut, sizeOut);
}

vplResult vplImage_WriteLayers(const vplLayer* layers, int count, const char* path)
{
    REQUIRE(NULL, path);
    REQUIRE_ARRAY(NULL, layers, count);
    vplContext* context = count > 0 ? layers[0].image->context : NULL;
    const Format* format = findFormat(path);
    uint8_t* bytes;
    size_t size;
    if (format == NULL || format->encode != vplEncodeExr) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "%s: only .exr files have layers", path);
    }
    TRY(vplImage_EncodeLayers(layers, count, &bytes, &size));
    return writeAndFree(context, path, bytes, size);
}

vplResult vplImage_ReadLayer(vplContext* context, const char* path, const char* name, vplImage** imageOut)
{
    REQUIRE(context, context, path, name, imageOut);
    const Format* format = findFormat(path);
    char* bytes;
    size_t size;
    if (format == NULL || format->decode != vplDecodeExr) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "%s: only .exr files have layers", path);
    }
    TRY(vplReadFile(context, path, &bytes, &size));
    const vplResult result = vplDecodeExrLayer(context, path, name, (const uint8_t*)bytes, size, imageOut);
    vplFree(context, bytes);
    return result;
}

vplResult vplImage_Read(vplContext* context, const char* path, vplImage** imageOut)
{
    REQUIRE(context, context, path, imageOut);
    const Format* format = findFormat(path);
    if (format == NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "%s: unknown picture format; the name must end in .jpg, .bmp, .tga, %s", path,
                       vplImage_GetExtensions());
    }
    char* bytes;
    size_t size;
    TRY(vplReadFile(context, path, &bytes, &size));
    vplResult result = format->contents == NULL
                           ? VPL_SUCCESS
                           : vplCheckFileKind(context, path, bytes, size, format->contents, format->what);
    result =
        result == VPL_SUCCESS ? format->decode(context, path, (const uint8_t*)bytes, size, imageOut) : result;
    vplFree(context, bytes);
    return result;
}
