// SPDX-License-Identifier: MIT
// Tests of exposure and tone maps, but for Reinhard's, which are in test_tone_tables.c and test_image.c. Covers
// extremes X109 to X111.
#include "test.h"

#include <float.h>
#include <math.h>

typedef void ToneMap(vplImage* image);

static ToneMap* const MAPS[] = {vplToneMap_Aces, vplToneMap_Agx};

static vplImage* makeImage(vplContext* context, int width, int height, float grey)
{
    vplImage* image;
    assert_int_equal(vplImage_Create(context, width, height, &image), VPL_SUCCESS);
    for (int i = 0; i < 3 * width * height; i++) {
        image->pixels[i] = grey;
    }
    return image;
}

// Greys from 2^-30 to 2^30 by eighths of a stop, then light of all colours.
static vplImage* makeColours(vplContext* context)
{
    vplImage* image = makeImage(context, 481, 40, 0);
    for (int i = 0; i < 3 * 481 * 40; i++) {
        image->pixels[i] = i < 3 * 481 ? exp2f((float)(i / 3) / 8 - 30)
                                       : exp2f((float)(24 * uniformAt(5, (uint64_t)i) - 14));
    }
    return image;
}

static float autoExposure(const vplImage* image)
{
    float stops = NAN;
    assert_int_equal(vplImage_AutoExposure(image, &stops), VPL_SUCCESS);
    return stops;
}

// ---- tone maps

TEST(ToneMapsAreThoseOfTheTable, 1)
{
    static const char* const names[3][3] = {
        {"r", "g", "b"}, {"aces_r", "aces_g", "aces_b"}, {"agx_r", "agx_g", "agx_b"}};
    Table t = loadTable("tone_maps.csv");
    for (int map = 0; map < 2; map++) {
        vplImage* image = makeImage(context, t.rows, 1, 0);
        for (int i = 0; i < 3 * t.rows; i++) {
            image->pixels[i] = (float)number(&t, i / 3, names[0][i % 3]);
        }
        MAPS[map](image);
        for (int i = 0; i < 3 * t.rows; i++) {
            const float found = map == 0 ? image->pixels[i] : vplSrgb_Encode(image->pixels[i]);
            const char* name = names[1 + map][i % 3];
            assertNear((double)found, number(&t, i / 3, name), map == 0 ? 1e-6 : 4e-5, name, i / 3);
        }
        vplImage_Destroy(image);
    }
    freeTable(&t);
}

// AgX's matrices add 1.4e-4 and -1.7e-4 to 1 in the rows of red, so grey is not exactly the curve.
TEST(AgxOfGreyIsThePublishedCurve, 1)
{
    Table t = loadTable("agx_contrast.csv");
    for (int row = 0; row < t.rows; row++) {
        const double stops = number(&t, row, "index") / 4095 * 16.5 - 10;
        vplImage* image = makeImage(context, 1, 1, (float)(0.18 * exp2(stops)));
        vplToneMap_Agx(image);
        for (int c = 0; c < 3; c++) {
            assertNear((double)vplSrgb_Encode(image->pixels[c]), number(&t, row, "code"), 3e-4, "code", row);
        }
        vplImage_Destroy(image);
    }
    freeTable(&t);
}

TEST(ToneMapsOfGreyAreMonotoneFromBlackToWhite, 1)
{
    for (int map = 0; map < 2; map++) {
        vplImage* image = makeColours(context);
        MAPS[map](image);
        for (int i = 3; i < 3 * 481; i++) {
            assert_true(image->pixels[i] >= image->pixels[i - 3]);
        }
        for (int c = 0; c < 3; c++) {
            assert_true(image->pixels[c] == 0 && vplSrgb_Code(image->pixels[3 * 480 + c]) == 255);
        }
        vplImage_Destroy(image);
    }
}

TEST(ToneMapsKeepMiddleGrey, 1)
{
    for (int map = 0; map < 2; map++) {
        vplImage* image = makeImage(context, 1, 1, 0.18f);
        MAPS[map](image);
        assertNear((double)image->pixels[1], 0.2135, 0.001, "grey", map);
        vplImage_Destroy(image);
    }
}

