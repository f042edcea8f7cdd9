// SPDX-License-Identifier: MIT
// vplTraceAny for packets of sixteen rays.
// Based on: Ingo Wald, Philipp Slusallek, Carsten Benthin and Markus Wagner, Interactive Rendering with
// Coherent Ray Tracing, Eurographics 2001 (packets). Departs: the last few rays of a subtree or block are
// traced one by one.
#include "geometry/packet_tests.h"

// Up to this many rays are traced one by one through a subtree or block. Twice or half as many change
// bench/rays by 0 to 5 %.
enum { FEW = 3, FEW_AT_BLOCK = 2 };

// A subtree and the rays that enter it: bit i is ray i.
typedef struct Visit {
    int32_t child;
    uint32_t lanes;
} Visit;

// ---- preparing

// prepare() for all lanes. Inactive lanes become copies of an active one.
static void prepareLanes(const vplRayPacket* rays, Packet* restrict p)
{
    const int first = __builtin_ctz(rays->active);
    float d[3][LANES];
    for (int i = 0; i < LANES; i++) {
        const int from = rays->active >> i & 1 ? i : first;
        for (int axis = 0; axis < 3; axis++) {
            p->origin[axis][i] = rays->origin[axis][from];
            d[axis][i] = rays->direction[axis][from];
        }
        p->skipFirst[i] = rays->skipFirst[from];
        p->skipCount[i] = rays->skipCount[from];
    }
    for (int axis = 0; axis < 3; axis++) {
        for (int i = 0; i < LANES; i++) {
            const float v = d[axis][i];
            p->inverse[axis][i] = 1 / (fabsf(v) > 0x1p-126f ? v : copysignf(0x1p-126f, v));
        }
    }
    for (int i = 0; i < LANES; i++) {
        const float x = d[0][i], y = d[1][i], z = d[2][i], ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
        const int32_t kz = ax > ay ? (ax > az ? 0 : 2) : (ay > az ? 1 : 2);
        const float along = kz == 0 ? x : kz == 1 ? y : z;
        p->kz[i] = kz;
        p->sx[i] = (kz == 0 ? y : kz == 1 ? z : x) / along;
        p->sy[i] = (kz == 0 ? z : kz == 1 ? x : y) / along;
        p->sz[i] = 1 / along * DEPTH_SCALE;
    }
    for (int k = 0; k < 3; k++) {
        int32_t same[LANES];
        for (int i = 0; i < LANES; i++) {
            same[i] = -(p->kz[i] == k);
        }
        p->along[k] = collectLanes(same);
    }
}

// The minimum and maximum over all lanes, by halves.
static inline void findRange(const float values[LANES], float* leastOut, float* mostOut)
{
    float least[LANES], most[LANES];
    memcpy(least, values, sizeof least);
    memcpy(most, values, sizeof most);
    for (int half = LANES / 2; half > 0; half /= 2) {
        for (int i = 0; i < half; i++) {
            least[i] = least[i] < least[i + half] ? least[i] : least[i + half];
            most[i] = most[i] > most[i + half] ? most[i] : most[i + half];
        }
    }
    *leastOut = least[0];
    *mostOut = most[0];
}

static void prepareIntervals(Packet* p)
{
    for (int axis = 0; axis < 3; axis++) {
        float low, high;
        findRange(p->origin[axis], &low, &high);
        findRange(p->inverse[axis], &p->least[axis], &p->most[axis]);
        const bool down = p->most[axis] < 0;
        p->sameSign[axis] = down || p->least[axis] > 0;
        p->enterOrigin[axis] = down ? low : high;
        p->leaveOrigin[axis] = down ? high : low;
        p->enterRow[axis] = down ? axis + 3 : axis;
        p->leaveRow[axis] = down ? axis : axis + 3;
    }
}

