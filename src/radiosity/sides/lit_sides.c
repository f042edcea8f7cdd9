// SPDX-License-Identifier: MIT
// Sides that no particle hit: a side is lit if it sees a light source or a lit side.
#include "base/context.h"
#include "math/scalar.h"
#include "math/vec.h"
#include "geometry/triangle.h"
#include "radiosity/sides/lit_search.h"
#include "radiosity/sides/side.h"

#include <math.h>
#include <string.h>

enum {
    QUARTERS = 4, // of a side: one sample in each
    GATHERS = 4,  // rays from each sample
    LEAST_PASSES = 4,
    MOST_PASSES = 16,       // each pass finds one more room behind rooms
    DARK_SAMPLES = 1 << 18, // on all surfaces of the scene; dark sides get them in proportion to their area
    MOST_DARK_PASSES = 1 << 14,
    ROOM = 128,       // dark sides are a room if they are more than one in ROOM patches; fewer are crevices
    LEAST_OF_ROOM = 3 // and at least so many: among few patches a crevice may be one in ROOM
};

// The distance from a sample's offset point to the two points beside it (isBroad), as a multiple of the height of the offset point
// above the surface.
static const float WIDTH = 4;

// ---- one side

static void markLit(const vplLitSearch* s, const vplLitSample* sample, vplVec3 from)
{
    s->nextOpen[sample->side] = VPL_ALL_CELLS;
    s->nextFromEye[sample->side] = sample->fromEye;
    s->nextLitPoint[sample->side] = vplLitSearch_MoveTowards(s, sample->side / 2, sample->point, from);
}

// Tests whether a viewpoint sees a side that is not lit yet.
static void testViewpoints(const vplLitSearch* s, int side, int64_t* rays)
{
    for (int i = 0; i < QUARTERS && s->open[side] == 0; i++) {
        vplLitSample sample = {.side = side, .cell = 5 * i, .fromEye = true};
        if (!vplLitSample_Offset(s, &sample, rays)) {
            continue;
        }
        const int k = s->nextOpen[side] == 0 ? vplLitSample_SeesViewpoint(s, &sample, rays) : -1;
        if (k >= 0) {
            markLit(s, &sample, s->def->viewpoints[k]);
        }
    }
}

// Tests whether all geometry lies behind a triangle's side, as for the outsides of most walls, half of all sides.
static bool facesOutside(const vplLitSearch* s, int side, int triangle)
{
    const vplGeometry* g = s->geometry;
    const vplVec3 n = vplLitSearch_Normal(s, side, triangle), low = g->boundsMin, high = g->boundsMax;
    const vplVec3 farthest =
        vplVec(n.x > 0 ? high.x : low.x, n.y > 0 ? high.y : low.y, n.z > 0 ? high.z : low.z);
    vplVec3 corners[3];
    const int patch = side / 2,
              node = vplPatches_IsGroup(s->patches, patch) ? triangle : s->patches->patches[patch];
    vplPatchNode_GetCorners(s->patches, node, side & 1, corners);
    return vplDot(vplSub(farthest, corners[0]), n) < s->heights[side / 2];
}

// Tests whether light reaches a side that is not lit yet. Each pass takes other samples.
static void testLight(const vplLitSearch* s, int side, int64_t* rays)
{
    for (int i = 0; i < QUARTERS && s->open[side] == 0 && s->nextOpen[side] == 0; i++) {
        vplLitSample sample = {.side = side, .cell = 4 * i + s->pass % 4};
        vplVec3 from;
        if (vplLitSample_Offset(s, &sample, rays) &&
            vplLitSample_IsLit(s, &sample, facesOutside(s, side, sample.triangle) ? 0 : GATHERS, rays,
                               &from)) {
            markLit(s, &sample, from);
        }
    }
}

// True if `from` also lights two points beside the sample. A ray that leaks through a seam between surfaces lights a single point.
static bool isBroad(const vplLitSearch* s, const vplLitSample* sample, vplVec3 from, int64_t* rays)
{
    const float step = WIDTH * s->heights[sample->side / 2];
    vplVec3 across[2];
    bool broad = true;
    vplTangentFrame(vplLitSearch_Normal(s, sample->side, sample->triangle), &across[0], &across[1]);
    for (int k = 0; k < 2 && broad; k++) {
        broad = vplLitSearch_IsVisible(s, vplAdd(sample->point, vplScale(step, across[k])), from, rays);
    }
    return broad;
}

