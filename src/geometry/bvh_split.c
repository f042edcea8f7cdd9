// SPDX-License-Identifier: MIT
// Based on: Ingo Wald, On Fast Construction of SAH-Based Bounding Volume Hierarchies, RT 2007: ranges of
// triangles are split where the surface area heuristic, sampled at bins of centroids, is least.
#include "geometry/bvh_build.h"

enum { BINS = 16, FEWER_BINS = 8, FEW_ITEMS = 16, HALVING_DEPTH = VPL_BVH_DEPTH - 32 };

typedef struct Split {
    float cost;
    int axis, bin; // bins up to this one go left
} Split;

// Which bin an item falls into, on all axes.
typedef struct Binning {
    vplFour from, scale; // scale 0: all are in one place
    int count;
} Binning;

typedef struct Bins {
    vplBuildBox boxes[3][BINS];
    int counts[3][BINS];
} Bins;

vplBuildRange vplMakeRange(const vplBuilder* b, int first, int count)
{
    vplBuildRange range = {vplNoBox(), vplNoBox(), first, count};
    for (int i = first; i < first + count; i++) {
        const vplFour centre = vplCentre(&b->items[i]);
        range.box = vplJoinBoxes(range.box, b->items[i]);
        range.centres = vplJoinBoxes(range.centres, (vplBuildBox){centre, centre});
    }
    return range;
}

static Binning makeBinning(const vplBuildRange* range)
{
    Binning b = {.count = range->count <= FEW_ITEMS ? FEWER_BINS : BINS};
    b.from = range->centres.low;
    for (int axis = 0; axis < 3; axis++) {
        const float size = range->centres.high[axis] - range->centres.low[axis];
        b.scale[axis] = size > 0x1p-100f && size < INFINITY ? (float)b.count / size : 0;
    }
    return b;
}

// The same on one axis.
static inline int binOf(const Binning* b, const vplBuildBox* item, int axis)
{
    const float low = item->low[axis], high = item->high[axis];
    const float bin = (0.5f * low + 0.5f * high - b->from[axis]) * b->scale[axis];
    return (int)bin < b->count - 1 ? (int)bin : b->count - 1;
}

static inline vplFourInts binsOf(const Binning* b, const vplBuildBox* item)
{
    const vplFour last = vplFour_Of((float)(b->count - 1)), none = {0, 0, 0, 0};
    const vplFour bins = (vplCentre(item) - b->from) * b->scale;
    return __builtin_convertvector(vplFour_Max(vplFour_Min(bins, last), none), vplFourInts);
}

static void fillBins(const vplBuilder* b, const vplBuildRange* range, const Binning* binning, Bins* bins)
{
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < binning->count; i++) {
            bins->boxes[axis][i] = vplNoBox();
            bins->counts[axis][i] = 0;
        }
    }
    for (int i = range->first; i < range->first + range->count; i++) {
        const vplBuildBox item = b->items[i];
        const vplFourInts at = binsOf(binning, &item);
        for (int axis = 0; axis < 3; axis++) {
            vplBuildBox* box = &bins->boxes[axis][at[axis]];
            *box = vplJoinBoxes(*box, item);
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
    vplBuildBox right = vplNoBox(), left = vplNoBox();
    for (int i = count - 1, items = 0; i > 0; i--) {
        right = vplJoinBoxes(right, boxes[i]);
        items += counts[i];
        rightCost[i] = items ? vplHalfSurface(b, &right) * (float)items : INFINITY;
    }
    for (int i = 0, items = 0; i < count - 1; i++) {
        left = vplJoinBoxes(left, boxes[i]);
        items += counts[i];
        const float cost = items ? vplHalfSurface(b, &left) * (float)items + rightCost[i + 1] : INFINITY;
        if (cost < best->cost) {
            *best = (Split){cost, axis, i};
        }
    }
}

// Moves the items that go left to the front and returns how many they are. Without a branch that would be
// mispredicted half of the time.
static int partition(const vplBuilder* b, const vplBuildRange* range, const Binning* binning,
                     const Split* split)
{
    int left = range->first;
    for (int i = range->first; i < range->first + range->count; i++) {
        const vplBuildBox item = b->items[i];
        const int32_t id = b->ids[i];
        b->items[i] = b->items[left];
        b->ids[i] = b->ids[left];
        b->items[left] = item;
        b->ids[left] = id;
        left += binOf(binning, &item, split->axis) <= split->bin;
    }
    return left - range->first;
}

void vplCutRange(const vplBuilder* b, vplBuildRange* range, vplBuildRange* otherOut, int depth)
{
    Split split = {INFINITY, 0, 0};
    int left = range->count / 2;
    if (depth < HALVING_DEPTH) {
        const Binning binning = makeBinning(range);
        Bins bins;
        fillBins(b, range, &binning, &bins);
        for (int axis = 0; axis < 3; axis++) {
            splitAlong(b, &bins, binning.count, axis, &split);
        }
        const int parted = split.cost < INFINITY ? partition(b, range, &binning, &split) : 0;
        left = parted > 0 && parted < range->count ? parted : left; // boxes beyond all floats have no centre
    }
    *otherOut = vplMakeRange(b, range->first + left, range->count - left);
    *range = vplMakeRange(b, range->first, left);
}
