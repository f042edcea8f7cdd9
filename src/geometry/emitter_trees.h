// SPDX-License-Identifier: MIT
// All sources of light of a scene, with the trees from which points choose among many of them.
#ifndef VPL_GEOMETRY_EMITTER_TREES_H
#define VPL_GEOMETRY_EMITTER_TREES_H

#include "geometry/emitter_tree.h"

typedef struct vplEmitterTrees {
    vplArena* arena; // owns all of it
    vplEmission* emission;
    vplEmitterTree* emitters;  // of points and spots; NULL: there is none
    vplEmitterTree* triangles; // of triangles that emit; NULL: there is none
    int* directional;          // indices of directional emitters, which are in no tree
    int directionalCount;
} vplEmitterTrees;

// The least numbers of sources that have a tree; INT32_MAX: none.
typedef struct vplTreesWanted {
    int emitters, triangles;
} vplTreesWanted;

// Needs O(n log n) time; the memory of the trees is said in emitter_tree.h. Copies the emitters; the geometry must outlive
// the trees.
vplResult vplEmitterTrees_Create(const vplGeometry* geometry, const vplEmitterDef* emitters, int emitterCount,
                                 vplTreesWanted wanted, vplEmitterTrees** treesOut);

void vplEmitterTrees_Destroy(vplEmitterTrees* trees);

#endif
