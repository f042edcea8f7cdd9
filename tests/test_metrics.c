// SPDX-License-Identifier: MIT
// Tests of SSIM, FLIP and heat maps: against other implementations (tests/data/metrics.csv), by exact
// relations, with odd sizes, and refusals.
#include "metric_pairs.h"

static float valueAt(const vplImage* map, int x, int y)
{
    return map->pixels[3 * (y * map->width + x)];
}

// Other implementations agree to 1e-8 for SSIM and to 2e-5 for FLIP. They and we compute FLIP in float: where
// an edge comes from rounding alone, FLIP's square root magnifies it.
TEST(SsimAndFlipAreThoseOfOtherImplementations, 2)
{
    Table t = loadTable("metrics.csv");
    assert_true(t.rows >= 30);
    for (int row = 0; row < t.rows; row++) {
        Pair p = makePair(context, (int)number(&t, row, "pair"), (int)number(&t, row, "width"),
                          (int)number(&t, row, "height"));
        int x = (int)number(&t, row, "px"), y = (int)number(&t, row, "py");
        double ssim, flip;
        vplImage *ssimMap, *flipMap;
        assert_int_equal(vplImage_Ssim(p.a, p.b, &ssim, &ssimMap), VPL_SUCCESS);
        assert_int_equal(vplImage_Flip(p.a, p.b, number(&t, row, "ppd"), &flip, &flipMap), VPL_SUCCESS);
        assertNear(flip, number(&t, row, "flip"), 3e-5, "flip", row);
        assertNear((double)valueAt(flipMap, x, y), number(&t, row, "flip_px"), 1e-4, "flip_px", row);
        if (!isEmpty(&t, row, "ssim")) {
            assertNear(ssim, number(&t, row, "ssim"), 1e-7, "ssim", row);
            assertNear((double)valueAt(ssimMap, x, y), number(&t, row, "ssim_px"), 1e-6, "ssim_px", row);
        }
        vplImage_Destroy(ssimMap);
        vplImage_Destroy(flipMap);
        freePair(p);
    }
    freeTable(&t);
}

TEST(APictureIsEqualToItself, 2)
{
    static const int sizes[][2] = {{64, 48}, {12, 40}, {10, 11}, {3, 2}, {1, 1}, {1, 30}, {30, 1}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        for (int kind = 0; kind < 3; kind++) {
            Pair p = makePair(context, kind, sizes[i][0], sizes[i][1]);
            double ssim, flip;
            vplComparison c;
            assert_int_equal(vplImage_Ssim(p.a, p.a, &ssim, NULL), VPL_SUCCESS);
            assert_int_equal(vplImage_Flip(p.a, p.a, VPL_DEFAULT_PPD, &flip, NULL), VPL_SUCCESS);
            assert_int_equal(vplImage_Compare(p.a, p.a, &c), VPL_SUCCESS);
            assert_true(ssim == 1 && flip == 0 && c.trimmedRelmse == 0 && isinf(c.psnr));
            freePair(p);
        }
    }
}

TEST(SsimAndFlipAreSymmetric, 2)
{
    for (int kind = 0; kind < 3; kind++) {
        Pair p = makePair(context, kind, 40, 30);
        double ssim[2], flip[2];
        assert_int_equal(vplImage_Ssim(p.a, p.b, &ssim[0], NULL), VPL_SUCCESS);
        assert_int_equal(vplImage_Ssim(p.b, p.a, &ssim[1], NULL), VPL_SUCCESS);
        assert_int_equal(vplImage_Flip(p.a, p.b, 40, &flip[0], NULL), VPL_SUCCESS);
        assert_int_equal(vplImage_Flip(p.b, p.a, 40, &flip[1], NULL), VPL_SUCCESS);
        assert_true(ssim[0] == ssim[1] && flip[0] == flip[1]);
        assert_true(ssim[0] < 1 && flip[0] > 0);
        freePair(p);
    }
}

