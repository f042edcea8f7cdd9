// SPDX-License-Identifier: MIT
// Places a hair above surfaces, and what is between them.
#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "radiosity/cells.h"
#include "radiosity/open_cells.h"

int vplCell_Find(const vplVec3 corners[3], vplVec3 point)
{
    double w[3];
    vplTriangle_Barycentrics(corners, point, w);
    const int part = vplCell_Inward(w);
    return 4 * part + vplCell_Inward(w);
}

void vplSide_GetCorners(const vplPatches* patches, int patch, bool back, vplVec3 cornersOut[3])
{
    const uint32_t* corners = patches->nodes[patches->patches[patch]].corners;
    for (int k = 0; k < 3; k++) {
        cornersOut[k] = patches->positions[corners[back ? (3 - k) % 3 : k]];
    }
}

static int triangleOf(const vplReach* reach, int side)
{
    return vplPatches_TriangleOf(reach->patches, side / 2);
}

vplVec3 vplReach_Normal(const vplReach* reach, int side)
{
    const vplVec3 n = reach->geometry->normals[triangleOf(reach, side)];
    return side & 1 ? vplNegate(n) : n;
}

bool vplReach_IsSmall(const vplReach* reach, int patch)
{
    return vplPatches_Area(reach->patches, patch) * 32 < reach->meanArea;
}

bool vplReach_IsFree(const vplReach* reach, vplVec3 a, vplVec3 b, int64_t* rays)
{
    const vplRay ray = {a, vplSub(b, a), {0, 0}};
    const vplVec3 d = ray.direction;
    if (d.x == 0 && d.y == 0 && d.z == 0) {
        return true;
    }
    ++*rays;
    return !vplGeometry_IsOccluded(reach->geometry, &ray, 1);
}

vplVec3 vplReach_Pull(const vplReach* reach, int patch, vplVec3 place, vplVec3 towards)
{
    const vplVec3 way = vplSub(towards, place);
    const float length = vplLength(way), height = reach->heights[patch];
    return vplAdd(place, vplScale(length > 2 * height ? height / length : 0.5f, way));
}

// ---- triangles in one place

// The first of all triangles that are where `triangle` is under a place.
static int firstBelow(const vplReach* reach, vplVec3 place, vplVec3 down, int triangle, int64_t* rays)
{
    const vplRay ray = {place, down, {triangle, reach->geometry->triangleCount - triangle}};
    vplHit hit;
    ++*rays;
    const bool found = vplClosestHitWithin(reach->geometry, &ray, 1 + VPL_SAME_PLACE, &hit);
    return found && hit.t > 1 - VPL_SAME_PLACE ? hit.triangle : triangle;
}

bool vplReach_Rise(const vplReach* reach, int side, vplVec3 point, int64_t* rays, vplVec3* placeOut)
{
    const int triangle = triangleOf(reach, side);
    const vplVec3 up = vplScale(reach->heights[side / 2], vplReach_Normal(reach, side));
    const vplRay ray = {vplAdd(point, up), vplNegate(up), {triangle, 1}};
    vplHit hit;
    *placeOut = ray.origin;
    ++*rays;
    if (!vplClosestHitWithin(reach->geometry, &ray, 1 + VPL_SAME_PLACE, &hit)) {
        return true;
    }
    return hit.t > 1 - VPL_SAME_PLACE && hit.triangle > triangle &&
           firstBelow(reach, ray.origin, ray.direction, triangle, rays) == triangle;
}

// ---- landing

bool vplReach_Land(const vplReach* reach, vplVec3 from, vplVec3 direction, int64_t* rays,
                   vplLanding* landingOut)
{
    const vplRay ray = {from, direction, {0, 0}};
    vplHit hit;
    ++*rays;
    if (!vplGeometry_ClosestHit(reach->geometry, &ray, &hit)) {
        return false;
    }
    const bool back = vplDot(direction, hit.normal) > 0;
    const vplVec3 normal = back ? vplNegate(hit.normal) : hit.normal;
    const int patch = vplPatches_Find(reach->patches, hit.triangle, hit.position);
    *landingOut =
        (vplLanding){vplAdd(hit.position, vplScale(reach->heights[patch], normal)), normal, 2 * patch + back};
    return true;
}

void vplReach_Settle(const vplReach* reach, vplLanding* landing, int64_t* rays)
{
    const vplVec3 down = vplScale(-reach->heights[landing->side / 2], landing->normal);
    const int triangle = triangleOf(reach, landing->side),
              first = firstBelow(reach, landing->place, down, triangle, rays);
    if (first != triangle) {
        const int patch = vplPatches_Find(reach->patches, first, vplAdd(landing->place, down));
        landing->side = 2 * patch + (vplDot(landing->normal, reach->geometry->normals[first]) < 0);
    }
}
