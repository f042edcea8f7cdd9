// SPDX-License-Identifier: MIT
// Choices from an emitter tree for sixteen points side by side.
#include "geometry/emitter_nodes.h"
#include "math/vec.h"
#include "shading/shading.h"

// The halves of each point's node, and the share of the left one. Points that have ended compare a node with itself.
typedef struct Halves {
    int32_t left[VPL_LANES], right[VPL_LANES]; // nodes
    double share[VPL_LANES];
} Halves;

static inline __attribute__((always_inline)) void
findShares(const vplEmitterTree* t, const vplSurface* restrict s, bool cones, Halves* restrict h)
{
    for (int l = 0; l < VPL_LANES; l++) {
        h->share[l] =
            vplEmitterTree_LeftShare(t, h->left[l], h->right[l], vplVec(s->px[l], s->py[l], s->pz[l]),
                                     vplVec(s->nx[l], s->ny[l], s->nz[l]), cones, false);
    }
}

// Finds the halves of all nodes. Returns whether any point goes on.
static bool findHalves(const vplEmitterTree* t, const vplDescent d[VPL_LANES], Halves* h)
{
    int all = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const int left = d[l].ended ? 0 : t->nodes[d[l].node].left;
        h->left[l] = d[l].node + (left > 0);
        h->right[l] = d[l].node + 2 * left;
        all |= left;
    }
    return all > 0;
}

void VPL_KERNEL(vplChooseSources)(const vplEmitterTree* t, const vplSurface* s, const int32_t* covered,
                                  const double* choice, vplChosenSource* out)
{
    vplDescent d[VPL_LANES];
    Halves h;
    for (int l = 0; l < VPL_LANES; l++) {
        d[l] = vplDescent_Start(choice[l]);
        d[l].ended = !covered[l];
    }
    while (findHalves(t, d, &h)) {
        if (t->cones) {
            findShares(t, s, true, &h);
        } else {
            findShares(t, s, false, &h);
        }
        for (int l = 0; l < VPL_LANES; l++) {
            if (h.right[l] > h.left[l]) {
                d[l] = vplDescent_Step(d[l], (h.right[l] - d[l].node) / 2, h.share[l]);
            }
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        out[l] = (vplChosenSource){d[l].ended ? -1 : t->sources[d[l].first], d[l].probability, d[l].rest};
    }
}