// X109 to X111
TEST(ToneMapsGiveValuesOfAScreenForAnyInput, 1)
{
    const float odd[] = {0,      -0.0f,   -1,       1e30f,     FLT_MAX, -FLT_MAX,
                         1e-45f, FLT_MIN, INFINITY, -INFINITY, NAN,     1};
    enum { ODD = sizeof odd / sizeof *odd };
    for (int map = 0; map < 2; map++) {
        vplImage* image = makeImage(context, ODD * ODD, ODD, 0);
        for (int i = 0; i < ODD * ODD * ODD; i++) {
            image->pixels[3 * i] = odd[i % ODD];
            image->pixels[3 * i + 1] = odd[i / ODD % ODD];
            image->pixels[3 * i + 2] = odd[i / ODD / ODD];
        }
        MAPS[map](image);
        for (int i = 0; i < 3 * ODD * ODD * ODD; i++) {
            assert_true(image->pixels[i] >= 0 && image->pixels[i] <= 1); // not NaN
        }
        vplImage_Destroy(image);
    }
}

// A clipped lamp of one colour stays that colour however bright; these maps turn it pale, and a dim one not.
TEST(BrightSaturatedLightTurnsPale, 1)
{
    for (int map = 0; map < 2; map++) {
        vplImage* image = makeImage(context, 3, 1, 0);
        image->pixels[0] = 0.1f;
        image->pixels[3] = 3;
        image->pixels[6] = 1000;
        MAPS[map](image);
        float last = 0;
        for (int i = 0; i < 3; i++) {
            const float* p = image->pixels + 3 * i;
            const float saturation = p[1] / p[0]; // 0 for pure red, 1 for white
            assert_true(saturation >= last && saturation < 1.001f && p[2] < 1.001f * p[0]);
            last = saturation;
        }
        assert_true(image->pixels[1] < 0.2f * image->pixels[0] && last > 0.85f);
        vplImage_Destroy(image);
    }
}

static uint64_t hashOfMaps(vplContext* context)
{
    uint64_t hash = 0;
    for (int map = 0; map < 2; map++) {
        vplImage* image = makeColours(context);
        const float stops = autoExposure(image);
        MAPS[map](image);
        hash = 31 * hash + vplImage_Hash(image) + (uint64_t)(stops * 0x1p20f);
        vplImage_Destroy(image);
    }
    closeTestContext(context);
    return hash;
}

TEST_ALONE(ExposureAndToneMapsAreTheSameEverywhere)
{
    assertSameEverywhere(hashOfMaps);
}

// ---- automatic exposure

TEST(AutomaticExposureMakesGreyMiddleGrey, 1)
{
    static const float greys[] = {0.18f, 0.09f, 1, 7e-9f, 3e12f};
    for (int i = 0; i < 5; i++) {
        for (int size = 1; size <= 40; size += 39) {
            vplImage* image = makeImage(context, size, size, greys[i]);
            assertNear((double)autoExposure(image), log2(0.18 / (double)greys[i]), 1.0 / 128, "stops", i);
            vplImage_Destroy(image);
        }
    }
}

TEST(AutomaticExposureFollowsTheLight, 1)
{
    vplImage* image = makeImage(context, 30, 20, 0);
    for (int i = 0; i < 3 * 600; i++) {
        image->pixels[i] = (float)uniformAt(3, (uint64_t)i);
    }
    const float stops = autoExposure(image);
    for (int i = 0; i < 3 * 600; i++) {
        image->pixels[i] *= 8;
    }
    assertNear((double)autoExposure(image), (double)stops - 3, 1e-5, "stops", 0);
    vplImage_Destroy(image);
}

