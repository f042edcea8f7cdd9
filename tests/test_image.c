// SPDX-License-Identifier: MIT
// Tests of pictures: files, tone mapping, comparison. Covers extremes X110 and X112.
#include "test.h"

#include "base/context.h"
#include "image/draw.h"
#include "image/srgb.h"

#include <float.h>
#include <math.h>
#include <unistd.h>

static vplImage* makeImage(vplContext* context, int width, int height)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, width, height, &image), VPL_SUCCESS);
    for (int i = 0; i < 3 * width * height; i++) {
        image->pixels[i] = (float)(4 * uniformAt(9, (uint64_t)i) * uniformAt(8, (uint64_t)i));
    }
    return image;
}

// With skipBlack the background does not affect the other pixels; by default it counts, as published.
TEST(ReinhardCanLeaveBlackOut, 1)
{
    float mapped[3] = {0, 0, 0};
    for (int way = 0; way < 3; way++) { // grey alone, with as much black left out, with as much black counted
        vplImage* image;
        assert_int_equal(vplImage_Create(context, way > 0 ? 8 : 4, 2, &image), VPL_SUCCESS);
        for (int y = 0; y < 2; y++) {
            for (int k = 0; k < 12; k++) {
                image->pixels[3 * image->width * y + k] = 2.5f;
            }
        }
        vplReinhardDef def = vplDefaultReinhardDef();
        def.white = INFINITY;
        def.skipBlack = way == 1;
        assert_int_equal(vplToneMap_Reinhard(image, &def), VPL_SUCCESS);
        mapped[way] = image->pixels[0];
        vplImage_Destroy(image);
    }
    assert_true(mapped[1] == mapped[0]);
    assertNear((double)mapped[0], 0.152542, 1e-5, "grey", 0);
    assert_true(mapped[2] > 0.9f);
}

// X110: one bad pixel becomes black, and the others are mapped as if it were not there.
TEST(ReinhardIgnoresPixelsThatAreNotFinite, 1)
{
    const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) {
        vplImage *image = makeImage(context, 4, 4), *without;
        assert_int_equal(vplImage_Create(context, 5, 3, &without), VPL_SUCCESS);
        memcpy(without->pixels, image->pixels, 6 * sizeof(float)); // all but pixel 2
        memcpy(without->pixels + 6, image->pixels + 9, 39 * sizeof(float));
        image->pixels[7] = bad[i];
        assert_int_equal(vplToneMap_Reinhard(image, NULL), VPL_SUCCESS);
        assert_int_equal(vplToneMap_Reinhard(without, NULL), VPL_SUCCESS);
        assert_memory_equal(without->pixels, image->pixels, 6 * sizeof(float));
        assert_memory_equal(without->pixels + 6, image->pixels + 9, 39 * sizeof(float));
        for (int k = 0; k < 48; k++) {
            assert_true(isfinite(image->pixels[k]));
        }
        assert_true(image->pixels[0] > 0 && image->pixels[6] == 0);
        vplImage_Destroy(without);
        vplImage_Destroy(image);
    }
}

TEST(PfmKeepsEveryBit, 1)
{
    vplImage *image = makeImage(context, 13, 7), *back;
    image->pixels[5] = 1e-42f;
    image->pixels[6] = -3e38f;
    const char* path = temporaryName(".pfm");
    assert_int_equal(vplImage_Write(image, path, NULL), VPL_SUCCESS);
    assert_int_equal(vplImage_Read(context, path, &back), VPL_SUCCESS);
    assert_true(vplImage_Hash(image) == vplImage_Hash(back));
    unlink(path);
    vplImage_Destroy(image);
    vplImage_Destroy(back);
}

TEST(APfmFileIsMadeWithoutCopiesOfIt, 1)
{
    vplImage* image = makeImage(context, 256, 200);
    const size_t before = context->bytes, size = sizeof(vplRgb) * 256 * 200;
    context->peakBytes = before;
    const char* path = temporaryName(".pfm");
    assert_int_equal(vplImage_Write(image, path, NULL), VPL_SUCCESS);
    assert_true(context->peakBytes >= before + size && context->peakBytes < before + size + 8192);
    unlink(path);
    vplImage_Destroy(image);
}

