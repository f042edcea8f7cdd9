// SPDX-License-Identifier: MIT
// The trees of patches while they grow.
#ifndef VPL_GEOMETRY_PATCH_TREE_H
#define VPL_GEOMETRY_PATCH_TREE_H

#include "geometry/triangle.h"

// Room for all is made before.
typedef struct vplPatchTree {
    const vplGeometry* geometry;
    vplVec3* positions;
    uint32_t* slots; // where a position's bits lead: 1 + its index; 0: empty
    uint32_t slotMask;
    vplPatchNode* nodes;
    int positionCount, nodeCount;
} vplPatchTree;

// Turns the corners until the first is opposite to the longest edge; of equally long ones the first of 01, 12, 20.
// Returns where corner 0 was.
int vplPatch_FirstCorner(const vplTriangleCorners* triangle);
vplTriangleCorners vplPatch_Turn(const vplTriangleCorners* triangle);

// Square of the edge opposite to corner 0, in double: the squares of floats' differences lose nothing that matters, and
// edges exactly as long as T are not longer (X097).
double vplPatch_Square(const vplTriangleCorners* turned);

// The middle of the edge opposite to corner 0, the same bits from both sides of it. False where halves would have no
// area, because float holds nothing between the ends.
bool vplPatch_Middle(const vplTriangleCorners* turned, vplVec3 normal, vplVec3* middleOut);

// Corners begin with those of the edge that was cut, which is what decides between equally long edges (X099).
vplTriangleCorners vplPatch_Half(const vplTriangleCorners* turned, vplVec3 middle, int second);

// Room for so many positions and nodes.
vplResult vplPatchTree_Reserve(vplPatchTree* tree, size_t positions, size_t nodes);

// The index of a position, which is added if it is new.
uint32_t vplPatchTree_Intern(vplPatchTree* tree, vplVec3 position);

// Node t for each triangle t.
void vplPatchTree_AddTriangles(vplPatchTree* tree);

vplTriangleCorners vplPatchTree_Corners(const vplPatchTree* tree, int node);

// Gives a node two children where its longest edge's square is more than `square`. False where it stays a leaf.
bool vplPatchTree_Bisect(vplPatchTree* tree, int node, double square);

// Makes patches of the leaves and takes over the memory. On failure the tree's memory is freed.
vplResult vplPatchTree_Finish(vplPatchTree* tree, vplPatches** patchesOut);

#endif
