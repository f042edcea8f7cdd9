// SPDX-License-Identifier: MIT
#include "radiosity/sides/side.h"

#include "base/context.h"
#include "geometry/triangle.h"
#include "math/vec.h"

#include <float.h>

void vplPatchNode_GetCorners(const vplPatches* patches, int node, bool back, vplVec3 cornersOut[3])
{
    const uint32_t* corners = patches->nodes[node].corners;
    for (int k = 0; k < 3; k++) {
        cornersOut[k] = patches->positions[corners[back ? (3 - k) % 3 : k]];
    }
}

// ---- cells

// Turns barycentrics of a part into those of the whole triangle.
static inline void fromPart(int part, float w[3])
{
    for (int k = 0; k < 3; k++) {
        w[k] = part == 3 ? 0.5f * (1 - w[k]) : 0.5f * (w[k] + (k == part ? 1.0f : 0.0f));
    }
}

// Source: Heitz, A Low-Distortion Map Between Triangle and Square, 2019.
static inline void toTriangle(float u, float v, float w[3])
{
    w[1] = v > u ? 0.5f * u : u - 0.5f * v;
    w[2] = v > u ? v - 0.5f * u : 0.5f * v;
    w[0] = 1 - w[1] - w[2];
}

static inline vplVec3 weigh(const vplVec3 corners[3], const float w[3])
{
    return vplAdd(vplScale(w[0], corners[0]), vplAdd(vplScale(w[1], corners[1]), vplScale(w[2], corners[2])));
}

vplVec3 vplCell_Point(const vplVec3 corners[3], int cell, float u, float v)
{
    float w[3];
    toTriangle(u, v, w);
    fromPart(cell & 3, w);
    fromPart(cell >> 2, w);
    return weigh(corners, w);
}

vplVec3 vplTriangle_Point(const vplVec3 corners[3], float u, float v)
{
    float w[3];
    toTriangle(u, v, w);
    return weigh(corners, w);
}

int vplGroup_SampleTriangle(const vplPatches* p, int patch, int k, float u, float* uOut)
{
    const int* first = &p->firstMember[patch - (p->patchCount - p->groupCount)];
    const double target = p->areaUpTo[first[1] - 1] * ((k + (double)u) / VPL_PATCH_CELLS);
    int low = first[0], high = first[1] - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (p->areaUpTo[middle] > target) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    const double before = low > first[0] ? p->areaUpTo[low - 1] : 0, area = p->areaUpTo[low] - before;
    const float place = (float)((target - before) / area);
    *uOut = place < 0x1.fffffep-1f ? place : 0x1.fffffep-1f;
    return p->members[low];
}

vplSidePoint vplPatchSide_SampleCell(const vplPatchSides* sides, const vplPatchSide* side, int k, float u,
                                     float v)
{
    const vplPatches* p = sides->patches;
    if (!vplPatches_IsGroup(p, side->patch)) {
        return (vplSidePoint){vplCell_Point(side->corners, k, u, v), side->normal,
                              vplPatches_TriangleOf(p, side->patch)};
    }
    vplVec3 corners[3];
    const int triangle = vplGroup_SampleTriangle(p, side->patch, k, u, &u);
    const vplVec3 n = p->geometry->normals[triangle];
    vplPatchNode_GetCorners(p, triangle, side->back, corners);
    return (vplSidePoint){vplTriangle_Point(corners, u, v), side->back ? vplNegate(n) : n, triangle};
}

vplVec3 vplPatchSide_CellCentre(const vplPatchSide* side, int k)
{
    const float u = 2.0f / 3; // both give barycentrics of 1/3
    return vplCell_Point(side->corners, k, u, u);
}

int vplPatchSide_OpenCell(const vplPatchSide* side, int k)
{
    if (side->open == VPL_ALL_CELLS) { // most sides
        return k;
    }
    unsigned open = side->open;
    for (; k > 0; k--) {
        open &= open - 1;
    }
    return __builtin_ctz(open);
}

// ---- rays

vplRay vplPatchSides_Leave(const vplPatchSides* sides, const vplSidePoint* from, vplVec3 direction)
{
    const vplGeometry* g = sides->patches->geometry;
    const int triangle = from->triangle;
    const vplHit start = {.object = g->owners[triangle],
                          .face = vplGeometry_FaceOf(g, triangle),
                          .triangle = triangle,
                          .position = from->at,
                          .normal = g->normals[triangle]};
    return vplGeometry_Leave(g, &start, direction);
}