TEST(HdrKeepsAPercentAndPngKeepsCodes, 1)
{
    vplImage *image = makeImage(context, 33, 9), *back;
    const char* path = temporaryName(".hdr");
    assert_int_equal(vplImage_Write(image, path, NULL), VPL_SUCCESS);
    assert_int_equal(vplImage_Read(context, path, &back), VPL_SUCCESS);
    for (int i = 0; i < 33 * 9; i++) {
        float largest =
            fmaxf(image->pixels[3 * i], fmaxf(image->pixels[3 * i + 1], image->pixels[3 * i + 2]));
        for (int c = 0; c < 3; c++) { // 8 bits of mantissa, shared exponent, truncated
            assertNear((double)back->pixels[3 * i + c], (double)image->pixels[3 * i + c],
                       0.008 * (double)largest, "hdr", i);
        }
    }
    unlink(path);
    vplImage_Destroy(back);
    path = temporaryName(".png");
    assert_int_equal(vplImage_Write(image, path, NULL), VPL_SUCCESS);
    assert_int_equal(vplImage_Read(context, path, &back), VPL_SUCCESS);
    for (int i = 0; i < 3 * 33 * 9; i++) {
        assert_int_equal(vplSrgb_Code(back->pixels[i]), vplSrgb_Code(image->pixels[i]));
    }
    unlink(path);
    vplImage_Destroy(back);
    vplImage_Destroy(image);
}

TEST(ExposureDoublesPerStop, 1)
{
    vplImage *image = makeImage(context, 5, 5), *back;
    vplWriteOptions options = vplDefaultWriteOptions();
    options.exposure = -2;
    const char* path = temporaryName(".png");
    assert_int_equal(vplImage_Write(image, path, &options), VPL_SUCCESS);
    assert_int_equal(vplImage_Read(context, path, &back), VPL_SUCCESS);
    for (int i = 0; i < 75; i++) {
        assert_int_equal(vplSrgb_Code(back->pixels[i]), vplSrgb_Code(image->pixels[i] / 4));
    }
    options.exposure = NAN;
    assert_int_equal(vplImage_Write(image, path, &options), VPL_INVALID_ARGUMENT);
    unlink(path);
    vplImage_Destroy(back);
    vplImage_Destroy(image);
}

TEST(APictureThatIsNotFiniteIsRefusedByName, 1)
{
    vplImage* image = makeImage(context, 8, 8);
    image->pixels[3 * (8 * 2 + 5) + 1] = NAN;
    const char* path = temporaryName(".pfm");
    assert_int_equal(vplImage_Write(image, path, NULL), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "pixel (5, 2) channel 1"));
    assert_int_equal(access(path, F_OK), -1);
    vplImage_Destroy(image);
}

TEST(MalformedPicturesAreRefused, 1)
{
    const char* const texts[] = {"",
                                 "PF",
                                 "PF\n2 2\n",
                                 "PF\n2 2\n0\n",
                                 "PF\n-1 2\n-1\n",
                                 "PF\n99999 2\n-1\n",
                                 "PF\n2 2\n-1\nabc",
                                 "P6\n2 2\n255\nabcdefabcdef",
                                 "PF\nnan 2\n-1\n"};
    const char* const extensions[] = {".pfm", ".hdr", ".png"};
    for (int e = 0; e < 3; e++) {
        for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
            const char* path = temporaryName(extensions[e]);
            FILE* file = fopen(path, "wb");
            fputs(texts[i], file);
            fclose(file);
            vplImage* image = NULL;
            assert_int_equal(vplImage_Read(context, path, &image), VPL_PARSE_ERROR);
            assert_null(image);
            unlink(path);
        }
    }
    vplImage* image = NULL;
    assert_int_equal(vplImage_Read(context, "/nonexistent/a.pfm", &image), VPL_FILE_ERROR);
    assert_int_equal(vplImage_Read(context, "a.xyz", &image), VPL_INVALID_ARGUMENT);
}

