// SPDX-License-Identifier: MIT
// K-means over virtual lights: shared by the choice of the first clusters and the search.
#ifndef VPL_LIGHTS_CLUSTERS_H
#define VPL_LIGHTS_CLUSTERS_H

#include <vpl/lights.h>

// A light, or a place that it is compared with, in double.
typedef struct vplClusterPoint {
    double p[3]; // metres
    double n[3]; // unit
} vplClusterPoint;

static inline vplClusterPoint vplClusterPoint_Make(vplVec3 position, vplVec3 normal)
{
    return (vplClusterPoint){{(double)position.x, (double)position.y, (double)position.z},
                             {(double)normal.x, (double)normal.y, (double)normal.z}};
}

typedef struct vplClusterDistance {
    vplClusterMetric metric;
    double w1, w2;
} vplClusterDistance;

// At least 0. If the distance is `best` or more, any number from `best` on may be returned.
double vplClusterDistance_Below(const vplClusterDistance* distance, const vplClusterPoint* a,
                                const vplClusterPoint* b, double best);

// Sums over the lights of a cluster.
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
    // Per light.
    vplClusterPoint* points;
    const float* weights; // NULL: 1
    double* distances;    // from its cluster
    int* of;              // its cluster; 0 before the search
    // Per cluster.
    vplClusterPoint* centres;
    vplClusterTally* tallies;
    bool* moved; // since the last assignment
    int* movedList;
    int movedCount;
    uint64_t* hashes; // of all assignments so far
    int taskCount;
    bool* changed; // per task: whether a light changed its cluster
    bool first;    // the first assignment
} vplClusterSearch;

static inline double vplClusterSearch_Weight(const vplClusterSearch* search, int light)
{
    return search->weights != NULL ? (double)search->weights[light] : 1;
}

// Places clusters where def->last has clusters with lights, or at the lights def->seeds, then at lights that
// are far from all those before.
vplResult vplClusterSearch_Place(vplClusterSearch* search, const vplClusterDef* def);

// Searches from there. Writes of, centres, the sums and counts of tallies, and iterations and end of
// `clusters`.
vplResult vplClusterSearch_Run(vplClusterSearch* search, vplLightClusters* clusters);

#endif
