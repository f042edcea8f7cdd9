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
#include <stddef.h>
#include <string.h>

// ---- memory for stb
// Where memory runs out, stb asserts, frees blocks twice or takes the file for damaged. So its blocks come from the context's allocator, a list
// holds them, and where one is refused longjmp leaves the call of stb and the list is freed.

typedef struct Block {
    _Alignas(max_align_t) struct Block* previous;
    struct Block* next;
    size_t size; // with this header
} Block;

typedef struct StbCall {
    vplContext* context;
    Block list; // its end
    jmp_buf outOfMemory;
} StbCall;

static _Thread_local StbCall* stbCall; // of this thread

static void* resizeBlock(void* memory, size_t size)
{
    StbCall* call = stbCall;
    const vplContextDef* def = &call->context->def;
    Block* old = memory != NULL ? (Block*)memory - 1 : NULL;
    const size_t total = size + sizeof(Block);
    Block* block = total > size ? def->alloc(def->allocUser, old, old != NULL ? old->size : 0, total) : NULL;
    if (block == NULL) {
        longjmp(call->outOfMemory, 1);
    }
    if (old == NULL) {
        block->previous = &call->list;
        block->next = call->list.next;
    }
    block->size = total;
    block->previous->next = block->next->previous = block;
    return block + 1;
}

static void* unlinkBlock(Block* block)
{
    block->previous->next = block->next;
    block->next->previous = block->previous;
    return block + 1;
}

static void freeBlock(vplContext* context, void* memory)
{
    if (memory != NULL) {
        Block* block = (Block*)memory - 1;
        context->def.alloc(context->def.allocUser, block, block->size, 0);
    }
}

static void freeStb(void* memory)
{
    if (memory != NULL) {
        freeBlock(stbCall->context, unlinkBlock((Block*)memory - 1));
    }
}

// Runs work(data), which calls stb. It must free the blocks of stb that it does not unlink.
static vplResult callStb(vplContext* context, void (*work)(void*), void* data, const char* doing)
{
    StbCall call = {.context = context};
    call.list.previous = call.list.next = &call.list;
    stbCall = &call;
    if (setjmp(call.outOfMemory) == 0) {
        work(data);
        stbCall = NULL;
        return VPL_SUCCESS;
    }
    while (call.list.next != &call.list) {
        freeBlock(context, unlinkBlock(call.list.next));
    }
    stbCall = NULL;
    return vplFail(context, VPL_OUT_OF_MEMORY, "out of memory while %s", doing);
}

#define STBIW_MALLOC(size)          resizeBlock(NULL, size)
#define STBIW_REALLOC(memory, size) resizeBlock(memory, size)
#define STBIW_FREE(memory)          freeStb(memory)
#define STBI_MALLOC(size)           resizeBlock(NULL, size)
#define STBI_REALLOC(memory, size)  resizeBlock(memory, size)
#define STBI_FREE(memory)           freeStb(memory)

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

vplResult vplEncodePng(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    if ((size_t)image->width * (size_t)image->height > INT_MAX / 6) { // stb counts bytes in int
        return vplFail(image->context, VPL_LIMIT, "a PNG of %dx%d pixels is too large; write .pfm instead",
                       image->width, image->height);
    }
    uint8_t* codes;
    TRY(vplMakeCodes(image, options, &codes));
    const vplResult result =
        callStb(image->context, encodePng, &(Encoding){image, codes, buffer}, "encoding a PNG");
    vplFree(image->context, codes);
    return result;
}

vplResult vplEncodeHdr(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    (void)options;
    return callStb(image->context, encodeHdr, &(Encoding){image, NULL, buffer}, "encoding an HDR picture");
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
    if (t->codes != NULL) {
        unlinkBlock((Block*)t->codes - 1); // stays when the call has ended
        return;
    }
    const char* reason = stbi_failure_reason();
    t->reason = reason != NULL && *reason != 0 ? reason : t->reason;
}

// Decodes codes with `channels` channels, or with those of the file if that is 0.
static vplResult decodeCodes(vplContext* context, const uint8_t* bytes, size_t size, int channels,
                             vplTexels* out)
{
    // A BMP's height is negative where rows go down; stb takes its absolute value, which -2^31 has not.
    static const uint8_t least[4] = {0, 0, 0, 0x80};
    *out = (vplTexels){.context = context, .reason = "its data is damaged"};
    if (size >= 26 && memcmp(bytes, "BM", 2) == 0 && bytes[14] != 12 && memcmp(bytes + 22, least, 4) == 0) {
        out->reason = "its height is -2147483648";
        return VPL_SUCCESS;
    }
    return size > INT_MAX
               ? VPL_SUCCESS
               : callStb(context, decode, &(Decoding){bytes, (int)size, channels, out}, "reading a picture");
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
    freeBlock(texels->context, texels->codes);
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
