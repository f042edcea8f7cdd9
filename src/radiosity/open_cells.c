// SPDX-License-Identifier: MIT
// What particles missed: sides that see a side that light reaches, and the cells of each.
#include "radiosity/open_cells.h"

#include "base/context.h"
#include "base/rng.h"
#include "math/sampling.h"
#include "math/scalar.h"
#include "radiosity/cells.h"

enum {
    TASK = 32,    // patches
    QUARTERS = 4, // of a side that nothing is known of: a point in each
    POINTS = 8,   // of a cell that is open in part
    GATHERS = 4,  // rays from each point
    KNOWN = 4,    // places of a side that are remembered
    SWEEPS = 16,  // rooms behind rooms that no particle came to
    STREAM = 0x5ead1000
};

typedef struct Sweep {
    vplReach* reach;
    void (*examine)(const vplReach* reach, int side, int64_t* rays);
} Sweep;

// ---- one side

// Random numbers of point `point` of cell `cell` of a side, and of the rays from it.
static vplRandom4 dice(const vplReach* reach, int side, int cell, int point, int ray)
{
    const uint64_t index =
        ((uint64_t)side * VPL_PATCH_CELLS + (uint64_t)cell) * 64 + (uint64_t)(point * 8 + ray);
    return vplRandomAt(reach->def->seed, STREAM + (uint32_t)reach->sweep, index);
}

static bool risesFrom(const vplReach* reach, int side, int cell, int point, int64_t* rays, vplVec3* place)
{
    const vplRandom4 r = dice(reach, side, cell, point, 0);
    vplVec3 corners[3];
    vplSide_GetCorners(reach->patches, side / 2, side & 1, corners);
    const float u = ((float)point + vplUnitFloat(r.v[0])) / POINTS,
                v = vplUnitFloat(r.v[1]) + vplVanDerCorput((uint32_t)point);
    const vplVec3 at = vplCell_Point(corners, cell, u, v < 1 ? v : v - 1);
    return vplReach_Rise(reach, side, at, rays, place);
}

// Whether a ray from a place lands where light is: from there the known place of that side must be free to go to, or
// the floor under a box would be light because it is so beside it.
static bool seesLight(const vplReach* reach, int side, int cell, int point, int ray, vplVec3 place,
                      int64_t* rays)
{
    const vplRandom4 r = dice(reach, side, cell, point, 1 + ray);
    const vplPatches* patches = reach->patches;
    vplVec3 n = reach->geometry->normals[patches->nodes[patches->patches[side / 2]].triangle];
    n = side & 1 ? vplNegate(n) : n;
    vplLanding landing;
    const vplVec3 direction = vplSampleCosineAround(n, vplUnitFloat(r.v[0]), vplUnitFloat(r.v[1]));
    return vplReach_Land(reach, place, direction, rays, &landing) && reach->open[landing.side] != 0 &&
           vplReach_IsFree(reach, landing.place, reach->known[landing.side], rays);
}

static void note(const vplReach* reach, int side, int cell, vplVec3 place)
{
    if (reach->nextOpen[side] == 0) {
        reach->nextKnown[side] = place;
    }
    reach->nextOpen[side] |= (uint16_t)(vplReach_IsSmall(reach, side / 2) ? 0xffff : 1 << cell);
}

static bool seesEye(const vplReach* reach, int side, vplVec3 place, int64_t* rays)
{
    const vplPatches* patches = reach->patches;
    const vplVec3 n = reach->geometry->normals[patches->nodes[patches->patches[side / 2]].triangle];
    for (int i = 0; i < reach->def->eyeCount; i++) {
        const vplVec3 eye = reach->def->eyes[i];
        const float along = vplDot(vplSub(eye, place), n);
        if ((side & 1 ? -along : along) > 0 && vplReach_IsFree(reach, place, eye, rays)) {
            return true;
        }
    }
    return false;
}

// A side that nothing reaches yet, seen from an eye.
static void lookAtSide(const vplReach* reach, int side, int64_t* rays)
{
    for (int point = 0; point < QUARTERS && reach->open[side] == 0 && reach->nextOpen[side] == 0; point++) {
        const int cell = 5 * point;
        vplVec3 place;
        if (risesFrom(reach, side, cell, 0, rays, &place) && seesEye(reach, side, place, rays)) {
            note(reach, side, cell, place);
        }
    }
}

// A side that nothing reaches yet: does it see one that is reached?
static void exploreSide(const vplReach* reach, int side, int64_t* rays)
{
    for (int point = 0; point < QUARTERS && reach->open[side] == 0 && reach->nextOpen[side] == 0; point++) {
        const int cell = 4 * point + reach->sweep % 4;
        vplVec3 place;
        if (!risesFrom(reach, side, cell, 0, rays, &place)) {
            continue;
        }
        for (int ray = 0; ray < GATHERS && reach->nextOpen[side] == 0; ray++) {
            if (seesLight(reach, side, cell, 0, ray, place, rays)) {
                note(reach, side, cell, place);
            }
        }
    }
}