int vplPatchSides_Hit(const vplPatchSides* sides, const vplRay* ray)
{
    vplHit hit;
    if (!vplGeometry_ClosestHit(sides->patches->geometry, ray, &hit)) {
        return -1;
    }
    return vplPatchSides_Met(sides, &hit, ray->direction);
}

// A point near a corner is this fraction of the way from the corner to the triangle's centroid.
static const float NEAR_CORNER = 0.125f;

vplVec3 vplNearCorner(const vplVec3 corners[3], int k)
{
    const vplVec3 centre = vplScale(1 / 3.0f, vplAdd(corners[0], vplAdd(corners[1], corners[2])));
    return vplAdd(corners[k], vplScale(NEAR_CORNER, vplSub(centre, corners[k])));
}

// Tests whether light reaches a point of a triangle of a group. From the dark part of a triangle that a wall crosses, the wall hides the
// lit corner.
static bool isLitAt(const vplPatchSides* sides, const vplHit* hit, int face)
{
    const int code = sides->dark == NULL ? 0 : sides->dark[hit->triangle] >> 4 * face & 15;
    if (code < 2) {
        return code == 0;
    }
    vplVec3 corners[3];
    vplPatchNode_GetCorners(sides->patches, hit->triangle, face, corners);
    const vplVec3 n = sides->patches->geometry->normals[hit->triangle], up = face ? vplNegate(n) : n;
    const vplVec3 lit = vplNearCorner(corners, code - 2), way = vplSub(lit, hit->position);
    const vplSidePoint from = {hit->position, up, hit->triangle};
    const vplRay ray = vplPatchSides_Leave(sides, &from, vplAdd(way, vplScale(0x1p-8f * vplLength(way), up)));
    return !vplGeometry_IsOccluded(sides->patches->geometry, &ray, 1);
}

int vplPatchSides_Met(const vplPatchSides* sides, const vplHit* hit, vplVec3 direction)
{
    const int patch = vplPatches_Find(sides->patches, hit->triangle, hit->position);
    const int face = vplDot(direction, hit->normal) > 0;
    return patch < 0 || !isLitAt(sides, hit, face) ? -1 : vplSideOf(sides, patch, face);
}

// ---- values

vplRgb vplReflectanceOf(const vplPatchSides* sides, int triangle, int side)
{
    return side >= 0 && !vplPatches_IsGroup(sides->patches, sides->sides[side].patch)
               ? sides->sides[side].reflectance
               : vplReflectanceOfTriangle(sides->patches->geometry, triangle);
}

float vplClampToFloat(double x)
{
    return x > (double)FLT_MAX ? FLT_MAX : x < -(double)FLT_MAX ? -FLT_MAX : (float)x;
}

vplResult vplCheckRgb(const vplContext* context, const char* name, const vplRgb* values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const vplRgb v = values[i];
        if (!(isfinite(v.r) && isfinite(v.g) && isfinite(v.b))) {
            return vplFail(context, VPL_INVALID_ARGUMENT, "%s[%zu] is (%g, %g, %g), must be finite", name, i,
                           (double)v.r, (double)v.g, (double)v.b);
        }
    }
    return VPL_SUCCESS;
}

// ---- values of sides, channel by channel

size_t vplPaddedSides(int count)
{
    return ((size_t)count + VPL_SIDE_LANES - 1) / VPL_SIDE_LANES * VPL_SIDE_LANES;
}

vplPlanes vplPlanes_Alloc(vplArena* arena, int count)
{
    const size_t stride = vplPaddedSides(count);
    float* values = vplArena_AllocZero(arena, 3 * stride, sizeof *values);
    return values != NULL ? (vplPlanes){{values, values + stride, values + 2 * stride}} : (vplPlanes){{NULL}};
}

void vplPlanes_Read(vplPlanes* planes, const vplRgb* values, int count)
{
    for (int i = 0; i < count; i++) {
        planes->c[0][i] = values[i].r;
        planes->c[1][i] = values[i].g;
        planes->c[2][i] = values[i].b;
    }
}

void vplPlanes_Write(const vplPlanes* planes, int count, vplRgb* valuesOut)
{
    for (int i = 0; i < count; i++) {
        valuesOut[i] = (vplRgb){planes->c[0][i], planes->c[1][i], planes->c[2][i]};
    }
}