// Two constant pictures have no variance: SSIM is (2 m n + C1) / (m^2 + n^2 + C1) of the encoded values, at
// any size, including sizes below 11 pixels, at which borders are mirrored.
TEST(SsimOfFlatPicturesIsItsLuminanceTerm, 1)
{
    static const int sizes[][2] = {{20, 20}, {11, 5}, {4, 30}, {1, 1}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        vplImage* a = makeFlat(context, sizes[i][0], sizes[i][1], 0.5f, 0.5f, 0.5f);
        vplImage* b = makeFlat(context, sizes[i][0], sizes[i][1], 0.25f, 0.25f, 7.0f);
        const double m = 0.7353569830524495,
                     n = 0.5370987304831942; // sRGB of 0.5 and 0.25; 7 is clamped to 1
        double grey = (2 * m * n + 1e-4) / (m * m + n * n + 1e-4), blue = (2 * m + 1e-4) / (m * m + 1 + 1e-4);
        double ssim;
        assert_int_equal(vplImage_Ssim(a, b, &ssim, NULL), VPL_SUCCESS);
        assertNear(ssim, (2 * grey + blue) / 3, 1e-6, "flat", (int)i);
        vplImage_Destroy(a);
        vplImage_Destroy(b);
    }
}

// A local change has no effect beyond the window's radius, and the mean leaves the borders out.
TEST(SsimSeesWithinItsWindowOnly, 1)
{
    Pair p = makePair(context, 1, 32, 32);
    memcpy(p.a->pixels, p.b->pixels, 3 * 32 * 32 * sizeof(float));
    p.a->pixels[3 * (16 * 32 + 16)] += 0.25f;
    double ssim;
    vplImage* map;
    assert_int_equal(vplImage_Ssim(p.a, p.b, &ssim, &map), VPL_SUCCESS);
    double sum = 0;
    for (int y = 0; y < 32; y++) {
        for (int x = 0; x < 32; x++) {
            bool near = abs(x - 16) <= 5 && abs(y - 16) <= 5;
            assert_true(near ? valueAt(map, x, y) < 1 : valueAt(map, x, y) == 1);
            sum += x >= 5 && x < 27 && y >= 5 && y < 27 ? (double)valueAt(map, x, y) : 0;
        }
    }
    assertNear(ssim, sum / (22 * 22), 1e-7, "mean", 0);
    vplImage_Destroy(map);
    freePair(p);
}

// Green and blue are the two colours with the largest distance, so by definition their colour error is 1;
// away from edges FLIP has no other term. Clamping makes 9 the same as 1.
TEST(FlipOfGreenAndBlueIsOne, 1)
{
    vplImage *green = makeFlat(context, 24, 24, 0, 9, -3), *blue = makeFlat(context, 24, 24, 0, 0, 1);
    double flip;
    assert_int_equal(vplImage_Flip(green, blue, VPL_DEFAULT_PPD, &flip, NULL), VPL_SUCCESS);
    assertNear(flip, 1, 1e-6, "green and blue", 0);
    vplImage_Destroy(green);
    vplImage_Destroy(blue);
    // Black and white differ by 100 in L*. Green is (87.7347, -86.1827, 83.1793) and blue (32.2970, 79.1875,
    // -107.8602) in L*a*b* (Bruce Lindbloom's tables); the Hunt adjustment multiplies a and b by L/100.
    double da = 0.877347 * -86.1827 - 0.322970 * 79.1875, db = 0.877347 * 83.1793 - 0.322970 * -107.8602;
    double largest = pow(87.7347 - 32.2970 + sqrt(da * da + db * db), 0.7), knee = 0.4 * largest;
    double wanted = 0.95 + 0.05 * (pow(100, 0.7) - knee) / (largest - knee);
    vplImage *black = makeFlat(context, 24, 24, 0, 0, 0), *white = makeFlat(context, 24, 24, 1, 1, 1);
    assert_int_equal(vplImage_Flip(black, white, VPL_DEFAULT_PPD, &flip, NULL), VPL_SUCCESS);
    assertNear(flip, wanted, 5e-5, "black and white", 0);
    vplImage_Destroy(black);
    vplImage_Destroy(white);
}

