// SPDX-License-Identifier: MIT
// The cells of sides that light reaches.
#include "geometry/triangle.h"
#include "radiosity/open_cells.h"

#include "geometry/bvh.h"
#include "radiosity/cells.h"

enum {
    KNOWN = 4,   // places of a side that are remembered
    GATHERS = 4, // rays from each point that sees none of them
    FEW = VPL_REACH_POINTS / 2
};

_Static_assert((int)VPL_PATCH_CELLS == (int)VPL_RAY_PACKET, "one ray for each cell");

// Whether from the middle of all cells of a side the known place is seen, and nothing is between them and the side. So it
// is on most sides, and two packets of rays tell.
static bool isWhole(const vplReach* reach, int side, int64_t* rays)
{
    vplRayPacket down = {.active = 0}, over = {.active = 0};
    vplVec3 corners[3];
    const vplVec3 up = vplScale(reach->heights[side / 2], vplReach_Normal(reach, side));
    const int triangle = vplPatches_TriangleOf(reach->patches, side / 2);
    vplSide_GetCorners(reach->patches, side / 2, side & 1, corners);
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        const vplVec3 place = vplAdd(vplReach_PointOf(reach, side, cell, 0), up);
        vplRayPacket_Set(&down, cell, &(vplRay){place, vplNegate(up), {triangle, 1}});
        vplRayPacket_Set(&over, cell, &(vplRay){place, vplSub(reach->known[side], place), {0, 0}});
    }
    *rays += VPL_PATCH_CELLS;
    if (vplGeometry_AreOccluded(reach->geometry, &down, 1 + VPL_SAME_PLACE) != 0) {
        return false;
    }
    *rays += VPL_PATCH_CELLS;
    return vplGeometry_AreOccluded(reach->geometry, &over, 1) == 0;
}

typedef struct Settler {
    const vplReach* reach;
    vplVec3 known[KNOWN]; // more than one where something stands on the side
    int side, knownCount;
    int64_t* rays;
} Settler;

static bool seesKnown(const Settler* s, vplVec3 place)
{
    for (int i = 0; i < s->knownCount; i++) {
        if (vplReach_IsFree(s->reach, place, s->known[i], s->rays)) {
            return true;
        }
    }
    return false;
}

static bool isLit(const Settler* s, int cell, int point, vplVec3 place, vplVec3* from)
{
    if (vplReach_SeesSource(s->reach, s->side, cell, point, place, s->rays, from)) {
        return true;
    }
    for (int ray = 0; ray < GATHERS; ray++) {
        vplLanding landing;
        if (vplReach_SeesLight(s->reach, s->side, cell, point, ray, place, s->rays, &landing)) {
            *from = landing.place;
            return true;
        }
    }
    return false;
}

// `search`: also where none of the known places is seen.
static bool isReached(Settler* s, int cell, int point, bool search)
{
    vplVec3 place, from;
    if (!vplReach_Rise(s->reach, s->side, vplReach_PointOf(s->reach, s->side, cell, point), s->rays,
                       &place)) {
        return false;
    }
    if (seesKnown(s, place)) {
        return true;
    }
    if (!search || !isLit(s, cell, point, place, &from)) {
        return false;
    }
    if (s->knownCount < KNOWN) {
        s->known[s->knownCount++] = vplReach_Pull(s->reach, s->side / 2, place, from);
    }
    return true;
}

// Points first .. first + FEW - 1 of a cell that are reached and were not.
static unsigned findPoints(Settler* s, int cell, int first, bool search, unsigned reached)
{
    for (int point = first; point < first + FEW; point++) {
        if (!(reached >> point & 1) && isReached(s, cell, point, search)) {
            reached |= 1u << point;
        }
    }
    return reached;
}

// Cells of which light reaches a half at least; where it reaches no half, those that it reaches at all. A point of an
// open cell that is covered gets no light in the equations, and would darken the patch. Four points tell, eight where
// these do not agree; those that missed are tried again when other places of the side are known.
static unsigned cellsInPart(Settler* s)
{
    unsigned half = 0, some = 0, reached[VPL_PATCH_CELLS] = {0};
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        reached[cell] = findPoints(s, cell, 0, true, 0);
    }
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        int tested = FEW;
        if (s->knownCount > 1) {
            reached[cell] = findPoints(s, cell, 0, false, reached[cell]);
        }
        if (reached[cell] != 0 && reached[cell] != (1u << FEW) - 1) {
            reached[cell] = findPoints(s, cell, FEW, true, reached[cell]);
            tested = 2 * FEW;
        }
        half |= (unsigned)(2 * __builtin_popcount(reached[cell]) >= tested) << cell;
        some |= (unsigned)(reached[cell] != 0) << cell;
    }
    return half != 0 ? half : some;
}

static void findCells(const vplReach* reach, int side, int64_t* rays)
{
    if (reach->open[side] == 0 || vplReach_IsSmall(reach, side / 2) || isWhole(reach, side, rays)) {
        reach->nextOpen[side] = reach->open[side];
        return;
    }
    Settler s = {.reach = reach, .known = {reach->known[side]}, .side = side, .knownCount = 1, .rays = rays};
    reach->nextOpen[side] = (uint16_t)cellsInPart(&s);
}

vplResult vplReach_FindCells(vplReach* reach)
{
    int fresh;
    vplResult result = vplReach_Sweep(reach, findCells, 0.7, 1, &fresh);
    if (result == VPL_SUCCESS) { // also where no cell is left, which a sweep keeps
        uint16_t* cells = reach->nextOpen;
        reach->nextOpen = reach->open;
        reach->open = cells;
    }
    return result;
}
