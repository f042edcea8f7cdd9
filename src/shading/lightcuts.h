// SPDX-License-Identifier: MIT
// Cuts through the light tree.
#ifndef VPL_SHADING_LIGHTCUTS_H
#define VPL_SHADING_LIGHTCUTS_H

#include "shading/shading.h"

// Clusters in a cut. If they are not enough, the worst cluster is summed light by light, so that the error
// stays within its bound. No cut of the scenes in bench/lightcuts has half as many.
enum { VPL_CUT_CAPACITY = 16384 };

// A cluster of the cut: its representative stands for all of its lights.
typedef struct vplCutEntry {
    float visible[VPL_LANES]; // contribution of the representative, of intensity 1
    float open[VPL_LANES];    // the same if nothing were between
    float bound[VPL_LANES];   // largest error of the cluster, r + g + b
    vplCluster cluster;
} vplCutEntry;

// The cut of one block of points: a heap with the cluster of largest error on top.
typedef struct vplCut {
    vplCutEntry entries[VPL_CUT_CAPACITY];
    float keys[VPL_CUT_CAPACITY];  // errors, relative to the error that is allowed
    int indices[VPL_CUT_CAPACITY]; // of each key: its entry; behind the last key: free entries
    int count;
    int evaluations;
} vplCut;

// A worker's cut, and statistics over all its cuts.
typedef struct vplCutWorker {
    vplCut cut;
    int64_t evaluations, pixels;
    int largest;
} vplCutWorker;

// State of the strategy.
typedef struct vplLightcuts {
    vplLightTree* tree;
    vplCutWorker* workers;
} vplLightcuts;

#endif
