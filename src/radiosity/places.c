// SPDX-License-Identifier: MIT
// Places a hair above surfaces, and what is between them.
#include "base/context.h"
#include "geometry/bvh.h"
#include "radiosity/cells.h"
#include "radiosity/open_cells.h"

int vplCell_Find(const vplVec3 corners[3], vplVec3 point)
{
    double u[3], v[3], p[3], uu = 0, uv = 0, vv = 0, pu = 0, pv = 0;
    for (int k = 0; k < 3; k++) {
        const double origin = vplComponent(corners[0], k);
        u[k] = vplComponent(corners[1], k) - origin;
        v[k] = vplComponent(corners[2], k) - origin;
        p[k] = vplComponent(point, k) - origin;
        uu += u[k] * u[k];
        uv += u[k] * v[k];
        vv += v[k] * v[k];
        pu += p[k] * u[k];
        pv += p[k] * v[k];
    }
    const double area = uu * vv - uv * uv;
    double w[3] = {1, 0, 0};
    if (area > 0) {
        w[1] = (vv * pu - uv * pv) / area;
        w[2] = (uu * pv - uv * pu) / area;
        w[0] = 1 - w[1] - w[2];
    }
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
    return reach->patches->nodes[reach->patches->patches[side / 2]].triangle;
}

static vplVec3 normalOf(const vplReach* reach, int side)
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

// Triangles whose distance is this share of a place's height apart are in one place: their rounding decides which of
// them a ray meets. That triangle counts which has the lowest index.
static const float SAME_PLACE = 0x1p-6f;

// The first of all triangles that are where `triangle` is under a place.
static int firstBelow(const vplReach* reach, vplVec3 place, vplVec3 down, int triangle, int64_t* rays)
{
    const vplRay ray = {place, down, {triangle, reach->geometry->triangleCount - triangle}};
    vplHit hit;
    ++*rays;
    const bool found = vplClosestHitWithin(reach->geometry, &ray, 1 + SAME_PLACE, &hit);
    return found && hit.t > 1 - SAME_PLACE ? hit.triangle : triangle;
}

bool vplReach_Rise(const vplReach* reach, int side, vplVec3 point, int64_t* rays, vplVec3* placeOut)
{
    const int triangle = triangleOf(reach, side);
    const vplVec3 up = vplScale(reach->heights[side / 2], normalOf(reach, side));
    const vplRay ray = {vplAdd(point, up), vplNegate(up), {triangle, 1}};
    vplHit hit;
    *placeOut = ray.origin;
    ++*rays;
    if (!vplClosestHitWithin(reach->geometry, &ray, 1 + SAME_PLACE, &hit)) {
        return true;
    }
    return hit.t > 1 - SAME_PLACE && hit.triangle > triangle &&
           firstBelow(reach, ray.origin, ray.direction, triangle, rays) == triangle;
}

bool vplReach_Land(const vplReach* reach, vplVec3 from, vplVec3 direction, int64_t* rays,
                   vplLanding* landingOut)
{
    const vplRay ray = {from, direction, {0, 0}};
    vplHit hit;
    vplVec3 corners[3];
    ++*rays;
    if (!vplGeometry_ClosestHit(reach->geometry, &ray, &hit)) {
        return false;
    }
    const vplVec3 normal = vplDot(direction, hit.normal) > 0 ? vplNegate(hit.normal) : hit.normal;
    int patch = vplPatches_Find(reach->patches, hit.triangle, hit.position);
    const vplVec3 up = vplScale(reach->heights[patch], normal), place = vplAdd(hit.position, up);
    const int triangle = firstBelow(reach, place, vplNegate(up), hit.triangle, rays);
    if (triangle != hit.triangle) {
        patch = vplPatches_Find(reach->patches, triangle, hit.position);
    }
    const bool back = vplDot(normal, reach->geometry->normals[triangle]) < 0;
    vplSide_GetCorners(reach->patches, patch, back, corners);
    *landingOut = (vplLanding){place, normal, 2 * patch + back, vplCell_Find(corners, hit.position)};
    return vplReach_IsFree(reach, from, place, rays);
}

void vplReach_Mark(vplReach* reach, const vplLanding* landing)
{
    if (reach->open[landing->side] == 0) {
        reach->known[landing->side] = landing->place;
    }
    const bool small = vplReach_IsSmall(reach, landing->side / 2);
    reach->open[landing->side] |= (uint16_t)(small ? 0xffff : 1 << landing->cell);
}