TEST(AFlipMapIsInRangeAndItsMeanIsTheMean, 1)
{
    for (int kind = 0; kind < 3; kind++) {
        Pair p = makePair(context, kind, 37, 23);
        double flip, sum = 0;
        vplImage* map;
        assert_int_equal(vplImage_Flip(p.a, p.b, 50, &flip, &map), VPL_SUCCESS);
        for (int i = 0; i < 37 * 23; i++) {
            const float* v = map->pixels + 3 * i;
            assert_true(v[0] >= 0 && v[0] <= 1 && v[0] == v[1] && v[0] == v[2]);
            sum += (double)v[0];
        }
        assertNear(flip, sum / (37 * 23), 1e-7, "mean", kind);
        vplImage_Destroy(map);
        freePair(p);
    }
}

// FLIP of fine grain decreases with viewing distance.
TEST(FlipOfGrainFallsWithDistance, 2)
{
    Pair p = makePair(context, 0, 48, 48);
    double last = 1, flip;
    for (double ppd = 15; ppd < 300; ppd *= 2) {
        assert_int_equal(vplImage_Flip(p.a, p.b, ppd, &flip, NULL), VPL_SUCCESS);
        assert_true(flip < last);
        last = flip;
    }
    freePair(p);
}

typedef struct Bits {
    uint64_t ssimMap, flipMap, heat[4];
    double ssim, flip;
    vplComparison c;
    vplRegion regions[12];
} Bits;

static Bits measureBits(vplContext* context)
{
    Bits bits;
    memset(&bits, 0, sizeof bits); // padding is compared, too
    Pair p = makePair(context, 2, 61, 43);
    vplImage* map;
    assert_int_equal(vplImage_Ssim(p.a, p.b, &bits.ssim, &map), VPL_SUCCESS);
    bits.ssimMap = vplImage_Hash(map);
    vplImage_Destroy(map);
    assert_int_equal(vplImage_Flip(p.a, p.b, VPL_DEFAULT_PPD, &bits.flip, &map), VPL_SUCCESS);
    bits.flipMap = vplImage_Hash(map);
    vplImage_Destroy(map);
    assert_int_equal(vplImage_Compare(p.a, p.b, &bits.c), VPL_SUCCESS);
    assert_int_equal(vplImage_CompareRegions(p.a, p.b, 4, 3, bits.regions), VPL_SUCCESS);
    for (int of = VPL_HEAT_DIFFERENCE; of <= VPL_HEAT_FLIP; of++) {
        vplHeatmapDef def = vplDefaultHeatmapDef();
        def.of = (vplHeat)of;
        assert_int_equal(vplImage_HeatmapOf(p.a, p.b, &def, &map), VPL_SUCCESS);
        bits.heat[of] = vplImage_Hash(map);
        vplImage_Destroy(map);
    }
    freePair(p);
    return bits;
}

// The expected numbers hold for every compiler, optimisation level and machine.
TEST_ALONE(ThreadsAndMachinesChangeNoBitOfAMetric)
{
    Bits first = {0};
    for (int workers = 1; workers <= 7; workers += workers < 3 ? 1 : 4) {
        vplContext* context = openTestContext(workers);
        Bits bits = measureBits(context);
        closeTestContext(context);
        if (workers == 1) {
            first = bits;
        }
        assert_memory_equal(&bits, &first, sizeof bits);
    }
    assert_true(first.ssim == 0x1.8dad213e1bf79p-1 && first.flip == 0x1.0f998fa0caad7p-2);
    assert_true(first.ssimMap == 0x553dddd38688666b && first.flipMap == 0x95ff114f7dd33966);
}

