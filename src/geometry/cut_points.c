// SPDX-License-Identifier: MIT
// Makes points of cuts equal that only rounding separates: an edge may be cut in another order on its other side.
#include "geometry/bvh.h"
#include "geometry/patch_cuts.h"
#include "geometry/patch_tree.h"
#include "geometry/point_cells.h"
#include "math/double3.h"

static bool isNear(vplVec3 a, const double b[3], double radius)
{
    const double d[3] = {(double)a.x - b[0], (double)a.y - b[1], (double)a.z - b[2]};
    return vplDot3(d, d) <= radius * radius;
}

// The first point within `radius`, -1: none. Cells are four radii large.
static int findNear(const vplPointCells* c, vplVec3 point, double radius)
{
    double at[3];
    vplToDouble3(point, at);
    int best = -1;
    for (int corner = 0; corner < 8; corner++) {
        double probe[3];
        for (int k = 0; k < 3; k++) {
            probe[k] = at[k] + (corner >> k & 1 ? radius : -radius);
        }
        const vplCell cell = vplPointCells_At(c, probe);
        for (int i = vplPointCells_First(c, &cell); i >= 0; i = c->next[i]) {
            best = isNear(c->points[i], at, radius) && (best < 0 || i < best) ? i : best;
        }
    }
    return best;
}

// Moves the points of cuts; corners of triangles stay.
static void snap(vplPointCells* c, size_t corners, double radius, vplCutPieces* pieces)
{
    for (size_t i = 0; i < pieces->pointCount; i++) {
        const int same = i < corners ? -1 : findNear(c, pieces->points[i], radius);
        if (same >= 0) {
            pieces->points[i] = pieces->points[same];
        } else {
            vplPointCells_Add(c, (int)i);
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
    const double radius = 0.25 * tolerance; // points of one triangle are at least a tolerance apart
    if (p->pointCount == corners) {
        return VPL_SUCCESS;
    }
    vplPointCells c;
    TRY(vplPointCells_Create(scratch, p->points, p->pointCount, 4 * radius, &c));
    const vplVec3* before = vplArena_Copy(scratch, p->points, p->pointCount, sizeof *p->points);
    TRY(vplArena_Check(scratch));
    snap(&c, corners, radius, p);
    undoFlips(g, before, p);
    return VPL_SUCCESS;
}
