// SPDX-License-Identifier: MIT
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>

void vplTriangle_Cross(const vplTriangleCorners* triangle, double cross[3])
{
    const vplVec3* p = triangle->corner;
    double u[3], v[3];
    for (int axis = 0; axis < 3; axis++) {
        double origin = vplComponent(p[0], axis);
        u[axis] = vplComponent(p[1], axis) - origin;
        v[axis] = vplComponent(p[2], axis) - origin;
    }
    cross[0] = u[1] * v[2] - u[2] * v[1];
    cross[1] = u[2] * v[0] - u[0] * v[2];
    cross[2] = u[0] * v[1] - u[1] * v[0];
}

double vplTriangle_Area(const vplTriangleCorners* triangle)
{
    double c[3];
    vplTriangle_Cross(triangle, c);
    return 0.5 * sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
}

double vplGeometry_TriangleArea(const vplGeometry* g, int triangle)
{
    const vplTriangleCorners corners = vplGeometry_Corners(g, triangle);
    return vplTriangle_Area(&corners);
}

int vplGeometry_FaceOf(const vplGeometry* g, int triangle)
{
    const vplGeometryObject* object = &g->objects[g->owners[triangle]];
    return object->type == VPL_OBJECT_QUAD  ? VPL_FACE_QUAD
           : object->type == VPL_OBJECT_BOX ? (triangle - object->firstTriangle) / 2
                                            : VPL_FACE_NONE;
}

vplVec3 vplGeometry_Inside(const vplGeometry* g, int triangle, vplVec3 point)
{
    float u, v;
    return vplGeometry_InsideAt(g, triangle, point, &u, &v);
}

vplVec3 vplGeometry_InsideAt(const vplGeometry* g, int triangle, vplVec3 point, float* weight1,
                             float* weight2)
{
    // Raster coverage is snapped to 1/256 pixel, so a triangle's pixel centre may lie that far outside of it.
    const double inset = 0x1p-16;
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    double a[3], u[3], v[3], w[3], uu = 0, uv = 0, vv = 0, wu = 0, wv = 0;
    for (int i = 0; i < 3; i++) {
        a[i] = vplComponent(t.corner[0], i);
        u[i] = vplComponent(t.corner[1], i) - a[i];
        v[i] = vplComponent(t.corner[2], i) - a[i];
        w[i] = vplComponent(point, i) - a[i];
        uu += u[i] * u[i];
        uv += u[i] * v[i];
        vv += v[i] * v[i];
        wu += w[i] * u[i];
        wv += w[i] * v[i];
    }
    const double area = uu * vv - uv * uv;
    *weight1 = *weight2 = 0;
    if (!(area > 0)) {
        return point;
    }
    double b = (vv * wu - uv * wv) / area, c = (uu * wv - uv * wu) / area, rest = 1 - b - c;
    *weight1 = (float)b;
    *weight2 = (float)c;
    if (b >= inset && c >= inset && rest >= inset) {
        return point;
    }
    b = b > inset ? b : inset;
    c = c > inset ? c : inset;
    rest = rest > inset ? rest : inset;
    const double sum = b + c + rest;
    b /= sum;
    c /= sum;
    *weight1 = (float)b;
    *weight2 = (float)c;
    return vplVec((float)(a[0] + b * u[0] + c * v[0]), (float)(a[1] + b * u[1] + c * v[1]),
                  (float)(a[2] + b * u[2] + c * v[2]));
}

void vplTriangle_Weigh(const vplVec3 corners[3], vplVec3 point, double weightsOut[3])
{
    double u[3], v[3], p[3], uu = 0, uv = 0, vv = 0, pu = 0, pv = 0;
    for (int k = 0; k < 3; k++) {
        const double origin = vplComponent(corners[0], k);
        u[k] = vplComponent(corners[1], k) - origin;
        v[k] = vplComponent(corners[2], k) - origin;
        p[k] = vplComponent(point, k) - origin;
        uu += u[k] * u[k];
        uv += u[k] * v[k];
        vv += v[k] * v[k];
        pu += p[k] * u[k];
        pv += p[k] * v[k];
    }
    const double area = uu * vv - uv * uv;
    weightsOut[1] = area > 0 ? (vv * pu - uv * pv) / area : 0;
    weightsOut[2] = area > 0 ? (uu * pv - uv * pu) / area : 0;
    weightsOut[0] = 1 - weightsOut[1] - weightsOut[2];
}
