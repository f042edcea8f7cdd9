// SPDX-License-Identifier: MIT
// K-means over virtual lights from the inside: what searching and choosing where to start share.
#ifndef VPL_LIGHTS_CLUSTERS_H
#define VPL_LIGHTS_CLUSTERS_H

#include <vpl/lights.h>

// A light, or what it is compared with, in double.
typedef struct vplClusterPoint {
    double p[3]; // metres
    double n[3]; // unit
} vplClusterPoint;

// A distance of points.
typedef struct vplClusterDistance {
    vplClusterMetric metric;
    double w1, w2;
} vplClusterDistance;

// At least 0. Where it is not less than `best` the answer may be anything that is not, either.
double vplClusterDistance_Below(const vplClusterDistance* distance, const vplClusterPoint* a,
                                const vplClusterPoint* b, double best);

// Of a cluster: sums over its lights.
typedef struct vplClusterTally {
    vplClusterPoint sum;
    double flux[3];
    double nearest; // distance of its nearest light
    double weight;  // of all its lights
    int lightCount;
} vplClusterTally;

enum { VPL_CLUSTER_TASK = 256 }; // lights

typedef struct vplClusterSearch {
    vplContext* context;
    vplClusterDistance distance;
    int lightCount, count, maxIterations;
    vplClusterPoint* points; // of each light
    const float* weights;    // of each light; NULL: 1
    double* reached;         // of each light: its distance from its cluster
    int* of;                 // of each light: its cluster; zeros before the search
    vplClusterPoint* centres;
    vplClusterTally* tallies;
    bool* moved; // of each cluster: since lights looked last
    int* movedList;
    int movedCount;
    uint64_t* hashes; // of all assignments so far
    int taskCount;
    bool* changed; // of each task: whether a light went to another cluster
    bool first;
} vplClusterSearch;

static inline double vplClusterSearch_Weight(const vplClusterSearch* search, int light)
{
    return search->weights != NULL ? (double)search->weights[light] : 1;
}

// Where clusters start: where def->last has clusters with lights, or at lights that def->seeds names, then at lights
// that are far from all those before.
void vplClusterSearch_Place(vplClusterSearch* search, const vplClusterDef* def);

// From there to the end: of, centres, the tallies' sums and counts; iterations and end of `clusters`.
void vplClusterSearch_Run(vplClusterSearch* search, vplLightClusters* clusters);

#endif
