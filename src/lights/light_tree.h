// SPDX-License-Identifier: MIT
// A binary tree over virtual lights. The node of a cluster bounds the contribution of its lights.
#ifndef VPL_LIGHTS_LIGHT_TREE_H
#define VPL_LIGHTS_LIGHT_TREE_H

#include <vpl/lights.h>

#include "base/arena.h"

// A cluster of two lights or more. The node of its left half follows, that of the right half comes `left`
// nodes later; halves of one light have no node.
typedef struct vplLightNode {
    float low[3], high[3]; // box of the positions, metres
    float axis[3], cosine; // cone that holds all normals; -1: any direction
    float rgb[3];          // of all lights
    float intensity;       // r + g + b
    int left;              // lights in the left half
    int representative;    // index in the tree's lights; also that of one of the halves
} vplLightNode;

typedef struct vplTreeLight {
    vplShadeLight light;
    int index; // in the array that the tree was made from
} vplTreeLight;

typedef struct vplLightTree {
    vplTreeLight* lights; // each cluster's lie together
    vplLightNode* nodes;  // lightCount - 1 of them, the root first; 104 bytes per light with the lights
    int lightCount;
    vplContext* context;
    vplArena* arena; // owns the tree
} vplLightTree;

// A cluster: lights first .. first + count - 1, and its node where there is more than one.
typedef struct vplCluster {
    int node, first, count;
} vplCluster;

static inline vplCluster vplLightTree_Root(const vplLightTree* tree)
{
    return (vplCluster){0, 0, tree->lightCount};
}

// Halves of a cluster of two lights or more.
static inline void vplLightTree_Halves(const vplLightTree* tree, vplCluster c, vplCluster halves[2])
{
    const int left = tree->nodes[c.node].left;
    halves[0] = (vplCluster){c.node + 1, c.first, left};
    halves[1] = (vplCluster){c.node + left, c.first + left, c.count - left};
}

static inline int vplLightTree_Representative(const vplLightTree* tree, vplCluster c)
{
    return c.count > 1 ? tree->nodes[c.node].representative : c.first;
}

// Needs O(n log n) time. The same tree for any number of workers.
vplResult vplLightTree_Create(vplContext* context, const vplShadeLight* lights, int lightCount,
                              vplProgressFcn* progress, void* user, vplLightTree** treeOut);

// NULL is allowed.
void vplLightTree_Destroy(vplLightTree* tree);

#endif
