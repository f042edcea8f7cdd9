// SPDX-License-Identifier: MIT
// Based on: Emanuele Franchi and Lorenzo Ferrante, Virtual Point Lights, "Intersection Tests". Rays are
// tested in local space without renormalising the direction, so that t means the same for all objects.
// Departs: t must be above 0, and a ray from inside a box hits its exit; otherwise a particle would hit the
// surface it just left.
#include "geometry/triangle.h"
#include "math/double3.h"
#include "math/matrix.h"
#include "math/vec.h"
#include "scene/scene.h"

#include <string.h>

vplResult vplPlacement_Create(vplContext* context, const vplMat4* transform, vplPlacement* placementOut)
{
    REQUIRE(context, context, transform, placementOut);
    vplFault fault = vplCheckTransform(transform);
    if (fault.field != NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPlacement_Create: transform %s", fault.text);
    }
    vplAffine world = vplAffine_FromMat4(transform);
    vplAffine local = vplAffine_Inverse(&world);
    memcpy(placementOut->toWorld, world.m, sizeof world.m);
    memcpy(placementOut->toLocal, local.m, sizeof local.m);
    for (int face = 0; face < 6; face++) { // a row of the inverse is a column of its transpose
        const double* n = local.m[face >> 1];
        double largest = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
        double x = n[0] / largest, y = n[1] / largest, z = n[2] / largest;
        double scale = (face & 1 ? -1 : 1) / sqrt(x * x + y * y + z * z);
        placementOut->normal[face][0] = (float)(x * scale);
        placementOut->normal[face][1] = (float)(y * scale);
        placementOut->normal[face][2] = (float)(z * scale);
    }
    return VPL_SUCCESS;
}

// A ray in local space.
typedef struct LocalRay {
    double o[3], d[3];
} LocalRay;

static LocalRay toLocal(const vplRay* ray, const vplPlacement* p)
{
    LocalRay local;
    for (int i = 0; i < 3; i++) {
        const double* m = p->toLocal[i];
        local.o[i] = m[0] * ray->origin.x + m[1] * ray->origin.y + m[2] * ray->origin.z + m[3];
        local.d[i] = m[0] * ray->direction.x + m[1] * ray->direction.y + m[2] * ray->direction.z;
    }
    return local;
}

// The coordinate on a face along its first axis (`which` 0) or its second.
static float onFace(const double at[3], int face, int which)
{
    const int axis = face >> 1;
    return (float)at[which == 0 ? axis == 0 : 2 - (axis == 2)];
}

// False where t overflows a float: a hit that far away counts as a miss.
static bool fillHit(const vplPlacement* p, const double at[3], double t, int face, vplHit* hit)
{
    double world[3];
    for (int i = 0; i < 3; i++) {
        world[i] = vplDot3(p->toWorld[i], at) + p->toWorld[i][3];
    }
    *hit = (vplHit){.t = (float)t,
                    .object = -1,
                    .face = face,
                    .triangle = -1,
                    .u = onFace(at, face, 0),
                    .v = onFace(at, face, 1),
                    .position = vplRound3(world),
                    .normal = vplVec(p->normal[face][0], p->normal[face][1], p->normal[face][2])};
    return hit->t > 0 && isfinite(hit->t);
}

// Intersects a local ray with the plane at coordinate `side` of an axis. False if parallel or behind.
static bool hitPlane(const LocalRay* r, int axis, double side, double* t, double at[3])
{
    if (r->d[axis] == 0) {
        return false;
    }
    *t = (side - r->o[axis]) / r->d[axis];
    for (int i = 0; i < 3; i++) {
        at[i] = r->o[i] + *t * r->d[i];
    }
    at[axis] = side; // exact, not rounded
    return *t > 0;
}

static double clampToFace(double p)
{
    return p < -0.5 ? -0.5 : p > 0.5 ? 0.5 : p;
}

bool vplRay_HitFace(const vplRay* ray, const vplPlacement* placement, int face, double side, vplHit* hitOut)
{
    const LocalRay r = toLocal(ray, placement);
    double t, at[3];
    if (!hitPlane(&r, face >> 1, side, &t, at)) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        at[i] = clampToFace(at[i]);
    }
    return fillHit(placement, at, t, face, hitOut);
}

bool vplRay_HitQuad(const vplRay* ray, const vplPlacement* placement, vplHit* hitOut)
{
    const LocalRay r = toLocal(ray, placement);
    double t, at[3];
    return hitPlane(&r, 2, 0, &t, at) && fabs(at[0]) <= 0.5 && fabs(at[1]) <= 0.5 &&
           fillHit(placement, at, t, VPL_FACE_QUAD, hitOut);
}

// The part of a ray inside all three slabs, and the faces where it begins and ends.
typedef struct Span {
    double entry, exit;
    int entryFace, exitFace;
} Span;

static bool intersectSlabs(const LocalRay* r, Span* span)
{
    *span = (Span){-INFINITY, INFINITY, VPL_FACE_NONE, VPL_FACE_NONE};
    for (int axis = 0; axis < 3; axis++) {
        double o = r->o[axis], d = r->d[axis];
        if (d == 0) { // avoids (1/2 - 1/2) / 0, which is NaN
            if (fabs(o) > 0.5) {
                return false;
            }
            continue;
        }
        int nearFace = 2 * axis + (d > 0); // a ray towards + enters by the - face
        double tNear = ((d > 0 ? -0.5 : 0.5) - o) / d, tFar = ((d > 0 ? 0.5 : -0.5) - o) / d;
        if (tNear > span->entry) { // strictly: at equal t the lowest axis wins
            span->entry = tNear;
            span->entryFace = nearFace;
        }
        if (tFar < span->exit) {
            span->exit = tFar;
            span->exitFace = nearFace ^ 1;
        }
    }
    return span->entryFace != VPL_FACE_NONE;
}

bool vplRay_HitBox(const vplRay* ray, const vplPlacement* placement, int fromFace, vplHit* hitOut)
{
    LocalRay r = toLocal(ray, placement);
    Span span;
    if (!intersectSlabs(&r, &span)) {
        return false;
    }
    if (fromFace != VPL_FACE_NONE) {
        double outward = fromFace & 1 ? -r.d[fromFace >> 1] : r.d[fromFace >> 1];
        if (outward >= 0) {
            return false; // a convex box is not hit again
        }
        span.entry = -INFINITY; // starts on the surface and crosses the inside
    }
    bool outside = span.entry > 0;
    double t = outside ? span.entry : span.exit;
    int face = outside ? span.entryFace : span.exitFace;
    if (!(span.entry <= span.exit && t > 0)) {
        return false;
    }
    double at[3];
    for (int axis = 0; axis < 3; axis++) {
        at[axis] = clampToFace(r.o[axis] + t * r.d[axis]);
    }
    at[face >> 1] = face & 1 ? -0.5 : 0.5; // exact, not rounded
    return fillHit(placement, at, t, face, hitOut);
}
