// SPDX-License-Identifier: MIT
// Based on: Tomas Akenine-Moeller et al., Improved Shader and Texture Level of Detail Using Ray Cones, JCGT 2021.
// Departs: a pixel's point is found from its triangle's plane, as the texture's, because not all strategies keep
// positions.
#include "shading/pixel_paint.h"

#include "geometry/paint.h"
#include "geometry/triangle.h"
#include "math/scalar.h"
#include "shading/edges.h"

float vplDistanceOf(const vplGeometry* geometry, const vplView* view, int triangle, vplVec3 normal,
                    float offset, vplVec3 sight)
{
    const vplTriangleCorners t = vplGeometry_Corners(geometry, triangle);
    float least = INFINITY, most = 0;
    for (int i = 0; i < 3; i++) {
        const float w = vplDot(view->forward, vplSub(t.corner[i], view->eye));
        least = vplMinf(least, w);
        most = vplMaxf(most, w);
    }
    const float w = offset / vplDot(normal, sight);
    return vplMinf(vplMaxf(w, vplMaxf(least, (float)view->nearPlane)), most); // NaN becomes the least
}

vplRgb vplReflectanceSeen(const vplGeometry* g, const vplView* view, int triangle, vplVec3 point)
{
    const vplVec3 way = vplSub(point, view->eye);
    const float pixel = 2 / (float)(view->height * view->scaleY);
    const vplFootprint footprint = {vplNormalize(way), pixel * fabsf(vplDot(view->forward, way))};
    return vplGeometry_Reflectance(g, triangle, point, &footprint);
}

vplRgb vplReflectanceInPixel(const vplGeometry* g, const vplView* view, int triangle, int x, int y)
{
    if (triangle < 0) {
        return (vplRgb){0, 0, 0};
    }
    const vplVec3 sight = vplSightOf(view, x, y, (vplSubPixel){0, 0}), n = g->normals[triangle];
    const vplVec3 corner = vplGeometry_Corners(g, triangle).corner[0];
    const float distance = vplDistanceOf(g, view, triangle, n, vplDot(n, vplSub(corner, view->eye)), sight);
    return vplReflectanceSeen(g, view, triangle, vplAdd(view->eye, vplScale(distance, sight)));
}