// Tests whether light reaches a side that was found from a viewpoint alone. The result is in nextFromEye.
static void testFromEye(const vplLitSearch* s, int side, int64_t* rays)
{
    s->nextFromEye[side] = s->fromEye[side];
    if (!s->fromEye[side] || (!s->spreads && s->darkPass >= s->darkShare[side])) {
        return;
    }
    for (int i = 0; i < VPL_PATCH_CELLS && s->nextFromEye[side] != 0; i++) {
        vplLitSample sample = {.side = side, .cell = i, .index = s->pass % VPL_LIT_SAMPLES};
        vplVec3 from;
        if (!vplLitSample_Offset(s, &sample, rays)) {
            continue;
        }
        const bool lit = vplLitSample_IsLit(s, &sample, GATHERS, rays, &from) && !sample.fromEye;
        if ((lit || vplLitSample_SeesFound(s, &sample, rays, &from)) && isBroad(s, &sample, from, rays)) {
            s->nextFromEye[side] = 0;
            s->nextLitPoint[side] = vplLitSearch_MoveTowards(s, side / 2, sample.point, from);
        }
    }
}

// ---- all sides

typedef struct Pass {
    vplLitSearch* search;
    vplExamineFcn* examine;
} Pass;

static void examineTask(void* data, int task, int worker)
{
    (void)worker;
    const Pass* pass = data;
    vplLitSearch* s = pass->search;
    const int end = vplMini((task + 1) * VPL_LIT_TASK_PATCHES, s->patches->patchCount);
    int64_t rays = 0;
    for (int side = 2 * task * VPL_LIT_TASK_PATCHES; side < 2 * end; side++) {
        pass->examine(s, side, &rays);
    }
    s->taskRays[task] = rays;
}

// Makes the results of a pass effective. Returns how many sides became lit.
static int adopt(vplLitSearch* s, int tasks)
{
    int added = 0;
    for (int side = 0; side < 2 * s->patches->patchCount; side++) {
        if (s->nextOpen[side] != 0) {
            added += s->open[side] == 0;
            s->fromEye[side] = s->open[side] == 0 ? s->nextFromEye[side] : s->fromEye[side];
            s->litPoint[side] = s->open[side] == 0 ? s->nextLitPoint[side] : s->litPoint[side];
            s->open[side] = s->nextOpen[side];
        }
    }
    for (int i = 0; i < tasks; i++) {
        s->rays += s->taskRays[i];
    }
    return added;
}

vplResult vplLitSearch_ForAllSides(vplLitSearch* s, vplExamineFcn* examine, const double range[2],
                                   int* newOut)
{
    const int tasks = (s->patches->patchCount + VPL_LIT_TASK_PATCHES - 1) / VPL_LIT_TASK_PATCHES;
    Pass pass = {s, examine};
    TRY(vplParallelForProgress(
        s->context, tasks, examineTask, &pass,
        (vplProgressRange){s->def->progress, s->def->progressUser, range[0], range[1]}));
    *newOut = adopt(s, tasks);
    s->pass++;
    return VPL_SUCCESS;
}

static int countUnlit(const vplLitSearch* s)
{
    int unlit = 0;
    for (int side = 0; side < 2 * s->patches->patchCount; side++) {
        unlit += s->open[side] == 0;
    }
    return unlit;
}

// The number of samples on a dark side is proportional to its area. Triangles of groups are small, so one pass has enough samples for
// a group.
static void findDarkShares(vplLitSearch* s)
{
    for (int side = 0; side < 2 * s->patches->patchCount; side++) {
        const int patch = side / 2;
        const bool large = s->fromEye[side] && !vplPatches_IsGroup(s->patches, patch);
        const double samples =
            large ? DARK_SAMPLES * vplPatches_Area(s->patches, patch) / s->geometry->area : 0;
        s->darkShare[side] = (uint16_t)fmin(MOST_DARK_PASSES, ceil(samples / VPL_PATCH_CELLS));
    }
}