// Extracts one ray.
static Prepared takeLane(const Packet* p, int lane)
{
    Prepared r = {.sx = p->sx[lane], .sy = p->sy[lane], .sz = p->sz[lane], .kz = p->kz[lane]};
    r.blocks = p->bvh->blocks;
    r.marks = p->bvh->marks;
    for (int axis = 0; axis < 3; axis++) {
        r.origin[axis] = p->origin[axis][lane];
        r.inverse[axis] = p->inverse[axis][lane];
        setRows(&r, axis);
    }
    r.kx = r.kz == 2 ? 0 : r.kz + 1;
    r.ky = r.kx == 2 ? 0 : r.kx + 1;
    r.skipFirst = p->skipFirst[lane];
    r.skipCount = p->skipCount[lane];
    return r;
}

// ---- blocks

static uint32_t testBlockLanes(const Packet* p, const vplTriangleBlock* block, uint32_t lanes)
{
    uint32_t hits = 0;
    for (int kz = 0; kz < 3; kz++) {
        uint32_t some = lanes & p->along[kz];
        if (__builtin_popcount(some) > FEW_AT_BLOCK && p->bvh->marks == NULL) {
            for (int i = 0; i < WIDTH && block->id[i] >= 0 && some != 0; i++) {
                const uint32_t hit = testTriangle(p, block, i, kz) & some;
                hits |= hit;
                some &= ~hit;
            }
            continue;
        }
        for (; some != 0; some &= some - 1) {
            const int lane = __builtin_ctz(some);
            const Prepared r = takeLane(p, lane);
            hits |= (uint32_t)hasHitBelow(&r, block, p->limit) << lane;
        }
    }
    return hits;
}

// ---- traversal

static uint32_t finishAlone(const Packet* p, const vplBvh* bvh, const Visit* visit)
{
    uint32_t hits = 0;
    for (uint32_t lanes = visit->lanes; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        const Prepared r = takeLane(p, lane);
        hits |= (uint32_t)hasHitInTree(&r, bvh, visit->child, p->limit) << lane;
    }
    return hits;
}

// Bit i of the result: ray i hits something in the tree.
static uint32_t traceTree(const Packet* p, const vplBvh* bvh, uint32_t active)
{
    Visit stack[VPL_BVH_DEPTH * (WIDTH - 1) + WIDTH];
    stack[0] = (Visit){0, active};
    uint32_t hits = 0;
    for (int height = 1; height > 0 && hits != active;) {
        Visit visit = stack[--height];
        visit.lanes &= ~hits;
        if (visit.child < 0) {
            hits |= testBlockLanes(p, &bvh->blocks[~visit.child], visit.lanes);
            continue;
        }
        if (__builtin_popcount(visit.lanes) <= FEW) {
            hits |= finishAlone(p, bvh, &visit);
            continue;
        }
        const vplBvhNode* node = &bvh->nodes[visit.child];
        for (uint32_t children = testIntervals(p, node); children != 0;) {
            const int i = 31 - __builtin_clz(children);
            children ^= 1u << i;
            const uint32_t lanes = testLanes(p, node, i) & visit.lanes;
            stack[height] = (Visit){node->child[i], lanes};
            height += lanes != 0;
        }
    }
    return hits;
}

vplTraceAnyPacketFcn VPL_KERNEL(vplTraceAnyPacket);

uint32_t VPL_KERNEL(vplTraceAnyPacket)(const vplBvh* bvh, const vplRayPacket* rays, float tMax)
{
    if (rays->active == 0) {
        return 0;
    }
    Packet p;
    p.limit = tMax;
    p.bvh = bvh;
    prepareLanes(rays, &p);
    if (bvh->nodes != NULL) {
        prepareIntervals(&p);
        return traceTree(&p, bvh, rays->active);
    }
    uint32_t hits = 0;
    for (int i = 0; i < bvh->blockCount && hits != rays->active; i++) {
        hits |= testBlockLanes(&p, &bvh->blocks[i], rays->active & ~hits);
    }
    return hits;
}
