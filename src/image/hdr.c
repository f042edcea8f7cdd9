// SPDX-License-Identifier: MIT
// Reads Radiance HDR pictures: a text header, a size line, then rows of RGBE pixels, plain or run-length
// coded.
// Based on: Greg Ward, Real Pixels, Graphics Gems II, 1991. Departs: it refuses the run-length coding from
// before 1991 and orientations other than "-Y height +X width".
#include "base/arena.h"
#include "image/image_file.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct Reader {
    const uint8_t *at, *end;
} Reader;

static size_t left(const Reader* r)
{
    return (size_t)(r->end - r->at);
}

// Reads the next line without its end. False at the end of the file, or if the line has more than 255
// characters.
static bool readLine(Reader* r, char line[256])
{
    const uint8_t* stop = memchr(r->at, '\n', left(r));
    if (stop == NULL || stop - r->at > 255) {
        return false;
    }
    memcpy(line, r->at, (size_t)(stop - r->at));
    line[stop - r->at] = 0;
    r->at = stop + 1;
    return true;
}

static bool readHeader(Reader* r, int* width, int* height)
{
    char line[256];
    if (!readLine(r, line) || strncmp(line, "#?", 2) != 0) {
        return false;
    }
    bool rgbe = false;
    while (readLine(r, line) && line[0] != 0) {
        rgbe = rgbe || strcmp(line, "FORMAT=32-bit_rle_rgbe") == 0;
    }
    int end = 0;
    return rgbe && readLine(r, line) && sscanf(line, "-Y %9d +X %9d%n", height, width, &end) == 2 &&
           line[end] == 0 && *width >= 1 && *width <= VPL_MAX_IMAGE_SIZE && *height >= 1 &&
           *height <= VPL_MAX_IMAGE_SIZE;
}

// Reads one component of one row. Counts above 128 repeat the next byte; others copy as many bytes.
static bool readRuns(Reader* r, uint8_t* out, int width)
{
    for (int x = 0; x < width;) {
        if (left(r) < 2) {
            return false;
        }
        int count = *r->at++;
        bool repeat = count > 128;
        count -= repeat ? 128 : 0;
        if (count == 0 || count > width - x || (!repeat && (size_t)count > left(r))) {
            return false;
        }
        if (repeat) {
            memset(out + x, *r->at++, (size_t)count);
        } else {
            memcpy(out + x, r->at, (size_t)count);
            r->at += count;
        }
        x += count;
    }
    return true;
}

// Reads one row into all r, then all g, all b and all e.
static bool readRow(Reader* r, uint8_t* row, int width)
{
    size_t w = (size_t)width;
    bool coded = left(r) >= 4 && width >= 8 && width < 32768 && r->at[0] == 2 && r->at[1] == 2 &&
                 (r->at[2] << 8 | r->at[3]) == width;
    if (coded) {
        r->at += 4;
        for (size_t c = 0; c < 4; c++) {
            if (!readRuns(r, row + c * w, width)) {
                return false;
            }
        }
        return true;
    }
    if (left(r) < 4 * w) {
        return false;
    }
    for (size_t i = 0; i < 4 * w; i++) {
        row[i % 4 * w + i / 4] = r->at[i];
    }
    r->at += 4 * w;
    return true;
}

static vplResult readPixels(Reader* r, const char* path, vplImage* image)
{
    const size_t w = (size_t)image->width;
    uint8_t* row = vplAlloc(image->context, 4 * w, 1);
    vplResult result = row != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    float* pixel = image->pixels;
    for (int y = 0; y < image->height && result == VPL_SUCCESS; y++) {
        if (!readRow(r, row, image->width)) {
            result =
                vplFail(image->context, VPL_PARSE_ERROR,
                        "%s: HDR picture is damaged or ends early in row %d of %d", path, y, image->height);
            break;
        }
        for (size_t x = 0; x < w; x++, pixel += 3) {
            int exponent = row[3 * w + x];
            float scale = exponent ? ldexpf(1, exponent - 136) : 0;
            for (size_t c = 0; c < 3; c++) {
                pixel[c] = (float)row[c * w + x] * scale;
            }
        }
    }
    vplFree(image->context, row);
    return result;
}

vplResult vplDecodeHdr(vplContext* context, const char* path, const uint8_t* bytes, size_t size,
                       vplImage** imageOut)
{
    Reader reader = {bytes, bytes + size};
    int width, height;
    if (!readHeader(&reader, &width, &height)) {
        return vplFail(context, VPL_PARSE_ERROR,
                       "%s: not a Radiance HDR picture (wanted #?, FORMAT=32-bit_rle_rgbe, "
                       "-Y height +X width)",
                       path);
    }
    // Checks the size before allocating: a coded row has at least 4 bytes, and 2 per 127 pixels of a
    // component.
    size_t least = (size_t)height * (4 + 8 * (((size_t)width + 126) / 127));
    if (left(&reader) < (width < 8 ? 4 * (size_t)width * (size_t)height : least)) {
        return vplFail(context, VPL_PARSE_ERROR, "%s: HDR picture of %dx%d ends early: %zu bytes of pixels",
                       path, width, height, left(&reader));
    }
    vplImage* image;
    TRY(vplImage_Create(context, width, height, &image));
    const vplResult result = readPixels(&reader, path, image);
    if (result != VPL_SUCCESS) {
        vplImage_Destroy(image);
        return result;
    }
    *imageOut = image;
    return VPL_SUCCESS;
}
