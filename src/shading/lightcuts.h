// SPDX-License-Identifier: MIT
// What cuts through the light tree are made of.
#ifndef VPL_SHADING_LIGHTCUTS_H
#define VPL_SHADING_LIGHTCUTS_H

#include "shading/shading.h"

// Clusters a cut may hold. Where that is not enough the worst cluster is summed light by light, so that the error
// stays within its bound. No cut of the scenes in bench/lightcuts holds half as many.
enum { VPL_CUT_CAPACITY = 16384 };

// A cluster of the cut: its representative stands for all of its lights.
typedef struct vplCutEntry {
    float gives[VPL_LANES]; // the representative, of intensity 1
    float open[VPL_LANES];  // the same if nothing were between
    float bound[VPL_LANES]; // largest error of the cluster, r + g + b
    vplCluster cluster;
} vplCutEntry;

// The cut of one block of points. A heap of keys: the worst cluster is on top.
typedef struct vplCut {
    vplCutEntry entries[VPL_CUT_CAPACITY];
    float keys[VPL_CUT_CAPACITY];
    int places[VPL_CUT_CAPACITY]; // of the entry that belongs to a key
    int count;
    int evaluations;
} vplCut;

// What a worker needs for one cut after another, and what they came to.
typedef struct vplCutWorker {
    vplCut cut;
    int64_t evaluations, pixels;
    int largest;
} vplCutWorker;

typedef struct vplLightcuts {
    vplLightTree* tree;
    vplCutWorker* workers;
    int workerCount;
} vplLightcuts;

#endif