TEST(HeatMapsShowWhatTheyAreOf, 2)
{
    Pair p = makePair(context, 1, 200, 60);
    memcpy(p.a->pixels, p.b->pixels, (size_t)3 * 200 * 60 * sizeof(float));
    for (int i = 0; i < 3 * 60; i++) { // the top left 20x20 pixels are reversed
        for (int x = 0; i < 3 * 20 && x < 20; x++) {
            p.a->pixels[3 * (i / 3 * 200 + x) + i % 3] = 1 - p.b->pixels[3 * (i / 3 * 200 + x) + i % 3];
        }
    }
    for (int of = VPL_HEAT_DIFFERENCE; of <= VPL_HEAT_FLIP; of++) {
        vplHeatmapDef def = vplDefaultHeatmapDef();
        def.of = (vplHeat)of;
        vplImage* map;
        assert_int_equal(vplImage_HeatmapOf(p.a, p.b, &def, &map), VPL_SUCCESS);
        assert_true(map->width == 200 && map->height == 86); // with the colour bar
        const float *same = map->pixels + 3 * (50 * 200 + 150), *other = map->pixels + 3 * (10 * 200 + 10);
        assert_true(same[0] < 0.002f && same[1] < 0.002f && same[2] < 0.002f);
        assert_true(other[0] + other[1] + other[2] > 0.3f);
        // The right end of the bar has the colour of the largest value.
        const float* end = map->pixels + 3 * (65 * 200 + 199);
        assert_true(of == VPL_HEAT_FLIP ? end[0] > 0.9f && end[2] < 0.6f : end[0] == 1 && end[2] == 1);
        vplImage_Destroy(map);
    }
    freePair(p);
}

// 0.01 beside black and 1 beside 0.99 are differences of 1.
TEST(RelativeDifferencesAreOverOneHundredthMore, 1)
{
    static const float is[4] = {0.01f, 1.99f, 1, 0.5f}, shouldBe[4] = {0, 0.99f, 0, 0};
    Pair p = makePair(context, 0, 4, 1);
    vplImage* map;
    for (int i = 0; i < 12; i++) {
        p.a->pixels[i] = is[i / 3];
        p.b->pixels[i] = shouldBe[i / 3];
    }
    vplHeatmapDef def = vplDefaultHeatmapDef();
    def.of = VPL_HEAT_RELATIVE;
    def.scale = 2;
    assert_int_equal(vplImage_HeatmapOf(p.a, p.b, &def, &map), VPL_SUCCESS);
    for (int c = 0; c < 3; c++) {
        assertNear((double)map->pixels[c], (double)map->pixels[3 + c], 1e-5, "the same colour", c);
    }
    assert_true(fabsf(map->pixels[0] - map->pixels[6]) + fabsf(map->pixels[1] - map->pixels[7]) +
                    fabsf(map->pixels[2] - map->pixels[8]) >
                0.1f); // 100 has another
    vplImage_Destroy(map);
    freePair(p);
}

TEST(BadArgumentsAreRefusedInASentence, 1)
{
    Pair p = makePair(context, 0, 8, 8);
    double mean = -1;
    vplImage* map = NULL;
    vplRegion region;
    static const double ppds[] = {0, 0.99, 1000.5, -5, NAN, INFINITY};
    for (size_t i = 0; i < sizeof ppds / sizeof *ppds; i++) {
        assert_int_equal(vplImage_Flip(p.a, p.b, ppds[i], &mean, &map), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "must be in [1, 1000]"));
    }
    static const int grids[][2] = {{0, 1}, {1, 0}, {9, 1}, {1, 9}, {-1, -1}};
    for (size_t i = 0; i < sizeof grids / sizeof *grids; i++) {
        assert_int_equal(vplImage_CompareRegions(p.a, p.b, grids[i][0], grids[i][1], &region),
                         VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "must be in [1, 8] and [1, 8]"));
    }
    vplHeatmapDef def = vplDefaultHeatmapDef();
    def.of = (vplHeat)4;
    assert_int_equal(vplImage_HeatmapOf(p.a, p.b, &def, &map), VPL_INVALID_ARGUMENT);
    def = vplDefaultHeatmapDef();
    def.scale = NAN;
    assert_int_equal(vplImage_HeatmapOf(p.a, p.b, &def, &map), VPL_INVALID_ARGUMENT);
    def = vplDefaultHeatmapDef();
    def.cookie = 0;
    assert_int_equal(vplImage_HeatmapOf(p.a, p.b, &def, &map), VPL_INVALID_ARGUMENT);
    assert_true(mean == -1 && map == NULL);
    freePair(p);
}

