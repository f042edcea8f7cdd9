// SPDX-License-Identifier: MIT
// Based on: Dan Hemgren, Radiosity in Realtime Rendering, 3.1; Maria-Cecilia Rivara, Algorithms for Refining
// Triangular Grids, 1984 (longest-edge bisection). Departs: neighbours are not refined along; the radiosity
// mesh handles hanging vertices.
#include "geometry/patch_tree.h"

#include "geometry/bvh.h"
#include "math/vec.h"

#include <string.h>

// ---- one triangle

static double squareBetween(vplVec3 a, vplVec3 b)
{
    const double x = (double)b.x - (double)a.x, y = (double)b.y - (double)a.y, z = (double)b.z - (double)a.z;
    return x * x + y * y + z * z;
}

int vplPatch_FirstCorner(const vplTriangleCorners* triangle)
{
    const vplVec3* c = triangle->corner;
    const double s01 = squareBetween(c[0], c[1]), s12 = squareBetween(c[1], c[2]),
                 s20 = squareBetween(c[2], c[0]);
    return s01 >= s12 && s01 >= s20 ? 2 : s12 >= s20 ? 0 : 1;
}

vplTriangleCorners vplPatch_Rotate(const vplTriangleCorners* triangle)
{
    const vplVec3* c = triangle->corner;
    const int first = vplPatch_FirstCorner(triangle);
    return (vplTriangleCorners){{c[first], c[(first + 1) % 3], c[(first + 2) % 3]}};
}

double vplPatch_SquaredEdge(const vplTriangleCorners* rotated)
{
    return squareBetween(rotated->corner[1], rotated->corner[2]);
}

vplTriangleCorners vplPatch_Half(const vplTriangleCorners* rotated, vplVec3 middle, int second)
{
    const vplVec3* c = rotated->corner;
    return second ? (vplTriangleCorners){{middle, c[2], c[0]}} : (vplTriangleCorners){{c[1], middle, c[0]}};
}

bool vplPatch_FacesAlong(const vplTriangleCorners* triangle, vplVec3 normal)
{
    double c[3];
    vplTriangle_Cross(triangle, c);
    return c[0] * (double)normal.x + c[1] * (double)normal.y + c[2] * (double)normal.z > 0;
}

bool vplPatch_CanSplit(const vplTriangleCorners* rotated, vplVec3 point, vplVec3 normal)
{
    const vplTriangleCorners first = vplPatch_Half(rotated, point, 0),
                             second = vplPatch_Half(rotated, point, 1);
    return vplPatch_FacesAlong(&first, normal) && vplPatch_FacesAlong(&second, normal);
}

// Adds halves instead of halving the sum, which overflows for two large coordinates.
bool vplPatch_Middle(const vplTriangleCorners* rotated, vplVec3 normal, vplVec3* middleOut)
{
    const vplVec3 a = rotated->corner[1], b = rotated->corner[2];
    *middleOut = vplAdd(vplScale(0.5f, a), vplScale(0.5f, b));
    return vplPatch_CanSplit(rotated, *middleOut, normal);
}

// ---- positions

static uint32_t hashOf(const uint32_t bits[3])
{
    uint64_t h = bits[0] * UINT64_C(0x9E3779B97F4A7C15);
    h = (h ^ (h >> 32) ^ bits[1]) * UINT64_C(0xBF58476D1CE4E5B9);
    h = (h ^ (h >> 32) ^ bits[2]) * UINT64_C(0x94D049BB133111EB);
    return (uint32_t)(h >> 32);
}

uint32_t vplPatchTree_Intern(vplPatchTree* tree, vplVec3 position)
{
    const vplVec3 p = vplVec(position.x + 0.0f, position.y + 0.0f, position.z + 0.0f); // turns -0 into 0
    uint32_t bits[3];
    memcpy(bits, &p, sizeof bits);
    uint32_t slot = hashOf(bits) & tree->slotMask;
    for (; tree->slots[slot] != 0; slot = (slot + 1) & tree->slotMask) {
        if (memcmp(&tree->positions[tree->slots[slot] - 1], &p, sizeof p) == 0) {
            return tree->slots[slot] - 1;
        }
    }
    tree->positions[tree->positionCount] = p;
    tree->slots[slot] = (uint32_t)++tree->positionCount;
    return tree->slots[slot] - 1;
}

