// SPDX-License-Identifier: MIT
// The open cells of lit sides: those that light reaches.
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/vec.h"
#include "radiosity/sides/lit_search.h"
#include "radiosity/sides/side.h"

enum {
    LIT_POINTS = 4, // remembered per side
    GATHERS = 4,    // rays from each sample that sees none of them
    FEW = VPL_LIT_SAMPLES / 2
};

_Static_assert((int)VPL_PATCH_CELLS == (int)VPL_RAY_PACKET, "one ray for each cell");

// Tests whether the lit point is visible from all cells and nothing covers them. Two packets of rays decide
// that for most sides.
static bool isWhole(const vplLitSearch* s, int side, int64_t* rays)
{
    vplRayPacket down = {.active = 0}, across = {.active = 0};
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        vplLitSample sample = {.side = side, .cell = cell};
        const vplVec3 at = vplLitSample_OnSide(s, &sample),
                      up = vplScale(s->heights[side / 2], vplLitSearch_Normal(s, side, sample.triangle)),
                      offset = vplAdd(at, up);
        vplRayPacket_Set(&down, cell, &(vplRay){offset, vplNegate(up), {sample.triangle, 1}});
        vplRayPacket_Set(&across, cell, &(vplRay){offset, vplSub(s->litPoint[side], offset), {0, 0}});
    }
    *rays += VPL_PATCH_CELLS;
    if (vplGeometry_AreOccluded(s->geometry, &down, 1 + VPL_COPLANAR) != 0) {
        return false;
    }
    *rays += VPL_PATCH_CELLS;
    return vplGeometry_AreOccluded(s->geometry, &across, 1) == 0;
}

// The search on one side.
typedef struct CellSearch {
    const vplLitSearch* search;
    vplVec3 litPoints[LIT_POINTS]; // more than one where something stands on the side
    int side, litCount;
    int64_t* rays;
} CellSearch;

static bool seesLitPoint(const CellSearch* c, vplVec3 point)
{
    for (int i = 0; i < c->litCount; i++) {
        if (vplLitSearch_IsVisible(c->search, point, c->litPoints[i], c->rays)) {
            return true;
        }
    }
    return false;
}

// Tests whether light reaches a sample. `gather`: also cast rays where none of the lit points is visible.
static bool isReached(CellSearch* c, int cell, int index, bool gather)
{
    vplLitSample sample = {.side = c->side, .cell = cell, .index = index};
    vplVec3 from;
    if (!vplLitSample_Offset(c->search, &sample, c->rays)) {
        return false;
    }
    if (seesLitPoint(c, sample.point)) {
        return true;
    }
    if (!gather || !vplLitSample_IsLit(c->search, &sample, GATHERS, c->rays, &from)) {
        return false;
    }
    if (c->litCount < LIT_POINTS) {
        c->litPoints[c->litCount++] = vplLitSearch_MoveTowards(c->search, c->side / 2, sample.point, from);
    }
    return true;
}

// Tests samples first .. first + FEW - 1 of a cell, except those in the bit set `reached`. Returns that set with
// the samples added that light reaches.
static unsigned testSamples(CellSearch* c, int cell, int first, bool gather, unsigned reached)
{
    for (int index = first; index < first + FEW; index++) {
        if (!(reached >> index & 1) && isReached(c, cell, index, gather)) {
            reached |= 1u << index;
        }
    }
    return reached;
}

// Returns the cells of which light reaches at least half or, if there are none, those that it reaches at all:
// a covered point of an open cell gets no light in the equations and would darken the patch. Four samples
// decide, eight where these disagree; samples that missed are tested again once the side has further lit
// points.
static unsigned findOpenCells(CellSearch* c)
{
    unsigned half = 0, some = 0, reached[VPL_PATCH_CELLS] = {0};
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        reached[cell] = testSamples(c, cell, 0, true, 0);
    }
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        int tested = FEW;
        if (c->litCount > 1) {
            reached[cell] = testSamples(c, cell, 0, false, reached[cell]);
        }
        if (reached[cell] != 0 && reached[cell] != (1u << FEW) - 1) {
            reached[cell] = testSamples(c, cell, FEW, true, reached[cell]);
            tested = 2 * FEW;
        }
        half |= (unsigned)(2 * __builtin_popcount(reached[cell]) >= tested) << cell;
        some |= (unsigned)(reached[cell] != 0) << cell;
    }
    return half != 0 ? half : some;
}