// Every metric refuses a non-finite pixel in either picture and names the pixel.
TEST(PicturesThatAreNotFiniteAreRefused, 1)
{
    static const float bad[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 6; i++) {
        Pair p = makePair(context, 0, 6, 5);
        (i < 3 ? p.a : p.b)->pixels[3 * (2 * 6 + 4) + 1] = bad[i % 3];
        double mean;
        vplImage* map = NULL;
        vplRegion region;
        vplComparison c;
        const char* const name = i < 3 ? "first picture: pixel (4, 2)" : "second picture: pixel (4, 2)";
        for (int metric = 0; metric < 5; metric++) {
            vplResult result = metric == 0   ? vplImage_Compare(p.a, p.b, &c)
                               : metric == 1 ? vplImage_Ssim(p.a, p.b, &mean, &map)
                               : metric == 2 ? vplImage_Flip(p.a, p.b, 60, &mean, &map)
                               : metric == 3 ? vplImage_CompareRegions(p.a, p.b, 1, 1, &region)
                                             : vplImage_HeatmapOf(p.a, p.b, NULL, &map);
            assert_int_equal(result, VPL_INVALID_ARGUMENT);
            assert_non_null(strstr(takeMessage(), name));
            assert_null(map);
        }
        freePair(p);
    }
}

TEST(PicturesOfDifferentSizeAreRefused, 1)
{
    Pair p = makePair(context, 0, 6, 5), q = makePair(context, 0, 5, 6);
    double mean;
    vplRegion region;
    assert_int_equal(vplImage_Ssim(p.a, q.a, &mean, NULL), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplImage_Flip(p.a, q.a, 60, &mean, NULL), VPL_INVALID_ARGUMENT);
    assert_int_equal(vplImage_CompareRegions(p.a, q.a, 1, 1, &region), VPL_INVALID_ARGUMENT);
    assert_non_null(strstr(takeMessage(), "differ in size: 6x5 and 5x6"));
    freePair(p);
    freePair(q);
}

// For extreme values that a renderer may produce, metrics stay finite and in range.
TEST(HugeAndNegativeValuesGiveFiniteMetrics, 1)
{
    Pair p = makePair(context, 2, 20, 20);
    static const float values[] = {3e38f, -3e38f, 1e-42f, -1e-42f, -0.01f, 1e20f, 0, 1};
    for (int i = 0; i < 3 * 400; i++) {
        p.a->pixels[i] = values[noise(1, (uint32_t)i) % 8];
        p.b->pixels[i] = values[noise(2, (uint32_t)i) % 8];
    }
    double ssim, flip;
    vplImage* map;
    vplComparison c;
    assert_int_equal(vplImage_Ssim(p.a, p.b, &ssim, NULL), VPL_SUCCESS);
    assert_int_equal(vplImage_Flip(p.a, p.b, 60, &flip, NULL), VPL_SUCCESS);
    assert_int_equal(vplImage_Compare(p.a, p.b, &c), VPL_SUCCESS);
    assert_true(ssim >= -1 && ssim <= 1 && flip >= 0 && flip <= 1);
    assert_true(isfinite(c.rmse) && isfinite(c.relmse) && isfinite(c.trimmedRelmse));
    for (int of = VPL_HEAT_DIFFERENCE; of <= VPL_HEAT_FLIP; of++) {
        vplHeatmapDef def = vplDefaultHeatmapDef();
        def.of = (vplHeat)of;
        assert_int_equal(vplImage_HeatmapOf(p.a, p.b, &def, &map), VPL_SUCCESS);
        for (int i = 0; i < 3 * 400; i++) {
            assert_true(map->pixels[i] >= 0 && map->pixels[i] <= 1);
        }
        vplImage_Destroy(map);
    }
    freePair(p);
}
