// SPDX-License-Identifier: MIT
// One side of a patch: its cells, its corners, and rays that leave or hit it.
//
// Cell 4 a + b of a triangle is part b of its part a. Parts 0, 1 and 2 of a triangle are those at its
// corners, part 3 is the middle one.
#ifndef VPL_RADIOSITY_SIDE_H
#define VPL_RADIOSITY_SIDE_H

#include "base/arena.h"
#include "geometry/cut_outs.h"
#include "geometry/paint.h"
#include "radiosity/radiosity_kernels.h"

// vplPatchSide.open where all cells are open.
enum { VPL_ALL_CELLS = (1 << VPL_PATCH_CELLS) - 1 };

// Index in sides->sides of a patch's front (0) or back (1); -1: light does not reach it.
static inline int vplSideOf(const vplPatchSides* sides, int patch, int face)
{
    return sides->ofPatch[2 * (size_t)patch + (size_t)face];
}

// The patches that light reaches on some side.
static inline int vplPatchSides_CountPatches(const vplPatchSides* sides)
{
    int count = 0;
    for (int i = 0; i < sides->count; i++) {
        count += i == 0 || sides->sides[i].patch != sides->sides[i - 1].patch;
    }
    return count;
}

// The corners of a node, counter-clockwise seen from one of its sides.
void vplPatchNode_GetCorners(const vplPatches* patches, int node, bool back, vplVec3 cornersOut[3]);

// A point of a cell of a triangle, uniform over it for u, v uniform in [0, 1).
vplVec3 vplCell_Point(const vplVec3 corners[3], int cell, float u, float v);

// The triangle at a point of cell k of a group. *uOut, v is the point's place on the whole triangle.
int vplGroup_SampleTriangle(const vplPatches* patches, int patch, int k, float u, float* uOut);

// A point of a triangle, uniform over it for u, v uniform in [0, 1).
vplVec3 vplTriangle_Point(const vplVec3 corners[3], float u, float v);

// The midpoint of cell k of a patch that is no group.
vplVec3 vplPatchSide_CellCentre(const vplPatchSide* side, int k);

// The k-th open cell.
int vplPatchSide_OpenCell(const vplPatchSide* side, int k);

// The ray that leaves a side at a point of a triangle. The point's normal does not count.
vplRay vplPatchSides_Leave(const vplPatchSides* sides, const vplSidePoint* from, vplVec3 direction);

// The side that a ray hits; -1: the ray hits nothing, or a side that light does not reach.
int vplPatchSides_Hit(const vplPatchSides* sides, const vplRay* ray);

// A point of a triangle near corner k.
vplVec3 vplNearCorner(const vplVec3 corners[3], int k);

// The same as vplPatchSides_Hit for a ray whose hit is known.
int vplPatchSides_Met(const vplPatchSides* sides, const vplHit* hit, vplVec3 direction);

// The share of what each side emits that arrives at sides, by 64 rays from each. *rays grows by them. (hit_share.c)
vplResult vplPatchSides_FindHitShares(const vplPatchSides* sides, uint64_t seed, float* sharesOut,
                                      int64_t* rays);

// The reflectance of a triangle of the geometry.
static inline vplRgb vplReflectanceOfTriangle(const vplGeometry* g, int triangle)
{
    return vplGeometry_ReflectanceOf(g, triangle);
}

// The reflectance of a triangle that is a part of a patch. `side`: the patch's side, or -1.
vplRgb vplReflectanceOf(const vplPatchSides* sides, int triangle, int side);

// sum += weight * value, per channel.
static inline void vplAddRgb(double sum[3], double weight, vplRgb value)
{
    sum[0] += weight * (double)value.r;
    sum[1] += weight * (double)value.g;
    sum[2] += weight * (double)value.b;
}

static inline vplRgb vplDivideRgb(const double sum[3], double by)
{
    return (vplRgb){(float)(sum[0] / by), (float)(sum[1] / by), (float)(sum[2] / by)};
}

// x, clamped to the range of float.
float vplClampToFloat(double x);

// VPL_INVALID_ARGUMENT unless all values are finite. The message begins with "<name>[<index>] is".
vplResult vplCheckRgb(const vplContext* context, const char* name, const vplRgb* values, size_t count);

// ---- values of sides, channel by channel

// `count`, rounded up to a multiple of VPL_SIDE_LANES.
size_t vplPaddedSides(int count);

// All 0, in one allocation. NULL planes when out of memory; vplArena_Check reports it.
vplPlanes vplPlanes_Alloc(vplArena* arena, int count);

void vplPlanes_Read(vplPlanes* planes, const vplRgb* values, int count);
void vplPlanes_Write(const vplPlanes* planes, int count, vplRgb* valuesOut);

#endif
