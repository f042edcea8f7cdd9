// SPDX-License-Identifier: MIT
// Sixteen rays against the children of a node and against a triangle, by the arithmetic of ray_tests.h.
// Based on: Solomon Boulos, Ingo Wald and Peter Shirley, Geometric and Arithmetic Culling Methods for Entire
// Ray Packets, University of Utah, 2006 (intervals).
#ifndef VPL_GEOMETRY_PACKET_TESTS_H
#define VPL_GEOMETRY_PACKET_TESTS_H

#include "geometry/ray_tests.h"

enum { LANES = VPL_RAY_PACKET };

typedef struct Packet {
    float origin[3][LANES], inverse[3][LANES];
    float sx[LANES], sy[LANES], sz[LANES];
    int32_t kz[LANES], skipFirst[LANES], skipCount[LANES];
    uint32_t along[3]; // bit i: ray i has this kz
    float limit;
    const vplBvh* bvh;
    // Intervals over all rays: of the origins, towards the planes by which rays enter and leave a box, and of
    // the inverse directions. They bound nothing along an axis in which the directions differ in sign.
    float enterOrigin[3], leaveOrigin[3], least[3], most[3];
    int enterRow[3], leaveRow[3];
    bool sameSign[3];
} Packet;

static inline uint32_t collectLanes(const int32_t flags[LANES])
{
    return collectBits(flags) | collectBits(flags + WIDTH) << WIDTH;
}

// ---- boxes

// Bit i of the result: some ray may meet child i. Rounding is monotone, so every ray misses what the
// intervals miss.
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
        for (int i = 0; p->sameSign[axis] && i < WIDTH; i++) {
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

// The distances at which each ray enters and leaves a box.
static inline void crossBox(const Packet* p, const float low[3], const float high[3], float* restrict in,
                            float* restrict out)
{
    const float* restrict ox = p->origin[0], * restrict oy = p->origin[1], * restrict oz = p->origin[2];
    const float* restrict ix = p->inverse[0], * restrict iy = p->inverse[1], * restrict iz = p->inverse[2];
    for (int i = 0; i < LANES; i++) {
        const float ax = (low[0] - ox[i]) * ix[i], bx = (high[0] - ox[i]) * ix[i];
        const float ay = (low[1] - oy[i]) * iy[i], by = (high[1] - oy[i]) * iy[i];
        const float az = (low[2] - oz[i]) * iz[i], bz = (high[2] - oz[i]) * iz[i];
        in[i] = slabEntry(ax < bx ? ax : bx, ay < by ? ay : by, az < bz ? az : bz);
        out[i] = slabExit(ax < bx ? bx : ax, ay < by ? by : ay, az < bz ? bz : az);
    }
}

// Bit i of the result: ray i meets the box of a child before the limit.
static inline uint32_t testLanes(const Packet* p, const vplBvhNode* node, int child)
{
    const float low[3] = {node->planes[0][child], node->planes[1][child], node->planes[2][child]};
    const float high[3] = {node->planes[3][child], node->planes[4][child], node->planes[5][child]};
    float in[LANES], out[LANES];
    int32_t met[LANES];
    crossBox(p, low, high, in, out);
    for (int i = 0; i < LANES; i++) {
        met[i] = -((in[i] <= out[i]) & (in[i] <= p->limit));
    }
    return collectLanes(met);
}

// ---- triangles

// One triangle in the sheared space of each ray: depths of the corners and edge functions.
typedef struct Sheared {
    float z[3][LANES], u[LANES], v[LANES], w[LANES];
} Sheared;

// The first half of testBlock, for rays of the same kz.
static inline void shearTriangle(const Packet* p, const vplTriangleBlock* block, int lane, int kz,
                                 Sheared* restrict s)
{
    const int kx = kz == 2 ? 0 : kz + 1, ky = kx == 2 ? 0 : kx + 1;
    const float* restrict ox = p->origin[kx], * restrict oy = p->origin[ky], * restrict oz = p->origin[kz];
    float x[3][LANES], y[3][LANES];
    int32_t zero[LANES];
    for (int corner = 0; corner < 3; corner++) {
        const float px = block->p[corner][kx][lane], py = block->p[corner][ky][lane],
                    pz = block->p[corner][kz][lane];
        for (int i = 0; i < LANES; i++) {
            const float dz = pz - oz[i];
            x[corner][i] = (px - ox[i]) - p->sx[i] * dz;
            y[corner][i] = (py - oy[i]) - p->sy[i] * dz;
            s->z[corner][i] = p->sz[i] * dz;
        }
    }
    for (int i = 0; i < LANES; i++) {
        s->u[i] = x[2][i] * y[1][i] - y[2][i] * x[1][i];
        s->v[i] = x[0][i] * y[2][i] - y[0][i] * x[2][i];
        s->w[i] = x[1][i] * y[0][i] - y[1][i] * x[0][i];
        zero[i] = -((s->u[i] == 0) | (s->v[i] == 0) | (s->w[i] == 0));
    }
    for (uint32_t zeros = collectLanes(zero); zeros != 0; zeros &= zeros - 1) {
        const int i = __builtin_ctz(zeros);
        const float a[2] = {x[0][i], y[0][i]}, b[2] = {x[1][i], y[1][i]}, c[2] = {x[2][i], y[2][i]};
        edgesInDouble(a, b, c, &s->u[i], &s->v[i], &s->w[i]);
    }
}

// Bit i of the result: ray i passes inside all edges and does not skip the triangle.
static inline uint32_t areInside(const Packet* p, const Sheared* s, uint32_t id)
{
    int32_t flags[LANES];
    for (int i = 0; i < LANES; i++) {
        const float u = s->u[i], v = s->v[i], w = s->w[i];
        float least = u < v ? u : v, most = u > v ? u : v;
        least = least < w ? least : w;
        most = most > w ? most : w;
        flags[i] =
            -(((least >= 0) | (most <= 0)) & (id - (uint32_t)p->skipFirst[i] >= (uint32_t)p->skipCount[i]));
    }
    return collectLanes(flags);
}

// Bit i of the result: ray i hits the triangle before the limit. All rays have the same kz.
static uint32_t testTriangle(const Packet* p, const vplTriangleBlock* block, int lane, int kz)
{
    Sheared s;
    shearTriangle(p, block, lane, kz, &s);
    const uint32_t inside = areInside(p, &s, (uint32_t)block->id[lane]);
    if (inside == 0) {
        return 0;
    }
    float in[LANES], out[LANES];
    int32_t flags[LANES];
    const vplBox box = boundLane(block, lane);
    const float low[3] = {box.low[0], box.low[1], box.low[2]};
    const float high[3] = {box.high[0], box.high[1], box.high[2]};
    crossBox(p, low, high, in, out);
    for (int i = 0; i < LANES; i++) {
        const float det = s.u[i] + s.v[i] + s.w[i];
        const float inverse = 1 / (det != 0 ? det : 1);
        const float distance =
            (s.u[i] * s.z[0][i] + s.v[i] * s.z[1][i] + s.w[i] * s.z[2][i]) * inverse * (1 / DEPTH_SCALE);
        float t = distance > in[i] ? distance : in[i];
        t = t < out[i] ? t : out[i];
        flags[i] = -((det != 0) & (distance > 0) & (distance < INFINITY) & (in[i] <= out[i]) & (t > 0) &
                     (t < p->limit));
    }
    return inside & collectLanes(flags);
}

#endif
