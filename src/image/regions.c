// SPDX-License-Identifier: MIT
// Parts of pictures: cropping, and comparison block by block.
#include "base/arena.h"
#include "image/metrics.h"

#include <math.h>
#include <string.h>

vplResult vplImage_Crop(const vplImage* image, int x, int y, int width, int height, vplImage** imageOut)
{
    REQUIRE(CONTEXT_OF(image), image, imageOut);
    bool inside = x >= 0 && y >= 0 && width >= 1 && height >= 1 && width <= image->width - x &&
                  height <= image->height - y;
    if (!inside) {
        return vplFail(image->context, VPL_INVALID_ARGUMENT,
                       "region %dx%d at (%d, %d) must lie inside the picture, which is %dx%d", width, height,
                       x, y, image->width, image->height);
    }
    vplImage* crop;
    TRY(vplImage_Create(image->context, width, height, &crop));
    size_t row = 3 * (size_t)width;
    for (int i = 0; i < height; i++) {
        size_t first = 3 * ((size_t)(y + i) * (size_t)image->width + (size_t)x);
        memcpy(crop->pixels + (size_t)i * row, image->pixels + first, row * sizeof(float));
    }
    *imageOut = crop;
    return VPL_SUCCESS;
}

static void measure(const vplImage* a, const vplImage* b, vplRegion* region)
{
    double square = 0, sumA = 0, sumB = 0;
    for (int y = region->y; y < region->y + region->height; y++) {
        size_t first = 3 * ((size_t)y * (size_t)a->width + (size_t)region->x);
        for (size_t i = first; i < first + 3 * (size_t)region->width; i++) {
            double va = a->pixels[i], vb = b->pixels[i];
            square += (va - vb) * (va - vb);
            sumA += va;
            sumB += vb;
        }
    }
    double count = 3.0 * region->width * region->height;
    region->meanA = sumA / count;
    region->meanB = sumB / count;
    region->ratio = sumA == sumB ? 1 : sumA / sumB;
    region->rmse = sqrt(square / count);
}

// The first pixel of block `index` of `count` along a side. Blocks differ by one pixel at most.
static int beginOf(int index, int count, int side)
{
    return (int)((int64_t)index * side / count);
}

vplResult vplImage_CompareRegions(const vplImage* a, const vplImage* b, int columns, int rows,
                                  vplRegion* regionsOut)
{
    REQUIRE(CONTEXT_OF(a) ?: CONTEXT_OF(b), a, b);
    TRY(vplRequirePair(a, b));
    if (columns < 1 || columns > a->width || rows < 1 || rows > a->height) {
        return vplFail(a->context, VPL_INVALID_ARGUMENT,
                       "regions are %dx%d, must be in [1, %d] and [1, %d]: one pixel each at least", columns,
                       rows, a->width, a->height);
    }
    CHECK_POINTERS(a->context, regionsOut); // after the counts: without room for them callers have no array
    for (int j = 0; j < rows; j++) {
        for (int i = 0; i < columns; i++) {
            vplRegion* region = &regionsOut[(size_t)j * (size_t)columns + (size_t)i];
            region->x = beginOf(i, columns, a->width);
            region->y = beginOf(j, rows, a->height);
            region->width = beginOf(i + 1, columns, a->width) - region->x;
            region->height = beginOf(j + 1, rows, a->height) - region->y;
            measure(a, b, region);
        }
    }
    return VPL_SUCCESS;
}
