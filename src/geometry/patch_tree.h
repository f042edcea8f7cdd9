// SPDX-License-Identifier: MIT
// The bisection trees of patches while they grow.
#ifndef VPL_GEOMETRY_PATCH_TREE_H
#define VPL_GEOMETRY_PATCH_TREE_H

#include "base/arena.h"
#include "geometry/patch_groups.h"

typedef struct vplPatchTree {
    const vplGeometry* geometry;
    vplArena* arena;   // of the patches that it becomes: owns positions and nodes
    vplArena* scratch; // owns the slots
    vplVec3* positions;
    uint32_t* slots; // hash table of positions: 1 + index; 0: empty
    uint32_t slotMask;
    vplPatchNode* nodes;
    int positionCount, nodeCount;
    int rootCount; // nodes before the first bisection: triangles and their pieces
    // As in vplPatches; owned by the arena.
    const vplPatchCut* cuts;
    const int* firstCut;
    int cutPatches, unresolvedCuts;
    vplPatchGroups groups;
} vplPatchTree;

// Rotates the corners until corner 0 is opposite the longest edge; among equally long ones 01 goes before 12
// and 12 before 20.
vplTriangleCorners vplPatch_Rotate(const vplTriangleCorners* triangle);

// Returns the corner that vplPatch_Rotate makes corner 0.
int vplPatch_FirstCorner(const vplTriangleCorners* triangle);

// True if the triangle has an area and is counter-clockwise seen from where the normal points.
bool vplPatch_FacesAlong(const vplTriangleCorners* triangle, vplVec3 normal);

// True if a split from corner 0 to a point on the opposite edge leaves two parts of which this holds.
bool vplPatch_CanSplit(const vplTriangleCorners* rotated, vplVec3 point, vplVec3 normal);

// Squared length of the edge opposite corner 0, in double, so that an edge of length T does not exceed T.
double vplPatch_SquaredEdge(const vplTriangleCorners* rotated);

// The middle of the edge opposite corner 0, the same bits from both of its sides. False where a half would
// have no area, because no float lies between the ends.
bool vplPatch_Middle(const vplTriangleCorners* rotated, vplVec3 normal, vplVec3* middleOut);

// A half of a bisected triangle. Its corners begin with those on the edge that was cut: that order decides
// which of several equally long edges is bisected next.
vplTriangleCorners vplPatch_Half(const vplTriangleCorners* rotated, vplVec3 middle, int second);

// Makes a leaf. `corners` are indices in `positions`.
vplPatchNode vplPatchNode_Make(const vplVec3* positions, const uint32_t corners[3], int triangle, int parent);

// Allocates room for positions and nodes, and makes the arenas. The tree's geometry is set.
vplResult vplPatchTree_Reserve(vplPatchTree* tree, size_t positions, size_t nodes);

// The index of a position, which is added if it is new.
uint32_t vplPatchTree_Intern(vplPatchTree* tree, vplVec3 position);

// Adds node t for each triangle t.
void vplPatchTree_AddTriangles(vplPatchTree* tree);

// Adds nodes whose corners are indices in `points`.
void vplPatchTree_AddPieces(vplPatchTree* tree, const vplPatchNode* nodes, size_t count,
                            const vplVec3* points);

// Copies cuts into the tree's arena. `firstCut` has an entry more than there are triangles; NULL: there are none.
vplResult vplPatchTree_CopyCuts(vplPatchTree* tree, const vplPatchCut* cuts, const int* firstCut);

// Copies groups into the tree's arena.
vplResult vplPatchTree_CopyGroups(vplPatchTree* tree, const vplPatchGroups* groups);

// Gives a node two children if the square of its longest edge exceeds `square`. False where it stays a leaf.
bool vplPatchTree_Bisect(vplPatchTree* tree, int node, double square);

// How many more bisections than asked for are made so that patches of one length and area stay alike.
static inline int vplSparePatches(int more)
{
    return more / 20;
}

// Bisects the leaf with the longest edge, `more` times, each triangle at most `rounds` times. Of equally long leaves the one with
// the largest area is first, then the one with the lowest index. If leaves are left that equal the last one and are at most
// vplSparePatches, they are bisected, too. There is room for all. `isKept`: nodes that are not bisected; NULL: none.
// (patch_refine.c)
vplResult vplPatchTree_BisectLongest(vplPatchTree* tree, const uint8_t* isKept, int more, int rounds);

// Ends a tree: makes patches of its leaves, unless `result` is a failure on the way here, which it returns.
vplResult vplPatchTree_Finish(vplPatchTree* tree, vplResult result, vplPatches** patchesOut);

#endif
