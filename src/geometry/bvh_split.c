// SPDX-License-Identifier: MIT
// Based on: Ingo Wald, On Fast Construction of SAH-Based Bounding Volume Hierarchies, RT 2007: ranges of
// triangles are split where the surface area heuristic, sampled at bins of centroids, is least.
#include "geometry/bvh_build.h"

#include <math.h>

enum { BINS = 16, FEWER_BINS = 8, FEW_ITEMS = 8, HALVING_DEPTH = VPL_BVH_DEPTH - 32 };

const vplBuildBox vplNoBox = {{INFINITY, INFINITY, INFINITY, INFINITY},
                              {-INFINITY, -INFINITY, -INFINITY, -INFINITY}};

typedef struct Split {
    float cost;
    int axis, bin; // bins up to this one go left
} Split;

// Which bin an item falls into, on all axes.
typedef struct Binning {
    float from[4], scale[4]; // scale 0: all are in one place
    int count;
} Binning;

typedef struct Bins {
    vplBuildBox boxes[3][BINS];
    int counts[3][BINS];
} Bins;

static Binning makeBinning(const vplBuildRange* range)
{
    Binning b = {.count = range->count <= FEW_ITEMS ? FEWER_BINS : BINS};
    for (int axis = 0; axis < 3; axis++) {
        const float size = range->centres.high[axis] - range->centres.low[axis];
        b.from[axis] = range->centres.low[axis];
        b.scale[axis] = size > 0x1p-100f && size < INFINITY ? (float)b.count / size : 0;
    }
    return b;
}

static inline void binsOf(const Binning* b, const vplBuildBox* item, int32_t bins[4])
{
    for (int i = 0; i < 4; i++) {
        const float centre = 0.5f * item->low[i] + 0.5f * item->high[i];
        bins[i] = (int32_t)((centre - b->from[i]) * b->scale[i]);
    }
    for (int i = 0; i < 4; i++) {
        bins[i] = bins[i] < b->count - 1 ? bins[i] : b->count - 1;
    }
}

static void fillBins(const vplBuilder* b, const vplBuildRange* range, const Binning* binning, Bins* bins)
{
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < binning->count; i++) {
            bins->boxes[axis][i] = vplNoBox;
            bins->counts[axis][i] = 0;
        }
    }
    for (int i = range->first; i < range->first + range->count; i++) {
        const vplBuildBox item = b->items[i];
        int32_t at[4];
        binsOf(binning, &item, at);
        for (int axis = 0; axis < 3; axis++) {
            vplGrowBox(&bins->boxes[axis][at[axis]], &item);
            bins->counts[axis][at[axis]]++;
        }
    }
}

// The cheapest plane between bins along one axis, if it is cheaper than `best`.
static void splitAlong(const vplBuilder* b, const Bins* bins, int count, int axis, Split* best)
{
    const vplBuildBox* boxes = bins->boxes[axis];
    const int* counts = bins->counts[axis];
    float rightCost[BINS];
    vplBuildBox right = vplNoBox, left = vplNoBox;
    for (int i = count - 1, items = 0; i > 0; i--) {
        vplGrowBox(&right, &boxes[i]);
        items += counts[i];
        rightCost[i] = items ? vplHalfSurface(b, right.low, right.high) * (float)items : INFINITY;
    }
    for (int i = 0, items = 0; i < count - 1; i++) {
        vplGrowBox(&left, &boxes[i]);
        items += counts[i];
        const float cost =
            items ? vplHalfSurface(b, left.low, left.high) * (float)items + rightCost[i + 1] : INFINITY;
        if (cost < best->cost) {
            *best = (Split){cost, axis, i};
        }
    }
}

static void swapItems(const vplBuilder* b, int i, int k)
{
    const vplBuildBox box = b->items[i];
    const int32_t id = b->ids[i];
    b->items[i] = b->items[k];
    b->ids[i] = b->ids[k];
    b->items[k] = box;
    b->ids[k] = id;
}

static vplBuildRange emptyRange(int first)
{
    return (vplBuildRange){vplNoBox, vplNoBox, first, 0};
}

void vplCutRange(const vplBuilder* b, vplBuildRange* range, vplBuildRange* otherOut, int depth)
{
    const int first = range->first, end = first + range->count;
    const Binning binning = makeBinning(range);
    Split split = {INFINITY, 0, 0};
    if (depth < HALVING_DEPTH) {
        Bins bins;
        fillBins(b, range, &binning, &bins);
        for (int axis = 0; axis < 3; axis++) {
            splitAlong(b, &bins, binning.count, axis, &split);
        }
    }
    vplBuildRange left = emptyRange(first), right = emptyRange(end);
    const bool halves = !(split.cost < INFINITY);
    const int half = first + range->count / 2;
    while (left.first + left.count < right.first) {
        const int i = left.first + left.count;
        int32_t bins[4];
        binsOf(&binning, &b->items[i], bins);
        if (halves ? i < half : bins[split.axis] <= split.bin) {
            vplRange_Add(&left, &b->items[i]);
            left.count++;
        } else {
            right.first--;
            right.count++;
            swapItems(b, i, right.first);
            vplRange_Add(&right, &b->items[right.first]);
        }
    }
    *range = left;
    *otherOut = right;
}
