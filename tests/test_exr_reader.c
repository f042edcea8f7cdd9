// SPDX-License-Identifier: MIT
// A second reader of EXR pictures, which has no code in common with OpenEXR: what the library writes is decoded by the format's
// description ("The OpenEXR File Layout"), for chunks of ZIP compression and for chunks that are stored raw.
#include "test.h"

#include "image/image_file.h"
#include "inflate.h"

enum { CHUNK_ROWS = 16, MOST_SIDE = 48, MOST_LAYERS = 4, MOST_CHANNELS = 3 * MOST_LAYERS };

typedef struct Exr {
    const uint8_t* bytes;
    size_t size, at;
    int width, height, channelCount;
    char channels[MOST_CHANNELS][32];
    int types[MOST_CHANNELS]; // 0: UINT, 2: FLOAT
    int raw, zipped;          // chunks
    uint32_t values[MOST_CHANNELS][MOST_SIDE * MOST_SIDE];
} Exr;

static uint64_t get(Exr* x, int bytes)
{
    uint64_t value = 0;
    assert_true(x->at + (size_t)bytes <= x->size);
    for (int i = 0; i < bytes; i++) {
        value |= (uint64_t)x->bytes[x->at++] << 8 * i;
    }
    return value;
}

static const char* getText(Exr* x)
{
    const char* text = (const char*)x->bytes + x->at;
    while (get(x, 1) != 0) {
    }
    return text;
}

static void getChannels(Exr* x)
{
    for (const char* name = getText(x); name[0] != 0; name = getText(x)) {
        const int c = x->channelCount++;
        assert_true(c < MOST_CHANNELS);
        snprintf(x->channels[c], sizeof x->channels[c], "%s", name);
        x->types[c] = (int)get(x, 4);
        assert_true(x->types[c] == 0 || x->types[c] == 2);
        x->at += 4; // linear, reserved
        assert_true(get(x, 4) == 1 && get(x, 4) == 1);
        assert_true(c == 0 || strcmp(x->channels[c - 1], x->channels[c]) < 0); // sorted
    }
}

static void getHeader(Exr* x)
{
    assert_int_equal(get(x, 4), 20000630);
    assert_int_equal(get(x, 4) & ~0x400u, 2); // scanlines, of one part; names may be long
    for (const char* name = getText(x); name[0] != 0; name = getText(x)) {
        getText(x); // type
        const size_t size = (size_t)get(x, 4), end = x->at + size;
        if (strcmp(name, "channels") == 0) {
            getChannels(x);
        } else if (strcmp(name, "compression") == 0) {
            assert_int_equal(x->bytes[x->at], 3); // ZIP
        } else if (strcmp(name, "lineOrder") == 0) {
            assert_int_equal(x->bytes[x->at], 0); // increasing y
        } else if (strcmp(name, "dataWindow") == 0) {
            assert_true(get(x, 4) == 0 && get(x, 4) == 0);
            x->width = (int)get(x, 4) + 1;
            x->height = (int)get(x, 4) + 1;
        }
        x->at = end;
    }
    assert_true(x->width <= MOST_SIDE && x->height <= MOST_SIDE);
}

// Bytes were sorted into even and odd ones, then replaced by their differences.
static void undoPrediction(uint8_t* bytes, size_t size, uint8_t* out)
{
    for (size_t i = 1; i < size; i++) {
        bytes[i] = (uint8_t)(bytes[i - 1] + bytes[i] - 128);
    }
    for (size_t i = 0; i < size; i++) {
        out[i] = bytes[i / 2 + (i % 2 ? (size + 1) / 2 : 0)];
    }
}

static void getChunk(Exr* x, int y)
{
    static uint8_t raw[4 * MOST_CHANNELS * CHUNK_ROWS * MOST_SIDE], sorted[sizeof raw];
    const int rows = x->height - y < CHUNK_ROWS ? x->height - y : CHUNK_ROWS;
    const size_t wanted = (size_t)(4 * x->channelCount * rows * x->width);
    assert_int_equal(get(x, 4), y);
    const size_t size = (size_t)get(x, 4);
    assert_true(size <= wanted && x->at + size <= x->size);
    if (size == wanted) {
        memcpy(raw, x->bytes + x->at, size);
        x->raw++;
    } else {
        assert_int_equal(inflateBytes(x->bytes + x->at, size, sorted, sizeof sorted), (long)wanted);
        undoPrediction(sorted, wanted, raw);
        x->zipped++;
    }
    x->at += size;
    for (size_t i = 0, k = 0; k < wanted; i++, k += 4) { // row by row, in each channel by channel
        const size_t row = i / (size_t)(x->width * x->channelCount),
                     channel = i / (size_t)x->width % (size_t)x->channelCount;
        x->values[channel][((size_t)y + row) * (size_t)x->width + i % (size_t)x->width] =
            (uint32_t)raw[k] | (uint32_t)raw[k + 1] << 8 | (uint32_t)raw[k + 2] << 16 |
            (uint32_t)raw[k + 3] << 24;
    }
}

