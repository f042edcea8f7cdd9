// SPDX-License-Identifier: MIT
// Tests of EXR pictures: they are written and read back, and the reader also gets files that the tests
// assemble byte by byte from the format's description ("The OpenEXR File Layout"), so that it does not depend
// on our own writer.
#include "test.h"

#include "image/image_file.h"

#include <stdlib.h>
#include <unistd.h>

enum { UINT = 0, HALF = 1, FLOAT = 2 };

// The parameters of an uncompressed EXR file.
typedef struct Recipe {
    const char* channels; // one letter each, in alphabetical order
    int type;
    int x, y, width, height; // data window
    int sampling;
    uint32_t flags;         // of the version field: 0x200 means tiled
    const uint32_t* values; // bits of one value per channel; each pixel adds 0
} Recipe;

typedef struct File {
    uint8_t bytes[8192];
    size_t size;
} File;

static void put(File* f, const void* bytes, size_t size)
{
    assert_true(f->size + size <= sizeof f->bytes);
    memcpy(f->bytes + f->size, bytes, size);
    f->size += size;
}

static void putNumber(File* f, uint64_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) {
        uint8_t byte = (uint8_t)(value >> 8 * i);
        put(f, &byte, 1);
    }
}

static void putAttribute(File* f, const char* name, const char* type, int size)
{
    put(f, name, strlen(name) + 1);
    put(f, type, strlen(type) + 1);
    putNumber(f, (uint64_t)size, 4);
}

static void putWindow(File* f, const char* name, const Recipe* r)
{
    putAttribute(f, name, "box2i", 16);
    putNumber(f, (uint32_t)r->x, 4);
    putNumber(f, (uint32_t)r->y, 4);
    putNumber(f, (uint32_t)(r->x + r->width - 1), 4);
    putNumber(f, (uint32_t)(r->y + r->height - 1), 4);
}

static void putHeader(File* f, const Recipe* r)
{
    putNumber(f, 20000630, 4);
    putNumber(f, 2 | r->flags, 4);
    int count = (int)strlen(r->channels);
    putAttribute(f, "channels", "chlist", 18 * count + 1);
    for (int c = 0; c < count; c++) {
        put(f, (const char[]){r->channels[c], 0}, 2);
        putNumber(f, (uint64_t)r->type, 4);
        putNumber(f, 0, 4);
        putNumber(f, (uint64_t)r->sampling, 4);
        putNumber(f, (uint64_t)r->sampling, 4);
    }
    putNumber(f, 0, 1);
    putAttribute(f, "compression", "compression", 1);
    putNumber(f, 0, 1);
    putWindow(f, "dataWindow", r);
    putWindow(f, "displayWindow", r);
    putAttribute(f, "lineOrder", "lineOrder", 1);
    putNumber(f, 0, 1);
    putAttribute(f, "pixelAspectRatio", "float", 4);
    putNumber(f, 0x3f800000, 4);
    putAttribute(f, "screenWindowCenter", "v2f", 8);
    putNumber(f, 0, 8);
    putAttribute(f, "screenWindowWidth", "float", 4);
    putNumber(f, 0x3f800000, 4);
    if (r->flags & 0x200) {
        putAttribute(f, "tiles", "tiledesc", 9);
        putNumber(f, 16, 4);
        putNumber(f, 16, 4);
        putNumber(f, 0, 1);
    }
    putNumber(f, 0, 1);
}

static File build(Recipe r)
{
    File f = {.size = 0};
    putHeader(&f, &r);
    size_t bytes = r.type == HALF ? 2 : 4, channels = strlen(r.channels);
    size_t line = bytes * channels * (size_t)r.width, first = f.size + 8 * (size_t)r.height;
    for (size_t y = 0; y < (size_t)r.height; y++) {
        putNumber(&f, first + y * (8 + line), 8);
    }
    for (int y = 0; y < r.height; y++) {
        putNumber(&f, (uint32_t)(r.y + y), 4);
        putNumber(&f, line, 4);
        for (size_t i = 0; i < channels * (size_t)r.width; i++) {
            putNumber(&f, r.values[i / (size_t)r.width], (int)bytes);
        }
    }
    return f;
}

static vplResult readBytes(vplContext* context, const uint8_t* bytes, size_t size, vplImage** imageOut)
{
    const char* path = temporaryName(".exr");
    FILE* file = fopen(path, "wb");
    assert_true(file != NULL && fwrite(bytes, 1, size, file) == size);
    fclose(file);
    vplResult result = vplImage_Read(context, path, imageOut);
    unlink(path);
    return result;
}

static bool hasExr(void)
{
    return vplImage_CanWrite("a.exr");
}

static const uint32_t ONES[4] = {0x3f800000, 0x3f800000, 0x3f800000, 0x3f800000};