// A black or very dark background, a small lamp, corners without light and bad pixels do not change the
// exposure.
TEST(AutomaticExposureLeavesOutBackgroundLampsAndCorners, 1)
{
    static const float others[] = {0, -1, NAN, INFINITY, 1e-6f, 1e30f, 1e-30f};
    for (int i = 0; i < 7; i++) {
        vplImage* image = makeImage(context, 100, 10, 0.02f);
        const int rows = i < 5 ? 9 : 0, columns = i < 5 ? 0 : i == 5 ? 1 : 4; // 90 % of the picture, 1 %, 4 %
        for (int p = 0; p < 1000; p++) {
            for (int c = 0; c < 3 && (p / 100 < rows || p % 100 < columns); c++) {
                image->pixels[3 * p + c] = others[i];
            }
        }
        assertNear((double)autoExposure(image), log2(0.18 / 0.02), 1.0 / 128, "stops", i);
        vplImage_Destroy(image);
    }
}

// 4 % of the picture are sunlit: they become 8, if two stops are enough for it.
TEST(AutomaticExposureSparesLargeHighlights, 1)
{
    static const float suns[] = {0.1f, 1, 2, 1e30f};
    static const double less[] = {0, 0.169925, 1.169925, 2}; // 0.18 / 0.02 = 9 times sun is 0.9, 9, 18
    for (int i = 0; i < 4; i++) {
        vplImage* image = makeImage(context, 100, 10, 0.02f);
        for (int p = 0; p < 1000; p++) {
            for (int c = 0; c < 3 && p % 100 < 4; c++) {
                image->pixels[3 * p + c] = suns[i];
            }
        }
        assertNear((double)autoExposure(image), log2(0.18 / 0.02) - less[i], 1.0 / 64, "stops", i);
        vplImage_Destroy(image);
    }
}

TEST(AutomaticExposureIsBetweenItsLimits, 1)
{
    static const float greys[] = {0, -2, 1e-45f, FLT_MAX, NAN};
    static const float wanted[] = {0, 0, 64, -64, 0};
    for (int i = 0; i < 5; i++) {
        vplImage* image = makeImage(context, 3, 2, greys[i]);
        assert_true(autoExposure(image) == wanted[i]);
        vplImage_Destroy(image);
    }
}

// ---- files

static void assertSamePng(const vplImage* image, const vplWriteOptions* a, const vplWriteOptions* b)
{
    uint8_t *bytesA, *bytesB;
    size_t sizeA, sizeB;
    assert_int_equal(vplImage_Encode(image, ".png", a, &bytesA, &sizeA), VPL_SUCCESS);
    assert_int_equal(vplImage_Encode(image, ".png", b, &bytesB, &sizeB), VPL_SUCCESS);
    assert_true(sizeA == sizeB && memcmp(bytesA, bytesB, sizeA) == 0);
    vplBytes_Free(image->context, bytesA);
    vplBytes_Free(image->context, bytesB);
}

TEST(AFileOfAutomaticExposureHasTheOneFound, 1)
{
    vplImage* image = makeColours(context);
    for (int map = VPL_TONEMAP_NONE; map <= VPL_TONEMAP_AGX; map++) {
        vplWriteOptions automatic = vplDefaultWriteOptions(), found = automatic;
        automatic.tonemap = found.tonemap = (vplToneMap)map;
        automatic.exposure = VPL_EXPOSURE_AUTO;
        found.exposure = map == VPL_TONEMAP_REINHARD ? 0 : autoExposure(image); // it has its own key
        assertSamePng(image, &automatic, &found);
    }
    vplImage_Destroy(image);
}

TEST(OptionsOfFilesOutOfRangeAreRefused, 1)
{
    vplImage* image = makeImage(context, 1, 1, 1);
    uint8_t* bytes;
    size_t size;
    vplWriteOptions options = vplDefaultWriteOptions();
    assert_true(options.exposure == 0 && options.tonemap == VPL_TONEMAP_NONE);
    options.exposure = 65;
    assert_int_equal(vplImage_Encode(image, ".png", &options, &bytes, &size), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "exposure is 65, must be in [-64, 64] or VPL_EXPOSURE_AUTO"));
    options = vplDefaultWriteOptions();
    options.tonemap = (vplToneMap)4;
    assert_int_equal(vplImage_Encode(image, ".png", &options, &bytes, &size), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "tonemap is 4"));
    vplImage_Destroy(image);
}