// Decodes a file whole: chunks lie where the table says, one after the other up to the end.
static void decode(Exr* x, const uint8_t* bytes, size_t size)
{
    x->bytes = bytes;
    x->size = size;
    x->at = 0;
    x->width = x->height = x->channelCount = 0;
    getHeader(x);
    size_t table = x->at;
    x->at += 8 * (size_t)((x->height + CHUNK_ROWS - 1) / CHUNK_ROWS);
    for (int y = 0; y < x->height; y += CHUNK_ROWS, table += 8) {
        const size_t here = x->at;
        x->at = table;
        assert_int_equal(get(x, 8), here);
        x->at = here;
        getChunk(x, y);
    }
    assert_int_equal(x->at, size);
}

static int findChannel(const Exr* x, const char* name)
{
    for (int c = 0; c < x->channelCount; c++) {
        if (strcmp(x->channels[c], name) == 0) {
            return c;
        }
    }
    fail_msg("there is no channel %s", name);
    return 0;
}

static void checkChannel(const Exr* x, const char* name, const vplImage* image, int k, int n)
{
    const int c = findChannel(x, name);
    for (int i = 0; i < image->width * image->height; i++) {
        uint32_t bits = (uint32_t)image->pixels[3 * i + k]; // an index
        if (x->types[c] == 2) {
            memcpy(&bits, &image->pixels[3 * i + k], 4);
        }
        if (bits != x->values[c][i]) {
            fail_msg("picture %d of %dx%d pixels, pixel %d, %s: %08x instead of %08x", n, image->width,
                     image->height, i, name, x->values[c][i], bits);
        }
    }
}

// A picture of a random size whose values have from 0 to 24 random bits, and every fourth picture all 32 but exponents
// of infinities.
static vplImage* rollImage(vplContext* context, int n, int width, int height)
{
    const double levels = ldexp(1, (int)(25 * uniformAt(11, (uint64_t)n)));
    vplImage* image;
    assert_int_equal(vplImage_Create(context, width, height, &image), VPL_SUCCESS);
    for (int k = 0; k < 3 * width * height; k++) {
        const double u = uniformAt(12 + (uint64_t)n, (uint64_t)k);
        const uint32_t bits = (uint32_t)(u * 0x1p32) & 0xbfffffffu; // |x| < 2
        image->pixels[k] = (float)(floor(levels * u) / levels);
        if (n % 4 == 0) {
            memcpy(&image->pixels[k], &bits, 4);
        }
    }
    return image;
}

TEST(ASecondReaderFindsEveryBitThatWasWritten, 1)
{
    enum { PICTURES = 1500 };
    static Exr x;
    x.raw = x.zipped = 0;
    for (int n = 0; n < PICTURES && vplHasExr(); n++) {
        const int most = n % 10 == 0 ? MOST_SIDE : 9, width = 1 + (int)(most * uniformAt(9, (uint64_t)n)),
                  height = 1 + (int)(most * uniformAt(10, (uint64_t)n));
        vplImage* image = rollImage(context, n, width, height);
        vplByteBuffer buffer = {.context = context};
        assert_int_equal(vplEncodeExr(image, NULL, &buffer), VPL_SUCCESS);
        decode(&x, buffer.bytes, buffer.size);
        assert_true(x.width == width && x.height == height && x.channelCount == 3);
        checkChannel(&x, "R", image, 0, n);
        checkChannel(&x, "G", image, 1, n);
        checkChannel(&x, "B", image, 2, n);
        vplFree(context, buffer.bytes);
        vplImage_Destroy(image);
    }
    printf("# %d chunks of ZIP compression, %d raw ones\n", x.zipped, x.raw);
    assert_true(!vplHasExr() || (x.raw > 100 && x.zipped > 100));
}

// A picture, directions, a number and an index in one file.
TEST(ASecondReaderFindsEveryLayer, 1)
{
    static Exr x;
    for (int n = 0; n < 20 && vplHasExr(); n++) {
        vplImage* images[4];
        for (int i = 0; i < 4; i++) {
            images[i] = rollImage(context, 4 * n + i + 1, 5 + n, 37 - n);
        }
        for (int k = 0; k < (5 + n) * (37 - n); k++) {
            images[3]->pixels[3 * k] = (float)(k % 1000);
        }
        const vplLayer layers[4] = {{.name = "", .kind = VPL_LAYER_COLOUR, .image = images[0]},
                                    {.name = "normal", .kind = VPL_LAYER_VECTOR, .image = images[1]},
                                    {.name = "depth", .kind = VPL_LAYER_NUMBER, .image = images[2]},
                                    {.name = "object", .kind = VPL_LAYER_INDEX, .image = images[3]}};
        static const char* const names[8] = {"R",        "G",        "B",     "normal.X",
                                             "normal.Y", "normal.Z", "depth", "object"};
        uint8_t* bytes;
        size_t size;
        assert_int_equal(vplImage_EncodeLayers(layers, 4, &bytes, &size), VPL_SUCCESS);
        decode(&x, bytes, size);
        assert_int_equal(x.channelCount, 8);
        for (int c = 0; c < 8; c++) {
            checkChannel(&x, names[c], images[c < 6 ? c / 3 : c - 4], c < 6 ? c % 3 : 0, n);
        }
        vplBytes_Free(context, bytes);
        for (int i = 0; i < 4; i++) {
            vplImage_Destroy(images[i]);
        }
    }
}