// ---- the cells of a side that is reached

typedef struct Settler {
    const vplReach* reach;
    vplVec3 known[KNOWN]; // more than one where something stands on the side
    int side, knownCount;
    int64_t* rays;
} Settler;

static bool isReached(Settler* s, int cell, int point)
{
    vplVec3 place;
    if (!risesFrom(s->reach, s->side, cell, point, s->rays, &place)) {
        return false;
    }
    for (int i = 0; i < s->knownCount; i++) {
        if (vplReach_IsFree(s->reach, place, s->known[i], s->rays)) {
            return true;
        }
    }
    for (int ray = 0; ray < GATHERS; ray++) {
        if (seesLight(s->reach, s->side, cell, point, ray, place, s->rays)) {
            if (s->knownCount < KNOWN) {
                s->known[s->knownCount++] = place;
            }
            return true;
        }
    }
    return false;
}

// Cells of which light reaches a half at least; where it reaches no half, those that it reaches at all. A point of an
// open cell that is covered gets no light in the equations, and would darken the patch: counting cells of which any
// point is reached made floor patches beside the blocks of the report's box 0.83 of what they are by area, halves 0.95.
static unsigned cellsInPart(Settler* s)
{
    unsigned half = 0, some = 0;
    for (int cell = 0; cell < VPL_PATCH_CELLS; cell++) {
        int reached = 0;
        for (int point = 0; point < POINTS; point++) {
            reached += isReached(s, cell, point);
        }
        half |= (unsigned)(2 * reached >= POINTS) << cell;
        some |= (unsigned)(reached > 0) << cell;
    }
    return half != 0 ? half : some;
}

// From most cells the known place is seen, and one point of each will do.
static void settleSide(const vplReach* reach, int side, int64_t* rays)
{
    const unsigned open = reach->open[side];
    Settler s = {.reach = reach, .known = {reach->known[side]}, .side = side, .knownCount = 1, .rays = rays};
    bool whole = true;
    for (int cell = 0; cell < VPL_PATCH_CELLS && open != 0 && whole; cell++) {
        whole = (open >> cell & 1) != 0 || isReached(&s, cell, 0);
    }
    if (open != 0) {
        const unsigned part = whole ? 0xffff : cellsInPart(&s);
        reach->nextOpen[side] = (uint16_t)(part != 0 ? part : open);
    }
}

// ---- all sides

static void examineSome(void* data, int task, int worker)
{
    (void)worker;
    const Sweep* sweep = data;
    vplReach* reach = sweep->reach;
    const int end = vplMini((task + 1) * TASK, reach->patches->patchCount);
    int64_t rays = 0;
    for (int side = 2 * task * TASK; side < 2 * end; side++) {
        sweep->examine(reach, side, &rays);
    }
    reach->taskRays[task] = rays;
}

// What a sweep found counts in the next only, so that the order of tasks is of no matter. Returns how many sides are new.
static int adopt(vplReach* reach, int tasks)
{
    const int sides = 2 * reach->patches->patchCount;
    int fresh = 0;
    for (int side = 0; side < sides; side++) {
        if (reach->open[side] == 0 && reach->nextOpen[side] != 0) {
            reach->known[side] = reach->nextKnown[side];
            fresh++;
        }
        reach->open[side] = reach->nextOpen[side] != 0 ? reach->nextOpen[side] : reach->open[side];
        reach->nextOpen[side] = 0;
    }
    for (int i = 0; i < tasks; i++) {
        reach->rays += reach->taskRays[i];
    }
    return fresh;
}

static vplResult runSweep(vplReach* reach, Sweep sweep, double from, double to, int* freshOut)
{
    const int tasks = (reach->patches->patchCount + TASK - 1) / TASK;
    vplResult result = vplParallelForProgress(reach->context, tasks, examineSome, &sweep,
                                              reach->def->progress, reach->def->progressUser, from, to);
    if (result == VPL_SUCCESS) {
        *freshOut = adopt(reach, tasks);
        reach->sweep++;
    }
    return result;
}

vplResult vplReach_Explore(vplReach* reach)
{
    vplResult result = VPL_SUCCESS;
    int fresh = 0;
    if (reach->def->eyeCount > 0) {
        result = runSweep(reach, (Sweep){reach, lookAtSide}, 0.5, 0.55, &fresh);
    }
    fresh = 1;
    for (int i = 0; i < SWEEPS && fresh > 0 && result == VPL_SUCCESS; i++) {
        result = runSweep(reach, (Sweep){reach, exploreSide}, 0.55 + 0.25 * i / SWEEPS,
                          0.55 + 0.25 * (i + 1) / SWEEPS, &fresh);
    }
    return result == VPL_SUCCESS ? runSweep(reach, (Sweep){reach, settleSide}, 0.8, 1, &fresh) : result;
}
