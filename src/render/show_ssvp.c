// SPDX-License-Identifier: MIT
// Pictures of SSVP's stages.
#include "render/show_ssvp.h"

#include "base/context.h"
#include "math/scalar.h"
#include "math/vec.h"

enum { PARTS = 4 }; // position, normal, reflectance, flux

typedef struct Shown {
    const vplReflectiveMap* map;
    const vplGeometry* geometry;
    vplImage* image;
    size_t partWidth;
} Shown;

static float shareOf(float at, float low, float high)
{
    return high > low ? vplClampf((at - low) / (high - low), 0, 1) : 0;
}

// Where a texel is in the first part. The cross: +y above, -x +z +x -z in a row, -y below.
static size_t pixelOf(const Shown* s, int64_t texel)
{
    static const int columns[6] = {2, 0, 1, 1, 1, 3}, rows[6] = {1, 1, 0, 2, 1, 1};
    const int64_t size = s->map->size, face = texel / (size * size);
    const bool cross = s->map->faceCount == 6;
    const int64_t x = (cross ? columns[face] * size : 0) + texel % size;
    const int64_t y = (cross ? rows[face] * size : 0) + texel / size % size;
    return (size_t)y * (size_t)s->image->width + (size_t)x;
}

static void showRow(void* data, int row, int worker)
{
    (void)worker;
    const Shown* s = data;
    const vplVec3 low = s->geometry->boundsMin, high = s->geometry->boundsMax;
    for (int64_t i = 0; i < s->map->size; i++) {
        const int64_t texel = (int64_t)row * s->map->size + i;
        vplReflectiveTexel t;
        if (!vplReflectiveMap_GetTexel(s->map, s->geometry, texel, &t)) {
            continue;
        }
        const float values[PARTS][3] = {
            {shareOf(t.position.x, low.x, high.x), shareOf(t.position.y, low.y, high.y),
             shareOf(t.position.z, low.z, high.z)},
            {0.5f * (t.normal.x + 1), 0.5f * (t.normal.y + 1), 0.5f * (t.normal.z + 1)},
            {t.albedo.r, t.albedo.g, t.albedo.b},
            {t.flux.r, t.flux.g, t.flux.b},
        };
        float* pixel = s->image->pixels + 3 * pixelOf(s, texel);
        for (int part = 0; part < PARTS; part++, pixel += 3 * s->partWidth) {
            for (int c = 0; c < 3; c++) {
                pixel[c] = values[part][c];
            }
        }
    }
}

// By the largest number in the last part.
static void scaleFlux(const Shown* s)
{
    const size_t width = (size_t)s->image->width, height = (size_t)s->image->height;
    const size_t first = 3 * (PARTS - 1) * s->partWidth, last = 3 * width;
    float largest = 0;
    for (size_t y = 0; y < height; y++) {
        for (size_t i = first; i < last; i++) {
            largest = fmaxf(largest, s->image->pixels[3 * y * width + i]);
        }
    }
    for (size_t y = 0; y < height && largest > 0; y++) {
        for (size_t i = first; i < last; i++) {
            s->image->pixels[3 * y * width + i] /= largest;
        }
    }
}

vplResult vplShowReflectiveMap(const vplReflectiveMap* map, const vplGeometry* geometry, vplImage** imageOut)
{
    const int columns = map->faceCount == 6 ? 4 : 1, rows = map->faceCount == 6 ? 3 : 1;
    if (PARTS * columns * map->size > VPL_MAX_IMAGE_SIZE) {
        return vplFail(map->context, VPL_LIMIT,
                       "a reflective shadow map of %d texels is too large to show, at most %d", map->size,
                       VPL_MAX_IMAGE_SIZE / PARTS / columns);
    }
    vplImage* image;
    const vplResult result =
        vplImage_Create(map->context, PARTS * columns * map->size, rows * map->size, &image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    Shown s = {map, geometry, image, (size_t)(columns * map->size)};
    vplParallelFor(map->context, map->faceCount * map->size, showRow, &s);
    scaleFlux(&s);
    *imageOut = image;
    return VPL_SUCCESS;
}