TEST(MetricsAreTheirDefinitions, 1)
{
    vplImage *a, *b;
    assert_int_equal(vplImage_Create(context, 2, 1, &a), VPL_SUCCESS);
    assert_int_equal(vplImage_Create(context, 2, 1, &b), VPL_SUCCESS);
    for (int i = 0; i < 6; i++) {
        a->pixels[i] = 0.5f;
        b->pixels[i] = i < 3 ? 0.5f : 0.25f;
    }
    vplComparison c;
    assert_int_equal(vplImage_Compare(a, b, &c), VPL_SUCCESS);
    assertNear(c.rmse, sqrt(0.0625 / 2), 1e-12, "rmse", 0);
    assertNear(c.relativeRmse, sqrt(0.0625 / 2) / 0.375, 1e-12, "relative", 0);
    assertNear(c.relmse, 0.0625 / (0.26 * 0.26) / 2, 1e-12, "relmse", 0);
    assertNear(c.energyRatio, 3 / 2.25, 1e-12, "energy", 0);
    assertNear(c.maxDifference, 0.25, 0, "max", 0);
    assert_true(c.maxX == 1 && c.maxY == 0);
    double d = 0.7353569830524495 - 0.5370987304831942; // sRGB of 0.5 and 0.25
    assertNear(c.psnr, 10 * log10(2 / (d * d)), 1e-4, "psnr", 0);
    assert_int_equal(vplImage_Compare(a, a, &c), VPL_SUCCESS);
    assert_true(c.rmse == 0 && c.relmse == 0 && isinf(c.psnr) && c.energyRatio == 1 && c.maxDifference == 0);
    vplImage *map = NULL, *other = makeImage(context, 3, 1);
    assert_int_equal(vplImage_Compare(a, other, &c), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplImage_Heatmap(a, b, 0, &map), VPL_SUCCESS);
    assert_true(map->pixels[0] == 0 && map->pixels[3] == 1);
    vplImage_Destroy(map);
    vplImage_Destroy(other);
    vplImage_Destroy(a);
    vplImage_Destroy(b);
}

TEST(HashSeesEveryBitAndTheShape, 1)
{
    vplImage *a = makeImage(context, 6, 4), *b = makeImage(context, 4, 6);
    assert_true(vplImage_Hash(a) != vplImage_Hash(b));
    uint64_t hash = vplImage_Hash(a);
    for (int i = 0; i < 72; i++) {
        uint32_t bits;
        memcpy(&bits, a->pixels + i, 4);
        bits ^= 1;
        memcpy(a->pixels + i, &bits, 4);
        assert_true(vplImage_Hash(a) != hash);
        bits ^= 1;
        memcpy(a->pixels + i, &bits, 4);
    }
    assert_true(vplImage_Hash(a) == hash);
    vplImage_Destroy(a);
    vplImage_Destroy(b);
}

// Tests values around every threshold between codes, and values that are not valid light.
TEST_ALONE(CodesByTableAreThoseOfTheFormula)
{
    vplSrgbTable table;
    vplSrgbTable_Fill(&table);
    float odd[] = {0, -0.0f, -1, NAN, INFINITY, -INFINITY, 1, 2, 1e30f, 1e-30f, 0x1p-13f, 0x1p-14f, FLT_MIN};
    uint8_t code;
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        vplSrgbTable_Encode(&table, &odd[i], 1, &code);
        assert_int_equal(code, vplSrgb_Code(odd[i]));
    }
    for (int k = 0; k < 255; k++) {
        float x = table.next[k] * (1 - 0x1p-18f);
        for (int i = 0; i < 100; i++, x = nextafterf(x, 2)) {
            vplSrgbTable_Encode(&table, &x, 1, &code);
            assert_int_equal(code, vplSrgb_Code(x));
        }
        assert_true(vplSrgb_Code(table.next[k]) == k + 1 && vplSrgb_Code(nextafterf(table.next[k], 0)) == k);
    }
}

static vplRgb greyOf(float t)
{
    return (vplRgb){t, t, t};
}

// Its colours go evenly from that of nothing at the left end to that of the largest value at the right end.
TEST(AColourBarShowsAllColours, 1)
{
    enum { WIDTH = 321 };
    vplImage* image;
    assert_int_equal(vplImage_Create(context, WIDTH, 40, &image), VPL_SUCCESS);
    vplColourBar_Draw(image, 10, 5, greyOf);
    for (int x = 0; x < WIDTH; x++) {
        const float* top = &image->pixels[3 * (12 * WIDTH + x)];
        assert_true(fabsf(top[0] - (float)x / (WIDTH - 1)) < 1e-6f && top[1] == top[0] && top[2] == top[0]);
        assert_true(image->pixels[3 * (11 * WIDTH + x)] == 0);
    }
    vplImage_Destroy(image);
}

TEST(SizesAndFormatsThatThereAreNotAreRefused, 1)
{
    vplImage *image = makeImage(context, 5, 5), *none = NULL;
    uint8_t* bytes = NULL;
    size_t size = 0;
    assert_int_equal(vplImage_Create(context, 0, 5, &none), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "image size is 0x5, each side must be in [1, 16384]"));
    assert_int_equal(vplImage_Encode(image, "a.txt", NULL, &bytes, &size), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "a.txt: unknown picture format"));
    assert_true(none == NULL && bytes == NULL && size == 0);
    vplImage_Destroy(image);
}
