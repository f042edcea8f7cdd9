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
#include <setjmp.h>
#include <string.h>

// ---- memory for stb
// When memory runs out, stb fails an assertion, frees a block twice or reports a damaged file. So its blocks are in an arena, and when an
// allocation fails, longjmp leaves stb. The blocks that stb still holds are freed with the arena.

typedef struct StbCall {
    vplArena* arena;
    jmp_buf outOfMemory;
} StbCall;

static _Thread_local StbCall* stbCall; // of this thread

static void* allocateStb(size_t size)
{
    void* memory = vplArena_Alloc(stbCall->arena, 1, size);
    if (memory == NULL) {
        longjmp(stbCall->outOfMemory, 1);
    }
    return memory;
}

static void freeStb(void* memory)
{
    vplArena_Free(stbCall->arena, memory);
}

static void* resizeStb(void* old, size_t oldSize, size_t size)
{
    void* memory = allocateStb(size);
    if (old != NULL) {
        memcpy(memory, old, oldSize < size ? oldSize : size);
        freeStb(old);
    }
    return memory;
}

// Runs work(data), which calls stb.
static vplResult callStb(vplArena* arena, void (*work)(void*), void* data)
{
    StbCall call = {.arena = arena};
    stbCall = &call;
    if (vplArena_Check(arena) == VPL_SUCCESS && setjmp(call.outOfMemory) == 0) {
        work(data);
    }
    stbCall = NULL;
    return vplArena_Check(arena);
}

#define STBIW_MALLOC(size)                      allocateStb(size)
#define STBIW_REALLOC_SIZED(old, oldSize, size) resizeStb(old, oldSize, size)
#define STBIW_FREE(memory)                      freeStb(memory)
#define STBI_MALLOC(size)                       allocateStb(size)
#define STBI_REALLOC_SIZED(old, oldSize, size)  resizeStb(old, oldSize, size)
#define STBI_FREE(memory)                       freeStb(memory)

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

// ---- writing

typedef struct Encoding {
    const vplImage* image;
    const uint8_t* codes; // of a PNG
    vplByteBuffer* buffer;
} Encoding;

static void append(void* buffer, void* bytes, int size)
{
    vplByteBuffer_Append(buffer, bytes, (size_t)size);
}

static void encodePng(void* data)
{
    const Encoding* e = data;
    const int width = e->image->width;
    stbi_write_png_to_func(append, e->buffer, width, e->image->height, 3, e->codes, 3 * width);
}

static void encodeHdr(void* data)
{
    const Encoding* e = data;
    stbi_write_hdr_to_func(append, e->buffer, e->image->width, e->image->height, 3, e->image->pixels);
}

static vplResult encode(void (*work)(void*), const vplImage* image, const uint8_t* codes,
                        vplByteBuffer* buffer)
{
    vplArena* arena = vplArena_Create(image->context);
    const vplResult result = callStb(arena, work, &(Encoding){image, codes, buffer});
    vplArena_Destroy(arena);
    return result;
}

vplResult vplEncodePng(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    if ((size_t)image->width * (size_t)image->height > INT_MAX / 6) { // stb counts bytes in int
        return vplFail(image->context, VPL_LIMIT, "a PNG of %dx%d pixels is too large; write .pfm instead",
                       image->width, image->height);
    }
    uint8_t* codes;
    TRY(vplMakeCodes(image, options, &codes));
    const vplResult result = encode(encodePng, image, codes, buffer);
    vplFree(image->context, codes);
    return result;
}

vplResult vplEncodeHdr(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    (void)options;
    return encode(encodeHdr, image, NULL, buffer);
}

// ---- reading

typedef struct Decoding {
    const uint8_t* bytes;
    int size, channels; // wanted; 0: those of the file
    vplTexels* texels;
} Decoding;

static void decode(void* data)
{
    const Decoding* d = data;
    vplTexels* t = d->texels;
    int found = 0;
    t->codes = stbi_load_from_memory(d->bytes, d->size, &t->width, &t->height, &found, d->channels);
    t->channels = d->channels != 0 ? d->channels : found;
    const char* reason = t->codes == NULL ? stbi_failure_reason() : NULL;
    t->reason = reason != NULL && *reason != 0 ? reason : t->reason;
}

// Decodes codes with `channels` channels, or with those of the file if that is 0.
static vplResult decodeCodes(vplContext* context, const uint8_t* bytes, size_t size, int channels,
                             vplTexels* out)
{
    // A BMP's height is negative where rows go down; stb takes its absolute value, which -2^31 has not.
    static const uint8_t least[4] = {0, 0, 0, 0x80};
    *out = (vplTexels){.reason = "its data is damaged"};
    if (size >= 26 && memcmp(bytes, "BM", 2) == 0 && bytes[14] != 12 && memcmp(bytes + 22, least, 4) == 0) {
        out->reason = "its height is -2147483648";
        return VPL_SUCCESS;
    }
    if (size > INT_MAX) {
        return VPL_SUCCESS;
    }
    out->arena = vplArena_Create(context);
    const vplResult result = callStb(out->arena, decode, &(Decoding){bytes, (int)size, channels, out});
    if (result != VPL_SUCCESS || out->codes == NULL) {
        vplTexels_Free(out);
    }
    return result;
}

vplResult vplTexels_Decode(vplContext* context, const uint8_t* bytes, size_t size, vplTexels* texelsOut)
{
    TRY(decodeCodes(context, bytes, size, 0, texelsOut));
    if (texelsOut->codes != NULL &&
        (texelsOut->width < 1 || texelsOut->height < 1)) { // stb reads TGA files of no pixels
        vplTexels_Free(texelsOut);
        texelsOut->reason = "it has no pixels";
    }
    return VPL_SUCCESS;
}

void vplTexels_Free(vplTexels* texels)
{
    vplArena_Destroy(texels->arena);
    texels->arena = NULL;
    texels->codes = NULL;
}

vplResult vplDecodeLdr(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                       vplImage** imageOut)
{
    vplTexels t;
    TRY(decodeCodes(context, bytes, size, 3, &t));
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
