// SPDX-License-Identifier: MIT
// Tests of trimmed relMSE, and of regions of pictures.
#include "metric_pairs.h"

static int compareDoubles(const void* a, const void* b)
{
    double x = *(const double*)a, y = *(const double*)b;
    return (x > y) - (x < y);
}

// Compares with sorting, for sizes around multiples of a thousand, with ties and with fireflies.
TEST(TrimmedRelmseLeavesOutTheLargestThousandth, 1)
{
    static const int widths[] = {1, 999, 1000, 1001, 1999, 2000, 7777, 12000};
    for (size_t i = 0; i < sizeof widths / sizeof *widths; i++) {
        int n = widths[i];
        Pair p = makePair(context, 2, n, 1);
        double* values = calloc((size_t)n, sizeof *values);
        for (int x = 0; x < n; x++) {
            float firefly = x % 997 == 3 ? 1e18f : x % 7 == 0 ? 2.0f : 0;
            for (int c = 0; c < 3; c++) {
                float* a = &p.a->pixels[3 * x + c];
                *a += firefly;
                double b = p.b->pixels[3 * x + c], r = (*a - b) / (b + 0.01);
                values[x] += r * r;
            }
        }
        qsort(values, (size_t)n, sizeof *values, compareDoubles);
        double sum = 0;
        for (int x = 0; x < n - n / 1000; x++) {
            sum += values[x];
        }
        vplComparison c;
        assert_int_equal(vplImage_Compare(p.a, p.b, &c), VPL_SUCCESS);
        double wanted = sum / (3.0 * (n - n / 1000));
        assertNear(c.trimmedRelmse, wanted, 1e-12 * wanted, "trimmed", n);
        assert_true(n < 1000 ? c.trimmedRelmse == c.relmse : c.trimmedRelmse <= c.relmse);
        free(values);
        freePair(p);
    }
}

TEST(RegionsCoverEveryPixelOnce, 1)
{
    Pair p = makePair(context, 0, 37, 23);
    vplComparison c;
    assert_int_equal(vplImage_Compare(p.a, p.b, &c), VPL_SUCCESS);
    static const int grids[][2] = {{1, 1}, {5, 4}, {37, 23}, {1, 23}};
    vplRegion regions[37 * 23];
    for (size_t g = 0; g < sizeof grids / sizeof *grids; g++) {
        int count = grids[g][0] * grids[g][1], pixels = 0, covered[37 * 23] = {0};
        assert_int_equal(vplImage_CompareRegions(p.a, p.b, grids[g][0], grids[g][1], regions), VPL_SUCCESS);
        double square = 0, sumA = 0, sumB = 0;
        for (int i = 0; i < count; i++) {
            const vplRegion* r = &regions[i];
            int n = r->width * r->height;
            pixels += n;
            for (int k = 0; k < n; k++) {
                covered[(r->y + k / r->width) * 37 + r->x + k % r->width]++;
            }
            square += r->rmse * r->rmse * n;
            sumA += r->meanA * n;
            sumB += r->meanB * n;
            if (r->meanB > 0) { // one pixel of the ramps is black
                assertNear(r->ratio, r->meanA / r->meanB, 1e-12, "ratio", i);
            }
        }
        for (int i = 0; i < 37 * 23; i++) {
            assert_int_equal(covered[i], 1);
        }
        assertNear(sqrt(square / pixels), c.rmse, 1e-12, "rmse", (int)g);
        assertNear(sumA / sumB, c.energyRatio, 1e-12, "energy", (int)g);
    }
    freePair(p);
}

TEST(BlackRegionsHaveARatio, 1)
{
    vplImage *black = makeFlat(context, 4, 4, 0, 0, 0), *grey = makeFlat(context, 4, 4, 1, 1, 1);
    vplRegion region;
    assert_int_equal(vplImage_CompareRegions(black, black, 1, 1, &region), VPL_SUCCESS);
    assert_true(region.ratio == 1 && region.rmse == 0);
    assert_int_equal(vplImage_CompareRegions(grey, black, 1, 1, &region), VPL_SUCCESS);
    assert_true(isinf(region.ratio) && region.rmse == 1);
    vplImage_Destroy(black);
    vplImage_Destroy(grey);
}

TEST(ACropIsItsRectangle, 1)
{
    Pair p = makePair(context, 2, 13, 9);
    vplImage* crop = NULL;
    assert_int_equal(vplImage_Crop(p.a, 3, 2, 10, 7, &crop), VPL_SUCCESS);
    for (int i = 0; i < 3 * 10 * 7; i++) {
        int x = 3 + i / 3 % 10, y = 2 + i / 3 / 10;
        assert_true(crop->pixels[i] == p.a->pixels[3 * (y * 13 + x) + i % 3]);
    }
    vplImage_Destroy(crop);
    static const int outside[][4] = {{-1, 0, 2, 2}, {0, -1, 2, 2}, {0, 0, 0, 2}, {0, 0, 2, 0},
                                     {13, 0, 1, 1}, {4, 0, 10, 1}, {0, 8, 1, 2}, {1, 1, 2147483647, 1}};
    for (size_t i = 0; i < sizeof outside / sizeof *outside; i++) {
        const int* r = outside[i];
        crop = NULL;
        assert_int_equal(vplImage_Crop(p.a, r[0], r[1], r[2], r[3], &crop), VPL_INVALID_ARGUMENT);
        assert_non_null(strstr(takeMessage(), "inside the picture, which is 13x9"));
        assert_null(crop);
    }
    freePair(p);
}

// Each kind of heat map is black where pictures agree and bright where they differ much; FLIP's bright end is
// pale yellow.
