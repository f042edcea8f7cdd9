// SPDX-License-Identifier: MIT
// Sixteen rays through the hierarchy together: whether each meets anything, as vplTraceAny says.
// Based on: Ingo Wald, Philipp Slusallek, Carsten Benthin and Markus Wagner, Interactive Rendering with Coherent Ray
// Tracing, Eurographics 2001 (packets); Solomon Boulos, Ingo Wald and Peter Shirley, Geometric and Arithmetic
// Culling Methods for Entire Ray Packets, 2006 (intervals). Departs: where few rays are left they go on alone.
#include "geometry/ray_tests.h"

enum { LANES = VPL_RAY_PACKET, FEW = 3, FEW_AT_BLOCK = 2 };

// A subtree and the rays that enter it.
typedef struct Visit {
    int32_t child;
    uint32_t lanes;
} Visit;

typedef struct Packet {
    float origin[3][LANES], inverse[3][LANES];
    float sx[LANES], sy[LANES], sz[LANES];
    int32_t kz[LANES], skipFirst[LANES], skipCount[LANES];
    uint32_t along[3]; // rays by kz
    float limit;
    // All rays at once: intervals of origins and inverse directions, for the planes that they enter a box by and
    // those that they leave it by. Axes in which they do not all go the same way tell nothing.
    float enterOrigin[3], leaveOrigin[3], least[3], most[3];
    int enterRow[3], leaveRow[3];
    bool tells[3];
} Packet;

static inline uint32_t collectLanes(const int32_t flags[LANES])
{
    return collectBits(flags) | collectBits(flags + WIDTH) << WIDTH;
}

// ---- preparing

// As prepare() does. Rays that are not there become copies of one that is.
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
        p->sz[i] = 1 / along;
    }
    for (int k = 0; k < 3; k++) {
        int32_t same[LANES];
        for (int i = 0; i < LANES; i++) {
            same[i] = -(p->kz[i] == k);
        }
        p->along[k] = collectLanes(same);
    }
}

// The least and the most of all lanes, in halves.
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
        p->tells[axis] = down || p->least[axis] > 0;
        p->enterOrigin[axis] = down ? low : high;
        p->leaveOrigin[axis] = down ? high : low;
        p->enterRow[axis] = down ? axis + 3 : axis;
        p->leaveRow[axis] = down ? axis : axis + 3;
    }
}

