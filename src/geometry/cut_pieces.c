// SPDX-License-Identifier: MIT
// Splits triangles along segments. A piece is a triangle; the line of a segment splits it from a corner to a point on
// the opposite edge, once or twice. Pieces that the segment does not enter stay whole. Long segments go first, so that
// walls divide a floor before what stands on it does.
#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/patch_cuts.h"
#include "geometry/patch_tree.h"
#include "math/double3.h"

#include <stdlib.h>

// A piece is halved as in bisection, not split, where the line's way through it is more than REACH times as long as
// the segment: a chair's leg would otherwise divide a floor from wall to wall. At most EXTRA nodes per triangle and
// BASE for all come from cuts.
enum { REACH = 8, EXTRA = 6, BASE = 1 << 17 };

static const double EQUAL = 1 + 0x1p-10;

typedef struct Cutter {
    const vplGeometry* geometry;
    vplArena* scratch;
    vplCutPieces* pieces;
    double tolerance;
    size_t mostNodes;
    bool spanned; // the segment could not be resolved somewhere
} Cutter;

static vplTriangleCorners cornersOf(const Cutter* c, int node)
{
    return vplCornersOf(c->pieces->points, c->pieces->nodes[node].corners);
}

// ---- splits

static bool comesBefore(vplVec3 a, vplVec3 b)
{
    return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
}

// The point at `share` of the way from a to b, with the same bits from both sides of the edge.
static vplVec3 pointBetween(vplVec3 a, vplVec3 b, double share)
{
    double from[3], to[3];
    const bool swap = comesBefore(b, a);
    vplToDouble3(swap ? b : a, from);
    vplToDouble3(swap ? a : b, to);
    for (int k = 0; k < 3; k++) {
        from[k] += (swap ? 1 - share : share) * (to[k] - from[k]);
    }
    return vplRound3(from);
}

static void addNode(vplCutPieces* pieces, const uint32_t corners[3], int triangle, int parent)
{
    pieces->nodes[pieces->nodeCount++] = vplPatchNode_Make(pieces->points, corners, triangle, parent);
}

// Splits a piece from corner `apex` to a point on the opposite edge. False if that leaves a part without area.
static bool split(const Cutter* c, int node, int apex, vplVec3 point, float share)
{
    vplCutPieces* p = c->pieces;
    const vplPatchNode whole = p->nodes[node];
    const uint32_t a = whole.corners[apex], b = whole.corners[(apex + 1) % 3],
                   d = whole.corners[(apex + 2) % 3];
    const vplTriangleCorners rotated = {{p->points[a], p->points[b], p->points[d]}};
    const vplVec3 normal = c->geometry->normals[whole.triangle];
    if (!(share > 0 && share < 1) || !vplPatch_CanSplit(&rotated, point, normal) ||
        p->nodeCount + 2 > c->mostNodes) {
        return false;
    }
    const uint32_t m = (uint32_t)p->pointCount;
    p->points[p->pointCount++] = point;
    p->nodes[node] = (vplPatchNode){.corners = {a, b, d},
                                    .triangle = whole.triangle,
                                    .parent = whole.parent,
                                    .children = (int)p->nodeCount,
                                    .patch = -1,
                                    .at = share};
    addNode(p, (const uint32_t[]){b, m, a}, whole.triangle, node);
    addNode(p, (const uint32_t[]){m, d, a}, whole.triangle, node);
    return true;
}

static bool halve(const Cutter* c, int node)
{
    const vplTriangleCorners at = cornersOf(c, node), rotated = vplPatch_Rotate(&at);
    vplVec3 middle;
    return vplPatch_Middle(&rotated, c->geometry->normals[c->pieces->nodes[node].triangle], &middle) &&
           split(c, node, vplPatch_FirstCorner(&at), middle, 0.5f);
}

// Corners of a piece by their side of a line: -1, 0 or 1.
typedef struct Sides {
    double distance[3];
    int side[3];
} Sides;

static Sides sidesOf(const Cutter* c, const vplCutLine* line, int node)
{
    const vplTriangleCorners at = cornersOf(c, node);
    Sides s;
    for (int k = 0; k < 3; k++) {
        double along;
        vplCutLine_Locate(line, at.corner[k], &along, &s.distance[k]);
        s.side[k] = s.distance[k] > c->tolerance ? 1 : s.distance[k] < -c->tolerance ? -1 : 0;
    }
    return s;
}

// Splits a piece from a corner that lies on the line.
static bool splitFromCorner(const Cutter* c, int node, const Sides* s, int apex)
{
    const vplTriangleCorners at = cornersOf(c, node);
    const int i = (apex + 1) % 3, j = (apex + 2) % 3;
    const double share = s->distance[i] / (s->distance[i] - s->distance[j]);
    return split(c, node, apex, pointBetween(at.corner[i], at.corner[j], share), (float)share);
}

static double squareBetween(vplVec3 a, vplVec3 b)
{
    const double d[3] = {(double)b.x - (double)a.x, (double)b.y - (double)a.y, (double)b.z - (double)a.z};
    return vplDot3(d, d);
}

