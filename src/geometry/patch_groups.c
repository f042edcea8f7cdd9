// SPDX-License-Identifier: MIT
// Groups small triangles by position and normal.
// Based on: Smits, Arvo and Greenberg, A Clustering Algorithm for Radiosity in Complex Environments, SIGGRAPH 1994, and
// Willmott, Heckbert and Garland, Face Cluster Radiosity, Eurographics Workshop on Rendering 1999 (clusters of faces with
// similar normals are patches). Departs: clusters are boxes of one tree that does not depend on their size, so that the
// size for a number of patches is found by bisection.
#include "geometry/patch_groups.h"

#include "base/context.h"
#include "geometry/bvh.h"
#include "math/double3.h"
#include "math/scalar.h"

#include <string.h>

// Deeper boxes are halved by count, which limits the depth to 48 + log2(n).
enum { HALVES_DEPTH = 48 };

// Triangles with an edge above LARGE times the diagonal of their box are parted from those with edges below SMALL times
// the longest: a chair is no group with the floor, nor torn apart where the floor's middle is.
static const float LARGE = 0.5f, SMALL = 0.25f;

// Triangles of less area than this share of T x T are not cut. At 1.3 m a thousand slivers of the conference room, 1.3 m
// long and 3 cm wide, would otherwise become 11,000 pieces.
static const double UNCUT = 1 / 32.0;

typedef struct Bounds {
    vplVec3 low, high;
    float edge; // the longest, metres
    float area; // m^2
} Bounds;

typedef struct Node {
    int children; // the first of two, which follow each other; -1: one triangle
    int first, count;
    float diagonal;
} Node;

struct vplGroupTree {
    const vplGeometry* geometry;
    Bounds* bounds; // per triangle of the geometry
    int* order;     // triangles that have an area; those of a node follow each other
    int count;
    Node* nodes;
    int nodeCount;
    // The groups of the last length: group g is members[starts[g]] .. members[ends[g] - 1].
    int *members, *starts, *ends, *spare;
    int groupCount;
    uint8_t *isGrouped, *isUncut;
};

// ---- boxes

static Bounds boundsOf(const vplGeometry* g, int triangle)
{
    const vplTriangleCorners c = vplGeometry_Corners(g, triangle);
    Bounds b = {c.corner[0], c.corner[0], 0, (float)vplTriangle_Area(&c)};
    for (int k = 0; k < 3; k++) {
        const vplVec3 p = c.corner[k];
        b.low = vplVec(vplMinf(b.low.x, p.x), vplMinf(b.low.y, p.y), vplMinf(b.low.z, p.z));
        b.high = vplVec(vplMaxf(b.high.x, p.x), vplMaxf(b.high.y, p.y), vplMaxf(b.high.z, p.z));
        b.edge = vplMaxf(b.edge, vplLength(vplSub(c.corner[(k + 1) % 3], p)));
    }
    return b;
}

static vplVec3 centreOf(const Bounds* b)
{
    return vplAdd(vplScale(0.5f, b->low), vplScale(0.5f, b->high));
}

// The box of a node's triangles and of their centres, and the range of their edges.
typedef struct Range {
    vplVec3 low, high, first, last;
    float least, most;
} Range;

static vplVec3 least(vplVec3 a, vplVec3 b)
{
    return vplVec(vplMinf(a.x, b.x), vplMinf(a.y, b.y), vplMinf(a.z, b.z));
}

static vplVec3 most(vplVec3 a, vplVec3 b)
{
    return vplVec(vplMaxf(a.x, b.x), vplMaxf(a.y, b.y), vplMaxf(a.z, b.z));
}

static Range rangeOf(const vplGroupTree* t, const Node* node)
{
    const Bounds* b = &t->bounds[t->order[node->first]];
    Range r = {b->low, b->high, centreOf(b), centreOf(b), b->edge, b->edge};
    for (int i = 1; i < node->count; i++) {
        b = &t->bounds[t->order[node->first + i]];
        r.low = least(r.low, b->low);
        r.high = most(r.high, b->high);
        r.first = least(r.first, centreOf(b));
        r.last = most(r.last, centreOf(b));
        r.least = vplMinf(r.least, b->edge);
        r.most = vplMaxf(r.most, b->edge);
    }
    return r;
}

// ---- halving

// Parts numbers stably by a key: those below `middle` come first. Returns how many these are.
typedef float KeyFcn(const vplGroupTree* tree, int triangle, int key);

