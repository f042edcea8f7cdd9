// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.1: each round bisects every triangle whose
// longest edge is longer than T. An edge exactly as long as T stays whole.
#include "base/context.h"
#include "geometry/bvh.h"
#include "geometry/patch_tree.h"
#include "math/scalar.h"
#include "math/vec.h"

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

// The number of patches of all triangles, at most `enough`. Allocates nothing: too many are refused before.
static int countAll(const vplGeometry* g, double square, int rounds, int enough)
{
    int count = 0;
    for (int t = 0; t < g->triangleCount && count < enough; t++) {
        if (vplCanBeHit(g, t)) {
            const vplTriangleCorners corners = vplGeometry_Corners(g, t);
            count += countPart(&corners, g->normals[t], square, rounds, enough - count);
        }
    }
    return count;
}

// ---- the longest edge for a count

static double longestOf(const vplGeometry* g)
{
    double longest = 0;
    for (int t = 0; t < g->triangleCount; t++) {
        const vplTriangleCorners corners = vplGeometry_Corners(g, t), rotated = vplPatch_Rotate(&corners);
        longest = fmax(longest, vplCanBeHit(g, t) ? vplPatch_SquaredEdge(&rotated) : 0);
    }
    return sqrt(longest);
}

// The longest T that gives `count` patches, to 2^-18 of it. Halves are never longer than their whole, so
// bisecting the longest edge first ends in the same patches as such a T. The tolerance exceeds rounding, so
// edges that are meant to be equal stay together. The search starts a little above the longest edge, to keep
// the interval's ends off halves and quarters of it, which are lengths of patches.
static double lengthFor(const vplGeometry* g, int count, int rounds)
{
    double high = longestOf(g) * (1 + 0x1p-15), low = high;
    const int most = countAll(g, 0, rounds, count);
    if (countAll(g, INFINITY, 0, count) >= count || most == 0) {
        return INFINITY;
    }
    while (countAll(g, low * low, rounds, count) < most) {
        high = low;
        low *= 0.5;
    }
    while (high - low > low * 0x1p-18) {
        const double middle = 0.5 * (low + high);
        if (countAll(g, middle * middle, rounds, count) < most) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return low;
}

// ---- growing

static void grow(vplPatchTree* tree, double square, int rounds)
{
    const int triangles = tree->nodeCount;
    for (int round = 0, begin = 0; round < rounds; round++) {
        const int end = tree->nodeCount;
        for (int i = begin; i < end; i++) {
            if (i >= triangles || vplCanBeHit(tree->geometry, i)) {
                vplPatchTree_Bisect(tree, i, square);
            }
        }
        begin = end;
    }
}

vplResult vplPatches_Create(const vplGeometry* geometry, const vplPatchDef* def, vplPatches** patchesOut)
{
    TRY(checkDef(geometry, def));
    const double length = def->size > 0 ? (double)def->size : lengthFor(geometry, def->count, def->rounds);
    const double square = length * length;
    const int count = countAll(geometry, square, def->rounds, VPL_MAX_PATCHES + 1);
    if (count > VPL_MAX_PATCHES) {
        return vplFail(geometry->context, VPL_LIMIT,
                       "patches with edges up to %g m are more than %d, which are allowed", length,
                       VPL_MAX_PATCHES);
    }
    const size_t triangles = (size_t)geometry->triangleCount, vertices = (size_t)geometry->vertexCount;
    const size_t corners = 3 * triangles < vertices ? 3 * triangles : vertices;
    vplPatchTree tree = {.geometry = geometry};
    const vplResult result =
        vplPatchTree_Reserve(&tree, corners + (size_t)count, triangles + 2 * (size_t)count);
    if (result == VPL_SUCCESS) {
        vplPatchTree_AddTriangles(&tree);
        grow(&tree, square, def->rounds);
    }
    return vplPatchTree_Finish(&tree, result, patchesOut);
}

void vplPatches_Destroy(vplPatches* patches)
{
    vplArena_Destroy(patches != NULL ? patches->arena : NULL);
}

// ---- queries

double vplPatches_Area(const vplPatches* patches, int patch)
{
    const vplTriangleCorners at =
        vplCornersOf(patches->positions, patches->nodes[patches->patches[patch]].corners);
    return vplTriangle_Area(&at);
}

// The walk updates barycentrics and reads no positions, which took two fifths of the time of testing sides at
// 51,456 patches. In a half, the middle gets twice the weight of the corner that is left out.
int vplPatches_Find(const vplPatches* patches, int triangle, vplVec3 position)
{
    const vplPatchNode* node = &patches->nodes[triangle];
    const vplTriangleCorners at = vplCornersOf(patches->positions, node->corners);
    double w[3];
    vplTriangle_Barycentrics(at.corner, position, w);
    while (node->children >= 0) {
        const bool second = w[2] > w[1];
        const vplPatchNode* half = &patches->nodes[node->children + second];
        const double a = w[0], b = second ? 2 * w[1] : w[1] - w[2], c = second ? w[2] - w[1] : 2 * w[2];
        const uint32_t apex = node->corners[0]; // has weight a, and is anywhere in the half's rotated corners
        const int rotation = half->corners[0] == apex ? 0 : half->corners[2] == apex ? 1 : 2;
        w[0] = rotation == 0 ? a : rotation == 1 ? b : c;
        w[1] = rotation == 0 ? b : rotation == 1 ? c : a;
        w[2] = rotation == 0 ? c : rotation == 1 ? a : b;
        node = half;
    }
    return node->patch;
}