// One of the rays alone.
static Prepared takeLane(const Packet* p, int lane)
{
    Prepared r = {.sx = p->sx[lane], .sy = p->sy[lane], .sz = p->sz[lane], .kz = p->kz[lane]};
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

// ---- boxes

// Bit i of the result: some ray may meet child i. Each operation rounds monotonously, so what the intervals miss all
// rays miss.
static inline uint32_t testIntervals(const Packet* p, const vplBvhNode* node)
{
    float in[WIDTH], out[WIDTH];
    int32_t met[WIDTH];
    for (int i = 0; i < WIDTH; i++) {
        in[i] = 0;
        out[i] = INFINITY;
    }
    for (int axis = 0; axis < 3; axis++) {
        const float* restrict enter = node->planes[p->enterRow[axis]];
        const float* restrict leave = node->planes[p->leaveRow[axis]];
        const float from = p->enterOrigin[axis], to = p->leaveOrigin[axis];
        const float least = p->least[axis], most = p->most[axis];
        for (int i = 0; p->tells[axis] && i < WIDTH; i++) {
            const float a = (enter[i] - from) * least, b = (enter[i] - from) * most;
            const float c = (leave[i] - to) * least, d = (leave[i] - to) * most;
            const float soonest = a < b ? a : b, latest = c > d ? c : d;
            in[i] = soonest > in[i] ? soonest : in[i];
            out[i] = latest < out[i] ? latest : out[i];
        }
    }
    for (int i = 0; i < WIDTH; i++) {
        met[i] = -((in[i] <= out[i] * (1 + 0x1p-20f)) & (in[i] <= p->limit));
    }
    return collectBits(met) & ((1u << node->count) - 1);
}

// Bit i of the result: ray i meets the box of a child before the limit.
static inline uint32_t testLanes(const Packet* p, const vplBvhNode* node, int child)
{
    const float* restrict ox = p->origin[0], * restrict oy = p->origin[1], * restrict oz = p->origin[2];
    const float* restrict ix = p->inverse[0], * restrict iy = p->inverse[1], * restrict iz = p->inverse[2];
    const float lowX = node->planes[0][child], lowY = node->planes[1][child], lowZ = node->planes[2][child];
    const float highX = node->planes[3][child], highY = node->planes[4][child],
                highZ = node->planes[5][child];
    const float limit = p->limit;
    int32_t met[LANES];
    for (int i = 0; i < LANES; i++) {
        const float ax = (lowX - ox[i]) * ix[i], bx = (highX - ox[i]) * ix[i];
        const float ay = (lowY - oy[i]) * iy[i], by = (highY - oy[i]) * iy[i];
        const float az = (lowZ - oz[i]) * iz[i], bz = (highZ - oz[i]) * iz[i];
        const float in = slabEntry(ax < bx ? ax : bx, ay < by ? ay : by, az < bz ? az : bz);
        const float out = slabExit(ax < bx ? bx : ax, ay < by ? by : ay, az < bz ? bz : az);
        met[i] = -((in <= out) & (in <= limit));
    }
    return collectLanes(met);
}

// ---- triangles

// One triangle against all rays, which have the same kz. Bit i of the result: ray i has a hit before the limit.
static uint32_t testTriangle(const Packet* p, const vplTriangleBlock* block, int lane, int kz)
{
    const int kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
    const float* restrict ox = p->origin[kx], * restrict oy = p->origin[ky], * restrict oz = p->origin[kz];
    const float* restrict sx = p->sx, * restrict sy = p->sy, * restrict sz = p->sz;
    float x[3][LANES], y[3][LANES], z[3][LANES], u[LANES], v[LANES], w[LANES];
    int32_t flags[LANES];
    for (int corner = 0; corner < 3; corner++) {
        const float px = block->p[corner][kx][lane], py = block->p[corner][ky][lane],
                    pz = block->p[corner][kz][lane];
        for (int i = 0; i < LANES; i++) {
            const float dz = pz - oz[i];
            x[corner][i] = (px - ox[i]) - sx[i] * dz;
            y[corner][i] = (py - oy[i]) - sy[i] * dz;
            z[corner][i] = sz[i] * dz;
        }
    }
    for (int i = 0; i < LANES; i++) {
        u[i] = x[2][i] * y[1][i] - y[2][i] * x[1][i];
        v[i] = x[0][i] * y[2][i] - y[0][i] * x[2][i];
        w[i] = x[1][i] * y[0][i] - y[1][i] * x[0][i];
        flags[i] = -((u[i] == 0) | (v[i] == 0) | (w[i] == 0));
    }
    for (uint32_t zeros = collectLanes(flags); zeros != 0; zeros &= zeros - 1) {
        const int i = __builtin_ctz(zeros);
        const float a[2] = {x[0][i], y[0][i]}, b[2] = {x[1][i], y[1][i]}, c[2] = {x[2][i], y[2][i]};
        edgesInDouble(a, b, c, &u[i], &v[i], &w[i]);
    }
    const uint32_t id = (uint32_t)block->id[lane];
    for (int i = 0; i < LANES; i++) {
        float least = u[i] < v[i] ? u[i] : v[i], most = u[i] > v[i] ? u[i] : v[i];
        least = least < w[i] ? least : w[i];
        most = most > w[i] ? most : w[i];
        flags[i] =
            -(((least >= 0) | (most <= 0)) & (id - (uint32_t)p->skipFirst[i] >= (uint32_t)p->skipCount[i]));
    }
    if (collectLanes(flags) == 0) {
        return 0;
    }
    float corner[3][3], low[3], high[3];
    for (int i = 0; i < 9; i++) {
        corner[i / 3][i % 3] = block->p[i / 3][i % 3][lane];
    }
    vplBoundTriangle(corner, low, high);
    const float* restrict px = p->origin[0], * restrict py = p->origin[1], * restrict pz = p->origin[2];
    const float* restrict ix = p->inverse[0], * restrict iy = p->inverse[1], * restrict iz = p->inverse[2];
    const float limit = p->limit;
    for (int i = 0; i < LANES; i++) {
        const float det = u[i] + v[i] + w[i];
        const float inverse = 1 / (det != 0 ? det : 1);
        const float distance = (u[i] * z[0][i] + v[i] * z[1][i] + w[i] * z[2][i]) * inverse;
        const float ax = (low[0] - px[i]) * ix[i], bx = (high[0] - px[i]) * ix[i];
        const float ay = (low[1] - py[i]) * iy[i], by = (high[1] - py[i]) * iy[i];
        const float az = (low[2] - pz[i]) * iz[i], bz = (high[2] - pz[i]) * iz[i];
        const float in = slabEntry(ax < bx ? ax : bx, ay < by ? ay : by, az < bz ? az : bz);
        const float out = slabExit(ax < bx ? bx : ax, ay < by ? by : ay, az < bz ? bz : az);
        float t = distance > in ? distance : in;
        t = t < out ? t : out;
        flags[i] &=
            -((det != 0) & (distance > 0) & (distance < INFINITY) & (in <= out) & (t > 0) & (t < limit));
    }
    return collectLanes(flags);
}

static uint32_t testBlockLanes(const Packet* p, const vplTriangleBlock* block, uint32_t lanes)
{
    uint32_t hits = 0;
    for (int kz = 0; kz < 3; kz++) {
        uint32_t some = lanes & p->along[kz];
        if (__builtin_popcount(some) > FEW_AT_BLOCK) {
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

// Rays that meet something in the tree.
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
