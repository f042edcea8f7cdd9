// SPDX-License-Identifier: MIT
// Marks quads and boxes that share a plane with another object. A point on one surface may be rounded to below the
// other one, which would then block light that leaves the point. Rays leave such objects from above their surface
// (vplGeometry_Leave).
#include "base/arena.h"
#include "geometry/object_build.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>
#include <stdlib.h>

typedef struct Face {
    double offset; // dot(normal, corner) in m
    vplVec3 normal, corners[4];
    int object;
} Face;

// By distance from (0, 0, 0).
static int byDistance(const void* a, const void* b)
{
    const Face *x = a, *y = b;
    const double one = fabs(x->offset), other = fabs(y->offset);
    return one < other ? -1 : one > other ? 1 : x->object - y->object;
}

// True if a line along an edge of a separates the two rectangles: b is beyond a on one side of it.
static bool isApart(const Face* a, const Face* b, float rounding)
{
    for (int i = 0; i < 4; i++) {
        const vplVec3 edge = vplSub(a->corners[(i + 1) % 4], a->corners[i]);
        const vplVec3 axis = vplNormalize(vplCross(edge, a->normal));
        float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int k = 0; k < 8; k++) {
            const float x = vplDot(axis, vplSub(k < 4 ? a->corners[k] : b->corners[k - 4], a->corners[i]));
            low[k / 4] = fminf(low[k / 4], x);
            high[k / 4] = fmaxf(high[k / 4], x);
        }
        if (low[1] > high[0] + rounding || high[1] < low[0] - rounding) {
            return true;
        }
    }
    return false;
}

// True if two faces lie in one plane and overlap. Quads count back to back, too. The bottom of a box and the floor below
// it do not: light reaches neither where they touch.
static bool meet(const vplGeometryObject* objects, const Face* a, const Face* b, float rounding)
{
    const float cosine = vplDot(a->normal, b->normal);
    const bool quads =
        objects[a->object].type == VPL_OBJECT_QUAD && objects[b->object].type == VPL_OBJECT_QUAD;
    const double between = fabs(cosine < 0 ? a->offset + b->offset : a->offset - b->offset);
    return a->object != b->object && between <= (double)rounding &&
           (quads ? fabsf(cosine) : cosine) > 1 - 0x1p-16f && !isApart(a, b, rounding) &&
           !isApart(b, a, rounding);
}

// The face that a triangle, the first of its two, belongs to.
static Face faceOf(const vplGeometry* g, int triangle)
{
    const vplTriangleCorners one = vplGeometry_Corners(g, triangle),
                             other = vplGeometry_Corners(g, triangle + 1);
    const vplVec3 n = g->normals[triangle], first = one.corner[0];
    return (Face){(double)n.x * first.x + (double)n.y * first.y + (double)n.z * first.z,
                  n,
                  {first, one.corner[1], one.corner[2], other.corner[2]},
                  g->owners[triangle]};
}

// Marks the objects of faces that meet, among faces sorted by distance. A face with more than NEIGHBOURS others at its
// distance is taken to meet one of them, which bounds the time: a ray that starts above its surface does no harm.
static void markPairs(vplGeometryObject* objects, const Face* faces, int count, float rounding)
{
    enum { NEIGHBOURS = 64 };
    for (int i = 0; i < count; i++) {
        const double farthest = fabs(faces[i].offset) + (double)rounding;
        bool* own = &objects[faces[i].object].coplanar;
        for (int j = i + 1; j < count && j - i <= NEIGHBOURS + 1 && fabs(faces[j].offset) <= farthest; j++) {
            bool* other = &objects[faces[j].object].coplanar;
            if (!(*own && *other) && (j - i > NEIGHBOURS || meet(objects, &faces[i], &faces[j], rounding))) {
                *own = *other = true;
            }
        }
    }
}

vplResult vplMarkCoplanar(const vplGeometry* g, vplGeometryObject* objects)
{
    bool meshes = false;
    for (int i = 0; i < g->objectCount; i++) {
        meshes = meshes || objects[i].type == VPL_OBJECT_MESH;
    }
    for (int i = 0; i < g->objectCount; i++) {
        objects[i].coplanar = meshes; // a triangle of a mesh may lie in any plane
    }
    const int count = meshes ? 0 : g->triangleCount / 2;
    if (count == 0) {
        return VPL_SUCCESS;
    }
    Face* faces = vplAlloc(g->context, (size_t)count, sizeof *faces);
    if (faces == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int i = 0; i < count; i++) {
        faces[i] = faceOf(g, 2 * i);
    }
    qsort(faces, (size_t)count, sizeof *faces, byDistance);
    markPairs(objects, faces, count, vplGeometry_LargestCoordinate(g) * 0x1p-20f);
    vplFree(g->context, faces);
    return VPL_SUCCESS;
}
