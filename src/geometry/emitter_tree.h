// SPDX-License-Identifier: MIT
// A binary tree over sources of light, from which a point chooses one by how much light it may send there.
#ifndef VPL_GEOMETRY_EMITTER_TREE_H
#define VPL_GEOMETRY_EMITTER_TREE_H

#include <vpl/geometry.h>

#include "base/arena.h"

typedef struct vplEmitterTree vplEmitterTree;

// A source that was chosen.
typedef struct vplChosenSource {
    int source;         // index; -1: none can light the point
    double probability; // of being chosen
    double rest;        // in [0, 1): a random number again
} vplChosenSource;

// Makes a tree of the sources first .. end - 1 that have a place: points, spots and triangles. Needs O(n log n) time and
// 120 bytes per source, twice as much while it is made. The arena owns it. *treeOut is NULL where there are none.
vplResult vplEmitterTree_Create(vplArena* arena, const vplEmission* emission, int first, int end,
                                vplEmitterTree** treeOut);

// Makes the tree choose sources by power alone, wherever the lit point is; for comparisons.
void vplEmitterTree_ForgetPlaces(vplEmitterTree* tree);

// Chooses a source for a point and the normal of the side that is lit, by a number in [0, 1), in O(log n). A source that
// may light the point has a probability greater than 0. Together they may stay below 1: bounds are loose, and a choice can
// end where no source lights the point.
vplChosenSource vplEmitterTree_Choose(const vplEmitterTree* tree, vplVec3 position, vplVec3 normal,
                                      double choice);

// The probability with which the point chooses a source of the tree, in O(log n).
double vplEmitterTree_Probability(const vplEmitterTree* tree, vplVec3 position, vplVec3 normal, int source);

#endif
