// SPDX-License-Identifier: MIT
// The hierarchy from the inside: a tree of groups of sides, and links between any two of its nodes.
#ifndef VPL_RADIOSITY_LINKS_H
#define VPL_RADIOSITY_LINKS_H

#include "radiosity/solve.h"

// A side, or a group of sides that look about the same way.
typedef struct vplLinkNode {
    int children;     // the first of two, which follow each other and their parent; -1: a side
    int first, count; // in vplLinkTree.order
    bool flat;        // its sides are in one plane: none sees another
    float area;
    float glow; // the radiosity that it may be expected to have, as a share of the mean of all; at least 1
    vplVec3 low, high, centre;  // the box around it, metres, and its middle
    float radius;               // from there to the farthest corner
    vplVec3 normal;             // unit: the mean over its area; any where that is 0
    float cosSpread, sinSpread; // of the largest angle between it and a side's normal
} vplLinkNode;

// Points by which pairs are judged: 16 pairs, one block of lanes.
enum { VPL_JUDGE_POINTS = 4 };

typedef struct vplNodePoints {
    vplVec3 at[VPL_JUDGE_POINTS];
    int side[VPL_JUDGE_POINTS];
} vplNodePoints;

struct vplLinkTree {
    vplLinkNode* nodes; // the root first; parents before children
    int nodeCount;
    int* order; // of the sides, such that those of each node follow each other
    vplNodePoints*
        points;       // of each node, while links are found; drawn for each pair they took 0.35 of all time
    double* areaUpTo; // of the sides before each in that order; one more than sides
    // What each node receives, links sorted by receiver: irradiance = the sum of factor times the sender's radiosity.
    int64_t* firstOf; // of each node; one more than nodes
    int32_t* senders;
    float* factors;
    float* scale; // per side, in both directions: see vplRowSums
};

// Nodes, order and areas.
vplResult vplLinkTree_Build(const vplPatchSides* sides, struct vplLinkTree* tree);

// ---- refinement (links_refine.c)

typedef struct vplLink {
    int32_t p, q;
    float kernel; // mean of cos cos V / (pi r^2), 1/m^2: times the sender's area it is the form factor
} vplLink;

// Of all progress, when all are found.
#define VPL_LINKS_SHARE 0.9

typedef struct vplLinkList {
    vplLink* links;
    size_t count, capacity;
    int64_t rays;
} vplLinkList;

// The caller frees links, on failure as well.
vplResult vplFindLinks(const vplPatchSides* sides, struct vplLinkTree* tree, const vplLinkDef* def,
                       vplLinkList* list);

// ---- one pair of nodes (links_pair.c)

enum { VPL_LINK_POINTS = 32 }; // most on either of two nodes

typedef struct vplLinkPair {
    int32_t p, q;
    bool
        seen; // rays between their parents met nothing: where these are divided for their shape alone, none are cast
    float weight; // of all the work: halved with each division
} vplLinkPair;

typedef enum vplLinkVerdict {
    VPL_LINK_NONE = 0, // nothing is exchanged
    VPL_LINK_KEEP,
    VPL_LINK_DIVIDE_P,
    VPL_LINK_DIVIDE_Q
} vplLinkVerdict;

typedef struct vplLinkAnswer {
    vplLinkVerdict verdict;
    bool seen;
    float kernel; // of VPL_LINK_KEEP
    int rays;
} vplLinkAnswer;

// Of two different nodes.
vplLinkAnswer vplJudgePair(const vplPatchSides* sides, const struct vplLinkTree* tree, const vplLinkDef* def,
                           const vplLinkPair* pair);

// Sixteen pairs of points, x on one surface and y on another: cos cos / (pi r^2) of each, 0 where one lies behind the
// other.
typedef struct vplPointPairs {
    float x[3][VPL_SIDE_LANES], nx[3][VPL_SIDE_LANES]; // [axis]
    float y[3][VPL_SIDE_LANES], ny[3][VPL_SIDE_LANES];
} vplPointPairs;

typedef void vplPairKernelFcn(const vplPointPairs* pairs, float kernelOut[VPL_SIDE_LANES]);

// ---- transport (links_gather.c)

// Doubles that vplLinks_Gather needs.
size_t vplLinks_ScratchSize(const vplLinks* links);

// sums = F x.
void vplLinks_Gather(const vplLinks* links, const vplPlanes* x, double* scratch, double (*sums)[3]);

// Sorts the list into the tree by receiver.
vplResult vplLinkTree_Connect(vplContext* context, struct vplLinkTree* tree, const vplLinkList* list);

// Whether nothing that a side sends can miss the other sides, as far as some rays tell. Adds how many it cast.
vplResult vplFindClosed(const vplPatchSides* sides, const vplLinkDef* def, bool* closed, int64_t* rays);

// Finds the scale of each side that makes sums of rows what they are to be, and the sums before. `closed`: which
// are to have 1, others only not more.
vplResult vplLinks_FitRows(vplLinks* links, vplRowSums rows, const bool* closed, float* rowSums);

#endif
