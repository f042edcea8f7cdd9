// SPDX-License-Identifier: MIT
// Tests of sRGB codes and of Reinhard's tone map against tables of exact answers. Covers extremes X109 to X111.
#include "test.h"

#include "image/tone.h"

#include <stdlib.h>

#define UNIT 0x1p-24 // of float's rounding

TEST_ALONE(EverySrgbCodeOfTheTable)
{
    Table t = loadTable("srgb_codes.csv");
    int thresholds = 0;
    for (int row = 0; row < t.rows; row++) {
        const int code = (int)number(&t, row, "code");
        const double linear = number(&t, row, "linear");
        // The code is rounded once, which counts up to 2.3 times in the power, and so is the result.
        assertNear((double)vplSrgb_Decode((float)code / 255.0f), linear, 3.3 * UNIT * linear, "decode", row);
        if (!isEmpty(&t, row, "encode_threshold")) {
            const float threshold = (float)number(&t, row, "encode_threshold");
            assert_int_equal(vplSrgb_Code(threshold * (1 + 2e-7f)), code);
            assert_int_equal(vplSrgb_Code(threshold * (1 - 2e-7f)), code - 1);
            thresholds++;
        }
    }
    assert_int_equal(t.rows, 256);
    assert_int_equal(thresholds, 255);
    freeTable(&t);
}

// Compares the code; one row lies 2e-8 below the threshold of its next, closer than a float can represent.
static int compareCode(const Table* t, int row)
{
    const float linear = (float)number(t, row, "linear");
    const double scaled = 255 * number(t, row, "encoded_clamped");
    const int code = (int)number(t, row, "code8");
    if (fabs(scaled - floor(scaled) - 0.5) > 255 * UNIT) {
        assert_int_equal(vplSrgb_Code(linear), code);
        return 0;
    }
    assert_int_equal(vplSrgb_Code(nextafterf(linear, 0)), code);
    assert_int_equal(vplSrgb_Code(nextafterf(linear, 1)), code + 1);
    return 1;
}

// X111. encoded_unclamped is encoded_clamped up to 1, and empty below 0. Beyond 1 it is what the library does not offer, because
// it clamps: two rows.
TEST_ALONE(EverySrgbValueOfTheTable)
{
    Table t = loadTable("srgb_values.csv");
    const int last = t.rows - 1; // where the branches meet the code falls by so much
    const double above = (double)vplSrgb_Encode(nextafterf(0.0031308f, 1)),
                 below = (double)vplSrgb_Encode(nextafterf(0.0031308f, 0)),
                 jump = number(&t, last, "encoded_clamped");
    int near = 0, unclamped = 0, beyond = 0;
    // Two roundings, and the growth of the code over two floats.
    assertNear(above - below, jump + 12.92 * 2 * 0x1p-32, 2 * UNIT * above, "jump", last);
    for (int row = 0; row < last; row++) {
        const double linear = number(&t, row, "linear"), wanted = number(&t, row, "encoded_clamped");
        const float rounded = (float)linear;
        // The value is rounded and so is its code, which grows no faster than in proportion. Rounding may cross the jump.
        const bool crosses = (linear <= 0.0031308) != ((double)rounded <= 0.0031308);
        assertNear((double)vplSrgb_Encode(rounded), wanted + (crosses ? jump : 0), 2 * UNIT * wanted,
                   "encode", row);
        near += compareCode(&t, row);
        if (!isEmpty(&t, row, "encoded_unclamped")) {
            const double value = number(&t, row, "encoded_unclamped");
            assertNear(wanted, fmin(value, 1), 0, "unclamped", row);
            unclamped += value <= 1;
            beyond += value > 1;
        }
    }
    assert_int_equal(t.rows, 17);
    assert_int_equal(near, 1);
    assert_int_equal(unclamped, 13);
    assert_int_equal(beyond, 2);
    freeTable(&t);
}

// X111
TEST_ALONE(SrgbCodesAreMonotoneAndDefinedEverywhere)
{
    int last = 0;
    for (int i = 0; i <= 100000; i++) {
        int code = vplSrgb_Code((float)i / 100000.0f);
        assert_true(code >= last);
        last = code;
    }
    assert_int_equal(last, 255);
    assert_int_equal(vplSrgb_Code(NAN), 0);
    assert_int_equal(vplSrgb_Code(-INFINITY), 0);
    assert_int_equal(vplSrgb_Code(INFINITY), 255);
}

