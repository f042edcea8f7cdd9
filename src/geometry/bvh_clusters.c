// SPDX-License-Identifier: MIT
// Based on: Christian Lauterbach et al., Fast BVH Construction on GPUs, Computer Graphics Forum 2009: triangles are
// sorted along a Morton curve, and ranges of them are split where the highest bit of their codes changes.
#include "geometry/bvh_build.h"
#include "geometry/triangle.h"

enum {
    AXIS_BITS = 7,   // of a code, per axis; triangles of one cell stay in the order of their mesh
    DIGIT_BITS = 11, // sorted in one pass
    DIGITS = 1 << DIGIT_BITS,
    PASSES = (3 * AXIS_BITS + DIGIT_BITS - 1) / DIGIT_BITS
};

// A triangle's place along the curve, and its index among the items.
typedef struct Place {
    uint32_t code;
    int32_t item;
} Place;

typedef struct Clusters {
    const vplBvhBuilder* builder;
    vplFour from, scale; // of centres, to cells of the curve
    Place* places;       // of all items, sorted
    int itemCount;
    vplItemRange* ranges; // of places
    int count;
    vplBox* boxes; // by cluster
    int32_t* ids;  // by place
} Clusters;

// ---- order along the curve

// Moves the ten lowest bits apart: two zeros follow each.
static uint32_t spreadBits(uint32_t x)
{
    x = (x | x << 16) & 0x030000FFu;
    x = (x | x << 8) & 0x0300F00Fu;
    x = (x | x << 4) & 0x030C30C3u;
    return (x | x << 2) & 0x09249249u;
}

static void findCodes(void* data, int chunk, int worker)
{
    (void)worker;
    const Clusters* c = data;
    const vplFour last = vplFour_Of((float)((1 << AXIS_BITS) - 1)), none = vplFour_Of(0);
    const int first = chunk * VPL_TRIANGLE_CHUNK,
              end = vplEndOfChunk(c->itemCount, first, VPL_TRIANGLE_CHUNK);
    for (int i = first; i < end; i++) {
        const vplFour cell = (vplCentreOf(&c->builder->items[i]) - c->from) * c->scale;
        const vplFourInts at =
            __builtin_convertvector(vplFour_Max(vplFour_Min(cell, last), none), vplFourInts);
        const uint32_t code =
            spreadBits((uint32_t)at[0]) | spreadBits((uint32_t)at[1]) << 1 | spreadBits((uint32_t)at[2]) << 2;
        c->places[i] = (Place){code, i};
    }
}

// One pass of a radix sort.
static void sortByDigit(const Place* from, Place* to, int count, int shift)
{
    int starts[DIGITS] = {0};
    for (int i = 0; i < count; i++) {
        starts[from[i].code >> shift & (DIGITS - 1)]++;
    }
    for (int digit = 0, sum = 0; digit < DIGITS; digit++) {
        const int items = starts[digit];
        starts[digit] = sum;
        sum += items;
    }
    for (int i = 0; i < count; i++) {
        to[starts[from[i].code >> shift & (DIGITS - 1)]++] = from[i];
    }
}

static vplResult sortAlongCurve(Clusters* c, const vplBuildRange* all)
{
    const vplBvhBuilder* b = c->builder;
    Place* other = vplArena_Alloc(b->scratch, (size_t)all->count, sizeof *other);
    c->places = vplArena_Alloc(b->scratch, (size_t)all->count, sizeof *c->places);
    TRY(vplArena_Check(b->scratch));
    c->from = all->centres.low;
    c->scale = vplScaleCentres(&all->centres, 1 << AXIS_BITS);
    TRY(vplParallelForAsking(b->geometry->context, vplCountChunks(all->count, VPL_TRIANGLE_CHUNK), findCodes,
                             c));
    for (int pass = 0; pass < PASSES; pass++) {
        sortByDigit(c->places, other, all->count, pass * DIGIT_BITS);
        Place* swap = c->places;
        c->places = other;
        other = swap;
    }
    return VPL_SUCCESS;
}

// ---- clusters

// The first of the places whose codes have the highest bit in which the first and the last code differ; the middle if these are equal.
static int findSplit(const Place* places, int first, int count)
{
    const uint32_t differ = places[first].code ^ places[first + count - 1].code;
    if (differ == 0) {
        return first + count / 2;
    }
    const uint32_t bit = 1u << (31 - __builtin_clz(differ));
    int low = first, high = first + count - 1; // without and with the bit
    while (high - low > 1) {
        const int middle = low + (high - low) / 2;
        if (places[middle].code & bit) {
            high = middle;
        } else {
            low = middle;
        }
    }
    return high;
}

static void addClusters(Clusters* c, int first, int count)
{
    if (count <= VPL_BVH_WIDTH) {
        c->ranges[c->count++] = (vplItemRange){first, count};
        return;
    }
    const int split = findSplit(c->places, first, count);
    addClusters(c, first, split - first);
    addClusters(c, split, first + count - split);
}

static void boundClusters(void* data, int chunk, int worker)
{
    (void)worker;
    const Clusters* c = data;
    const vplBvhBuilder* b = c->builder;
    const int first = chunk * VPL_TRIANGLE_CHUNK, end = vplEndOfChunk(c->count, first, VPL_TRIANGLE_CHUNK);
    for (int i = first; i < end; i++) {
        const vplItemRange* range = &c->ranges[i];
        vplBox box = vplBox_Empty();
        float area = 0;
        for (int k = range->first; k < range->first + range->count; k++) {
            const vplBox* item = &b->items[c->places[k].item];
            box = vplBox_Join(box, *item);
            area += item->high[3];
            c->ids[k] = b->ids[c->places[k].item];
        }
        box.high[3] = area;
        c->boxes[i] = box;
    }
}

vplResult vplGroupItems(vplBvhBuilder* b, vplBuildRange* all)
{
    Clusters c = {.builder = b, .itemCount = all->count};
    TRY(sortAlongCurve(&c, all));
    c.ranges = vplArena_Alloc(b->scratch, (size_t)all->count, sizeof *c.ranges);
    c.boxes = vplArena_Alloc(b->scratch, (size_t)all->count, sizeof *c.boxes);
    c.ids = vplArena_Alloc(b->scratch, (size_t)all->count, sizeof *c.ids);
    TRY(vplArena_Check(b->scratch));
    addClusters(&c, 0, all->count);
    TRY(vplParallelForAsking(b->geometry->context, vplCountChunks(c.count, VPL_TRIANGLE_CHUNK), boundClusters,
                             &c));
    for (int i = 0; i < c.count; i++) { // those of the triangles are in c.ids now
        b->ids[i] = i;
    }
    b->items = c.boxes;
    b->clusters = c.ranges;
    b->members = c.ids;
    b->leaf = b->perBlock = 1;
    *all = vplMakeRange(b, 0, c.count);
    return VPL_SUCCESS;
}
