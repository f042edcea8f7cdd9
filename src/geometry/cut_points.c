// SPDX-License-Identifier: MIT
// Makes points of cuts equal that only rounding separates: an edge may be cut in another order on its other side.
#include "geometry/bvh.h"
#include "geometry/patch_cuts.h"
#include "geometry/patch_tree.h"
#include "math/double3.h"

#include <math.h>

// A hash table of cells of space, whose points are chained.
typedef struct Cells {
    const vplVec3* points;
    int *table, *next; // -1: no more
    uint64_t mask;
    double size; // metres
} Cells;

static uint64_t slotOf(const Cells* c, const int64_t cell[3])
{
    uint64_t h = (uint64_t)cell[0] * UINT64_C(0x9E3779B97F4A7C15);
    h = (h ^ (h >> 32) ^ (uint64_t)cell[1]) * UINT64_C(0xBF58476D1CE4E5B9);
    h = (h ^ (h >> 32) ^ (uint64_t)cell[2]) * UINT64_C(0x94D049BB133111EB);
    return (h ^ (h >> 32)) & c->mask;
}

static void cellOf(const Cells* c, const double at[3], int64_t cell[3])
{
    for (int k = 0; k < 3; k++) {
        cell[k] = (int64_t)floor(at[k] / c->size);
    }
}

static bool isNear(vplVec3 a, const double b[3], double radius)
{
    const double d[3] = {(double)a.x - b[0], (double)a.y - b[1], (double)a.z - b[2]};
    return vplDot3(d, d) <= radius * radius;
}

// The first point within `radius`, -1: none. Cells are four radii large.
static int findNear(const Cells* c, vplVec3 point, double radius)
{
    double at[3];
    vplToDouble3(point, at);
    int best = -1;
    for (int corner = 0; corner < 8; corner++) {
        double probe[3];
        int64_t cell[3];
        for (int k = 0; k < 3; k++) {
            probe[k] = at[k] + (corner >> k & 1 ? radius : -radius);
        }
        cellOf(c, probe, cell);
        for (int i = c->table[slotOf(c, cell)]; i >= 0; i = c->next[i]) {
            best = isNear(c->points[i], at, radius) && (best < 0 || i < best) ? i : best;
        }
    }
    return best;
}

static void enter(Cells* c, int point)
{
    double at[3];
    int64_t cell[3];
    vplToDouble3(c->points[point], at);
    cellOf(c, at, cell);
    const uint64_t slot = slotOf(c, cell);
    c->next[point] = c->table[slot];
    c->table[slot] = point;
}

// Moves the points of cuts; corners of triangles stay.
static void snap(Cells* c, size_t corners, double radius, vplCutPieces* pieces)
{
    for (size_t i = 0; i < pieces->pointCount; i++) {
        const int same = i < corners ? -1 : findNear(c, pieces->points[i], radius);
        if (same >= 0) {
            pieces->points[i] = pieces->points[same];
        } else {
            enter(c, (int)i);
        }
    }
}

// Moves the points of a split back where it would leave a part without area.
static void undoFlips(const vplGeometry* g, const vplVec3* before, vplCutPieces* p)
{
    for (size_t i = 0; i < p->nodeCount; i++) {
        const vplPatchNode* node = &p->nodes[i];
        const vplTriangleCorners at = vplCornersOf(p->points, node->corners);
        if (vplCanBeHit(g, node->triangle) && !vplPatch_FacesAlong(&at, g->normals[node->triangle])) {
            for (int k = 0; k < 3; k++) {
                p->points[node->corners[k]] = before[node->corners[k]];
            }
        }
    }
}

vplResult vplCutPieces_Snap(vplArena* scratch, const vplGeometry* g, double tolerance, vplCutPieces* p)
{
    const size_t corners = 3 * (size_t)g->triangleCount;
    const double radius = 0.25 * tolerance; // pieces are higher than four of it
    if (p->pointCount == corners) {
        return VPL_SUCCESS;
    }
    Cells c = {.points = p->points, .mask = 15, .size = 4 * radius};
    while (c.mask < p->pointCount) {
        c.mask = 2 * c.mask + 1;
    }
    c.table = vplArena_Alloc(scratch, c.mask + 1, sizeof *c.table);
    c.next = vplArena_Alloc(scratch, p->pointCount, sizeof *c.next);
    const vplVec3* before = vplArena_Copy(scratch, p->points, p->pointCount, sizeof *p->points);
    TRY(vplArena_Check(scratch));
    for (uint64_t i = 0; i <= c.mask; i++) {
        c.table[i] = -1;
    }
    snap(&c, corners, radius, p);
    undoFlips(g, before, p);
    return VPL_SUCCESS;
}