static int parseList(const char* text, double* out)
{
    int count = 0;
    while (*text) {
        char* end;
        out[count++] = strtod(text, &end);
        text = *end == ' ' ? end + 1 : end;
    }
    return count;
}

// X110
// The column log_average is not to be seen by itself; it scales the luminances of both others.
TEST(ReinhardIsThatOfTheTable, 1)
{
    Table t = loadTable("reinhard.csv");
    for (int row = 0; row < t.rows; row++) {
        double in[8], simple[8], white[8];
        int count = parseList(cell(&t, row, "luminances"), in);
        for (int kind = 0; kind < 2; kind++) {
            const char* column = kind ? "Ld_white=max" : "Ld_simple";
            // If the geometric mean is 0, the formula divides by 0: the table's cell is empty, black stays
            // black and all results are finite (X109).
            bool defined =
                !isEmpty(&t, row, column) && parseList(cell(&t, row, column), kind ? white : simple) == count;
            vplImage* image;
            assert_int_equal(vplImage_Create(context, count, 1, &image), VPL_SUCCESS);
            for (int i = 0; i < 3 * count; i++) {
                image->pixels[i] = (float)in[i / 3];
            }
            vplReinhardDef def = vplDefaultReinhardDef();
            def.delta = (float)number(&t, row, "delta");
            def.white = kind ? 0 : INFINITY;
            assert_int_equal(vplToneMap_Reinhard(image, &def), VPL_SUCCESS);
            for (int i = 0; i < 3 * count; i++) {
                assert_true(isfinite(image->pixels[i]) && (in[i / 3] != 0 || image->pixels[i] == 0));
                if (defined) {
                    double wanted = kind ? white[i / 3] : simple[i / 3];
                    assertNear((double)image->pixels[i], wanted, 3e-6 * wanted + 1e-30, column, row);
                }
            }
            vplImage_Destroy(image);
        }
    }
    assert_int_equal(t.rows, 16);
    freeTable(&t);
}

// Compares the luminance that the row starts from, and that of the mapped pixel: Ld.
static void compareLuminances(const Table* t, int row, const float source[3], const float mapped[3])
{
    const double y = number(t, row, "Y_709"), ld = number(t, row, "Ld");
    assertNear(vplLuminance(source), y, 1e-15 * y, "Y_709", row);
    assertNear(vplLuminance(mapped), ld, 2.5 * UNIT * ld, "Ld", row);
}

// Errors: the key and the result are rounded to float, and so is the second pixel, which counts by half.
TEST(ReinhardKeepsChromaticityAsInTheTable, 1)
{
    Table t = loadTable("reinhard_rgb.csv");
    for (int row = 0; row < t.rows; row++) {
        // A second pixel, grey, gives the geometric mean that the row asks for; black is left out of it.
        const double mean = 0.18 / number(&t, row, "a_over_Lavg"), own = number(&t, row, "Y_709");
        vplImage* image;
        assert_int_equal(vplImage_Create(context, 2, 1, &image), VPL_SUCCESS);
        const char* const names[2][3] = {{"r", "g", "b"}, {"out_r", "out_g", "out_b"}};
        float source[3];
        for (int c = 0; c < 3; c++) {
            image->pixels[c] = source[c] = (float)number(&t, row, names[0][c]);
            image->pixels[3 + c] = (float)(own > 0 ? mean / own * mean : mean);
        }
        vplReinhardDef def = vplDefaultReinhardDef();
        def.delta = 0;
        def.key = 0.18f;
        def.white = INFINITY;
        def.skipBlack = true;
        assert_int_equal(vplToneMap_Reinhard(image, &def), VPL_SUCCESS);
        compareLuminances(&t, row, source, image->pixels);
        for (int c = 0; c < 3; c++) {
            const double wanted = number(&t, row, names[1][c]);
            assertNear((double)image->pixels[c], wanted, 2.5 * UNIT * wanted, names[1][c], row);
        }
        vplImage_Destroy(image);
    }
    assert_int_equal(t.rows, 21);
    freeTable(&t);
}