vplResult vplPatchTree_Reserve(vplPatchTree* tree, size_t positions, size_t nodes)
{
    size_t slots = 16;
    while (slots < 2 * positions) {
        slots *= 2;
    }
    tree->slotMask = (uint32_t)(slots - 1);
    tree->arena = vplArena_Create(tree->geometry->context);
    tree->scratch = vplArena_Create(tree->geometry->context);
    tree->positions = vplArena_Alloc(tree->arena, positions, sizeof *tree->positions);
    tree->nodes = vplArena_Alloc(tree->arena, nodes, sizeof *tree->nodes);
    tree->slots = vplArena_AllocZero(tree->scratch, slots, sizeof *tree->slots);
    TRY(vplArena_Check(tree->arena));
    return vplArena_Check(tree->scratch);
}

// ---- nodes

static vplTriangleCorners cornersOf(const vplPatchTree* tree, int node)
{
    return vplCornersOf(tree->positions, tree->nodes[node].corners);
}

vplPatchNode vplPatchNode_Make(const vplVec3* positions, const uint32_t corners[3], int triangle, int parent)
{
    const vplTriangleCorners at = vplCornersOf(positions, corners);
    const int first = vplPatch_FirstCorner(&at);
    vplPatchNode node = {.triangle = triangle, .parent = parent, .children = -1, .patch = -1, .at = 0.5f};
    for (int k = 0; k < 3; k++) {
        node.corners[k] = corners[(first + k) % 3];
    }
    return node;
}

static void addNode(vplPatchTree* tree, const uint32_t corners[3], int triangle, int parent)
{
    tree->nodes[tree->nodeCount++] = vplPatchNode_Make(tree->positions, corners, triangle, parent);
}

void vplPatchTree_AddTriangles(vplPatchTree* tree)
{
    for (int t = 0; t < tree->geometry->triangleCount; t++) {
        const vplTriangleCorners at = vplGeometry_Corners(tree->geometry, t);
        uint32_t corners[3];
        for (int k = 0; k < 3; k++) {
            corners[k] = vplPatchTree_Intern(tree, at.corner[k]);
        }
        addNode(tree, corners, t, -1);
    }
    tree->rootCount = tree->nodeCount;
}

void vplPatchTree_AddPieces(vplPatchTree* tree, const vplPatchNode* nodes, size_t count,
                            const vplVec3* points)
{
    for (size_t i = 0; i < count; i++) {
        tree->nodes[i] = nodes[i];
        for (int k = 0; k < 3; k++) {
            tree->nodes[i].corners[k] = vplPatchTree_Intern(tree, points[nodes[i].corners[k]]);
        }
    }
    tree->nodeCount = tree->rootCount = (int)count;
}

vplResult vplPatchTree_CopyCuts(vplPatchTree* tree, const vplPatchCut* cuts, const int* firstCut)
{
    const size_t triangles = (size_t)tree->geometry->triangleCount;
    if (firstCut == NULL) {
        return VPL_SUCCESS;
    }
    tree->cuts = vplArena_Copy(tree->arena, cuts, (size_t)firstCut[triangles], sizeof *cuts);
    tree->firstCut = vplArena_Copy(tree->arena, firstCut, triangles + 1, sizeof *firstCut);
    return vplArena_Check(tree->arena);
}

vplResult vplPatchTree_CopyGroups(vplPatchTree* tree, const vplPatchGroups* groups)
{
    const size_t count = (size_t)groups->count, members = count > 0 ? (size_t)groups->first[count] : 0;
    if (count == 0) {
        return VPL_SUCCESS;
    }
    tree->groups.count = groups->count;
    tree->groups.first = vplArena_Copy(tree->arena, groups->first, count + 1, sizeof *groups->first);
    tree->groups.members = vplArena_Copy(tree->arena, groups->members, members, sizeof *groups->members);
    tree->groups.areaUpTo = vplArena_Copy(tree->arena, groups->areaUpTo, members, sizeof *groups->areaUpTo);
    return vplArena_Check(tree->arena);
}

bool vplPatchTree_Bisect(vplPatchTree* tree, int node, double square)
{
    const vplPatchNode whole = tree->nodes[node];
    const vplTriangleCorners at = cornersOf(tree, node);
    vplVec3 middle;
    if (!(vplPatch_SquaredEdge(&at) > square) ||
        !vplPatch_Middle(&at, tree->geometry->normals[whole.triangle], &middle)) {
        return false;
    }
    const uint32_t m = vplPatchTree_Intern(tree, middle);
    tree->nodes[node].children = tree->nodeCount;
    addNode(tree, (const uint32_t[]){whole.corners[1], m, whole.corners[0]}, whole.triangle, node);
    addNode(tree, (const uint32_t[]){m, whole.corners[2], whole.corners[0]}, whole.triangle, node);
    return true;
}

