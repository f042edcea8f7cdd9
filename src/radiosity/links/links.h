// SPDX-License-Identifier: MIT
// The hierarchy: a tree of groups of sides, and links between any two of its nodes.
#ifndef VPL_RADIOSITY_LINKS_H
#define VPL_RADIOSITY_LINKS_H

#include "base/arena.h"
#include "radiosity/radiosity_kernels.h"

// ---- the tree (link_tree.c)

// A side, or a group of sides with similar normals.
typedef struct vplLinkNode {
    int children;     // the first of two, which follow each other and come after their parent; -1: a side
    int first, count; // in vplLinkTree.order
    bool flat;        // all sides are in one plane, so none sees another
    bool group;       // one side of a group of triangles
    float lit;        // particle hits over those that the mean of all sides predicts
    bool dim;         // `lit` is very low here or in its parent (link_tree.c)
    float area;
    float brightness;           // expected radiosity over the expected mean of all sides; at least 1
    vplVec3 low, high, centre;  // bounds, metres, and their centre
    float radius;               // of the sphere around `centre`
    vplVec3 middle;             // the centroid of the open cells
    vplVec3 least, most;        // bounds of the middles of its sides, from `middle` in radii
    vplVec3 normal;             // unit: the mean weighted by area, or any if that is 0
    float cosSpread, sinSpread; // of the largest angle between `normal` and a triangle's normal
    float cosTurn;              // of that between `normal` and a side's, which is the mean over a group
} vplLinkNode;

// One direction of a link. The receiver's irradiance at its middle is the sum of factor times the mean of the
// sender's radiosity, plus senderSlope times its first moment; it rises by receiverSlope times the mean per
// radius of the receiver.
typedef struct vplLinkEnd {
    int32_t sender;
    float factor, receiverSlope[3], senderSlope[3];
} vplLinkEnd;

struct vplLinkTree {
    vplLinkNode* nodes; // the root first, parents before children
    int nodeCount;
    int* order;       // sides, sorted so that those of each node are consecutive
    double* areaUpTo; // the summed area of the sides before each in `order`; one more than sides
    // Links sorted by receiver: a node receives over ends[firstOf[node]] .. ends[firstOf[node + 1] - 1].
    int64_t* firstOf;
    vplLinkEnd* ends;
    float* scale; // per side: form factors are multiplied by the scales of both their sides, see vplRowSums
};

// Fills nodes, order and areaUpTo, and reserves `scale`.
vplResult vplLinkTree_Build(vplArena* arena, const vplPatchSides* sides, struct vplLinkTree* tree);

// ---- finding links (link_refine.c)

// cos cos V / (pi r^2) between points of two nodes, times the larger area, as a linear function: its value at both
// middles, which is the larger form factor, and its slopes per radius of either node.
typedef struct vplLinkFit {
    float mean, p[3], q[3];
} vplLinkFit;

typedef struct vplLink {
    int32_t p, q;
    vplLinkFit fit;
} vplLink;

typedef struct vplLinkList {
    vplLink* links;
    size_t count, capacity;
    int64_t rays;
} vplLinkList;

// Pairs that are judged at a time.
enum { VPL_LINK_BATCH = 1 << 14 };

// The fraction of all progress after which links are found.
#define VPL_LINKS_PROGRESS 0.9

// The caller frees list->links, on failure as well.
vplResult vplFindLinks(const vplPatchSides* sides, const struct vplLinkTree* tree, const vplLinkDef* def,
                       vplLinkList* list);

// ---- points on nodes (link_points.c)

// The input of refinement.
typedef struct vplLinkWork {
    const vplPatchSides* sides;
    const struct vplLinkTree* tree;
    const vplLinkDef* def;
    double allowed;        // error of one link
    double dimRays;        // per m^2 of dim sides: rays that search for light from sides that are not dim
    vplLinkPoints* points; // of each node
    const int* leafAt; // the node of each side, in the tree's order; NULL: sides are not tried by themselves
} vplLinkWork;

// Everything but `points` and `leafAt`.
vplLinkWork vplLinkWork_Make(const vplPatchSides* sides, const struct vplLinkTree* tree,
                             const vplLinkDef* def);

// Draws a node's points on its open cells, stratified by area, and fills work->points[node].
void vplLinkPoints_Draw(const vplLinkWork* work, int node);

