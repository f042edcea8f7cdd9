// SPDX-License-Identifier: MIT
// Points on groups of sides, the terms between all pairs of them, and rays between them.
#include "base/rng.h"
#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "radiosity/links/links.h"
#include "radiosity/sides/side.h"
#include "visibility/hemi_map.h"

enum { STREAM = 0x4c00 }; // of random numbers; one per point

// ---- points

// The position in the tree's order of the side at which the summed area passes `target`.
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

void vplSampleNode(const vplLinkWork* work, int node, int other, int count, vplLinkPoint* out)
{
    const struct vplLinkTree* tree = work->tree;
    const vplLinkNode* n = &tree->nodes[node];
    const double from = tree->areaUpTo[n->first], to = tree->areaUpTo[n->first + n->count];
    const uint64_t index = (uint64_t)(uint32_t)node << 32 | (uint32_t)other;
    for (int k = 0; k < count; k++) {
        const vplRandom4 random = vplRandomAt(work->def->seed, STREAM + (uint32_t)k, index);
        const double target = from + (to - from) * ((k + (double)vplUnitFloat(random.v[0])) / count);
        const int place = findSide(tree, n, target);
        const vplPatchSide* side = &work->sides->sides[tree->order[place]];
        // Beside a large sum, the summed areas of tiny sides may differ by more than the area, or not at all.
        const double into = fmin((target - tree->areaUpTo[place]) / (double)side->area, 1);
        const int cells = __builtin_popcount(side->open);
        const int cell = (int)(into * cells);
        out[k].side = tree->order[place];
        out[k].point = vplPatchSide_SampleCell(work->sides, side,
                                               vplPatchSide_OpenCell(side, cell < cells ? cell : cells - 1),
                                               vplUnitFloat(random.v[1]), vplUnitFloat(random.v[2]));
    }
}

// ---- pairs

void vplFindLinkTerms(const vplLinkWork* work, const vplLinkPoint* p, const vplLinkPoint* q,
                      vplLinkTerms* out)
{
    const vplRadiosityKernels* kernels = vplGetRadiosityKernels(work->sides->context->isa);
    const int n = out->count;
    for (int first = 0; first < n * n; first += VPL_SIDE_LANES) {
        vplPointPairs pairs;
        float terms[VPL_SIDE_LANES];
        for (int l = 0; l < VPL_SIDE_LANES; l++) {
            const int at = first + l < n * n ? first + l : n * n - 1, i = at / n, k = at % n;
            vplSetLane(pairs.x, l, p[i].point.at);
            vplSetLane(pairs.nx, l, p[i].point.normal);
            vplSetLane(pairs.y, l, q[k].point.at);
            vplSetLane(pairs.ny, l, q[k].point.normal);
        }
        kernels->pairTerms(&pairs, terms);
        for (int l = 0; l < VPL_SIDE_LANES && first + l < n * n; l++) {
            out->of[(first + l) / n][(first + l) % n] = terms[l];
        }
    }
}

// ---- rays

double vplVisibleFraction(const vplLinkWork* work, const vplLinkPoint* p, const vplLinkPoint* q,
                          const vplLinkTerms* terms, int* rays)
{
    const vplPatchSides* sides = work->sides;
    const int n = terms->count, samples = work->def->samples;
    double open = 0, visible = 0;
    for (int first = 0; first < samples; first += VPL_RAY_PACKET) {
        vplRayPacket packet;
        float amount[VPL_RAY_PACKET];
        packet.active = 0;
        for (int l = 0; l < VPL_RAY_PACKET; l++) {
            const int i = (first + l) % n, k = (i + (first + l) / n) % n;
            amount[l] = first + l < samples ? terms->of[i][k] : 0;
            open += (double)amount[l];
            if (amount[l] > 0) {
                const vplVec3 way = vplWayToLight(q[k].point.at, q[k].point.normal, p[i].point.at);
                const vplRay ray = vplPatchSides_Leave(sides, &p[i].point, way);
                vplRayPacket_Set(&packet, l, &ray);
            }
        }
        *rays += vplGeometry_Darken(sides->patches->geometry, &packet, 1, amount);
        for (int l = 0; l < VPL_RAY_PACKET; l++) {
            visible += (double)amount[l];
        }
    }
    return open > 0 ? visible / open : 0;
}
