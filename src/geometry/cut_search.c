// SPDX-License-Identifier: MIT
// Finds the surfaces that meet each triangle: those in the leaves of the ray tree that its box reaches.
#include "base/context.h"
#include "geometry/box.h"
#include "geometry/bvh.h"
#include "geometry/patch_cuts.h"
#include "math/double3.h"
#include "math/scalar.h"

#include <stdlib.h>

// The search around one triangle.
typedef struct Search {
    const vplGeometry* geometry;
    const uint8_t* isUncut; // NULL: no triangle is
    vplArena* scratch;
    vplCutSegments* out;
    int triangle;
    float low[3], high[3]; // its bounds and the tolerance
    int* faces;            // first triangles of the faces that the box reaches
    size_t faceCount, faceCapacity;
    vplResult result;
} Search;

// ---- candidates

// Quads and faces of boxes are two triangles, named by the first.
static int faceOf(const vplGeometry* g, int triangle)
{
    const vplGeometryObject* object = &g->objects[g->owners[triangle]];
    return object->type == VPL_OBJECT_MESH ? triangle : triangle - (triangle - object->firstTriangle) % 2;
}

static bool isSame(vplVec3 a, vplVec3 b)
{
    return a.x == b.x && a.y == b.y && a.z == b.z;
}

// Triangles of one mesh that share an edge meet there alone. So do the faces of one box.
static bool areNeighbours(const vplGeometry* g, int triangle, int other)
{
    const vplGeometryObject* object = &g->objects[g->owners[triangle]];
    if (g->owners[triangle] != g->owners[other]) {
        return false;
    }
    if (object->type != VPL_OBJECT_MESH) {
        return true;
    }
    const vplTriangleCorners a = vplGeometry_Corners(g, triangle), b = vplGeometry_Corners(g, other);
    int shared = 0;
    for (int i = 0; i < 9; i++) {
        shared += isSame(a.corner[i / 3], b.corner[i % 3]);
    }
    return shared >= 2;
}

static bool isUncut(const Search* s, int triangle)
{
    return s->isUncut != NULL && s->isUncut[triangle];
}

static void addCandidate(Search* s, int triangle)
{
    const vplGeometry* g = s->geometry;
    if (isUncut(s, triangle)) {
        return;
    }
    const vplTriangleCorners c = vplGeometry_Corners(g, triangle);
    for (int k = 0; k < 3; k++) {
        const float a = vplComponent(c.corner[0], k), b = vplComponent(c.corner[1], k),
                    d = vplComponent(c.corner[2], k);
        if (fminf(a, fminf(b, d)) > s->high[k] || fmaxf(a, fmaxf(b, d)) < s->low[k]) {
            return;
        }
    }
    if (s->result != VPL_SUCCESS || areNeighbours(g, s->triangle, triangle) || !vplCanBeHit(g, triangle)) {
        return;
    }
    s->result = vplArena_Reserve(s->scratch, &s->faces, &s->faceCapacity, s->faceCount + 1, sizeof *s->faces);
    if (s->result == VPL_SUCCESS) {
        s->faces[s->faceCount++] = faceOf(g, triangle);
    }
}

static void addBlock(Search* s, const vplTriangleBlock* block)
{
    for (int i = 0; i < VPL_BVH_WIDTH && block->id[i] >= 0; i++) {
        addCandidate(s, block->id[i]);
    }
}

static bool reaches(const Search* s, const vplBvhNode* node, int child)
{
    for (int k = 0; k < 3; k++) {
        if (node->planes[k][child] > s->high[k] || node->planes[k + 3][child] < s->low[k]) {
            return false;
        }
    }
    return true;
}

static void searchTree(Search* s, const vplBvh* bvh)
{
    int stack[VPL_BVH_DEPTH * VPL_BVH_WIDTH] = {0}, depth = 1;
    while (depth > 0) {
        const vplBvhNode* node = &bvh->nodes[stack[--depth]];
        for (int i = 0; i < node->count; i++) {
            if (!reaches(s, node, i)) {
                continue;
            }
            if (node->child[i] < 0) {
                addBlock(s, &bvh->blocks[~node->child[i]]);
            } else {
                stack[depth++] = node->child[i];
            }
        }
    }
}