// ---- patches

static int firstLeaf(const vplPatchNode* nodes, int node)
{
    while (nodes[node].children >= 0) {
        node = nodes[node].children;
    }
    return node;
}

// The next leaf in the order of the tree, -1 after the last. Has no stack: trees may be refined to any depth.
static int nextLeaf(const vplPatchNode* nodes, int node)
{
    while (nodes[node].parent >= 0 && nodes[nodes[node].parent].children != node) {
        node = nodes[node].parent;
    }
    return nodes[node].parent < 0 ? -1 : firstLeaf(nodes, node + 1);
}

// The square root rounded up, so that as T it bisects none of these patches.
static float lengthOf(double square)
{
    const float length = (float)sqrt(square);
    return (double)length * (double)length < square ? nextafterf(length, INFINITY) : length;
}

// Marks the triangles of groups with the number that their group has among the patches. Returns how many there are.
static int markGroups(const vplPatchTree* tree)
{
    const int members = tree->groups.count > 0 ? tree->groups.first[tree->groups.count] : 0;
    for (int g = 0; g < tree->groups.count; g++) {
        for (int m = tree->groups.first[g]; m < tree->groups.first[g + 1]; m++) {
            tree->nodes[tree->groups.members[m]].patch = g;
        }
    }
    return members;
}

static void listGroups(const vplPatchTree* tree, vplPatches* patches, int* list)
{
    const int before = patches->patchCount;
    for (int g = 0; g < tree->groups.count; g++) {
        list[patches->patchCount++] = tree->groups.members[tree->groups.first[g]];
        for (int m = tree->groups.first[g]; m < tree->groups.first[g + 1]; m++) {
            tree->nodes[tree->groups.members[m]].patch = before + g;
        }
    }
    patches->groupCount = tree->groups.count;
    patches->firstMember = tree->groups.first;
    patches->members = tree->groups.members;
    patches->areaUpTo = tree->groups.areaUpTo;
}

static void listPatches(const vplPatchTree* tree, vplPatches* patches, int* list)
{
    double longest = 0;
    const bool grouped = markGroups(tree) > 0;
    for (int t = 0; t < tree->geometry->triangleCount; t++) {
        if (grouped && tree->nodes[t].patch >= 0) {
            continue;
        }
        for (int i = vplCanBeHit(tree->geometry, t) ? firstLeaf(tree->nodes, t) : -1; i >= 0;
             i = nextLeaf(tree->nodes, i)) {
            const vplTriangleCorners at = cornersOf(tree, i);
            longest = fmax(longest, vplPatch_SquaredEdge(&at));
            tree->nodes[i].patch = patches->patchCount;
            list[patches->patchCount++] = i;
        }
    }
    patches->longestEdge = lengthOf(longest);
    listGroups(tree, patches, list);
}

static vplResult makePatches(vplPatchTree* tree, vplPatches** patchesOut)
{
    const size_t leaves = ((size_t)tree->nodeCount + (size_t)tree->geometry->triangleCount) / 2;
    vplPatches* patches = vplArena_Alloc(tree->arena, 1, sizeof *patches);
    int* list = vplArena_Alloc(tree->arena, leaves, sizeof *list);
    TRY(vplArena_Check(tree->arena));
    *patches = (vplPatches){.geometry = tree->geometry,
                            .positions = tree->positions,
                            .positionCount = tree->positionCount,
                            .nodes = tree->nodes,
                            .nodeCount = tree->nodeCount,
                            .patches = list,
                            .cuts = tree->cuts,
                            .firstCut = tree->firstCut,
                            .cutPatches = tree->cutPatches,
                            .unresolvedCuts = tree->unresolvedCuts,
                            .arena = tree->arena,
                            .context = tree->geometry->context};
    listPatches(tree, patches, list);
    *patchesOut = patches;
    return VPL_SUCCESS;
}

vplResult vplPatchTree_Finish(vplPatchTree* tree, vplResult result, vplPatches** patchesOut)
{
    vplPatches* patches = NULL;
    vplArena_Destroy(tree->scratch);
    result = result == VPL_SUCCESS ? makePatches(tree, &patches) : result;
    return vplArena_Deliver(tree->arena, result, patches, patchesOut);
}
