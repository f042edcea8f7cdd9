// SPDX-License-Identifier: MIT
// Finds quads and boxes that share a plane with another object. Rounding puts a point of one below the other, which
// would hold back the light that leaves it, so rays leave such objects from a point above them (vplGeometry_Leave).
#include "base/arena.h"
#include "geometry/object_build.h"
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

// True if, across one of a's edges, all of b is further than all of a, or all before it.
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

// Two quads are one surface also back to back. A box covers what it stands on, but does not lie in it.
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

static Face faceAt(const vplGeometry* g, int object, int triangle)
{
    const vplVec3* p = g->positions + g->objects[object].firstVertex;
    const uint32_t* i = g->indices + 3 * (size_t)triangle; // of 0, 1, 2 and 0, 2, 3
    const vplVec3 n = g->normals[triangle], first = p[i[0]];
    return (Face){(double)n.x * first.x + (double)n.y * first.y + (double)n.z * first.z,
                  n,
                  {first, p[i[1]], p[i[2]], p[i[5]]},
                  object};
}

// Lists the faces of quads and boxes.
static int listFaces(const vplGeometry* g, Face* faces)
{
    int count = 0;
    for (int i = 0; i < g->objectCount; i++) {
        for (int t = 0; t < g->objects[i].triangleCount; t += 2) {
            faces[count++] = faceAt(g, i, g->objects[i].firstTriangle + t);
        }
    }
    return count;
}

// Marks pairs among faces that are sorted by distance. Behind NEIGHBOURS planes at the same distance the next is taken to
// meet the first, which bounds the time: rays that start a little above a surface do no harm.
static void markPairs(vplGeometryObject* objects, const Face* faces, int count, float rounding)
{
    enum { NEIGHBOURS = 64 };
    for (int i = 0; i < count; i++) {
        for (int j = i + 1; j < count && fabs(faces[j].offset) - fabs(faces[i].offset) <= (double)rounding;
             j++) {
            if (j - i > NEIGHBOURS || meet(objects, &faces[i], &faces[j], rounding)) {
                objects[faces[i].object].coplanar = objects[faces[j].object].coplanar = true;
                break;
            }
        }
    }
}

vplResult vplMarkCoplanar(const vplGeometry* g, vplGeometryObject* objects)
{
    int flat = 0;
    for (int i = 0; i < g->objectCount; i++) {
        flat += objects[i].type != VPL_OBJECT_MESH;
    }
    for (int i = 0; i < g->objectCount; i++) {
        objects[i].coplanar = flat < g->objectCount; // a triangle of a mesh may lie in any plane
    }
    if (flat < g->objectCount || flat == 0) {
        return VPL_SUCCESS;
    }
    Face* faces = vplAlloc(g->context, 6 * (size_t)flat, sizeof *faces);
    if (faces == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    const int count = listFaces(g, faces);
    qsort(faces, (size_t)count, sizeof *faces, byDistance);
    const float largest = fmaxf(vplLargestOf(g->boundsMin), vplLargestOf(g->boundsMax));
    markPairs(objects, faces, count, largest * 0x1p-20f);
    vplFree(g->context, faces);
    return VPL_SUCCESS;
}
