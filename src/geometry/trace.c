// SPDX-License-Identifier: MIT
// Rays through the scene: the tree of triangles finds what is hit, the object's own shape says where.
#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/vec.h"

#include <math.h>

// ---- without a tree

// Makes a hierarchy of one block of the triangles first .. first + 7.
static void makeBlock(const vplGeometry* g, int first, vplTriangleBlock* block, vplBvh* bvh)
{
    int32_t ids[VPL_BVH_WIDTH];
    int count = 0;
    for (int i = first; i < first + VPL_BVH_WIDTH && i < g->triangleCount; i++) {
        if (vplCanBeHit(g, i)) {
            ids[count++] = i;
        }
    }
    if (count > 0) {
        vplTriangleBlock_Fill(block, g, ids, count);
    }
    *bvh = (vplBvh){.blocks = block, .blockCount = count > 0};
}

// The closest hit, or with `any` some hit, by testing every triangle.
static vplRawHit testAll(const vplGeometry* g, const vplRay* ray, float tMax, bool any)
{
    const vplRayKernels* kernels = vplGetRayKernels(g->context->isa);
    vplRawHit best = {.t = tMax, .triangle = -1};
    for (int i = 0; i < g->triangleCount && !(any && best.triangle >= 0); i += VPL_BVH_WIDTH) {
        vplTriangleBlock block;
        vplBvh bvh;
        vplRawHit hit;
        makeBlock(g, i, &block, &bvh);
        kernels->closest(&bvh, ray, best.t, &hit);
        best = hit.triangle >= 0 ? hit : best; // ids ascend: among equal distances the first stays
    }
    return best;
}

bool vplAnyOfTriangles(const vplGeometry* g, const vplRay* ray, float tMax)
{
    return testAll(g, ray, tMax, true).triangle >= 0;
}

// ---- hits

// Sets distance, position and normal of a hit on a mesh triangle.
static void hitTriangle(const vplGeometry* g, const vplRawHit* raw, vplHit* hit)
{
    const vplTriangleCorners t = vplGeometry_Corners(g, raw->triangle);
    const double w1 = raw->b1, w2 = raw->b2;
    double at[3];
    for (int axis = 0; axis < 3; axis++) {
        const double a = vplComponent(t.corner[0], axis), b = vplComponent(t.corner[1], axis),
                     c = vplComponent(t.corner[2], axis);
        at[axis] = a + w1 * (b - a) + w2 * (c - a);
    }
    hit->position = vplRound3(at);
    hit->normal = g->normals[raw->triangle];
    hit->t = raw->t;
}

// Locates the hit on a triangle: by the formula of the quad or box that it belongs to, if any.
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

bool vplClosestHit(const vplGeometry* g, const vplRay* ray, float tMax, int* tests, vplHit* hitOut)
{
    vplRawHit raw;
    bool everyObject = true;
    if (g->rayTree != NULL) {
        vplBvh bvh = *g->rayTree;
        if (tests != NULL && bvh.blockCount <= VPL_COUNTED_BLOCKS) {
            bvh.nodes = NULL;
        }
        everyObject = bvh.nodes == NULL;
        vplGetRayKernels(g->context->isa)->closest(&bvh, ray, tMax, &raw);
    } else {
        raw = testAll(g, ray, tMax, false);
    }
    if (tests != NULL) {
        *tests += everyObject ? g->objectCount : raw.blocks;
    }
    if (raw.triangle >= 0) {
        *hitOut = finishHit(g, ray, &raw);
    }
    return raw.triangle >= 0;
}

bool vplGeometry_ClosestHit(const vplGeometry* geometry, const vplRay* ray, vplHit* hitOut)
{
    return vplClosestHit(geometry, ray, INFINITY, NULL, hitOut);
}

bool vplGeometry_IsOccluded(const vplGeometry* geometry, const vplRay* ray, float tMax)
{
    return geometry->rayTree ? vplGetRayKernels(geometry->context->isa)->any(geometry->rayTree, ray, tMax)
                             : vplAnyOfTriangles(geometry, ray, tMax);
}

uint32_t vplGeometry_AreOccluded(const vplGeometry* geometry, const vplRayPacket* rays, float tMax)
{
    if (geometry->rayTree != NULL) {
        return vplGetRayKernels(geometry->context->isa)->anyPacket(geometry->rayTree, rays, tMax);
    }
    uint32_t hits = 0;
    for (uint32_t active = rays->active; active != 0; active &= active - 1) {
        const int lane = __builtin_ctz(active);
        const vplRay ray = vplRayPacket_Get(rays, lane);
        hits |= (uint32_t)vplAnyOfTriangles(geometry, &ray, tMax) << lane;
    }
    return hits;
}

// ---- leaving a surface, shading, bounding boxes

vplRay vplGeometry_Leave(const vplGeometry* geometry, const vplHit* hit, vplVec3 direction)
{
    const vplGeometryObject* object = &geometry->objects[hit->object];
    const bool outward = vplDot(direction, hit->normal) >= 0;
    vplRay ray = {hit->position, direction, {hit->triangle, 1}};
    if (object->type == VPL_OBJECT_QUAD || (object->type == VPL_OBJECT_BOX && outward)) {
        ray.skip =
            (vplSkip){object->firstTriangle, object->triangleCount}; // flat or convex: cannot be hit again
    } else if (object->type == VPL_OBJECT_BOX) {
        ray.skip = (vplSkip){object->firstTriangle + 2 * hit->face, 2};
    } else {
        // Rounding moves the point off the triangle, and its neighbours are not coplanar: clear them all.
        const float distance = (outward ? 1 : -1) * vplLargestOf(hit->position) * 0x1p-20f;
        ray.origin = vplAdd(hit->position, vplScale(distance, hit->normal));
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
    float sign = vplDot(sum, hit->normal) < 0 ? -1 : 1; // the normals may disagree with the winding
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
            met = false; // leaves a triangle inside the box
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
