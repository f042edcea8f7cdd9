// SPDX-License-Identifier: MIT
// Rays through the scene: the tree of triangles finds what is hit, the object's own shape says where.
#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/cut_outs.h"
#include "geometry/formula.h"
#include "geometry/trace.h"
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/vec.h"

#include <float.h>
#include <math.h>

// ---- without a tree

// Makes a hierarchy of one block of the triangles first .. first + 7.
static void makeBlock(const vplGeometry* g, int first, vplTriangleBlock* block, vplBlockMarks* marks,
                      vplBvh* bvh)
{
    int32_t ids[VPL_BVH_WIDTH];
    int count = 0;
    for (int i = first; i < first + VPL_BVH_WIDTH && i < g->triangleCount; i++) {
        if (vplIsSolid(g, i)) {
            ids[count++] = i;
        }
    }
    if (count > 0) {
        *marks = vplTriangleBlock_Fill(block, g, ids, count);
    }
    *bvh = (vplBvh){.blocks = block, .marks = marks, .blockCount = count > 0};
}

// The closest hit, or with `any` some hit, by testing every triangle.
static vplRawHit testAll(const vplGeometry* g, const vplRay* ray, float tMax, bool any)
{
    const vplRayKernels* kernels = vplGetRayKernels(g->context->isa);
    vplRawHit best = {.t = tMax, .triangle = -1};
    for (int i = 0; i < g->triangleCount && !(any && best.triangle >= 0); i += VPL_BVH_WIDTH) {
        vplTriangleBlock block;
        vplBlockMarks marks;
        vplBvh bvh;
        vplRawHit hit;
        makeBlock(g, i, &block, &marks, &bvh);
        kernels->closest(&bvh, ray, best.t, &hit);
        best = hit.triangle >= 0 ? hit : best; // ids ascend: among equal distances the first stays
    }
    return best;
}

// ---- directions of any length

// True for directions with which triangle tests neither overflow nor underflow: of 2^-20 to 2^20 m.
static bool isOrdinary(vplVec3 d)
{
    const float square = d.x * d.x + d.y * d.y + d.z * d.z;
    return (square >= 0x1p-40f) & (square <= 0x1p40f);
}

// The length of other directions to a power of two.
static int farExponent(vplVec3 d)
{
    int exponent = 0; // stays where the direction is not finite
    frexpf(vplLargestOf(d), &exponent);
    return exponent;
}

// Divides a direction by 2^exponent, which is exact, so that triangle tests neither overflow nor underflow.
static vplRay shorten(const vplRay* ray, int exponent)
{
    const vplVec3 d = ray->direction;
    return (vplRay){
        ray->origin, {ldexpf(d.x, -exponent), ldexpf(d.y, -exponent), ldexpf(d.z, -exponent)}, ray->skip};
}

void vplTraceOneTree(const vplBvh* bvh, vplIsa isa, const vplRay* ray, float tMax, vplRawHit* hitOut)
{
    if (isOrdinary(ray->direction)) {
        vplGetRayKernels(isa)->closest(bvh, ray, tMax, hitOut);
        return;
    }
    const int exponent = farExponent(ray->direction);
    const vplRay shorter = shorten(ray, exponent);
    vplGetRayKernels(isa)->closest(bvh, &shorter, ldexpf(fminf(tMax, FLT_MAX), exponent), hitOut);
    hitOut->t = ldexpf(hitOut->t, -exponent);
}

// Tests what is solid.
static bool isOccluded(const vplGeometry* g, const vplRay* ray, float tMax, bool everyTriangle)
{
    vplRay shorter;
    if (!isOrdinary(ray->direction)) {
        const int exponent = farExponent(ray->direction);
        shorter = shorten(ray, exponent);
        ray = &shorter;
        tMax = ldexpf(fminf(tMax, FLT_MAX), exponent);
    }
    const bool occluded = g->rayTree == NULL || everyTriangle
                              ? testAll(g, ray, tMax, true).triangle >= 0
                              : vplGetRayKernels(g->context->isa)->any(g->rayTree, ray, tMax);
    vplHit hit;
    return occluded || (g->formulaCount > 0 && vplHitByFormula(g, ray, tMax, &hit));
}

bool vplAnyOfTriangles(const vplGeometry* g, const vplRay* ray, float tMax)
{
    vplHit hit;
    return isOccluded(g, ray, tMax, true) ||
           (g->cutOuts != NULL && vplCutOuts_ClosestHit(g, ray, tMax, &hit));
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
    hit->u = raw->b1;
    hit->v = raw->b2;
}

// Locates the hit on a triangle: by the formula of the quad or box that it belongs to, if any.
static inline vplHit finishHit(const vplGeometry* geometry, const vplRay* ray, const vplRawHit* raw)
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
    return hit;
}

vplHit vplFinishHit(const vplGeometry* geometry, const vplRay* ray, const vplRawHit* raw)
{
    return finishHit(geometry, ray, raw);
}

