// SPDX-License-Identifier: MIT
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/vec.h"

#include <math.h>

// The edges from corner 0, in double.
typedef struct Edges {
    double origin[3], u[3], v[3];
} Edges;

static Edges edgesOf(const vplVec3 corners[3])
{
    Edges e;
    vplToDouble3(corners[0], e.origin);
    for (int k = 0; k < 3; k++) {
        e.u[k] = vplComponent(corners[1], k) - e.origin[k];
        e.v[k] = vplComponent(corners[2], k) - e.origin[k];
    }
    return e;
}

void vplTriangle_Cross(const vplTriangleCorners* triangle, double cross[3])
{
    const Edges e = edgesOf(triangle->corner);
    vplCross3(e.u, e.v, cross);
}

double vplAreaOfCross(const double cross[3])
{
    return 0.5 * sqrt(vplDot3(cross, cross));
}

double vplTriangle_Area(const vplTriangleCorners* triangle)
{
    double cross[3];
    vplTriangle_Cross(triangle, cross);
    return vplAreaOfCross(cross);
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

// False where the triangle has no area.
static bool findBarycentrics(const Edges* e, vplVec3 point, double w[3])
{
    double uu = 0, uv = 0, vv = 0, pu = 0, pv = 0;
    for (int k = 0; k < 3; k++) {
        const double p = vplComponent(point, k) - e->origin[k];
        uu += e->u[k] * e->u[k];
        uv += e->u[k] * e->v[k];
        vv += e->v[k] * e->v[k];
        pu += p * e->u[k];
        pv += p * e->v[k];
    }
    const double area = uu * vv - uv * uv;
    w[1] = area > 0 ? (vv * pu - uv * pv) / area : 0;
    w[2] = area > 0 ? (uu * pv - uv * pu) / area : 0;
    w[0] = 1 - w[1] - w[2];
    return area > 0;
}

void vplTriangle_Barycentrics(const vplVec3 corners[3], vplVec3 point, double barycentricsOut[3])
{
    const Edges e = edgesOf(corners);
    findBarycentrics(&e, point, barycentricsOut);
}

vplVec3 vplGeometry_InsideAt(const vplGeometry* g, int triangle, vplVec3 point, float* uOut, float* vOut)
{
    // Raster coverage is snapped to 1/256 pixel, so a triangle's pixel centre may lie that far outside of it.
    const double inset = 0x1p-16;
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    const Edges e = edgesOf(t.corner);
    double w[3];
    const bool hasArea = findBarycentrics(&e, point, w);
    const bool inside = w[1] >= inset && w[2] >= inset && w[0] >= inset;
    if (hasArea && !inside) {
        for (int k = 0; k < 3; k++) {
            w[k] = w[k] > inset ? w[k] : inset;
        }
        const double sum = w[1] + w[2] + w[0];
        w[1] /= sum;
        w[2] /= sum;
        double at[3];
        for (int k = 0; k < 3; k++) {
            at[k] = e.origin[k] + w[1] * e.u[k] + w[2] * e.v[k];
        }
        point = vplRound3(at);
    }
    *uOut = (float)w[1];
    *vOut = (float)w[2];
    return point;
}

vplVec3 vplGeometry_Inside(const vplGeometry* g, int triangle, vplVec3 point)
{
    float u, v;
    return vplGeometry_InsideAt(g, triangle, point, &u, &v);
}
