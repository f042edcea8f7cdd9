// SPDX-License-Identifier: MIT
// Points on groups of sides, and what stands between them.
#ifndef VPL_RADIOSITY_LINKS_POINTS_H
#define VPL_RADIOSITY_LINKS_POINTS_H

#include "radiosity/links.h"

typedef struct vplLinkPoints {
    vplVec3 at[VPL_LINK_POINTS];
    const vplPatchSide* side[VPL_LINK_POINTS];
} vplLinkPoints;

// def->samples points on the open cells of a node, one in each of as many parts of equal area. Random numbers are those
// of the pair; `stream` tells draws apart, even for the first of the pair and odd for the second.
void vplSampleNode(const vplPatchSides* sides, const struct vplLinkTree* tree, const vplLinkDef* def,
                   int node, int other, int stream, vplLinkPoints* pointsOut);

// kernelOut[i][k] between point i of p and k of q, with nothing between them.
void vplPairPoints(const vplPatchSides* sides, const vplLinkPoints* p, const vplLinkPoints* q, int count,
                   float kernelOut[VPL_LINK_POINTS][VPL_LINK_POINTS]);

// Sets to 0 what meets something. Returns how many rays were cast.
int vplShadowPairs(const vplPatchSides* sides, const vplLinkPoints* p, const vplLinkPoints* q, int count,
                   float kernel[VPL_LINK_POINTS][VPL_LINK_POINTS]);

#endif
