// SPDX-License-Identifier: MIT
// Rays through the frozen scene: triangles find what is hit, the object's own shape says where.
#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/intersect.h"
#include "geometry/ray_tree.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <math.h>

// Point and normal of a mesh triangle.
static void hitTriangle(const vplGeometry* g, const vplRawHit* raw, vplHit* hit)
{
    const vplTriangleCorners t = vplGeometry_Corners(g, raw->triangle);
    const double w1 = raw->b1, w2 = raw->b2;
    float at[3];
    for (int axis = 0; axis < 3; axis++) {
        double a = vplComponent(t.corner[0], axis), b = vplComponent(t.corner[1], axis),
               c = vplComponent(t.corner[2], axis);
        at[axis] = (float)(a + w1 * (b - a) + w2 * (c - a));
    }
    hit->position = vplVec(at[0], at[1], at[2]);
    hit->normal = g->normals[raw->triangle];
    hit->t = raw->t;
}

// Where a triangle that was found is hit: by the formula of its object's own shape, where that has one.
static vplHit finishHit(const vplGeometry* geometry, const vplRay* ray, const vplRawHit* raw)
{
    const int index = geometry->owners[raw->triangle], face = vplGeometry_FaceOf(geometry, raw->triangle);
    const vplGeometryObject* object = &geometry->objects[index];
    vplHit hit = {0};
    const double side = object->type == VPL_OBJECT_QUAD ? 0 : face & 1 ? -0.5 : 0.5;
    const bool exact = face != VPL_FACE_NONE && vplRay_HitFace(ray, &object->placement, face, side, &hit);
    hit.object = index;
    if (!exact) {
        hitTriangle(geometry, raw, &hit);
    }
    hit.face = face;
    hit.triangle = raw->triangle;
    hit.u = raw->b1;
    hit.v = raw->b2;
    return hit;
}

bool vplClosestHit(const vplGeometry* geometry, const vplRay* ray, vplHit* hitOut, int* tests)
{
    vplRawHit raw;
    const vplBvh* tree = vplGeometry_GetBvh(geometry);
    if (tree != NULL) {
        vplBvh bvh = *tree;
        if (tests != NULL && bvh.blockCount <= VPL_COUNTED_BLOCKS) {
            bvh.nodes = NULL;
        }
        vplGetTraceClosest(geometry->context->isa)(&bvh, ray, INFINITY, &raw);
        if (tests != NULL) {
            *tests += bvh.nodes ? raw.blocks : geometry->objectCount;
        }
    } else {
        vplClosestOfTriangles(geometry, ray, &raw);
    }
    if (raw.triangle < 0) {
        return false;
    }
    *hitOut = finishHit(geometry, ray, &raw);
    return true;
}

bool vplClosestHitWithin(const vplGeometry* geometry, const vplRay* ray, float tMax, vplHit* hitOut)
{
    vplRawHit raw;
    const vplBvh* tree = vplGeometry_GetBvh(geometry);
    if (tree != NULL) {
        vplGetTraceClosest(geometry->context->isa)(tree, ray, tMax, &raw);
    } else {
        vplClosestOfTriangles(geometry, ray, &raw);
    }
    if (raw.triangle < 0 || !(raw.t < tMax)) {
        return false;
    }
    *hitOut = finishHit(geometry, ray, &raw);
    return true;
}

bool vplGeometry_ClosestHit(const vplGeometry* geometry, const vplRay* ray, vplHit* hitOut)
{
    return vplClosestHit(geometry, ray, hitOut, NULL);
}

bool vplGeometry_IsOccluded(const vplGeometry* geometry, const vplRay* ray, float tMax)
{
    const vplBvh* bvh = vplGeometry_GetBvh(geometry);
    return bvh ? vplGetTraceAny(geometry->context->isa)(bvh, ray, tMax)
               : vplAnyOfTriangles(geometry, ray, tMax);
}

uint32_t vplGeometry_AreOccluded(const vplGeometry* geometry, const vplRayPacket* rays, float tMax)
{
    const vplBvh* bvh = vplGeometry_GetBvh(geometry);
    if (bvh != NULL) {
        return vplGetTraceAnyPacket(geometry->context->isa)(bvh, rays, tMax);
    }
    uint32_t hits = 0;
    for (int i = 0; i < VPL_RAY_PACKET; i++) {
        const vplRay ray = vplRayPacket_Get(rays, i);
        hits |= (uint32_t)((rays->active >> i & 1) && vplAnyOfTriangles(geometry, &ray, tMax)) << i;
    }
    return hits;
}

vplRay vplGeometry_Leave(const vplGeometry* geometry, const vplHit* hit, vplVec3 direction)
{
    const vplGeometryObject* object = &geometry->objects[hit->object];
    const bool outward = vplDot(direction, hit->normal) >= 0;
    vplRay ray = {hit->position, direction, {hit->triangle, 1}};
    if (object->type == VPL_OBJECT_QUAD || (object->type == VPL_OBJECT_BOX && outward)) {
        ray.skip = (vplSkip){object->firstTriangle, object->triangleCount}; // flat or convex: not met again
    } else if (object->type == VPL_OBJECT_BOX) {
        ray.skip = (vplSkip){object->firstTriangle + 2 * hit->face, 2};
    } else {
        // The point is off the triangle by rounding, and its neighbours meet it at an angle: step clear of both.
        vplVec3 p = hit->position;
        float largest = fmaxf(fabsf(p.x), fmaxf(fabsf(p.y), fabsf(p.z)));
        ray.origin = vplAdd(p, vplScale((outward ? 1 : -1) * largest * 0x1p-20f, hit->normal));
    }
    return ray;
}

vplVec3 vplGeometry_ShadingNormal(const vplGeometry* geometry, const vplHit* hit)
{
    const vplGeometryObject* object = &geometry->objects[hit->object];
    if (!object->smooth) {
        return hit->normal;
    }
    const vplVec3* n = geometry->shadingNormals + object->firstVertex;
    const uint32_t* index = geometry->indices + 3 * (size_t)hit->triangle;
    vplVec3 sum = vplAdd(vplScale(1 - hit->u - hit->v, n[index[0]]),
                         vplAdd(vplScale(hit->u, n[index[1]]), vplScale(hit->v, n[index[2]])));
    float length = vplLength(sum);
    if (!(length > 0)) {
        return hit->normal;
    }
    float sign = vplDot(sum, hit->normal) < 0 ? -1 : 1; // normals that disagree with the winding
    return vplScale(sign / length, sum);
}

bool vplGeometry_ClosestBox(const vplGeometry* geometry, const vplRay* ray, const vplHit* from,
                            vplHit* hitOut)
{
    bool found = false;
    for (int i = 0; i < geometry->objectCount; i++) {
        const vplGeometryObject* object = &geometry->objects[i];
        const bool left = from != NULL && from->object == i;
        vplHit hit;
        bool met;
        if (object->type == VPL_OBJECT_QUAD) {
            met = !left && vplRay_HitQuad(ray, &object->placement, &hit);
        } else if (left && from->face == VPL_FACE_NONE) {
            met = false; // from a triangle inside the box: on its way out
        } else {
            met = vplRay_HitBox(ray, object->type == VPL_OBJECT_BOX ? &object->placement : &object->bounds,
                                left ? from->face : VPL_FACE_NONE, &hit);
        }
        if (met && (!found || hit.t < hitOut->t)) {
            *hitOut = hit;
            hitOut->object = i;
            hitOut->triangle = object->firstTriangle;
            found = true;
        }
    }
    return found;
}
