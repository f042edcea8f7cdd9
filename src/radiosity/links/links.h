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
    float area;
    float brightness;           // expected radiosity over the expected mean of all sides; at least 1
    vplVec3 low, high, centre;  // bounds, metres, and their centre
    float radius;               // of the sphere around `centre`
    vplVec3 normal;             // unit: the mean weighted by area, or any if that is 0
    float cosSpread, sinSpread; // of the largest angle between `normal` and a triangle's normal
    float cosTurn;              // of that between `normal` and a side's, which is the mean over a group
} vplLinkNode;

struct vplLinkTree {
    vplLinkNode* nodes; // the root first, parents before children
    int nodeCount;
    int* order;       // sides, sorted so that those of each node are consecutive
    double* areaUpTo; // the summed area of the sides before each in `order`; one more than sides
    // Links sorted by receiver: a node's irradiance is the sum of factor times the sender's radiosity over
    // the links firstOf[node] .. firstOf[node + 1] - 1.
    int64_t* firstOf;
    int32_t* senders;
    float* factors;
    float* scale; // per side: form factors are multiplied by the scales of both their sides, see vplRowSums
};

// Fills nodes, order and areaUpTo, and reserves `scale`.
vplResult vplLinkTree_Build(vplArena* arena, const vplPatchSides* sides, struct vplLinkTree* tree);

// ---- finding links (link_refine.c)

typedef struct vplLink {
    int32_t p, q;
    float mean; // of cos cos V / (pi r^2), 1/m^2; times the sender's area it is the form factor
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

// Each node has four points by which all its pairs are judged: 16 pairs of points, one block of lanes. Drawing
// points again for each pair took 0.35 of the whole time.
enum { VPL_JUDGE_POINTS = 4 };

typedef struct vplLinkPoint {
    vplSidePoint point;
    int side;
} vplLinkPoint;

// The input of refinement.
typedef struct vplLinkWork {
    const vplPatchSides* sides;
    const struct vplLinkTree* tree;
    const vplLinkDef* def;
    vplLinkPoint (*points)[VPL_JUDGE_POINTS]; // of each node
} vplLinkWork;

enum { VPL_LINK_POINTS = 32 }; // the most on either of two nodes

// `count` points on the open cells of a node, stratified by area. The random numbers are those of the pair of
// `node` and `other`; those of a node with itself give vplLinkWork.points.
void vplSampleNode(const vplLinkWork* work, int node, int other, int count, vplLinkPoint* pointsOut);

// The unoccluded terms cos cos / (pi r^2), 1/m^2, between point i of one node and point k of another.
typedef struct vplLinkTerms {
    int count; // points on either
    float of[VPL_LINK_POINTS][VPL_LINK_POINTS];
} vplLinkTerms;

// Fills termsOut->of for termsOut->count points on either node.
void vplFindLinkTerms(const vplLinkWork* work, const vplLinkPoint* p, const vplLinkPoint* q,
                      vplLinkTerms* termsOut);

// The visible fraction of the terms, by rays between def->samples pairs of points: (0, 0), (1, 1), ..., then
// (0, 1), (1, 2), .... Adds how many rays it cast to *rays.
double vplVisibleFraction(const vplLinkWork* work, const vplLinkPoint* p, const vplLinkPoint* q,
                          const vplLinkTerms* terms, int* rays);

// ---- one pair of nodes (link_pair.c)

typedef struct vplLinkPair {
    int32_t p, q;
    // Some ray between their parents was not blocked. If form factors vary too much over such a pair, it is
    // divided without further rays.
    bool visible;
    float weight; // the fraction of all work, for the progress; halved by each division
} vplLinkPair;

typedef enum vplLinkVerdict {
    VPL_LINK_NONE = 0, // nothing is exchanged
    VPL_LINK_KEEP,
    VPL_LINK_DIVIDE_P,
    VPL_LINK_DIVIDE_Q
} vplLinkVerdict;

typedef struct vplLinkAnswer {
    vplLinkVerdict verdict;
    bool visible;
    float mean; // of vplLink, if kept
    int rays;
} vplLinkAnswer;

// Decides about a pair of two different nodes.
vplLinkAnswer vplJudgePair(const vplLinkWork* work, const vplLinkPair* pair);

// ---- light over links (link_gather.c)

// Values of nodes that vplLinks_Gather computes.
typedef struct vplLinkScratch {
    double (*received)[3];
    float (*sent)[4]; // the last is 0, so that four floats are loaded at once
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
