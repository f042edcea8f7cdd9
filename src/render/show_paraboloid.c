// SPDX-License-Identifier: MIT
// What a cluster sees, for looking at.
#include "render/show_paraboloid.h"

#include "base/context.h"
#include "math/vec.h"

enum { PARTS = 4 };

static vplVec3 shareOf(const vplGeometry* g, vplVec3 p)
{
    const vplVec3 from = vplSub(p, g->boundsMin), size = vplSub(g->boundsMax, g->boundsMin);
    return vplVec(size.x > 0 ? from.x / size.x : 0, size.y > 0 ? from.y / size.y : 0,
                  size.z > 0 ? from.z / size.z : 0);
}

static void put(vplImage* image, int x, int y, vplVec3 value)
{
    float* pixel = image->pixels + 3 * ((size_t)y * (size_t)image->width + (size_t)x);
    pixel[0] = value.x;
    pixel[1] = value.y;
    pixel[2] = value.z;
}

static void showTexel(const vplParaboloidMap* map, const vplGeometry* g, int hemisphere, int column, int row,
                      vplImage* image)
{
    const int size = map->size, y = hemisphere * size + size - 1 - row; // rows go up
    vplVec3 part[PARTS] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    vplHit hit;
    vplVec3 direction;
    if (vplParaboloidMap_GetHit(map, g, hemisphere, column, row, &hit, &direction)) {
        const vplVec3 n = vplDot(direction, hit.normal) > 0 ? vplNegate(hit.normal) : hit.normal;
        const vplRgb albedo = g->materials[g->triangleMaterials[hit.triangle]].diffuse;
        part[0] = shareOf(g, hit.position);
        part[1] = vplScale(0.5f, vplAdd(n, vplVec(1, 1, 1)));
        part[2] = vplVec(albedo.r, albedo.g, albedo.b);
        part[3] = vplVec(hit.t, hit.t, hit.t);
    }
    for (int k = 0; k < PARTS; k++) {
        put(image, k * size + column, y, part[k]);
    }
}

vplResult vplShowParaboloidMap(const vplParaboloidMap* map, const vplGeometry* geometry, vplImage** imageOut)
{
    const int size = map->size;
    if (PARTS * size > VPL_MAX_IMAGE_SIZE) {
        return vplFail(map->context, VPL_LIMIT,
                       "a paraboloid map of %d texels is too large to show, at most %d", size,
                       VPL_MAX_IMAGE_SIZE / PARTS);
    }
    vplImage* image;
    const vplResult result = vplImage_Create(map->context, PARTS * size, map->hemispheres * size, &image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    for (int hemisphere = 0; hemisphere < map->hemispheres; hemisphere++) {
        for (int i = 0; i < size * size; i++) {
            showTexel(map, geometry, hemisphere, i % size, i / size, image);
        }
    }
    *imageOut = image;
    return VPL_SUCCESS;
}