// Without OpenEXR, reading and writing are refused with a message, and no file is written.
TEST(WithoutOpenExrASentenceSaysSo, 1)
{
    vplImage *image = NULL, *back = NULL;
    File f = build((Recipe){"BGR", FLOAT, 0, 0, 2, 2, 1, 0, ONES});
    vplResult read = readBytes(context, f.bytes, f.size, &back);
    if (!hasExr()) {
        assert_int_equal(read, VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "no OpenEXR"));
        assert_int_equal(vplImage_Create(context, 2, 2, &image), VPL_SUCCESS);
        assert_int_equal(vplImage_Write(image, temporaryName(".exr"), NULL), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "no OpenEXR"));
        assert_int_equal(access(temporaryName(".exr"), F_OK), -1);
    } else {
        assert_int_equal(read, VPL_SUCCESS);
        assert_non_null(strstr(vplImage_GetExtensions(), ".exr"));
    }
    vplImage_Destroy(image);
    vplImage_Destroy(back);
}

// The sizes surround 16 rows, the chunk height of ZIP compression.
TEST(ExrKeepsEveryBit, 1)
{
    static const int sizes[][2] = {{1, 1}, {13, 7}, {5, 16}, {40, 17}, {3, 100}, {200, 33}};
    for (size_t i = 0; hasExr() && i < sizeof sizes / sizeof *sizes; i++) {
        vplImage *image, *back;
        assert_int_equal(vplImage_Create(context, sizes[i][0], sizes[i][1], &image), VPL_SUCCESS);
        for (int k = 0; k < 3 * sizes[i][0] * sizes[i][1]; k++) {
            image->pixels[k] = (float)(8 * uniformAt(5, (uint64_t)k) - 1);
        }
        image->pixels[0] = 1e-42f;
        image->pixels[1] = -3e38f;
        image->pixels[2] = -0.0f;
        assert_int_equal(vplImage_Write(image, temporaryName(".exr"), NULL), VPL_SUCCESS);
        assert_int_equal(vplImage_Read(context, temporaryName(".exr"), &back), VPL_SUCCESS);
        assert_true(vplImage_Hash(image) == vplImage_Hash(back));
        unlink(temporaryName(".exr"));
        vplImage_Destroy(image);
        vplImage_Destroy(back);
    }
}

// Sizes up to 7 x 7 and values with few digits, so that many a chunk has as many bytes compressed as raw.
static void assertRandomPicturesComeBack(vplContext* context, int first, int count)
{
    for (int n = first; hasExr() && n < first + count; n++) {
        const int width = 1 + (int)(7 * uniformAt(1, (uint64_t)n)),
                  height = 1 + (int)(7 * uniformAt(2, (uint64_t)n));
        const double levels = ldexp(1, (int)(25 * uniformAt(3, (uint64_t)n)));
        vplByteBuffer buffer = {.context = context};
        vplImage *image, *back;
        assert_int_equal(vplImage_Create(context, width, height, &image), VPL_SUCCESS);
        for (int k = 0; k < 3 * width * height; k++) {
            image->pixels[k] = (float)(floor(levels * uniformAt(4 + (uint64_t)n, (uint64_t)k)) / levels);
        }
        assert_int_equal(vplEncodeExr(image, NULL, &buffer), VPL_SUCCESS);
        assert_int_equal(vplDecodeExr(context, "memory", buffer.bytes, buffer.size, &back), VPL_SUCCESS);
        if (vplImage_Hash(image) != vplImage_Hash(back)) {
            fail_msg("random picture %d of %dx%d pixels is not what was written", n, width, height);
        }
        vplFree(context, buffer.bytes);
        vplImage_Destroy(image);
        vplImage_Destroy(back);
    }
}

TEST(RandomPicturesComeBackWithEveryBit, 1)
{
    assertRandomPicturesComeBack(context, 0, 5000);
}

TEST(ManyRandomPicturesComeBackWithEveryBit, 1, SLOW)
{
    assertRandomPicturesComeBack(context, 5000, 95000);
}

static void assertPixels(const vplImage* image, float r, float g, float b)
{
    for (int i = 0; i < image->width * image->height; i++) {
        const float* p = image->pixels + 3 * i;
        if (!(p[0] == r && p[1] == g && p[2] == b)) {
            fail_msg("pixel %d is (%g, %g, %g)", i, (double)p[0], (double)p[1], (double)p[2]);
        }
    }
}