// Splits a piece of which corner `lone` is alone on its side of the line: first to one of the line's two points on
// edges, along the shorter diagonal, then between the two.
static bool splitAcross(const Cutter* c, int node, const Sides* s, int lone)
{
    const vplTriangleCorners at = cornersOf(c, node);
    const int i = (lone + 1) % 3, j = (lone + 2) % 3;
    const double p = s->distance[lone] / (s->distance[lone] - s->distance[i]),
                 q = s->distance[lone] / (s->distance[lone] - s->distance[j]);
    const vplVec3 onI = pointBetween(at.corner[lone], at.corner[i], p),
                  onJ = pointBetween(at.corner[lone], at.corner[j], q);
    // Rounding does not choose between two diagonals of one length: a scene in other units has the same pieces.
    const bool byI = squareBetween(onI, at.corner[j]) <= EQUAL * squareBetween(onJ, at.corner[i]);
    const uint32_t corner = c->pieces->nodes[node].corners[lone];
    if (!(byI ? split(c, node, j, onI, (float)p) : split(c, node, i, onJ, (float)(1 - q)))) {
        return false;
    }
    const int half = c->pieces->nodes[node].children + (byI ? 0 : 1); // the one that has the lone corner
    const uint32_t m = (uint32_t)c->pieces->pointCount - 1;
    int apex = 0;
    while (c->pieces->nodes[half].corners[apex] != m) {
        apex++;
    }
    const bool fromLone = c->pieces->nodes[half].corners[(apex + 1) % 3] == corner;
    const double share = byI ? q : p;
    return split(c, half, apex, byI ? onJ : onI, (float)(fromLone ? share : 1 - share));
}

static bool splitByLine(const Cutter* c, const vplCutLine* line, int node)
{
    const Sides s = sidesOf(c, line, node);
    for (int k = 0; k < 3; k++) {
        const int i = s.side[(k + 1) % 3], j = s.side[(k + 2) % 3];
        if (s.side[k] == 0 && i * j < 0) {
            return splitFromCorner(c, node, &s, k);
        }
        if (s.side[k] * i < 0 && s.side[k] * j < 0) {
            return splitAcross(c, node, &s, k);
        }
    }
    return true; // the line only grazes an edge
}

// ---- segments

static vplResult reserve(Cutter* c)
{
    vplCutPieces* p = c->pieces;
    TRY(vplArena_Reserve(c->scratch, &p->points, &p->pointCapacity, p->pointCount + 2, sizeof *p->points));
    return vplArena_Reserve(c->scratch, &p->nodes, &p->nodeCapacity, p->nodeCount + 4, sizeof *p->nodes);
}

static vplResult cut(Cutter* c, const vplCutLine* line, int node)
{
    double way[2];
    const vplTriangleCorners at = cornersOf(c, node);
    if (!vplCutLine_PassThrough(line, &at, c->tolerance, way) ||
        fmin(way[1], line->length) - fmax(way[0], 0) <= c->tolerance) {
        return VPL_SUCCESS;
    }
    if (c->pieces->nodes[node].children < 0) {
        TRY(reserve(c));
        const bool near = way[1] - way[0] <= EQUAL * REACH * line->length;
        if (near || !halve(c, node)) {
            c->spanned = !splitByLine(c, line, node) || c->spanned;
            return VPL_SUCCESS;
        }
    }
    const int children = c->pieces->nodes[node].children;
    TRY(cut(c, line, children));
    return cut(c, line, children + 1);
}

typedef struct Ordered {
    vplCutLine line;
    double rank; // its length, rounded, so that equal ones stay in their order
    int index;
} Ordered;

static double roundToBits(double x, int bits)
{
    int exponent;
    const double mantissa = frexp(x, &exponent);
    return ldexp(rint(ldexp(mantissa, bits)), exponent);
}

static int longestFirst(const void* a, const void* b)
{
    const Ordered *x = a, *y = b;
    return x->rank > y->rank ? -1 : x->rank < y->rank ? 1 : x->index - y->index;
}

static vplResult cutTriangle(Cutter* c, const vplPatchCut* segments, int count, int triangle)
{
    Ordered* order = vplAlloc(c->geometry->context, (size_t)count, sizeof *order);
    if (order == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    int lines = 0;
    for (int i = 0; i < count; i++) {
        Ordered* o = &order[lines];
        o->index = i;
        if (vplCutLine_Make(&segments[i], c->geometry->normals[triangle], &o->line)) {
            o->rank = roundToBits(o->line.length, 12);
            lines++;
        }
    }
    qsort(order, (size_t)lines, sizeof *order, longestFirst);
    vplResult result = VPL_SUCCESS;
    for (int i = 0; i < lines && result == VPL_SUCCESS; i++) {
        c->spanned = false;
        result = cut(c, &order[i].line, triangle);
        c->pieces->unresolved += c->spanned;
    }
    vplFree(c->geometry->context, order);
    return result;
}

vplResult vplCutPieces_Make(vplArena* scratch, const vplGeometry* g, const vplCutSegments* segments,
                            vplCutPieces* pieces)
{
    const size_t triangles = (size_t)g->triangleCount;
    *pieces = (vplCutPieces){.nodes = NULL};
    Cutter c = {g, scratch, pieces, segments->tolerance, (EXTRA + 1) * triangles + BASE, false};
    TRY(vplArena_Reserve(scratch, &pieces->points, &pieces->pointCapacity, 3 * triangles,
                         sizeof *pieces->points));
    TRY(vplArena_Reserve(scratch, &pieces->nodes, &pieces->nodeCapacity, triangles, sizeof *pieces->nodes));
    for (uint32_t t = 0; t < triangles; t++) {
        const vplTriangleCorners at = vplGeometry_Corners(g, (int)t);
        for (int k = 0; k < 3; k++) {
            pieces->points[pieces->pointCount++] = at.corner[k];
        }
        addNode(pieces, (const uint32_t[]){3 * t, 3 * t + 1, 3 * t + 2}, (int)t, -1);
    }
    for (int t = 0; t < g->triangleCount; t++) {
        const int first = segments->first[t], count = segments->first[t + 1] - first;
        TRY(t % 1024 == 1023 ? vplAsk(g->context) : VPL_SUCCESS);
        if (count > 0) {
            TRY(cutTriangle(&c, segments->list + first, count, t));
        }
    }
    return VPL_SUCCESS;
}
