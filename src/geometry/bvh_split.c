// SPDX-License-Identifier: MIT
// Based on: Ingo Wald, On Fast Construction of SAH-Based Bounding Volume Hierarchies, RT 2007: ranges of
// triangles are split where the surface area heuristic, sampled at bins of centroids, is least.
#include "geometry/cut_outs.h"
#include "geometry/bvh_build.h"
#include "geometry/triangle.h"

#include <string.h>

enum { BINS = 16, FEWER_BINS = 8, FEW_ITEMS = 16, HALVING_DEPTH = VPL_BVH_DEPTH - 32 };

vplBuildRange vplMakeRange(const vplBvhBuilder* b, int first, int count)
{
    vplBuildRange range = {vplBox_Empty(), vplBox_Empty(), first, count};
    for (int i = first; i < first + count; i++) {
        const vplFour centre = vplCentreOf(&b->items[i]);
        range.box = vplBox_Join(range.box, b->items[i]);
        range.centres = vplBox_Join(range.centres, (vplBox){centre, centre});
    }
    return range;
}

// ---- items

typedef struct Collection {
    const vplBvhBuilder* builder;
    vplBuildRange* ranges; // by chunk of triangles; items of a chunk begin at the index of its first triangle
} Collection;

vplBox vplBoundCorners(const vplVec3 corners[3])
{
    vplFour corner[3];
    for (int i = 0; i < 3; i++) {
        corner[i] = (vplFour){corners[i].x, corners[i].y, corners[i].z, 0};
    }
    return vplBoundTriangle(corner);
}

vplBox vplBoundItem(const vplGeometry* g, int triangle)
{
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    vplBox box = vplBoundCorners(t.corner);
    box.low[3] = 0;
    box.high[3] = (float)vplTriangle_Area(&t);
    return box;
}

static void collectChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Collection* c = data;
    const vplGeometry* g = c->builder->geometry;
    const int first = chunk * VPL_TRIANGLE_CHUNK,
              end = vplEndOfChunk(g->triangleCount, first, VPL_TRIANGLE_CHUNK);
    int count = 0;
    for (int i = first; i < end; i++) {
        if (vplIsSolid(g, i)) {
            c->builder->items[first + count] = vplBoundItem(g, i);
            c->builder->ids[first + count++] = i;
        }
    }
    c->ranges[chunk] = vplMakeRange(c->builder, first, count);
}

// Moves the items of all chunks together.
static vplBuildRange joinChunks(const Collection* c, int chunks)
{
    const vplBvhBuilder* b = c->builder;
    vplBuildRange all = {vplBox_Empty(), vplBox_Empty(), 0, 0};
    for (int i = 0; i < chunks; i++) {
        const vplBuildRange* part = &c->ranges[i];
        if (part->first != all.count) {
            memmove(b->items + all.count, b->items + part->first, (size_t)part->count * sizeof *b->items);
            memmove(b->ids + all.count, b->ids + part->first, (size_t)part->count * sizeof *b->ids);
        }
        all.box = vplBox_Join(all.box, part->box);
        all.centres = vplBox_Join(all.centres, part->centres);
        all.count += part->count;
    }
    return all;
}

vplResult vplCollectItems(vplBvhBuilder* b, vplBuildRange* allOut)
{
    const size_t triangles = (size_t)b->geometry->triangleCount;
    const int chunks = vplCountChunks(b->geometry->triangleCount, VPL_TRIANGLE_CHUNK);
    b->items = vplArena_Alloc(b->scratch, triangles, sizeof *b->items);
    b->ids = vplArena_Alloc(b->scratch, triangles, sizeof *b->ids);
    Collection c = {b, vplArena_Alloc(b->scratch, (size_t)chunks, sizeof *c.ranges)};
    TRY(vplArena_Check(b->scratch));
    TRY(vplParallelForAsking(b->geometry->context, chunks, collectChunk, &c));
    *allOut = joinChunks(&c, chunks);
    return VPL_SUCCESS;
}

// ---- splits

typedef struct Split {
    float cost;
    int axis, bin; // bins up to this one go left
} Split;

// Maps centres to bins: (centre - from) * scale.
typedef struct Binning {
    vplFour from, scale; // scale 0: all centres are in one place
    int count;
} Binning;

typedef struct Bins {
    vplBox boxes[3][BINS];
    int counts[3][BINS];
} Bins;

static Binning makeBinning(const vplBuildRange* range)
{
    Binning b = {.count = range->count <= FEW_ITEMS ? FEWER_BINS : BINS};
    b.from = range->centres.low;
    b.scale = vplScaleCentres(&range->centres, b.count);
    return b;
}

// The bin of an item along one axis.
static inline int binOf(const Binning* b, const vplBox* item, int axis)
{
    const float low = item->low[axis], high = item->high[axis];
    const float bin = (0.5f * low + 0.5f * high - b->from[axis]) * b->scale[axis];
    return (int)bin < b->count - 1 ? (int)bin : b->count - 1;
}