static void findCandidates(Search* s)
{
    const vplBvh* bvh = s->geometry->rayTree;
    s->faceCount = 0;
    if (bvh == NULL) {
        for (int i = 0; i < s->geometry->triangleCount; i++) {
            addCandidate(s, i);
        }
    } else if (bvh->nodes != NULL) {
        searchTree(s, bvh);
    } else {
        for (int i = 0; i < bvh->blockCount; i++) {
            addBlock(s, &bvh->blocks[i]);
        }
    }
}

// ---- segments

static vplCutPolygon polygonOf(const vplGeometry* g, int face)
{
    const bool mesh = g->objects[g->owners[face]].type == VPL_OBJECT_MESH;
    const vplTriangleCorners c = vplGeometry_Corners(g, face);
    vplCutPolygon polygon = {.count = mesh ? 3 : 4};
    for (int k = 0; k < 3; k++) {
        vplToDouble3(c.corner[k], polygon.corners[k]);
    }
    if (!mesh) {
        vplToDouble3(vplGeometry_Corners(g, face + 1).corner[2], polygon.corners[3]);
    }
    return polygon;
}

static int byIndex(const void* a, const void* b)
{
    const int x = *(const int*)a, y = *(const int*)b;
    return (x > y) - (x < y);
}

static vplResult addSegments(Search* s)
{
    const vplTriangleCorners corners = vplGeometry_Corners(s->geometry, s->triangle);
    if (s->faceCount == 0) {
        return VPL_SUCCESS;
    }
    qsort(s->faces, s->faceCount, sizeof *s->faces, byIndex);
    for (size_t i = 0; i < s->faceCount; i++) {
        if (i > 0 && s->faces[i] == s->faces[i - 1]) {
            continue;
        }
        vplPatchCut found[4];
        const vplCutPolygon polygon = polygonOf(s->geometry, s->faces[i]);
        const int count = vplCutSegment_Between(&corners, &polygon, s->out->tolerance, found);
        TRY(vplArena_Reserve(s->scratch, &s->out->list, &s->out->capacity, s->out->count + 4,
                             sizeof *s->out->list));
        for (int k = 0; k < count; k++) {
            s->out->list[s->out->count++] = found[k];
        }
    }
    return VPL_SUCCESS;
}

static vplResult searchAround(Search* s, int triangle)
{
    const vplTriangleCorners c = vplGeometry_Corners(s->geometry, triangle);
    const float more = (float)s->out->tolerance;
    s->triangle = triangle;
    for (int k = 0; k < 3; k++) {
        const float x = vplComponent(c.corner[0], k), y = vplComponent(c.corner[1], k),
                    z = vplComponent(c.corner[2], k);
        s->low[k] = fminf(x, fminf(y, z)) - more;
        s->high[k] = fmaxf(x, fmaxf(y, z)) + more;
    }
    findCandidates(s);
    TRY(s->result);
    return addSegments(s);
}

vplResult vplCutSegments_Find(vplArena* scratch, const vplGeometry* g, const uint8_t* uncut,
                              vplCutSegments* out)
{
    *out = (vplCutSegments){.tolerance = vplCutTolerance(g)};
    out->first = vplArena_Alloc(scratch, (size_t)g->triangleCount + 1, sizeof *out->first);
    TRY(vplArena_Check(scratch));
    Search s = {.geometry = g, .isUncut = uncut, .scratch = scratch, .out = out, .result = VPL_SUCCESS};
    for (int t = 0; t < g->triangleCount; t++) {
        out->first[t] = (int)out->count;
        TRY(t % 1024 == 1023 ? vplAsk(g->context) : VPL_SUCCESS);
        if (vplCanBeHit(g, t) && !isUncut(&s, t)) {
            TRY(searchAround(&s, t));
        }
    }
    out->first[g->triangleCount] = (int)out->count;
    return VPL_SUCCESS;
}