TEST(HalfFloatGreyAndFurtherChannelsAreRead, 1)
{
    static const uint32_t halves[] = {0x3800, 0xC000, 0x7BFF}, tiny[] = {0x0001, 0x8000, 0x3C00};
    static const uint32_t floats[] = {0x3f000000, 0xc0000000, 0x42280000}; // 0.5, -2, 42
    static const uint32_t more[] = {0x3e800000, 0x3f000000, 0xc0000000, 0x42280000, 0x7f800000};
    static const struct {
        Recipe recipe;
        float r, g, b;
    } cases[] = {
        {{"BGR", HALF, 0, 0, 5, 3, 1, 0, halves}, 65504, -2, 0.5f},
        {{"BGR", HALF, 0, 0, 5, 3, 1, 0, tiny}, 1, 0, 0x1p-24f},
        {{"BGR", FLOAT, 0, 0, 7, 4, 1, 0, floats}, 42, -2, 0.5f},
        {{"BGR", FLOAT, -3, -20, 7, 4, 1, 0, floats}, 42, -2, 0.5f}, // the data window may start anywhere
        {{"ABGRZ", FLOAT, 10, 100, 1, 9, 1, 0, more}, 42, -2, 0.5f}, // alpha and depth are ignored
        {{"Y", HALF, 0, 0, 6, 2, 1, 0, halves}, 0.5f, 0.5f, 0.5f},
        {{"AY", FLOAT, 0, 0, 6, 2, 1, 0, more}, 0.5f, 0.5f, 0.5f},
    };
    for (size_t i = 0; hasExr() && i < sizeof cases / sizeof *cases; i++) {
        File f = build(cases[i].recipe);
        vplImage* image;
        assert_int_equal(readBytes(context, f.bytes, f.size, &image), VPL_SUCCESS);
        assert_true(image->width == cases[i].recipe.width && image->height == cases[i].recipe.height);
        assertPixels(image, cases[i].r, cases[i].g, cases[i].b);
        vplImage_Destroy(image);
    }
}

TEST(OtherKindsAreRefusedInASentence, 1)
{
    static const struct {
        Recipe recipe;
        const char* text;
    } cases[] = {
        {{"BGR", UINT, 0, 0, 4, 4, 1, 0, ONES}, "channels are integers or subsampled"},
        {{"BGR", FLOAT, 0, 0, 4, 4, 2, 0, ONES}, "channels are integers or subsampled"},
        {{"BG", FLOAT, 0, 0, 4, 4, 1, 0, ONES}, "must be R, G and B, or Y"},
        {{"Z", FLOAT, 0, 0, 4, 4, 1, 0, ONES}, "must be R, G and B, or Y"},
        {{"RY", FLOAT, 0, 0, 4, 4, 1, 0, ONES}, "must be R, G and B, or Y"},
        {{"BGR", FLOAT, 0, 0, 16, 16, 1, 0x200, ONES}, "tiled or deep"},
        {{"BGR", FLOAT, 0, 0, 4, 4, 1, 0x1000, ONES}, "EXR picture"}, // claims to have several parts
    };
    for (size_t i = 0; hasExr() && i < sizeof cases / sizeof *cases; i++) {
        File f = build(cases[i].recipe);
        vplImage* image = NULL;
        assert_int_equal(readBytes(context, f.bytes, f.size, &image), VPL_PARSE_ERROR);
        const char* message = takeMessage();
        if (strstr(message, cases[i].text) == NULL) {
            fail_msg("case %zu: \"%s\" lacks \"%s\"", i, message, cases[i].text);
        }
        assert_null(image);
    }
}

// A header that requests more than 16384 pixels per side is refused.
TEST(TooLargePicturesAreRefused, 1)
{
    File f = build((Recipe){"BGR", FLOAT, 0, 0, 4, 4, 1, 0, ONES});
    for (size_t i = 0; hasExr() && i + 20 < f.size; i++) {
        if (memcmp(f.bytes + i, "box2i", 6) == 0) {
            f.bytes[i + 10 + 8 + 2] = 1; // width 4 + 65536
        }
    }
    vplImage* image = NULL;
    vplResult result = readBytes(context, f.bytes, f.size, &image);
    assert_int_equal(result, hasExr() ? VPL_PARSE_ERROR : VPL_INVALID_ARGUMENT);
    assert_true(image == NULL && takeMessage()[0] != 0);
}

TEST(AFileThatEndsEarlyIsRefusedAtEveryLength, 1)
{
    static const uint32_t halves[] = {0x3800, 0xC000, 0x7BFF};
    File f = build((Recipe){"BGR", HALF, 0, 0, 5, 3, 1, 0, halves});
    for (size_t size = 0; hasExr() && size < f.size; size++) {
        vplImage* image = NULL;
        assert_int_equal(readBytes(context, f.bytes, size, &image), VPL_PARSE_ERROR);
        assert_true(image == NULL && takeMessage()[0] != 0);
    }
}

TEST(AnExrThatIsNotFiniteIsNotWritten, 1)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, 8, 8, &image), VPL_SUCCESS);
    image->pixels[3 * (8 * 2 + 5) + 1] = NAN;
    assert_int_equal(vplImage_Write(image, temporaryName(".exr"), NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), hasExr() ? "pixel (5, 2) channel 1" : "no OpenEXR"));
    assert_int_equal(access(temporaryName(".exr"), F_OK), -1);
    vplImage_Destroy(image);
}