static int part(const vplGroupTree* t, int* list, int count, KeyFcn* keyOf, int key, float middle)
{
    int before = 0, after = 0;
    for (int i = 0; i < count; i++) {
        if (keyOf(t, list[i], key) < middle) {
            list[before++] = list[i];
        } else {
            t->spare[after++] = list[i];
        }
    }
    memcpy(list + before, t->spare, (size_t)after * sizeof *list);
    return before;
}

// The place of a triangle along an axis, or its longest edge.
static float placeOf(const vplGroupTree* t, int triangle, int key)
{
    const Bounds* b = &t->bounds[triangle];
    return key == 3 ? b->edge : vplComponent(centreOf(b), key);
}

static float normalOf(const vplGroupTree* t, int triangle, int key)
{
    return vplComponent(t->geometry->normals[triangle], key);
}

static int longestAxis(vplVec3 low, vplVec3 high)
{
    const vplVec3 d = vplSub(high, low);
    return d.x >= d.y && d.x >= d.z ? 0 : d.y >= d.z ? 1 : 2;
}

// Returns how many of a node's triangles its first child gets.
static int halve(const vplGroupTree* t, const Node* node, const Range* r, int depth)
{
    const bool uneven = r->most > LARGE * node->diagonal && r->least < SMALL * r->most;
    const int axis = longestAxis(r->first, r->last);
    const float middle =
        uneven ? LARGE * r->most : 0.5f * vplComponent(r->first, axis) + 0.5f * vplComponent(r->last, axis);
    const int before = depth < HALVES_DEPTH
                           ? part(t, t->order + node->first, node->count, placeOf, uneven ? 3 : axis, middle)
                           : 0;
    return before > 0 && before < node->count ? before : node->count / 2;
}

static void buildNode(vplGroupTree* t, int index, int depth)
{
    Node* node = &t->nodes[index];
    const Range range = rangeOf(t, node);
    node->diagonal = vplLength(vplSub(range.high, range.low));
    node->children = -1;
    if (node->count == 1) {
        return;
    }
    const int before = halve(t, node, &range, depth), child = t->nodeCount;
    node->children = child;
    t->nodeCount += 2;
    t->nodes[child] = (Node){.first = node->first, .count = before};
    t->nodes[child + 1] = (Node){.first = node->first + before, .count = node->count - before};
    buildNode(t, child, depth + 1);
    buildNode(t, child + 1, depth + 1);
}

vplResult vplGroupTree_Build(vplArena* scratch, const vplGeometry* g, vplGroupTree** treeOut)
{
    const size_t triangles = (size_t)g->triangleCount;
    vplGroupTree* t = vplArena_AllocZero(scratch, 1, sizeof *t);
    TRY(vplArena_Check(scratch));
    t->geometry = g;
    t->bounds = vplArena_Alloc(scratch, triangles, sizeof *t->bounds);
    t->order = vplArena_Alloc(scratch, triangles, sizeof *t->order);
    t->nodes = vplArena_Alloc(scratch, 2 * triangles, sizeof *t->nodes);
    t->members = vplArena_Alloc(scratch, triangles, sizeof *t->members);
    t->starts = vplArena_Alloc(scratch, triangles, sizeof *t->starts);
    t->ends = vplArena_Alloc(scratch, triangles, sizeof *t->ends);
    t->spare = vplArena_Alloc(scratch, triangles, sizeof *t->spare);
    t->isGrouped = vplArena_AllocZero(scratch, triangles, 1);
    t->isUncut = vplArena_AllocZero(scratch, triangles, 1);
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < g->triangleCount; i++) {
        if (vplCanBeHit(g, i)) {
            t->bounds[i] = boundsOf(g, i);
            t->order[t->count++] = i;
        }
    }
    if (t->count > 0) {
        t->nodes[0] = (Node){.first = 0, .count = t->count};
        t->nodeCount = 1;
        buildNode(t, 0, 0);
    }
    *treeOut = t;
    return vplAsk(g->context);
}

// ---- groups

static vplRgb emissionOf(const vplGeometry* g, int triangle)
{
    return g->materials[g->triangleMaterials[triangle]].emission;
}

// Parts the triangles that emit as the first does from others.
static int partEmission(const vplGroupTree* t, int* list, int count)
{
    const vplRgb first = emissionOf(t->geometry, list[0]);
    int same = 0, others = 0;
    for (int i = 0; i < count; i++) {
        const vplRgb e = emissionOf(t->geometry, list[i]);
        if (e.r == first.r && e.g == first.g && e.b == first.b) {
            list[same++] = list[i];
        } else {
            t->spare[others++] = list[i];
        }
    }
    memcpy(list + same, t->spare, (size_t)others * sizeof *list);
    return same;
}

