// SPDX-License-Identifier: MIT
// Pictures for looking into the works.
#include "image/draw.h"
#include "math/vec.h"
#include "render/render.h"

vplResult vplUnfoldCubeMap(const vplCubeMap* map, vplImage** imageOut)
{
    // Column and row of each face in the cross: +x, -x, +y, -y, +z, -z.
    static const int columns[6] = {2, 0, 1, 1, 1, 3}, rows[6] = {1, 1, 0, 2, 1, 1};
    if (4 * map->size > VPL_MAX_IMAGE_SIZE) {
        return vplFail(map->context, VPL_LIMIT, "a shadow map of %d texels is too large to show, at most %d",
                       map->size, VPL_MAX_IMAGE_SIZE / 4);
    }
    vplImage* image;
    vplResult result = vplImage_Create(map->context, 4 * map->size, 3 * map->size, &image);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const size_t size = (size_t)map->size;
    for (size_t face = 0; face < 6; face++) {
        for (size_t i = 0; i < size * size; i++) {
            size_t x = (size_t)columns[face] * size + i % size, y = (size_t)rows[face] * size + i / size;
            float* pixel = image->pixels + 3 * (y * (size_t)image->width + x);
            float stored = map->texels[face * size * size + i];
            pixel[0] = pixel[1] = pixel[2] = isfinite(stored) ? stored * map->far : 0;
        }
    }
    *imageOut = image;
    return VPL_SUCCESS;
}

bool vplView_IsHidden(const vplView* view, const vplGeometry* geometry, vplVec3 position)
{
    const vplVec3 way = vplSub(position, view->eye);
    const float begin = (float)view->near / vplDot(view->forward, way); // where the view begins
    const vplRay ray = {vplAdd(view->eye, vplScale(begin, way)), vplScale(1 - begin, way), {0, 0}};
    return vplGeometry_IsOccluded(geometry, &ray, 0.9999f);
}

void vplDrawLights(vplImage* image, const vplGeometry* geometry, const vplView* view, const vplLightSet* set)
{
    static const vplRgb colours[4] = {
        {1, 0.8f, 0.05f}, {1, 0.15f, 0.05f}, {0.1f, 0.4f, 1}, {0.7f, 0.1f, 0.9f}};
    float radius = fmaxf(3, 0.009f * (float)view->height);
    for (int i = 0; i < set->lightCount; i++) {
        const vplVirtualLight* light = &set->lights[i];
        float x, y;
        if (!vplView_Project(view, light->position, &x, &y)) {
            continue;
        }
        const bool hidden = vplView_IsHidden(view, geometry, light->position); // is drawn small
        vplDrawDisc(image, x, y, hidden ? 0.5f * radius : radius, colours[light->step < 3 ? light->step : 3]);
    }
}