// ---- triangles on both sides of a wall: those in groups, and those that are too small to be cut

// The side that a point of a triangle belongs to.
static int sideAt(const vplLitSearch* s, int side, int triangle, vplVec3 point)
{
    return vplPatches_IsGroup(s->patches, side / 2)
               ? side
               : 2 * vplPatches_Find(s->patches, triangle, point) + (side & 1);
}

// Returns the code of vplPatchSides.dark for one face of a triangle. Corners that are covered do not count.
static int darknessOf(const vplLitSearch* s, int side, int triangle, int64_t* rays)
{
    vplVec3 corners[3];
    bool dark = false;
    int lit = -1;
    vplPatchNode_GetCorners(s->patches, triangle, side & 1, corners);
    for (int k = 0; k < 3; k++) {
        const vplVec3 at = vplNearCorner(corners, k);
        vplLitSample sample = {.side = sideAt(s, side, triangle, at),
                               .cell = triangle % VPL_PATCH_CELLS,
                               .index = k,
                               .triangle = triangle};
        vplVec3 from;
        if (!vplLitSearch_Offset(s, sample.side, triangle, at, rays, &sample.point)) {
            continue;
        }
        if (s->open[sample.side] != 0 &&
            (vplLitSearch_IsVisible(s, sample.point, s->litPoint[sample.side], rays) ||
             vplLitSample_IsLit(s, &sample, GATHERS, rays, &from))) {
            lit = k;
        } else {
            dark = true;
        }
    }
    return !dark ? 0 : lit < 0 ? 1 : 2 + lit;
}

// Tests a triangle if it lies in the box of a dark room. Others have no part in it.
static void findDarkTriangle(const vplLitSearch* s, int side, int triangle, int64_t* rays)
{
    if (vplLitSearch_FindDarkBox(s, vplLitSearch_BoxOf(s, triangle)) < s->darkBoxCount) {
        s->dark[triangle] |= (uint8_t)(darknessOf(s, side, triangle, rays) << 4 * (side & 1));
    }
}

// Tests the triangles of a patch. A triangle that is divided into patches is tested once, with the first of them.
static void findDarkTriangles(const vplLitSearch* s, int side, int64_t* rays)
{
    const int patch = side / 2, triangle = vplPatches_TriangleOf(s->patches, patch);
    if (vplPatches_IsGroup(s->patches, patch)) {
        const vplPatchParts parts = vplPatches_GetParts(s->patches, patch);
        for (int i = 0; i < parts.count && s->open[side] != 0; i++) {
            findDarkTriangle(s, side, parts.nodes[i], rays);
        }
    } else if (patch == 0 || vplPatches_TriangleOf(s->patches, patch - 1) != triangle) {
        findDarkTriangle(s, side, triangle, rays);
    }
}

// A small patch has one cell.
static bool isSmall(const vplLitSearch* s, int patch)
{
    return vplPatches_Area(s->patches, patch) * 32 < s->meanArea;
}

static void findCells(const vplLitSearch* s, int side, int64_t* rays)
{
    if (s->dark != NULL) {
        findDarkTriangles(s, side, rays);
    }
    if (s->open[side] == 0 || isSmall(s, side / 2) || isWhole(s, side, rays)) {
        s->nextOpen[side] = s->open[side];
        return;
    }
    CellSearch c = {.search = s, .litPoints = {s->litPoint[side]}, .side = side, .litCount = 1, .rays = rays};
    s->nextOpen[side] = (uint16_t)findOpenCells(&c);
}

vplResult vplLitSearch_FindCells(vplLitSearch* s)
{
    int added;
    TRY(vplLitSearch_ForAllSides(s, findCells, (const double[2]){0.7, 1}, &added));
    // The pass does not close a side of which no cell is left, so its own results replace `open`.
    uint16_t* cells = s->nextOpen;
    s->nextOpen = s->open;
    s->open = cells;
    return VPL_SUCCESS;
}
