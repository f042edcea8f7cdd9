// SPDX-License-Identifier: MIT
// The reflectance that pixels show, for geometries with textures or colours of vertices.
#ifndef VPL_SHADING_PIXEL_PAINT_H
#define VPL_SHADING_PIXEL_PAINT_H

#include "shading/facet_cache.h"

// The reflectance of a triangle in the pixel that shows a point of it.
vplRgb vplReflectanceSeen(const vplGeometry* geometry, const vplView* view, int triangle, vplVec3 point);

// The same in the centre of pixel (x, y), which shows the triangle.
vplRgb vplReflectanceInPixel(const vplGeometry* geometry, const vplView* view, int triangle, int x, int y);

// Distance along the view axis at which a line of sight, of length 1 along it, meets a triangle's plane, clamped to
// the range of its corners. `offset`: vplFacet.offset.
float vplDistanceOf(const vplGeometry* geometry, const vplView* view, int triangle, vplVec3 normal,
                    float offset, vplVec3 sight);

// Multiplies irradiance into radiance.
static inline void vplFactorOf(vplRgb rho, double factor[3])
{
    const double scale = 1 / VPL_PI;
    factor[0] = rho.r * scale;
    factor[1] = rho.g * scale;
    factor[2] = rho.b * scale;
}

// The factors of a reflector in the centre of pixel (x, y).
static inline void vplFactorInPixel(const vplShading* s, const vplReflector* r, int triangle, int x, int y,
                                    double factor[3])
{
    memcpy(factor, r->factor, sizeof r->factor);
    if (s->geometry->paint != NULL) {
        vplFactorOf(vplReflectanceInPixel(s->geometry, s->view, triangle, x, y), factor);
    }
}

// The factors of a reflector at a point.
static inline void vplFactorAtPoint(const vplShading* s, const vplReflector* r, int triangle, vplVec3 point,
                                    double factor[3])
{
    memcpy(factor, r->factor, sizeof r->factor);
    if (s->geometry->paint != NULL) {
        vplFactorOf(vplReflectanceSeen(s->geometry, s->view, triangle, point), factor);
    }
}

#endif
