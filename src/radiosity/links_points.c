// SPDX-License-Identifier: MIT
// Points on groups of sides, all pairs of them, and rays between them.
#include "radiosity/links_points.h"

#include "base/context.h"
#include "base/isa.h"
#include "base/rng.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/vec.h"
#include "visibility/hemi_map.h"

#include <string.h>

enum { STREAM = 0x4c00 }; // of random numbers: one per point

VPL_KERNEL_TABLE(pairKernels, vplPairKernelFcn, vplPairKernel);

// ---- points

// The place in the tree's order whose side holds the area `target` of all before.
static int findSide(const struct vplLinkTree* tree, const vplLinkNode* node, double target)
{
    int low = node->first, high = node->first + node->count - 1;
    while (low < high) {
        const int middle = low + (high - low) / 2;
        if (tree->areaUpTo[middle + 1] > target) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

void vplSampleNode(const vplPatchSides* sides, const struct vplLinkTree* tree, uint64_t seed, int node,
                   int other, int count, vplLinkPoints* out)
{
    const vplLinkNode* n = &tree->nodes[node];
    const double from = tree->areaUpTo[n->first], to = tree->areaUpTo[n->first + n->count];
    const uint64_t index = (uint64_t)(uint32_t)node << 32 | (uint32_t)other;
    out->count = count;
    for (int k = 0; k < count; k++) {
        const vplRandom4 random = vplRandomAt(seed, STREAM + (uint32_t)k, index);
        const double target = from + (to - from) * ((k + (double)vplUnitFloat(random.v[0])) / count);
        const int place = findSide(tree, n, target);
        const vplPatchSide* side = &sides->sides[tree->order[place]];
        const double into = (target - tree->areaUpTo[place]) / (double)side->area;
        const int cells = __builtin_popcount(side->open);
        const int cell = (int)(into * cells);
        out->side[k] = tree->order[place];
        out->at[k] =
            vplPatchSide_SampleCell(side, vplPatchSide_OpenCell(side, cell < cells ? cell : cells - 1),
                                    vplUnitFloat(random.v[1]), vplUnitFloat(random.v[2]));
    }
}

// ---- pairs

static void setLane(float to[3][VPL_SIDE_LANES], int lane, vplVec3 v)
{
    to[0][lane] = v.x;
    to[1][lane] = v.y;
    to[2][lane] = v.z;
}

void vplPairPoints(const vplPatchSides* sides, const vplLinkPoints* p, const vplLinkPoints* q,
                   vplLinkKernel* out)
{
    vplPairKernelFcn* find = pairKernels[sides->context->isa];
    const int n = p->count;
    out->count = n;
    for (int first = 0; first < n * n; first += VPL_SIDE_LANES) {
        vplPointPairs pairs;
        float kernel[VPL_SIDE_LANES];
        for (int l = 0; l < VPL_SIDE_LANES; l++) {
            const int at = first + l < n * n ? first + l : n * n - 1, i = at / n, k = at % n;
            setLane(pairs.x, l, p->at[i]);
            setLane(pairs.nx, l, sides->sides[p->side[i]].normal);
            setLane(pairs.y, l, q->at[k]);
            setLane(pairs.ny, l, sides->sides[q->side[k]].normal);
        }
        find(&pairs, kernel);
        for (int l = 0; l < VPL_SIDE_LANES && first + l < n * n; l++) {
            out->of[(first + l) / n][(first + l) % n] = kernel[l];
        }
    }
}

// ---- rays

double vplSeeShare(const vplPatchSides* sides, const vplLinkPoints* p, const vplLinkPoints* q,
                   const vplLinkKernel* kernel, int samples, int* rays)
{
    const vplGeometry* g = sides->patches->geometry;
    const int n = kernel->count;
    double open = 0, seen = 0;
    for (int first = 0; first < samples; first += VPL_RAY_PACKET) {
        vplRayPacket packet;
        float amount[VPL_RAY_PACKET];
        packet.active = 0;
        for (int l = 0; l < VPL_RAY_PACKET; l++) {
            const int i = (first + l) % n, k = (i + (first + l) / n) % n;
            amount[l] = first + l < samples ? kernel->of[i][k] : 0;
            open += (double)amount[l];
            if (amount[l] > 0) {
                const vplHit start = vplPatchSide_HitAt(sides, &sides->sides[p->side[i]], p->at[i]);
                const vplRay ray = vplGeometry_Leave(
                    g, &start, vplWayToLight(q->at[k], sides->sides[q->side[k]].normal, p->at[i]));
                vplRayPacket_Set(&packet, l, &ray);
            }
        }
        *rays += vplGeometry_Darken(g, &packet, 1, amount);
        for (int l = 0; l < VPL_RAY_PACKET; l++) {
            seen += (double)amount[l];
        }
    }
    return open > 0 ? seen / open : 0;
}
