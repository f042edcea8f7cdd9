// SPDX-License-Identifier: MIT
#include "render/stages/show.h"

#include "base/context.h"
#include "geometry/paint.h"
#include "math/scalar.h"
#include "math/vec.h"

enum { PARTS = 4 };

// The values of a texel that the four pictures show.
typedef struct Texel {
    vplVec3 position, normal;
    vplRgb albedo, last;
} Texel;

// ---- pictures

// Creates a picture for columns * rows maps with `size` texels a side.
static vplResult createImage(vplContext* context, int size, int columns, int rows, vplImage** imageOut)
{
    const int most = VPL_MAX_IMAGE_SIZE / PARTS / columns;
    if (size > most) {
        return vplFail(context, VPL_LIMIT, "a map of %d texels a side is too large to show, at most %d", size,
                       most);
    }
    return vplImage_Create(context, PARTS * columns * size, rows * size, imageOut);
}

static float shareOf(float at, float low, float high)
{
    return high > low ? vplClampf((at - low) / (high - low), 0, 1) : 0;
}

static void putTexel(const vplGeometry* g, const Texel* t, int x, int y, vplImage* image)
{
    const vplVec3 low = g->boundsMin, high = g->boundsMax;
    const float values[PARTS][3] = {
        {shareOf(t->position.x, low.x, high.x), shareOf(t->position.y, low.y, high.y),
         shareOf(t->position.z, low.z, high.z)},
        {0.5f * (t->normal.x + 1), 0.5f * (t->normal.y + 1), 0.5f * (t->normal.z + 1)},
        {t->albedo.r, t->albedo.g, t->albedo.b},
        {t->last.r, t->last.g, t->last.b},
    };
    for (int part = 0; part < PARTS; part++) {
        const int column = part * (image->width / PARTS) + x;
        float* pixel = image->pixels + 3 * ((size_t)y * (size_t)image->width + (size_t)column);
        for (int c = 0; c < 3; c++) {
            pixel[c] = values[part][c];
        }
    }
}

// Divides the fourth picture by its largest number.
static void scaleLast(vplImage* image)
{
    const size_t width = 3 * (size_t)image->width, first = width / PARTS * (PARTS - 1);
    float largest = 0;
    for (size_t y = 0; y < (size_t)image->height; y++) {
        for (size_t i = first; i < width; i++) {
            largest = fmaxf(largest, image->pixels[y * width + i]);
        }
    }
    for (size_t y = 0; y < (size_t)image->height && largest > 0; y++) {
        for (size_t i = first; i < width; i++) {
            image->pixels[y * width + i] /= largest;
        }
    }
}

// ---- maps

typedef struct Shown {
    const vplReflectiveMap* reflective;
    const vplParaboloidMap* paraboloid;
    const vplGeometry* geometry;
    vplImage* image;
} Shown;

// Shows a row of a face. The cross has +y above, -x +z +x -z in a row, and -y below.
static void showReflectiveRow(void* data, int row, int worker)
{
    static const int columns[6] = {2, 0, 1, 1, 1, 3}, rows[6] = {1, 1, 0, 2, 1, 1};
    (void)worker;
    const Shown* s = data;
    const int size = s->reflective->size, face = row / size;
    const bool cross = s->reflective->faceCount == 6;
    for (int i = 0; i < size; i++) {
        vplReflectiveTexel t;
        if (vplReflectiveMap_GetTexel(s->reflective, s->geometry, (int64_t)row * size + i, &t)) {
            const Texel shown = {t.position, t.normal, t.albedo, t.flux};
            putTexel(s->geometry, &shown, (cross ? columns[face] * size : 0) + i,
                     (cross ? rows[face] * size : 0) + row % size, s->image);
        }
    }
}

// Shows a row of a hemisphere, counted from the bottom.
static void showParaboloidRow(void* data, int row, int worker)
{
    (void)worker;
    const Shown* s = data;
    const int size = s->paraboloid->size, hemisphere = row / size;
    for (int i = 0; i < size; i++) {
        vplHit hit;
        vplVec3 direction;
        if (vplParaboloidMap_GetHit(s->paraboloid, s->geometry,
                                    (vplParaboloidTexel){hemisphere, i, row % size}, &hit, &direction)) {
            const vplVec3 n = vplDot(direction, hit.normal) > 0 ? vplNegate(hit.normal) : hit.normal;
            const vplFootprint footprint = {direction, 2 * hit.t / (float)size};
            const vplRgb albedo =
                vplGeometry_Reflectance(s->geometry, hit.triangle, hit.position, &footprint);
            const Texel shown = {hit.position, n, albedo, {hit.t, hit.t, hit.t}};
            putTexel(s->geometry, &shown, i, (hemisphere + 1) * size - 1 - row % size, s->image);
        }
    }
}

vplResult vplShowReflectiveMap(const vplReflectiveMap* map, const vplGeometry* geometry, vplImage** imageOut)
{
    const bool cross = map->faceCount == 6;
    Shown s = {.reflective = map, .geometry = geometry};
    vplResult result = createImage(map->context, map->size, cross ? 4 : 1, cross ? 3 : 1, &s.image);
    if (result == VPL_SUCCESS) {
        result = vplParallelForAsking(map->context, map->faceCount * map->size, showReflectiveRow, &s);
    }
    if (result == VPL_SUCCESS) {
        scaleLast(s.image);
        *imageOut = s.image;
    } else {
        vplImage_Destroy(s.image);
    }
    return result;
}

vplResult vplShowParaboloidMap(const vplParaboloidMap* map, const vplGeometry* geometry, vplImage** imageOut)
{
    Shown s = {.paraboloid = map, .geometry = geometry};
    vplResult result = createImage(map->context, map->size, 1, map->hemispheres, &s.image);
    if (result == VPL_SUCCESS) {
        result = vplParallelForAsking(map->context, map->hemispheres * map->size, showParaboloidRow, &s);
    }
    if (result == VPL_SUCCESS) {
        scaleLast(s.image);
        *imageOut = s.image;
    } else {
        vplImage_Destroy(s.image);
    }
    return result;
}