// Tests whether the normals of all are near their mean, weighted by area.
static bool faceAlike(const vplGroupTree* t, const int* list, int count)
{
    double mean[3] = {0, 0, 0}, least = 1;
    for (int i = 0; i < count; i++) {
        const vplVec3 n = t->geometry->normals[list[i]];
        for (int k = 0; k < 3; k++) {
            mean[k] += (double)t->bounds[list[i]].area * (double)vplComponent(n, k);
        }
    }
    const double length = sqrt(vplDot3(mean, mean));
    for (int i = 0; i < count; i++) {
        double n[3];
        vplToDouble3(t->geometry->normals[list[i]], n);
        least = length > 0 ? fmin(least, vplDot3(n, mean) / length) : 0;
    }
    return least >= VPL_PATCH_GROUP_COSINE;
}

static int partNormals(const vplGroupTree* t, int* list, int count)
{
    vplVec3 low = t->geometry->normals[list[0]], high = low;
    for (int i = 1; i < count; i++) {
        low = least(low, t->geometry->normals[list[i]]);
        high = most(high, t->geometry->normals[list[i]]);
    }
    const int axis = longestAxis(low, high);
    return part(t, list, count, normalOf, axis,
                0.5f * vplComponent(low, axis) + 0.5f * vplComponent(high, axis));
}

// Divides triangles of one box into groups.
static void groupBox(vplGroupTree* t, int first, int count)
{
    int* list = t->members + first;
    if (count == 1) {
        return;
    }
    int before = partEmission(t, list, count);
    const bool alike = before == count && faceAlike(t, list, count);
    before = before == count && !alike ? partNormals(t, list, count) : before;
    if (before > 0 && before < count) {
        groupBox(t, first, before);
        groupBox(t, first + before, count - before);
    } else if (alike) {
        t->starts[t->groupCount] = first;
        t->ends[t->groupCount++] = first + count;
        for (int i = 0; i < count; i++) {
            t->isGrouped[list[i]] = 1;
        }
    }
}

static void groupNode(vplGroupTree* t, int index, const vplGroupLength* length)
{
    const Node* node = &t->nodes[index];
    if ((double)node->diagonal <= (node->first < length->finerCount ? length->finer : length->length)) {
        groupBox(t, node->first, node->count);
    } else if (node->children >= 0) {
        groupNode(t, node->children, length);
        groupNode(t, node->children + 1, length);
    }
}

int vplGroupTree_Group(vplGroupTree* t, const vplGroupLength* length)
{
    t->groupCount = 0;
    if (t->count > 0) {
        memset(t->isGrouped, 0, (size_t)t->geometry->triangleCount);
        memcpy(t->members, t->order, (size_t)t->count * sizeof *t->members);
        groupNode(t, 0, length);
    }
    return t->groupCount;
}

const uint8_t* vplGroupTree_IsGrouped(const vplGroupTree* t)
{
    return t->isGrouped;
}

const uint8_t* vplGroupTree_FindUncut(vplGroupTree* t, double length)
{
    for (int i = 0; i < t->count; i++) {
        const int triangle = t->order[i];
        t->isUncut[triangle] =
            t->isGrouped[triangle] || (double)t->bounds[triangle].area < UNCUT * length * length;
    }
    return t->isUncut;
}

double vplGroupTree_Diagonal(const vplGroupTree* t)
{
    return t->count > 0 ? (double)t->nodes[0].diagonal : 0;
}

vplResult vplGroupTree_List(const vplGroupTree* t, vplArena* arena, vplPatchGroups* out)
{
    size_t members = 0;
    for (int g = 0; g < t->groupCount; g++) {
        members += (size_t)(t->ends[g] - t->starts[g]);
    }
    int* first = vplArena_Alloc(arena, (size_t)t->groupCount + 1, sizeof *first);
    int* list = vplArena_Alloc(arena, members, sizeof *list);
    double* areaUpTo = vplArena_Alloc(arena, members, sizeof *areaUpTo);
    TRY(vplArena_Check(arena));
    int at = 0;
    for (int g = 0; g < t->groupCount; g++) {
        double area = 0;
        first[g] = at;
        for (int m = t->starts[g]; m < t->ends[g]; m++, at++) {
            area += vplGeometry_TriangleArea(t->geometry, t->members[m]);
            list[at] = t->members[m];
            areaUpTo[at] = area;
        }
    }
    first[t->groupCount] = at;
    *out = (vplPatchGroups){t->groupCount, first, list, areaUpTo};
    return VPL_SUCCESS;
}