// Makes the results of a pass over dark sides effective, and counts the pass.
static void adoptFound(vplLitSearch* s)
{
    for (int side = 0; side < 2 * s->patches->patchCount; side++) {
        if (s->fromEye[side] && !s->nextFromEye[side]) {
            s->found[s->foundCount++] = side;
            // The point so far is one that a viewpoint sees. Of a group it may lie behind a wall, in the dark.
            s->litPoint[side] = s->nextLitPoint[side];
        }
        s->fromEye[side] = s->nextFromEye[side];
    }
    s->darkPass++;
}

// Counts the sides that viewpoints see and no light was found to reach, and those of them that lack samples.
static int countDark(const vplLitSearch* s, int* lackingOut)
{
    int count = 0;
    *lackingOut = 0;
    for (int side = 0; side < 2 * s->patches->patchCount; side++) {
        count += s->fromEye[side] != 0;
        *lackingOut += s->fromEye[side] != 0 && s->darkPass < s->darkShare[side];
    }
    return count;
}

// Adds the box of a dark side to that of a room which it overlaps, or begins another room. When all boxes are in use, the last one takes
// all that is left.
static void addDarkBox(vplLitSearch* s, int side)
{
    const vplPatchParts parts = vplPatches_GetParts(s->patches, side / 2);
    vplBox box = vplBox_Empty();
    for (int i = 0; i < parts.count; i++) {
        box = vplBox_Join(box, vplLitSearch_BoxOf(s, parts.nodes[i]));
    }
    int at = vplLitSearch_FindDarkBox(s, box);
    if (at == s->darkBoxCount && at < VPL_DARK_BOXES) {
        s->darkBoxes[s->darkBoxCount++] = vplBox_Empty();
    }
    at = vplMini(at, VPL_DARK_BOXES - 1);
    s->darkBoxes[at] = vplBox_Join(s->darkBoxes[at], box);
}

// Closes sides that viewpoints see but light does not reach, as in a sealed room. Their form factors with lit sides would be 0
// but for rounding at seams. Without light sources all sides stay open. Each pass casts up to 80 rays from each dark side. Passes go
// on while they find lit sides, and on each side until it has its share of DARK_SAMPLES: light through a keyhole makes a spot that
// 16 samples of a large side miss. At the end the number of the pass is set back, so that later steps draw the same random numbers.
static vplResult closeDarkRooms(vplLitSearch* s)
{
    const int sides = 2 * s->patches->patchCount, pass = s->pass;
    int lacking = 0, left = 0;
    if (s->emission->sourceCount > 0) {
        findDarkShares(s);
        left = countDark(s, &lacking);
    }
    s->spreads = true; // the first pass tests all sides
    while (left > 0 && (s->spreads || lacking > 0) && s->darkPass < MOST_DARK_PASSES) {
        const int before = left;
        int added;
        TRY(vplLitSearch_ForAllSides(s, testFromEye, (const double[2]){0.7, 0.7}, &added));
        adoptFound(s);
        left = countDark(s, &lacking);
        s->spreads = left < before;
    }
    const bool beside =
        s->patches->groupCount > 0 && left >= LEAST_OF_ROOM && left * (int64_t)ROOM > s->patches->patchCount;
    s->pass = pass;
    for (int side = 0; side < sides && left > 0; side++) {
        s->open[side] = s->fromEye[side] ? 0 : s->open[side];
        if (s->fromEye[side] && beside) {
            addDarkBox(s, side);
        }
        s->nextOpen[side] = s->open[side];
    }
    return VPL_SUCCESS;
}

// At least four passes, which cast 64 rays from each side that stays unlit; 16 rays missed one patch in three
// thousand on the front of a block in Hemgren's box. Further passes follow while each finds at least one in
// 64 unlit sides, as in rooms behind rooms; slivers would go on forever.
vplResult vplLitSearch_FindSides(vplLitSearch* s)
{
    int added = 1;
    if (s->def->viewpointCount > 0) {
        TRY(vplLitSearch_ForAllSides(s, testViewpoints, (const double[2]){0.3, 0.4}, &added));
    }
    for (int i = 0; i < MOST_PASSES && (i < LEAST_PASSES || added * INT64_C(64) > countUnlit(s)); i++) {
        const double range[2] = {0.4 + 0.3 * i / MOST_PASSES, 0.4 + 0.3 * (i + 1) / MOST_PASSES};
        TRY(vplLitSearch_ForAllSides(s, testLight, range, &added));
    }
    return closeDarkRooms(s);
}
