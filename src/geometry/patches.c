// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.1: each round bisects every triangle whose
// longest edge is longer than T. An edge exactly as long as T stays whole.
#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/patch_cuts.h"
#include "geometry/patch_tree.h"
#include "math/scalar.h"
#include "math/vec.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { PATCH_COOKIE = 0x56504ca0 };

vplPatchDef vplDefaultPatchDef(void)
{
    return (vplPatchDef){.count = 1000, .rounds = VPL_MAX_PATCH_ROUNDS, .cookie = PATCH_COOKIE};
}

static vplResult checkDef(const vplGeometry* geometry, const vplPatchDef* def)
{
    vplContext* context = geometry->context;
    if (def->cookie != PATCH_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPatchDef was not made by vplDefaultPatchDef");
    }
    if (!(def->size >= 0 && isfinite(def->size))) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPatchDef.size is %g, must be finite and at least 0",
                       (double)def->size);
    }
    if (def->size == 0 && (def->count < 1 || def->count > VPL_MAX_PATCHES)) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPatchDef.count is %d, must be in [1, %d]",
                       def->count, VPL_MAX_PATCHES);
    }
    if (def->rounds < 0 || def->rounds > VPL_MAX_PATCH_ROUNDS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPatchDef.rounds is %d, must be in [0, %d]",
                       def->rounds, VPL_MAX_PATCH_ROUNDS);
    }
    if (geometry->triangleCount > VPL_MAX_PATCHES) {
        return vplFail(context, VPL_LIMIT, "the scene has %d triangles, at most %d patches are allowed",
                       geometry->triangleCount, VPL_MAX_PATCHES);
    }
    return VPL_SUCCESS;
}

// ---- counting

// The number of patches that a triangle, or a part of one, becomes in `rounds` rounds. Stops counting at
// `enough`.
static int countPart(const vplTriangleCorners* part, vplVec3 normal, double square, int rounds, int enough)
{
    const vplTriangleCorners rotated = vplPatch_Rotate(part);
    vplVec3 middle;
    if (rounds == 0 || !(vplPatch_SquaredEdge(&rotated) > square) ||
        !vplPatch_Middle(&rotated, normal, &middle)) {
        return 1;
    }
    int count = 0;
    for (int half = 0; half < 2 && count < enough; half++) {
        const vplTriangleCorners corners = vplPatch_Half(&rotated, middle, half);
        count += countPart(&corners, normal, square, rounds - 1, enough - count);
    }
    return count;
}

// The triangles that are bisected, or their pieces. Those of groups are not.
typedef struct Roots {
    const vplGeometry* geometry;
    vplGroupTree* tree; // NULL: there are no groups
    int groupCount;
    vplCutSegments segments;
    vplCutPieces pieces; // nodes: NULL where triangles are whole
    int count;           // of nodes
} Roots;

// False for a triangle without area, and for one that was cut.
static bool getRoot(const Roots* roots, int i, vplTriangleCorners* cornersOut, vplVec3* normalOut)
{
    const vplGeometry* g = roots->geometry;
    const vplPatchNode* node = roots->pieces.nodes != NULL ? &roots->pieces.nodes[i] : NULL;
    const int triangle = node != NULL ? node->triangle : i;
    if (!vplCanBeHit(g, triangle) || (roots->tree != NULL && vplGroupTree_IsGrouped(roots->tree)[triangle]) ||
        (node != NULL && node->children >= 0)) {
        return false;
    }
    *cornersOut =
        node != NULL ? vplCornersOf(roots->pieces.points, node->corners) : vplGeometry_Corners(g, triangle);
    *normalOut = g->normals[triangle];
    return true;
}

// The number of patches of all triangles, at most `enough`. Allocates nothing: too many are refused before.
static int countAll(const Roots* roots, double square, int rounds, int enough)
{
    int count = roots->groupCount;
    for (int i = 0; i < roots->count && count < enough; i++) {
        vplTriangleCorners corners;
        vplVec3 normal;
        if (getRoot(roots, i, &corners, &normal)) {
            count += countPart(&corners, normal, square, rounds, enough - count);
        }
    }
    return count;
}

