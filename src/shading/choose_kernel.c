// SPDX-License-Identifier: MIT
// Chooses sources from an emitter tree for sixteen points side by side.
#include "geometry/emitter_nodes.h"
#include "math/vec.h"
#include "shading/shading.h"

// The halves of each point's node, and the probability of the left one. A point that goes no further compares its node with itself.
typedef struct Steps {
    int32_t left[VPL_LANES]; // sources in the left half; 0: the point goes no further
    int32_t leftNode[VPL_LANES], rightNode[VPL_LANES];
    double share[VPL_LANES];
} Steps;

VPL_STEP void findShares(const vplEmitterTree* t, const vplSurface* restrict s, bool cones,
                         Steps* restrict at)
{
    for (int l = 0; l < VPL_LANES; l++) {
        at->share[l] = vplEmitterTree_LeftShare(t, at->leftNode[l], at->rightNode[l],
                                                vplVec(s->px[l], s->py[l], s->pz[l]),
                                                vplVec(s->nx[l], s->ny[l], s->nz[l]), cones, false);
    }
}

// Looks up the halves of each point's node. Returns whether any point goes further.
static bool findHalves(const vplEmitterTree* t, const vplDescent d[VPL_LANES], Steps* at)
{
    int all = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const int left = d[l].ended ? 0 : t->nodes[d[l].node].left;
        at->left[l] = left;
        at->leftNode[l] = d[l].node + (left > 0);
        at->rightNode[l] = d[l].node + 2 * left;
        all |= left;
    }
    return all > 0;
}

void VPL_KERNEL(vplChooseSources)(const vplEmitterTree* t, const vplPoints* points, const double* choice,
                                  vplChosenSource* out)
{
    vplDescent d[VPL_LANES];
    Steps at;
    for (int l = 0; l < VPL_LANES; l++) {
        d[l] = vplDescent_Start(choice[l]);
        d[l].ended = points->triangle[l] < 0;
    }
    while (findHalves(t, d, &at)) {
        if (t->cones) {
            findShares(t, points->surface, true, &at);
        } else {
            findShares(t, points->surface, false, &at);
        }
        for (int l = 0; l < VPL_LANES; l++) {
            if (at.left[l] > 0) {
                d[l] = vplDescent_Step(d[l], at.left[l], at.share[l]);
            }
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        out[l] = (vplChosenSource){d[l].ended ? -1 : t->sources[d[l].first], d[l].probability, d[l].rest};
    }
}