// The closest hit on what is tested as triangles.
static inline void traceTriangles(const vplGeometry* g, const vplRay* ray, float tMax, int* tests,
                                  vplRawHit* raw)
{
    if (g->rayTree != NULL && tests == NULL) { // most rays
        vplGetRayKernels(g->context->isa)->closest(g->rayTree, ray, tMax, raw);
        return;
    }
    bool everyObject = true;
    if (g->rayTree != NULL) {
        vplBvh bvh = *g->rayTree;
        bvh.nodes = bvh.blockCount <= VPL_COUNTED_BLOCKS ? NULL : bvh.nodes;
        everyObject = bvh.nodes == NULL;
        vplGetRayKernels(g->context->isa)->closest(&bvh, ray, tMax, raw);
    } else {
        *raw = testAll(g, ray, tMax, false);
    }
    if (tests != NULL) {
        *tests += everyObject ? g->objectCount : raw->blocks + g->formulaCount;
    }
}

// The closest hit on what is solid.
static bool closestSolid(const vplGeometry* g, const vplRay* ray, float tMax, int* tests, vplHit* hitOut)
{
    vplRawHit raw;
    if (isOrdinary(ray->direction)) {
        traceTriangles(g, ray, tMax, tests, &raw);
    } else {
        const int exponent = farExponent(ray->direction);
        const vplRay shorter = shorten(ray, exponent);
        traceTriangles(g, &shorter, ldexpf(fminf(tMax, FLT_MAX), exponent), tests, &raw);
        raw.t = ldexpf(raw.t, -exponent);
    }
    const bool met = raw.triangle >= 0 && raw.t > 0 && raw.t < INFINITY;
    if (g->formulaCount > 0 && vplHitByFormula(g, ray, met ? raw.t : tMax, hitOut)) {
        return true;
    }
    if (met) {
        *hitOut = finishHit(g, ray, &raw);
    }
    return met;
}

bool vplClosestHit(const vplGeometry* g, const vplRay* ray, float tMax, int* tests, vplHit* hitOut)
{
    const bool met = closestSolid(g, ray, tMax, tests, hitOut);
    if (__builtin_expect(g->cutOuts == NULL, 1)) {
        return met;
    }
    return vplCutOuts_ClosestHit(g, ray, met ? hitOut->t : tMax, hitOut) || met;
}

bool vplGeometry_ClosestHit(const vplGeometry* geometry, const vplRay* ray, vplHit* hitOut)
{
    return vplClosestHit(geometry, ray, INFINITY, NULL, hitOut);
}

bool vplGeometry_IsOccluded(const vplGeometry* geometry, const vplRay* ray, float tMax)
{
    vplHit hit;
    return isOccluded(geometry, ray, tMax, false) ||
           (geometry->cutOuts != NULL && vplCutOuts_ClosestHit(geometry, ray, tMax, &hit));
}

static bool areOrdinary(const vplRayPacket* rays)
{
    uint32_t odd = 0;
    for (int i = 0; i < VPL_RAY_PACKET; i++) {
        const float x = rays->direction[0][i], y = rays->direction[1][i], z = rays->direction[2][i],
                    square = x * x + y * y + z * z;
        odd |= (uint32_t) !((square >= 0x1p-40f) & (square <= 0x1p40f)) << i;
    }
    return (odd & rays->active) == 0;
}

uint32_t vplSolid_AreOccluded(const vplGeometry* geometry, const vplRayPacket* rays, float tMax)
{
    if (geometry->rayTree != NULL && geometry->formulaCount == 0 && areOrdinary(rays)) {
        return vplGetRayKernels(geometry->context->isa)->anyPacket(geometry->rayTree, rays, tMax);
    }
    uint32_t hits = 0;
    for (uint32_t active = rays->active; active != 0; active &= active - 1) {
        const int lane = __builtin_ctz(active);
        const vplRay ray = vplRayPacket_Get(rays, lane);
        hits |= (uint32_t)isOccluded(geometry, &ray, tMax, false) << lane;
    }
    return hits;
}

uint32_t vplGeometry_AreOccluded(const vplGeometry* geometry, const vplRayPacket* rays, float tMax)
{
    uint32_t hits = vplSolid_AreOccluded(geometry, rays, tMax);
    for (uint32_t open = geometry->cutOuts != NULL ? rays->active & ~hits : 0; open != 0; open &= open - 1) {
        const int lane = __builtin_ctz(open);
        const vplRay ray = vplRayPacket_Get(rays, lane);
        vplHit hit;
        hits |= (uint32_t)vplCutOuts_ClosestHit(geometry, &ray, tMax, &hit) << lane;
    }
    return hits;
}

int vplGeometry_Darken(const vplGeometry* geometry, const vplRayPacket* rays, float tMax,
                       float amount[VPL_RAY_PACKET])
{
    if (rays->active == 0) {
        return 0;
    }
    for (uint32_t dark = vplSolid_AreOccluded(geometry, rays, tMax); dark != 0; dark &= dark - 1) {
        amount[__builtin_ctz(dark)] = 0;
    }
    if (geometry->cutOuts != NULL) {
        vplCutOuts_Veil(geometry, rays, tMax, amount);
    }
    return __builtin_popcount(rays->active);
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
    }
    if (object->coplanar) {
        // Rounding moves the point off the triangle, and neighbours in a mesh are not coplanar: clear them all.
        const float distance = (outward ? 1.0f : -1.0f) * vplLargestOf(hit->position) * 0x1p-20f;
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
