// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.1: each round bisects every triangle whose longest edge is
// longer than T. Departs: "longer than", so that T equal to a length has one meaning (X097).
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

// ---- how many

typedef struct Part {
    vplTriangleCorners at;
    int round;
} Part;

// How many patches a triangle becomes; `enough` is as good as more.
static int countTriangle(const vplGeometry* g, int triangle, double square, int rounds, int enough)
{
    Part stack[VPL_MAX_PATCH_ROUNDS + 1];
    int depth = 1, count = 0;
    const vplTriangleCorners corners = vplGeometry_Corners(g, triangle);
    stack[0] = (Part){vplPatch_Turn(&corners), 0};
    while (depth > 0 && count < enough) {
        const Part part = stack[--depth];
        vplVec3 middle;
        if (part.round < rounds && vplPatch_Square(&part.at) > square &&
            vplPatch_Middle(&part.at, g->normals[triangle], &middle)) {
            const vplTriangleCorners first = vplPatch_Half(&part.at, middle, 0),
                                     second = vplPatch_Half(&part.at, middle, 1);
            stack[depth++] = (Part){vplPatch_Turn(&first), part.round + 1};
            stack[depth++] = (Part){vplPatch_Turn(&second), part.round + 1};
        } else {
            count++;
        }
    }
    return count;
}

// Of all triangles; at most `enough`. Nothing is made for it: what is too much is refused before (X098).
static int countAll(const vplGeometry* g, double square, int rounds, int enough)
{
    int count = 0;
    for (int t = 0; t < g->triangleCount && count < enough; t++) {
        count += vplCanBeHit(g, t) ? countTriangle(g, t, square, rounds, enough - count) : 0;
    }
    return count;
}

// ---- the length for a count

static double longestOf(const vplGeometry* g)
{
    double longest = 0;
    for (int t = 0; t < g->triangleCount; t++) {
        const vplTriangleCorners corners = vplGeometry_Corners(g, t), turned = vplPatch_Turn(&corners);
        longest = fmax(longest, vplCanBeHit(g, t) ? vplPatch_Square(&turned) : 0);
    }
    return sqrt(longest);
}

// Halves are never longer than their whole, so bisecting the longest first ends in the same patches as a length does
// that all longer ones are bisected by: the longest one that gives `count` patches, to 2^-18 of it. That is wider than
// what rounding does to edges that mean to be alike, and so these stay together. Searching from a little above the
// longest edge keeps the bounds off its halves and quarters, which edges of patches are.
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

// ---- all of it

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
    vplResult result = checkDef(geometry, def);
    if (result != VPL_SUCCESS) {
        return result;
    }
    const double length = def->size > 0 ? (double)def->size : lengthFor(geometry, def->count, def->rounds);
    const double square = length * length;
    const int count = countAll(geometry, square, def->rounds, VPL_MAX_PATCHES + 1);
    if (count > VPL_MAX_PATCHES) {
        return vplFail(geometry->context, VPL_LIMIT,
                       "patches with edges up to %g m are more than %d, which are allowed", length,
                       VPL_MAX_PATCHES);
    }
    const size_t triangles = (size_t)geometry->triangleCount, vertices = (size_t)geometry->vertexCount;
    vplPatchTree tree = {.geometry = geometry};
    result =
        vplPatchTree_Reserve(&tree, (3 * triangles < vertices ? 3 * triangles : vertices) + (size_t)count,
                             triangles + 2 * (size_t)count);
    if (result == VPL_SUCCESS) {
        vplPatchTree_AddTriangles(&tree);
        grow(&tree, square, def->rounds);
        result = vplPatchTree_Finish(&tree, patchesOut);
    }
    return result;
}

void vplPatches_Destroy(vplPatches* patches)
{
    if (patches != NULL) {
        vplFree(patches->context, (void*)patches->positions);
        vplFree(patches->context, (void*)patches->nodes);
        vplFree(patches->context, (void*)patches->patches);
        vplFree(patches->context, patches);
    }
}

// ---- questions

double vplPatches_Area(const vplPatches* patches, int patch)
{
    const vplTriangleCorners at =
        vplCornersOf(patches->positions, patches->nodes[patches->patches[patch]].corners);
    return vplTriangle_Area(&at);
}

// On its way down only weights change, and no position is looked up: 2 w of the corner that is left goes to the middle.
// The tests of sides at 51,456 patches spent two fifths of their time here when the middles' lines were asked.
int vplPatches_Find(const vplPatches* patches, int triangle, vplVec3 position)
{
    const vplPatchNode* node = &patches->nodes[triangle];
    const vplTriangleCorners at = vplCornersOf(patches->positions, node->corners);
    double w[3];
    vplTriangle_Weigh(at.corner, position, w);
    while (node->children >= 0) {
        const bool second = w[2] > w[1];
        const vplPatchNode* half = &patches->nodes[node->children + second];
        const double a = w[0], b = second ? 2 * w[1] : w[1] - w[2], c = second ? w[2] - w[1] : 2 * w[2];
        const uint32_t apex = node->corners[0]; // corner 0 of the half before it was turned
        const int turn = half->corners[0] == apex ? 0 : half->corners[2] == apex ? 1 : 2;
        w[0] = turn == 0 ? a : turn == 1 ? b : c;
        w[1] = turn == 0 ? b : turn == 1 ? c : a;
        w[2] = turn == 0 ? c : turn == 1 ? a : b;
        node = half;
    }
    return node->patch;
}