// The bins of an item along all axes.
static inline vplFourInts binsOf(const Binning* b, const vplBox* item)
{
    const vplFour last = vplFour_Of((float)(b->count - 1)), none = {0, 0, 0, 0};
    const vplFour bins = (vplCentreOf(item) - b->from) * b->scale;
    return __builtin_convertvector(vplFour_Max(vplFour_Min(bins, last), none), vplFourInts);
}

static void fillBins(const vplBvhBuilder* b, const vplBuildRange* range, const Binning* binning, Bins* bins)
{
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < binning->count; i++) {
            bins->boxes[axis][i] = vplBox_Empty();
            bins->counts[axis][i] = 0;
        }
    }
    for (int i = range->first; i < range->first + range->count; i++) {
        const vplBox item = b->items[i];
        const vplFourInts at = binsOf(binning, &item);
        for (int axis = 0; axis < 3; axis++) {
            vplBox* box = &bins->boxes[axis][at[axis]];
            *box = vplBox_Join(*box, item);
            bins->counts[axis][at[axis]]++;
        }
    }
}

// Finds the cheapest plane between bins along one axis, if it is cheaper than `best`.
static void splitAlong(const vplBvhBuilder* b, const Bins* bins, int count, int axis, Split* best)
{
    const vplBox* boxes = bins->boxes[axis];
    const int* counts = bins->counts[axis];
    float rightCost[BINS];
    vplBox right = vplBox_Empty(), left = vplBox_Empty();
    for (int i = count - 1, items = 0; i > 0; i--) {
        right = vplBox_Join(right, boxes[i]);
        items += counts[i];
        rightCost[i] = items ? vplHalfSurface(b, &right) * (float)items : INFINITY;
    }
    for (int i = 0, items = 0; i < count - 1; i++) {
        left = vplBox_Join(left, boxes[i]);
        items += counts[i];
        const float cost = items ? vplHalfSurface(b, &left) * (float)items + rightCost[i + 1] : INFINITY;
        if (cost < best->cost) {
            *best = (Split){cost, axis, i};
        }
    }
}

// Moves the items that go left to the front, and sets all of the halves but their boxes. Has no branch on the side: it
// would be mispredicted half of the time.
static void partition(const vplBvhBuilder* b, const vplBuildRange* range, const Binning* binning,
                      const Split* split, vplBuildRange halves[2])
{
    const vplFour none = vplFour_Of(INFINITY);
    vplBox centres[2] = {vplBox_Empty(), vplBox_Empty()};
    int left = range->first;
    for (int i = range->first; i < range->first + range->count; i++) {
        const vplBox item = b->items[i];
        const int32_t id = b->ids[i];
        b->items[i] = b->items[left];
        b->ids[i] = b->ids[left];
        b->items[left] = item;
        b->ids[left] = id;
        const bool goesLeft = binOf(binning, &item, split->axis) <= split->bin;
        left += goesLeft;
        const vplFourInts isLeft = (vplFourInts){0, 0, 0, 0} - (int32_t)goesLeft;
        const vplFour centre = vplCentreOf(&item);
        const vplBox ofLeft = {vplFour_Choose(isLeft, centre, none), vplFour_Choose(isLeft, centre, -none)};
        const vplBox ofRight = {vplFour_Choose(isLeft, none, centre), vplFour_Choose(isLeft, -none, centre)};
        centres[0] = vplBox_Join(centres[0], ofLeft);
        centres[1] = vplBox_Join(centres[1], ofRight);
    }
    const int count = left - range->first;
    halves[0] = (vplBuildRange){.centres = centres[0], .first = range->first, .count = count};
    halves[1] = (vplBuildRange){.centres = centres[1], .first = left, .count = range->count - count};
}

static vplBox joinBins(const vplBox* boxes, int count)
{
    vplBox all = vplBox_Empty();
    for (int i = 0; i < count; i++) {
        all = vplBox_Join(all, boxes[i]);
    }
    return all;
}

// Splits between bins. False where no plane separates centres, or centres of boxes near FLT_MAX overflow.
static bool splitBetweenBins(const vplBvhBuilder* b, const vplBuildRange* range, vplBuildRange halves[2])
{
    const Binning binning = makeBinning(range);
    Bins bins;
    fillBins(b, range, &binning, &bins);
    Split split = {INFINITY, 0, 0};
    for (int axis = 0; axis < 3; axis++) {
        splitAlong(b, &bins, binning.count, axis, &split);
    }
    if (!(split.cost < INFINITY)) {
        return false;
    }
    partition(b, range, &binning, &split, halves);
    const vplBox* boxes = bins.boxes[split.axis];
    halves[0].box = joinBins(boxes, split.bin + 1);
    halves[1].box = joinBins(boxes + split.bin + 1, binning.count - split.bin - 1);
    return halves[0].count > 0 && halves[1].count > 0;
}

void vplSplitRange(const vplBvhBuilder* b, const vplBuildRange* range, int depth, vplBuildRange halvesOut[2])
{
    const bool tries = range->count > 2 && depth < HALVING_DEPTH; // two are halved at any plane
    if (!tries || !splitBetweenBins(b, range, halvesOut)) {
        const int left = range->count / 2;
        halvesOut[0] = vplMakeRange(b, range->first, left);
        halvesOut[1] = vplMakeRange(b, range->first + left, range->count - left);
    }
}
