// SPDX-License-Identifier: MIT
// Portable float map: "PF" (RGB) or "Pf" (grey), size, scale (its sign is the byte order), rows bottom-up.
#include "base/arena.h"
#include "base/bytes.h"
#include "base/numbers.h"
#include "image/image_file.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static uint32_t readWord(const uint8_t* bytes, bool little)
{
    uint32_t word = 0;
    for (int b = 0; b < 4; b++) {
        word |= (uint32_t)bytes[little ? b : 3 - b] << 8 * b;
    }
    return word;
}

vplResult vplEncodePfm(const vplImage* image, const vplWriteOptions* options, vplByteBuffer* buffer)
{
    (void)options;
    char header[64];
    int length = snprintf(header, sizeof header, "PF\n%d %d\n-1.0\n", image->width, image->height);
    size_t rowFloats = 3 * (size_t)image->width;
    // A buffer that grew row by row would hold 5 GB more at 16384 x 16384 pixels.
    vplByteBuffer_Reserve(buffer, (size_t)length + 4 * rowFloats * (size_t)image->height);
    vplByteBuffer_Append(buffer, header, (size_t)length);
    uint8_t* row = vplAlloc(image->context, rowFloats, 4);
    if (row == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int y = image->height - 1; y >= 0; y--) {
        vplPutFloats(row, image->pixels + (size_t)y * rowFloats, rowFloats);
        vplByteBuffer_Append(buffer, row, 4 * rowFloats);
    }
    vplFree(image->context, row);
    return VPL_SUCCESS;
}

typedef struct Header {
    int channels, width, height;
    bool little;
    size_t offset; // of the first pixel
} Header;

// Reads the three header lines. Not with scanf, which would skip white space that belongs to the pixels.
static bool readHeader(const uint8_t* bytes, size_t size, Header* header)
{
    char text[128];
    size_t n = size < sizeof text - 1 ? size : sizeof text - 1;
    memcpy(text, bytes, n);
    text[n] = 0;
    if (text[0] != 'P' || (text[1] != 'F' && text[1] != 'f')) {
        return false;
    }
    header->channels = text[1] == 'F' ? 3 : 1;
    char* at = text + 2;
    long width = strtol(at, &at, 10);
    long height = strtol(at, &at, 10);
    double scale = vplParseDouble(at, &at);
    if (*at == '\r') {
        at++;
    }
    if ((*at != '\n' && *at != ' ' && *at != '\t') || width < 1 || width > VPL_MAX_IMAGE_SIZE || height < 1 ||
        height > VPL_MAX_IMAGE_SIZE || !isfinite(scale) || scale == 0) {
        return false;
    }
    header->width = (int)width;
    header->height = (int)height;
    header->little = scale < 0;
    header->offset = (size_t)(at - text) + 1;
    return true;
}

vplResult vplDecodePfm(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                       vplImage** imageOut)
{
    Header header;
    if (!readHeader(bytes, size, &header)) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: not a PFM picture (wanted PF, width, height, scale)",
                       path);
    }
    size_t rowFloats = (size_t)header.channels * (size_t)header.width;
    size_t wanted = 4 * rowFloats * (size_t)header.height;
    if (size - header.offset < wanted) {
        return vplFail(context, VPL_PARSE_ERROR,
                       "%s: PFM of %dx%d ends early: %zu bytes of pixels, %zu wanted", path, header.width,
                       header.height, size - header.offset, wanted);
    }
    vplImage* image;
    TRY(vplImage_Create(context, header.width, header.height, &image));
    const uint8_t* at = bytes + header.offset;
    for (int y = header.height - 1; y >= 0; y--) {
        float* row = image->pixels + 3 * (size_t)y * (size_t)header.width;
        for (size_t i = 0; i < 3 * (size_t)header.width; i++) {
            size_t source = header.channels == 3 ? i : i / 3;
            uint32_t word = readWord(at + 4 * source, header.little);
            memcpy(row + i, &word, 4);
        }
        at += 4 * rowFloats;
    }
    *imageOut = image;
    return VPL_SUCCESS;
}