// ---- groups

static int countWith(Roots* roots, const vplGroupLength* groups, int rounds, int enough)
{
    roots->groupCount = vplGroupTree_Group(roots->tree, groups);
    return countAll(roots, groups->length * groups->length, rounds, enough);
}

static int countFor(Roots* roots, double length, int rounds, int enough)
{
    return countWith(roots, &(vplGroupLength){.length = length}, rounds, enough);
}

// Finds for how many triangles the smaller T must be used, if the number of patches jumps between the two, as where all boxes are equal.
static vplGroupLength groupParts(Roots* roots, int count, int rounds, vplGroupLength groups)
{
    int low = 0;
    groups.finerCount = 1; // reaches the box of all triangles alone; that is enough if the number jumps there
    if (countWith(roots, &groups, rounds, count) < count) {
        low = 1;
        groups.finerCount = roots->geometry->triangleCount;
    }
    while (groups.finerCount - low > 1) {
        vplGroupLength fewer = groups;
        fewer.finerCount = low + (groups.finerCount - low) / 2;
        if (countWith(roots, &fewer, rounds, count) < count) {
            low = fewer.finerCount;
        } else {
            groups = fewer;
        }
    }
    return groups;
}

// The T that gives about `count` patches, with groups of triangles. Halves the interval in which it lies until the count
// is within 2 %, or jumps over it.
static vplGroupLength groupLength(Roots* roots, int count, int rounds)
{
    const int enough = count < VPL_MAX_PATCHES / 2 ? 2 * count : VPL_MAX_PATCHES;
    double high = vplGroupTree_Diagonal(roots->tree) * (1 + 0x1p-15), low = high;
    int fewer = countFor(roots, high, rounds, enough), more = fewer;
    for (int i = 0; i < VPL_MAX_PATCH_ROUNDS && more < count; i++) {
        high = low;
        fewer = more;
        low *= 0.5;
        more = countFor(roots, low, rounds, enough);
    }
    while (high - low > low * 0x1p-18 && more > count + count / 50 && fewer < count - count / 50) {
        const double middle = 0.5 * (low + high);
        const int found = countFor(roots, middle, rounds, enough);
        if (found < count) {
            high = middle;
            fewer = found;
        } else {
            low = middle;
            more = found;
        }
    }
    if (more - count > count / 10 && count - fewer > count / 10) {
        return groupParts(roots, count, rounds, (vplGroupLength){.length = high, .finer = low});
    }
    return (vplGroupLength){.length = more - count <= count - fewer ? low : high};
}

// ---- growing

static void grow(vplPatchTree* tree, double square, int rounds)
{
    for (int round = 0, begin = 0; round < rounds; round++) {
        const int end = tree->nodeCount;
        for (int i = begin; i < end; i++) {
            if (i >= tree->rootCount ||
                (tree->nodes[i].children < 0 && vplCanBeHit(tree->geometry, tree->nodes[i].triangle))) {
                vplPatchTree_Bisect(tree, i, square);
            }
        }
        begin = end;
    }
}

// Cuts triangles where other surfaces meet them. Where none does, roots stay triangles.
static vplResult cut(vplArena* scratch, const uint8_t* uncut, Roots* roots)
{
    const vplGeometry* g = roots->geometry;
    TRY(vplArena_Check(scratch));
    roots->pieces = (vplCutPieces){.nodes = NULL};
    roots->count = g->triangleCount;
    TRY(vplCutSegments_Find(scratch, g, uncut, &roots->segments));
    if (roots->segments.count == 0) {
        return VPL_SUCCESS;
    }
    TRY(vplCutPieces_Make(scratch, g, &roots->segments, &roots->pieces));
    TRY(vplCutPieces_Snap(scratch, g, roots->segments.tolerance, &roots->pieces));
    roots->count = (int)roots->pieces.nodeCount;
    return VPL_SUCCESS;
}

