// SPDX-License-Identifier: MIT
// Points on groups of sides, and what stands between them.
#ifndef VPL_RADIOSITY_LINKS_POINTS_H
#define VPL_RADIOSITY_LINKS_POINTS_H

#include "radiosity/side.h"
#include "radiosity/links.h"

typedef struct vplLinkPoints {
    int count;
    vplVec3 at[VPL_LINK_POINTS];
    int side[VPL_LINK_POINTS];
} vplLinkPoints;

// `count` points on the open cells of a node, one in each of as many parts of equal area. Random numbers are those of
// the pair of both nodes; node with itself: those by which pairs are judged.
void vplSampleNode(const vplPatchSides* sides, const struct vplLinkTree* tree, uint64_t seed, int node,
                   int other, int count, vplLinkPoints* pointsOut);

// cos cos / (pi r^2) between point i of one node and k of another, with nothing between them, 1/m^2.
typedef struct vplLinkKernel {
    int count; // points on either
    float of[VPL_LINK_POINTS][VPL_LINK_POINTS];
} vplLinkKernel;

void vplPairPoints(const vplPatchSides* sides, const vplLinkPoints* p, const vplLinkPoints* q,
                   vplLinkKernel* kernelOut);

// The share of the kernel that rays see, by `samples` pairs of points: (0, 0), (1, 1), ..., then (0, 1), (1, 2), ....
// Adds how many rays it cast.
double vplSeeShare(const vplPatchSides* sides, const vplLinkPoints* p, const vplLinkPoints* q,
                   const vplLinkKernel* kernel, int samples, int* rays);

#endif
