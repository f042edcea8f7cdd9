// SPDX-License-Identifier: MIT
// Reflectances that vary over a surface: textures and colours of vertices.
#ifndef VPL_GEOMETRY_PAINT_H
#define VPL_GEOMETRY_PAINT_H

#include <vpl/geometry.h>

#include "math/vec.h"

// The tangent of the angle over which texels are averaged around a ray that a diffuse reflection has sent out.
#define VPL_BOUNCE_SPREAD 0.05f

// What a look-up averages over: where a cone meets the surface.
typedef struct vplFootprint {
    vplVec3 direction; // of its axis, unit
    float width;       // diameter, metres; 0: a point
} vplFootprint;

// Where a cone of diameter `width` falls upright on a triangle.
static inline vplFootprint vplUpright(const vplGeometry* g, int triangle, float width)
{
    return (vplFootprint){g->normals[triangle], width};
}

// Where a ray that a diffuse reflection has sent out, in a unit direction, hits something.
static inline vplFootprint vplFootprintOfBounce(vplVec3 direction, float distance)
{
    return (vplFootprint){direction, VPL_BOUNCE_SPREAD * distance};
}

// The side of the square that stands for one of `count` points on all surfaces, metres.
float vplShareOfArea(const vplGeometry* geometry, int count);

// The functions below for a geometry that has paint.
vplRgb vplPaint_Reflectance(const vplGeometry* geometry, int triangle, vplVec3 point,
                            const vplFootprint* footprint);
vplRgb vplPaint_Mean(const vplGeometry* geometry, int triangle);

// The mean reflectance of a part of a triangle with these corners.
vplRgb vplPaint_MeanOfPart(const vplGeometry* geometry, int triangle, const vplVec3 corners[3]);

// The reflectance of a triangle around a point of it. Every picture takes it from here.
static inline vplRgb vplGeometry_Reflectance(const vplGeometry* geometry, int triangle, vplVec3 point,
                                             const vplFootprint* footprint)
{
    return geometry->paint != NULL ? vplPaint_Reflectance(geometry, triangle, point, footprint)
                                   : geometry->materials[geometry->triangleMaterials[triangle]].diffuse;
}

// The mean reflectance of a triangle.
static inline vplRgb vplGeometry_ReflectanceOf(const vplGeometry* geometry, int triangle)
{
    return geometry->paint != NULL ? vplPaint_Mean(geometry, triangle)
                                   : geometry->materials[geometry->triangleMaterials[triangle]].diffuse;
}

#endif
