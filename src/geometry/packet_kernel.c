// SPDX-License-Identifier: MIT
// Sixteen rays through the hierarchy together: whether each meets anything, as vplTraceAny says.
// Based on: Ingo Wald, Philipp Slusallek, Carsten Benthin and Markus Wagner, Interactive Rendering with Coherent Ray
// Tracing, Eurographics 2001 (packets). Departs: where few rays are left they go on alone.
#include "geometry/ray_tests.h"

enum { LANES = VPL_RAY_PACKET, FEW = 3 };

// A subtree and the rays that enter it.
typedef struct Visit {
    int32_t child;
    uint32_t lanes;
} Visit;

typedef struct Packet {
    float origin[3][LANES], inverse[3][LANES];
    Prepared rays[LANES];
    float limit;
} Packet;

static inline uint32_t collectLanes(const int32_t flags[LANES])
{
    return collectBits(flags) | collectBits(flags + WIDTH) << WIDTH;
}

// Bit i of the result: ray i meets the box of a child before the limit.
static inline uint32_t testLanes(const Packet* p, const vplBvhNode* node, int child)
{
    float in[LANES], out[LANES];
    int32_t met[LANES];
    for (int i = 0; i < LANES; i++) {
        in[i] = 0;
        out[i] = INFINITY;
    }
    for (int axis = 0; axis < 3; axis++) {
        const float low = node->planes[axis][child], high = node->planes[axis + 3][child];
        for (int i = 0; i < LANES; i++) {
            const float a = (low - p->origin[axis][i]) * p->inverse[axis][i];
            const float b = (high - p->origin[axis][i]) * p->inverse[axis][i];
            const float nearer = a < b ? a : b, further = a < b ? b : a;
            in[i] = nearer > in[i] ? nearer : in[i];
            out[i] = further < out[i] ? further : out[i];
        }
    }
    for (int i = 0; i < LANES; i++) {
        met[i] = -((in[i] <= out[i] * (1 + 0x1p-20f)) & (in[i] <= p->limit));
    }
    return collectLanes(met);
}

static uint32_t testBlockLanes(const Packet* p, const vplTriangleBlock* block, uint32_t lanes)
{
    uint32_t hits = 0;
    for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        hits |= (uint32_t)hasHitBelow(&p->rays[lane], block, p->limit) << lane;
    }
    return hits;
}

static uint32_t finishAlone(const Packet* p, const vplBvh* bvh, const Visit* visit)
{
    uint32_t hits = 0;
    for (uint32_t lanes = visit->lanes; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        hits |= (uint32_t)hasHitInTree(&p->rays[lane], bvh, visit->child, p->limit) << lane;
    }
    return hits;
}

// Rays that meet something in the tree.
static uint32_t traceTree(const Packet* p, const vplBvh* bvh, uint32_t active)
{
    Visit stack[VPL_BVH_DEPTH * (WIDTH - 1) + 1] = {{0, active}};
    uint32_t hits = 0;
    for (int height = 1; height > 0;) {
        Visit visit = stack[--height];
        visit.lanes &= ~hits;
        if (__builtin_popcount(visit.lanes) <= FEW) {
            hits |= finishAlone(p, bvh, &visit);
            continue;
        }
        const vplBvhNode* node = &bvh->nodes[visit.child];
        for (int i = node->count; i-- > 0;) {
            const uint32_t lanes = testLanes(p, node, i) & visit.lanes & ~hits;
            if (lanes == 0) {
                continue;
            }
            if (node->child[i] < 0) {
                hits |= testBlockLanes(p, &bvh->blocks[~node->child[i]], lanes);
            } else {
                stack[height++] = (Visit){node->child[i], lanes};
            }
        }
    }
    return hits;
}

vplTraceAnyPacketFcn VPL_KERNEL(vplTraceAnyPacket);

uint32_t VPL_KERNEL(vplTraceAnyPacket)(const vplBvh* bvh, const vplRayPacket* rays, float tMax)
{
    Packet p;
    p.limit = tMax;
    for (int i = 0; i < LANES; i++) {
        p.rays[i] = prepare(&rays->rays[i]);
        for (int axis = 0; axis < 3; axis++) {
            p.origin[axis][i] = p.rays[i].origin[axis];
            p.inverse[axis][i] = p.rays[i].inverse[axis];
        }
    }
    if (bvh->nodes != NULL) {
        return traceTree(&p, bvh, rays->active);
    }
    uint32_t hits = 0;
    for (int i = 0; i < bvh->blockCount && hits != rays->active; i++) {
        hits |= testBlockLanes(&p, &bvh->blocks[i], rays->active & ~hits);
    }
    return hits;
}