static void warnUnresolved(const Roots* roots)
{
    if (roots->pieces.unresolved > 0) {
        vplLog(roots->geometry->context, VPL_LOG_WARNING,
               "%d of %zu lines where surfaces meet do not divide all patches that they cross, so light may "
               "leak there",
               roots->pieces.unresolved, roots->segments.count);
    }
}

// Groups and cuts triangles for a length. Returns how many patches there are in *countOut.
static vplResult groupAndCut(const vplPatchDef* def, vplArena* scratch, Roots* roots,
                             const vplGroupLength* groups, int* countOut)
{
    const double length = groups->length;
    roots->pieces = (vplCutPieces){.nodes = NULL};
    roots->count = roots->geometry->triangleCount;
    roots->groupCount = vplGroupTree_Group(roots->tree, groups);
    TRY(def->cut ? cut(scratch, vplGroupTree_FindUncut(roots->tree, length), roots) : VPL_SUCCESS);
    *countOut = countAll(roots, length * length, def->rounds, VPL_MAX_PATCHES);
    return VPL_SUCCESS;
}

// Groups and cuts depend on each other: what is in a group is not cut, and what cuts add leaves fewer patches for the
// rest. So other numbers are tried until that with cuts is within 10 %, or the nearest of eight. The search ends when the
// same number is found again: then the split of one large box jumps over the wanted number.
static vplResult chooseGroups(const vplPatchDef* def, vplArena* scratch, Roots* roots)
{
    enum { ROUNDS = 8 };
    const int count = def->count;
    int least = 1, most = VPL_MAX_PATCHES, wanted = count, best = INT_MAX, below = 0, above = INT_MAX, found;
    vplGroupLength nearest = {.length = 0};
    TRY(vplGroupTree_Build(scratch, roots->geometry, &roots->tree));
    if (def->size > 0) {
        nearest.length = (double)def->size;
        return groupAndCut(def, scratch, roots, &nearest, &found);
    }
    for (int round = 0; round < ROUNDS && least <= most && best > count / 10; round++) {
        const vplGroupLength length = groupLength(roots, wanted, def->rounds);
        TRY(groupAndCut(def, scratch, roots, &length, &found));
        if (abs(found - count) < best) {
            best = abs(found - count);
            nearest = length;
        }
        if (found == below || found == above) {
            break;
        }
        least = found < count ? wanted + 1 : least;
        most = found > count ? wanted - 1 : most;
        below = found < count ? found : below;
        above = found > count ? found : above;
        const int next = wanted - (found - count);
        wanted = next >= least && next <= most ? next : least + (vplMini(most, 2 * wanted) - least) / 2;
    }
    return groupAndCut(def, scratch, roots, &nearest, &found);
}

// ---- growing

// Finds how many bisections the definition asks for. Refuses too many patches.
static vplResult countBisections(const Roots* roots, const vplPatchDef* def, int* moreOut, int* cutPatchesOut)
{
    const int pieces = countAll(roots, INFINITY, 0, VPL_MAX_PATCHES + 1);
    const double square = (double)def->size * (double)def->size;
    const int count = def->size > 0 ? countAll(roots, square, def->rounds, VPL_MAX_PATCHES + 1)
                                    : vplMaxi(pieces, def->count);
    if (pieces > VPL_MAX_PATCHES) {
        return vplFail(roots->geometry->context, VPL_LIMIT,
                       "cuts leave more than %d pieces of triangles, which are allowed", VPL_MAX_PATCHES);
    }
    if (count > VPL_MAX_PATCHES) {
        return vplFail(roots->geometry->context, VPL_LIMIT,
                       "patches with edges up to %g m are more than %d, which are allowed", (double)def->size,
                       VPL_MAX_PATCHES);
    }
    const Roots whole = {.geometry = roots->geometry,
                         .tree = roots->tree,
                         .groupCount = roots->groupCount,
                         .count = roots->geometry->triangleCount};
    *moreOut = count - pieces;
    *cutPatchesOut = pieces - countAll(&whole, INFINITY, 0, pieces);
    return VPL_SUCCESS;
}

