// SPDX-License-Identifier: MIT
// Quads and boxes that triangles of float cannot stand for: far away and small, very thin, or almost singular.
// Rays test them one by one, by their own formula.
#include "geometry/formula.h"
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/matrix.h"
#include "math/vec.h"

#include <math.h>
#include <string.h>

// Objects whose corners move by more than this share of their size when rounded to float, or whose axes span
// less than this share of a box. Smaller errors move edges by less than a pixel; larger ones let rays miss
// what vplRay_HitBox hits.
static const double LARGEST_SHIFT = 0x1p-9;

bool vplNeedsFormula(const vplGeometryObject* object, const vplMeshDef* shape, const vplVec3* positions)
{
    if (object->type == VPL_OBJECT_MESH) {
        return false;
    }
    vplAffine world;
    memcpy(world.m, object->placement.toWorld, sizeof world.m);
    double most = vplAffine_Orthogonality(&world) >= LARGEST_SHIFT ? 0 : 1; // of slivers no digit is right
    for (int i = 0; i < object->vertexCount; i++) {
        double at[3];
        vplToDouble3(positions[object->firstVertex + i], at);
        for (int axis = 0; axis < 3; axis++) {
            const double* row = object->placement.toLocal[axis];
            const double local = vplDot3(row, at) + row[3];
            most = fmax(most, fabs(local - (double)vplComponent(shape->positions[i], axis)));
        }
    }
    return !(most <= LARGEST_SHIFT);
}

// The triangle of a face that holds a point of the unit quad or box: the diagonal from corner 0 to corner 2 of
// the face's first triangle divides them, and corner 1 is on the first one's side.
static int findTriangle(const vplGeometry* g, const vplGeometryObject* object, const vplHit* hit)
{
    const int face = object->type == VPL_OBJECT_QUAD ? 0 : hit->face;
    const int axis = hit->face >> 1, first = object->firstTriangle + 2 * face;
    const uint32_t* index = g->indices + 3 * (size_t)first;
    double p[3][2]; // signs of the corners
    for (int corner = 0; corner < 3; corner++) {
        const unsigned bits = index[corner];
        const bool quad = object->type == VPL_OBJECT_QUAD;
        const bool x = quad ? bits == 1 || bits == 2 : (bits >> (axis == 0 ? 1 : 0) & 1) != 0;
        const bool y = quad ? bits >= 2 : (bits >> (axis == 2 ? 1 : 2) & 1) != 0;
        p[corner][0] = x ? 0.5 : -0.5;
        p[corner][1] = y ? 0.5 : -0.5;
    }
    const double dx = p[2][0] - p[0][0], dy = p[2][1] - p[0][1];
    const double side = dx * ((double)hit->v - p[0][1]) - dy * ((double)hit->u - p[0][0]);
    const double sideOf1 = dx * (p[1][1] - p[0][1]) - dy * (p[1][0] - p[0][0]);
    return side * sideOf1 >= 0 ? first : first + 1;
}

// A ray that skips all triangles misses the object; one that skips a face of a box leaves it.
static bool hitObject(const vplGeometryObject* object, const vplRay* ray, vplHit* hit)
{
    const int first = ray->skip.first - object->firstTriangle, end = first + ray->skip.count;
    if (first <= 0 && end >= object->triangleCount) {
        return false;
    }
    if (object->type == VPL_OBJECT_QUAD) {
        return vplRay_HitQuad(ray, &object->placement, hit);
    }
    const bool leaves = ray->skip.count > 0 && first >= 0 && end <= object->triangleCount;
    return vplRay_HitBox(ray, &object->placement, leaves ? first / 2 : VPL_FACE_NONE, hit);
}

bool vplHitByFormula(const vplGeometry* g, const vplRay* ray, float tMax, vplHit* hitOut)
{
    bool found = false;
    for (int i = 0; i < g->formulaCount; i++) {
        const vplGeometryObject* object = &g->objects[g->formulaObjects[i]];
        vplHit hit;
        if (hitObject(object, ray, &hit) && hit.t < tMax) {
            tMax = hit.t;
            hit.object = g->formulaObjects[i];
            hit.triangle = findTriangle(g, object, &hit);
            *hitOut = hit;
            found = true;
        }
    }
    return found;
}
