// SPDX-License-Identifier: MIT
// Groups of small triangles that are one patch each.
#ifndef VPL_GEOMETRY_PATCH_GROUPS_H
#define VPL_GEOMETRY_PATCH_GROUPS_H

#include "base/arena.h"
#include "geometry/triangle.h"

// The triangles of group i are members[first[i]] .. members[first[i + 1] - 1]; areaUpTo as in vplPatches.
typedef struct vplPatchGroups {
    int count;
    const int *first, *members;
    const double* areaUpTo;
} vplPatchGroups;

// All triangles in a tree of boxes, by which they are grouped for any length.
typedef struct vplGroupTree vplGroupTree;

vplResult vplGroupTree_Build(vplArena* scratch, const vplGeometry* geometry, vplGroupTree** treeOut);

// The largest diagonal of a group's box, T. Where many boxes are equal, one T groups either all of them or none, so the first
// `finerCount` triangles, in the tree's order, use a smaller T.
typedef struct vplGroupLength {
    double length, finer; // T, and the smaller T, metres
    int finerCount;
} vplGroupLength;

// Forms the groups: the largest boxes of the tree whose diagonal is at most T, divided by emission and by normals.
// Returns how many there are. `isGrouped` then says which triangles are in one.
int vplGroupTree_Group(vplGroupTree* tree, const vplGroupLength* length);

// One byte per triangle of the geometry.
const uint8_t* vplGroupTree_IsGrouped(const vplGroupTree* tree);

// The triangles that neither cut others nor are cut: those of groups, and those that are much thinner than T.
const uint8_t* vplGroupTree_FindUncut(vplGroupTree* tree, double length);

// The diagonal of the box of all triangles, metres.
double vplGroupTree_Diagonal(const vplGroupTree* tree);

// The groups as they are now. The arrays are in the arena.
vplResult vplGroupTree_List(const vplGroupTree* tree, vplArena* arena, vplPatchGroups* groupsOut);

#endif