static void addRoots(const Roots* roots, vplPatchTree* tree)
{
    if (roots->pieces.pointCount > 0) {
        vplPatchTree_AddPieces(tree, roots->pieces.nodes, (size_t)roots->count, roots->pieces.points);
    } else {
        vplPatchTree_AddTriangles(tree);
    }
}

// Marks the triangles of groups, which are not bisected. Returns NULL where there are no groups.
static const uint8_t* markKept(const Roots* roots, vplArena* scratch)
{
    if (roots->groupCount == 0) {
        return NULL;
    }
    uint8_t* isKept = vplArena_AllocZero(scratch, (size_t)roots->count, 1);
    if (vplArena_Check(scratch) == VPL_SUCCESS) {
        memcpy(isKept, vplGroupTree_IsGrouped(roots->tree), (size_t)roots->geometry->triangleCount);
    }
    return isKept;
}

static vplResult bisectRoots(const Roots* roots, const vplPatchDef* def, int more, vplPatchTree* tree)
{
    addRoots(roots, tree);
    if (def->size > 0) {
        grow(tree, (double)def->size * (double)def->size, def->rounds);
        return VPL_SUCCESS;
    }
    const uint8_t* isKept = markKept(roots, tree->scratch);
    TRY(vplArena_Check(tree->scratch));
    return vplPatchTree_BisectLongest(tree, isKept, more, def->rounds);
}

static vplResult build(const Roots* roots, const vplPatchDef* def, vplPatches** patchesOut)
{
    const vplGeometry* g = roots->geometry;
    const size_t triangles = (size_t)g->triangleCount, vertices = (size_t)g->vertexCount,
                 points = roots->pieces.pointCount;
    const size_t corners =
        (3 * triangles < vertices ? 3 * triangles : vertices) + (points > 0 ? points - 3 * triangles : 0);
    vplPatchTree tree = {.geometry = g, .unresolvedCuts = roots->pieces.unresolved};
    int more = 0;
    TRY(countBisections(roots, def, &more, &tree.cutPatches));
    const size_t most = (size_t)more + (size_t)vplSparePatches(more);
    vplResult result = vplPatchTree_Reserve(&tree, corners + most, (size_t)roots->count + 2 * most);
    if (result == VPL_SUCCESS && points > 0) {
        result = vplPatchTree_CopyCuts(&tree, roots->segments.list, roots->segments.first);
    }
    if (result == VPL_SUCCESS && roots->groupCount > 0) {
        result = vplGroupTree_List(roots->tree, tree.arena, &tree.groups);
    }
    if (result == VPL_SUCCESS) {
        result = bisectRoots(roots, def, more, &tree);
    }
    return vplPatchTree_Finish(&tree, result, patchesOut);
}

vplResult vplPatches_Create(const vplGeometry* geometry, const vplPatchDef* def, vplPatches** patchesOut)
{
    REQUIRE(CONTEXT_OF(geometry), geometry, def, patchesOut);
    TRY(checkDef(geometry, def));
    Roots roots = {.geometry = geometry, .count = geometry->triangleCount};
    vplArena* scratch = def->cut || def->group ? vplArena_Create(geometry->context) : NULL;
    vplResult result = def->group ? chooseGroups(def, scratch, &roots)
                       : def->cut ? cut(scratch, NULL, &roots)
                                  : VPL_SUCCESS;
    if (result == VPL_SUCCESS) {
        warnUnresolved(&roots);
        result = build(&roots, def, patchesOut);
    }
    vplArena_Destroy(scratch);
    return result;
}

void vplPatches_Destroy(vplPatches* patches)
{
    vplArena_Destroy(patches != NULL ? patches->arena : NULL);
}
