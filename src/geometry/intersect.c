// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights, "Intersection Tests". Rays are tested
// in local space without renormalising the direction, so that t means the same for all objects. Departs where
// the text would let a particle hit the surface it just left: t must be > 0, and a box hit from inside
// reports its exit.
#include <vpl/geometry.h>

#include "math/matrix.h"
#include "math/vec.h"
#include "scene/scene.h"

vplResult vplPlacement_Create(vplContext* context, const vplMat4* transform, vplPlacement* placementOut)
{
    vplFault fault = vplCheckTransform(transform);
    if (fault.field != NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPlacement_Create: transform %s", fault.text);
    }
    vplAffine world = vplAffine_FromMat4(transform);
    vplAffine local = vplAffine_Inverse(&world);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            placementOut->toWorld[i][j] = (float)world.m[i][j];
            placementOut->toLocal[i][j] = (float)local.m[i][j];
        }
        for (int j = 0; j < 3; j++) {
            placementOut->normal[i][j] = (float)local.m[j][i];
        }
    }
    return VPL_SUCCESS;
}

static vplVec3 transformPoint(const float m[3][4], vplVec3 p)
{
    return vplVec(m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
                  m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
                  m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]);
}

static vplVec3 transformDirection(const float m[3][4], vplVec3 d)
{
    return vplVec(m[0][0] * d.x + m[0][1] * d.y + m[0][2] * d.z, m[1][0] * d.x + m[1][1] * d.y + m[1][2] * d.z,
                  m[2][0] * d.x + m[2][1] * d.y + m[2][2] * d.z);
}

// The world normal of local face `face`: a signed column of the normal matrix.
static vplVec3 faceNormal(const vplPlacement* p, int face)
{
    int axis = face >> 1;
    vplVec3 n = vplVec(p->normal[0][axis], p->normal[1][axis], p->normal[2][axis]);
    return vplNormalize(face & 1 ? vplNegate(n) : n);
}

static void fillHit(const vplPlacement* p, vplVec3 local, float t, int face, vplHit* hit)
{
    hit->t = t;
    hit->object = -1;
    hit->face = face;
    hit->position = transformPoint(p->toWorld, local);
    hit->normal = faceNormal(p, face);
}

bool vplRay_HitQuad(const vplRay* ray, const vplPlacement* placement, vplHit* hitOut)
{
    vplVec3 o = transformPoint(placement->toLocal, ray->origin);
    vplVec3 d = transformDirection(placement->toLocal, ray->direction);
    if (d.z == 0) {
        return false; // parallel, or in the plane
    }
    float t = -o.z / d.z;
    float x = o.x + t * d.x;
    float y = o.y + t * d.y;
    if (!(t > 0 && isfinite(t) && fabsf(x) <= 0.5f && fabsf(y) <= 0.5f)) {
        return false;
    }
    fillHit(placement, vplVec(x, y, 0), t, VPL_FACE_QUAD, hitOut);
    return true;
}

bool vplRay_HitBox(const vplRay* ray, const vplPlacement* placement, int fromFace, vplHit* hitOut)
{
    vplVec3 localOrigin = transformPoint(placement->toLocal, ray->origin);
    vplVec3 localDirection = transformDirection(placement->toLocal, ray->direction);
    const float o[3] = {localOrigin.x, localOrigin.y, localOrigin.z};
    const float d[3] = {localDirection.x, localDirection.y, localDirection.z};
    float entry = -INFINITY, exit = INFINITY;
    int entryFace = VPL_FACE_NONE, exitFace = VPL_FACE_NONE;
    for (int axis = 0; axis < 3; axis++) {
        if (d[axis] == 0) { // before dividing: (1/2 - 1/2) / 0 is no number
            if (fabsf(o[axis]) > 0.5f) {
                return false;
            }
            continue;
        }
        int nearFace = 2 * axis + (d[axis] > 0); // moving towards +, the - side comes first
        float tNear = ((d[axis] > 0 ? -0.5f : 0.5f) - o[axis]) / d[axis];
        float tFar = ((d[axis] > 0 ? 0.5f : -0.5f) - o[axis]) / d[axis];
        if (tNear > entry) { // strictly: of faces met at one t the lowest axis is named
            entry = tNear;
            entryFace = nearFace;
        }
        if (tFar < exit) {
            exit = tFar;
            exitFace = nearFace ^ 1;
        }
    }
    if (fromFace != VPL_FACE_NONE) {
        float outward = fromFace & 1 ? -d[fromFace >> 1] : d[fromFace >> 1];
        if (outward >= 0) {
            return false; // a convex box is not met again
        }
        entry = -INFINITY; // it starts on the surface and crosses the inside
    }
    bool outside = entry > 0;
    float t = outside ? entry : exit;
    int face = outside ? entryFace : exitFace;
    if (!(entry <= exit && t > 0 && isfinite(t)) || face == VPL_FACE_NONE) {
        return false;
    }
    float hit[3];
    for (int axis = 0; axis < 3; axis++) {
        float p = o[axis] + t * d[axis];
        hit[axis] = p < -0.5f ? -0.5f : p > 0.5f ? 0.5f : p;
    }
    hit[face >> 1] = face & 1 ? -0.5f : 0.5f; // the face is known, not guessed from the rounded point
    fillHit(placement, vplVec(hit[0], hit[1], hit[2]), t, face, hitOut);
    return true;
}

static bool hitObject(const vplGeometry* g, int index, const vplRay* ray, vplRayStart start, vplHit* hitOut)
{
    const vplGeometryObject* object = &g->objects[index];
    if (object->type == VPL_OBJECT_QUAD) {
        return start.object != index && vplRay_HitQuad(ray, &object->placement, hitOut);
    }
    return vplRay_HitBox(ray, &object->placement, start.object == index ? start.face : VPL_FACE_NONE, hitOut);
}

bool vplGeometry_ClosestHit(const vplGeometry* geometry, const vplRay* ray, vplRayStart start, vplHit* hitOut)
{
    bool found = false;
    for (int i = 0; i < geometry->objectCount; i++) {
        vplHit hit;
        if (hitObject(geometry, i, ray, start, &hit) && (!found || hit.t < hitOut->t)) {
            *hitOut = hit;
            hitOut->object = i;
            found = true;
        }
    }
    return found;
}

bool vplGeometry_IsOccluded(const vplGeometry* geometry, const vplRay* ray, vplRayStart start, float tMax)
{
    for (int i = 0; i < geometry->objectCount; i++) {
        vplHit hit;
        if (hitObject(geometry, i, ray, start, &hit) && hit.t < tMax) {
            return true;
        }
    }
    return false;
}