// Point i, or its normal, or the origin of its rays.
static inline vplVec3 vplLinkPoint(const float from[3][VPL_LINK_POINTS], int i)
{
    return vplVec(from[0][i], from[1][i], from[2][i]);
}

// The ray from point i of a node to point k of another, which it reaches at 1.
vplRay vplLinkRay(const vplLinkPoints* from, int i, const vplLinkPoints* to, int k);

// Rays between the points of two nodes: each eight use every point of either node once, and any four leave and
// arrive at points of all quarters.
typedef struct vplLinkSight {
    const vplLinkPoints *p, *q;
    const vplLinkTerms* terms;
    unsigned start; // any number; decides which points are joined
    int from, to;   // rays, up to VPL_MOST_LINK_RAYS; `from` is a multiple of VPL_RAY_PACKET
} vplLinkSight;

enum { VPL_MOST_LINK_RAYS = VPL_LINK_POINTS * VPL_LINK_POINTS };

// Sums of terms: of all rays that were cast, and of those that were not blocked, by their ends.
typedef struct vplLinkSeen {
    double open, visible;
    float openP[VPL_LINK_POINTS], visibleP[VPL_LINK_POINTS];
    float openQ[VPL_LINK_POINTS], visibleQ[VPL_LINK_POINTS];
} vplLinkSeen;

// Adds to *seen, and how many rays it cast to *rays.
void vplCastLinkRays(const vplLinkWork* work, const vplLinkSight* sight, vplLinkSeen* seen, int* rays);

// Multiplies rows and columns by the visible fractions at their points.
void vplDarkenTerms(const vplLinkSeen* seen, vplLinkTerms* terms);

// ---- one pair of nodes (link_pair.c)

typedef struct vplLinkPair {
    int32_t p, q;
    // Some ray between their parents was not blocked. If form factors vary too much over such a pair, it is
    // divided without further rays.
    bool visible;
    bool clear;      // nothing is between their parents
    int32_t blocker; // a triangle between their parents, usually between them as well; -1: none is known
    float weight;    // the fraction of all work, for the progress; halved by each division
} vplLinkPair;

typedef enum vplLinkVerdict {
    VPL_LINK_NONE = 0, // nothing is exchanged
    VPL_LINK_KEEP,
    VPL_LINK_DIVIDE_P,
    VPL_LINK_DIVIDE_Q
} vplLinkVerdict;

typedef struct vplLinkAnswer {
    vplLinkVerdict verdict;
    bool visible, clear;
    int32_t blocker;
    vplLinkFit fit; // if kept
    int rays;
} vplLinkAnswer;

// Decides about a pair of two different nodes.
vplLinkAnswer vplJudgePair(const vplLinkWork* work, const vplLinkPair* pair);

// ---- light over links (link_gather.c)

// Values of nodes that vplLinks_Gather computes.
typedef struct vplLinkScratch {
    // At the middle, and the rise per radius along each axis. [0, x, y, z][channel]
    double (*received)[4][3];
    // The mean over the area, and the means of radiosity times the place, from the middle in radii, along each
    // axis. The last channel is 0, so that four floats are loaded at once. [0, x, y, z][channel]
    float (*sent)[4][4];
} vplLinkScratch;

// NULL arrays when out of memory; vplArena_Check reports it.
vplLinkScratch vplLinkScratch_Alloc(vplArena* arena, const vplLinks* links);

// sums = F x.
vplResult vplLinks_Gather(const vplLinks* links, const vplPlanes* x, const vplLinkScratch* scratch,
                          double (*sums)[3]);

// ---- how many there will be (link_count.c)

// Estimates the bytes that vplLinks_Create will hold, and needs besides while it works, by judging a few
// hundred pairs of each level of the tree.
vplResult vplLinks_EstimateBytes(const vplPatchSides* sides, const vplLinkDef* def, double* heldOut,
                                 double* scratchOut);

// ---- sums of rows (link_rows.c)

// Finds the sums of rows, and the scale of each side that corrects them as def->rowSums says.
vplResult vplLinks_FitRows(vplLinks* links, const vplPatchSides* sides, const vplLinkDef* def,
                           float* rowSumsOut);

#endif
