// SPDX-License-Identifier: MIT
// One ray against the triangles of a block and against the children of a node. Included by kernels only, so
// it is compiled once per instruction set; all give the same bits.
// Based on: Sven Woop, Carsten Benthin and Ingo Wald, Watertight Ray/Triangle Intersection, JCGT 2013; Thiago
// Ize, Robust BVH Ray Traversal, JCGT 2013 (rounding of the box test).
// Departs: a hit must also lie in its triangle's own bounds, by the arithmetic that tests nodes. That
// arithmetic is monotone, so a ray that meets a box never misses the box around it: the tree gives the same
// bits as testing every triangle, for all rays.
#ifndef VPL_GEOMETRY_RAY_TESTS_H
#define VPL_GEOMETRY_RAY_TESTS_H

#include "base/isa.h"
#include "geometry/box.h"
#include "geometry/bvh.h"

#include <math.h>
#include <string.h>

enum { WIDTH = VPL_BVH_WIDTH };

// Bit i of the result: flags[i] is -1. Flags are 0 or -1.
static inline uint32_t collectBits(const int32_t flags[WIDTH])
{
    static const int32_t place[WIDTH] = {1, 2, 4, 8, 16, 32, 64, 128};
    int32_t bits = 0;
    for (int i = 0; i < WIDTH; i++) {
        bits |= flags[i] & place[i];
    }
    return (uint32_t)bits;
}

// Depths are scaled by a power of two, which changes no digit, so that the products of depths down to the
// smallest float with edge functions do not underflow.
#define DEPTH_SCALE 0x1p20f

// A ray prepared for both tests. The triangle test permutes the axes so that kz is the ray's longest.
typedef struct Prepared {
    vplFour origin, inverse;   // of the direction; the fourth lane is not used
    int nearRow[3], farRow[3]; // byte offsets of rows of vplBvhNode.planes
    float sx, sy, sz;          // sz times DEPTH_SCALE
    int kx, ky, kz;
    int skipFirst, skipCount;
    const vplTriangleBlock* blocks; // of the tree
    const vplBlockMarks* marks;     // usually NULL
} Prepared;

enum { ROW = WIDTH * sizeof(float) };

static inline void setRows(Prepared* p, int axis)
{
    p->nearRow[axis] = ROW * (p->inverse[axis] < 0 ? axis + 3 : axis);
    p->farRow[axis] = ROW * (p->inverse[axis] < 0 ? axis : axis + 3);
}

// The axis of the largest component. Has no branches: they would be mispredicted for random rays.
static inline int longestAxis(float x, float y, float z)
{
    x = fabsf(x);
    y = fabsf(y);
    const float most = x > y ? x : y;
    const int axis = x > y ? 0 : 1;
    return most > fabsf(z) ? axis : 2;
}

static inline Prepared prepare(const vplBvh* bvh, const vplRay* ray)
{
    static const int next[4] = {1, 2, 0, 1};
    Prepared p;
    const float d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    p.origin = (vplFour){ray->origin.x, ray->origin.y, ray->origin.z, 0};
    p.kz = longestAxis(d[0], d[1], d[2]);
    p.kx = next[p.kz];
    p.ky = next[p.kz + 1];
    const vplFour shear = (vplFour){d[p.kx], d[p.ky], 1, 1} / vplFour_Of(d[p.kz]);
    p.sx = shear[0];
    p.sy = shear[1];
    p.sz = shear[2] * DEPTH_SCALE;
    vplFour divisor = {1, 1, 1, 1};
    for (int k = 0; k < 3; k++) {
        // Avoids 1/0, because 0 times infinity is NaN. A slab parallel to the ray becomes too wide to decide.
        divisor[k] = fabsf(d[k]) > 0x1p-126f ? d[k] : copysignf(0x1p-126f, d[k]);
    }
    p.inverse = 1 / divisor;
    for (int k = 0; k < 3; k++) {
        setRows(&p, k);
    }
    p.skipFirst = ray->skip.first;
    p.skipCount = ray->skip.count;
    p.blocks = bvh->blocks;
    p.marks = bvh->marks;
    return p;
}

// Recomputes the edge functions of a triangle in double where one came out as 0 in float: rounding never
// flips a sign, but it can hide one.
static void edgesInDouble(const float a[2], const float b[2], const float c[2], float* u, float* v, float* w)
{
    *u = (float)((double)c[0] * b[1] - (double)c[1] * b[0]);
    *v = (float)((double)a[0] * c[1] - (double)a[1] * c[0]);
    *w = (float)((double)b[0] * a[1] - (double)b[1] * a[0]);
}

// Tests the triangles of a block in float.
static __attribute__((noinline)) uint32_t testOrdinaryBlock(const Prepared* r, const vplTriangleBlock* block,
                                                            float* restrict t, float* restrict b1,
                                                            float* restrict b2)
{
    float x[3][WIDTH], y[3][WIDTH], z[3][WIDTH], u[WIDTH], v[WIDTH], w[WIDTH];
    int32_t flags[WIDTH];
    const float ox = r->origin[r->kx], oy = r->origin[r->ky], oz = r->origin[r->kz];
    const float sx = r->sx, sy = r->sy, sz = r->sz;
    for (int corner = 0; corner < 3; corner++) {
        const float* restrict px = block->p[corner][r->kx];
        const float* restrict py = block->p[corner][r->ky];
        const float* restrict pz = block->p[corner][r->kz];
        for (int i = 0; i < WIDTH; i++) {
            float dz = pz[i] - oz;
            x[corner][i] = (px[i] - ox) - sx * dz;
            y[corner][i] = (py[i] - oy) - sy * dz;
            z[corner][i] = sz * dz;
        }
    }
    for (int i = 0; i < WIDTH; i++) {
        u[i] = x[2][i] * y[1][i] - y[2][i] * x[1][i];
        v[i] = x[0][i] * y[2][i] - y[0][i] * x[2][i];
        w[i] = x[1][i] * y[0][i] - y[1][i] * x[0][i];
        flags[i] = -((u[i] == 0) | (v[i] == 0) | (w[i] == 0));
    }
    for (uint32_t zeros = collectBits(flags); zeros != 0; zeros &= zeros - 1) {
        const int i = __builtin_ctz(zeros);
        const float a[2] = {x[0][i], y[0][i]}, b[2] = {x[1][i], y[1][i]}, c[2] = {x[2][i], y[2][i]};
        edgesInDouble(a, b, c, &u[i], &v[i], &w[i]);
    }
    const uint32_t first = (uint32_t)r->skipFirst, count = (uint32_t)r->skipCount;
    for (int i = 0; i < WIDTH; i++) {
        float least = u[i] < v[i] ? u[i] : v[i], most = u[i] > v[i] ? u[i] : v[i];
        least = least < w[i] ? least : w[i];
        most = most > w[i] ? most : w[i];
        uint32_t id = (uint32_t)block->id[i]; // -1, unused: above all
        flags[i] = -(((least >= 0) | (most <= 0)) & (id - first >= count) & (id < 0x80000000u));
    }
    if (collectBits(flags) == 0) { // most blocks
        return 0;
    }
    for (int i = 0; i < WIDTH; i++) {
        float det = u[i] + v[i] + w[i];
        float inverse = 1 / (det != 0 ? det : 1);
        float distance = (u[i] * z[0][i] + v[i] * z[1][i] + w[i] * z[2][i]) * inverse * (1 / DEPTH_SCALE);
        t[i] = distance;
        b1[i] = v[i] * inverse;
        b2[i] = w[i] * inverse;
        flags[i] &= -((det != 0) & (distance > 0) & (distance < INFINITY));
    }
    return collectBits(flags);
}

// The distance at which a ray enters a box, from those at which it crosses the near planes.
static inline float slabEntry(float x, float y, float z)
{
    float t = x > y ? x : y;
    t = t > z ? t : z;
    return t > 0 ? t : 0;
}

// The distance at which it leaves the box, enlarged by 16 rounding units: the slabs err by 6 and the corners
// in the triangle test by 6 more, on top of the padding of vplBoundTriangle. Without it 204 of the 96000 rays
// of the test SharedEdgesLetNothingThrough fall through an edge: they miss the box of the triangle that they
// hit.
static inline float slabExit(float x, float y, float z)
{
    float t = x < y ? x : y;
    return (t < z ? t : z) * (1 + 0x1p-20f);
}

static inline const float* rowAt(const vplBvhNode* node, int offset)
{
    return (const float*)((const char*)node + offset);
}

// Finds the entry distances of a node's children. Bit i of the result: the ray meets child i before `limit`.
static inline uint32_t testBoxes(const Prepared* r, const vplBvhNode* node, float limit,
                                 float* restrict entry)
{
    const float* restrict nearX = rowAt(node, r->nearRow[0]);
    const float* restrict nearY = rowAt(node, r->nearRow[1]);
    const float* restrict nearZ = rowAt(node, r->nearRow[2]);
    const float* restrict farX = rowAt(node, r->farRow[0]);
    const float* restrict farY = rowAt(node, r->farRow[1]);
    const float* restrict farZ = rowAt(node, r->farRow[2]);
    const float ox = r->origin[0], oy = r->origin[1], oz = r->origin[2];
    const float ix = r->inverse[0], iy = r->inverse[1], iz = r->inverse[2];
    int32_t met[WIDTH];
    for (int i = 0; i < WIDTH; i++) {
        float in = slabEntry((nearX[i] - ox) * ix, (nearY[i] - oy) * iy, (nearZ[i] - oz) * iz);
        float out = slabExit((farX[i] - ox) * ix, (farY[i] - oy) * iy, (farZ[i] - oz) * iz);
        entry[i] = in;
        met[i] = -((in <= out) & (in <= limit));
    }
    return collectBits(met);
}

// Tests one triangle in double, because sums of products of its sizes leave float's range.
static __attribute__((noinline)) bool testInDouble(const Prepared* r, const vplTriangleBlock* block, int lane,
                                                   float* t, float* b1, float* b2)
{
    const double ox = (double)r->origin[r->kx], oy = (double)r->origin[r->ky], oz = (double)r->origin[r->kz];
    double x[3], y[3], z[3];
    for (int corner = 0; corner < 3; corner++) {
        z[corner] = (double)block->p[corner][r->kz][lane] - oz;
        x[corner] = (double)block->p[corner][r->kx][lane] - ox - (double)r->sx * z[corner];
        y[corner] = (double)block->p[corner][r->ky][lane] - oy - (double)r->sy * z[corner];
    }
    const double u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0],
                 det = u + v + w;
    const bool inside = (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0);
    const bool skipped = (uint32_t)(block->id[lane] - r->skipFirst) < (uint32_t)r->skipCount;
    if (!inside || skipped || det == 0) {
        return false;
    }
    const double depth = (u * z[0] + v * z[1] + w * z[2]) / det;
    *t = (float)(depth * ((double)r->sz / (double)DEPTH_SCALE));
    *b1 = (float)(v / det);
    *b2 = (float)(w / det);
    return *t > 0 && *t < INFINITY;
}

// Corrects the hits of a block with marks.
static __attribute__((noinline)) uint32_t testMarked(const Prepared* r, const vplTriangleBlock* block,
                                                     uint32_t hits, float* t, float* b1, float* b2)
{
    const vplBlockMarks marks = r->marks[block - r->blocks];
    hits &= ~(uint32_t)(marks.byFormula | marks.extreme);
    for (uint32_t lanes = marks.extreme & ~marks.byFormula & 0xffu; lanes != 0; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        hits |= (uint32_t)testInDouble(r, block, i, &t[i], &b1[i], &b2[i]) << i;
    }
    return hits;
}

// Bit i of the result: lane i was hit. Without hits the outputs are not set.
static inline uint32_t testBlock(const Prepared* r, const vplTriangleBlock* block, float* t, float* b1,
                                 float* b2)
{
    const uint32_t hits = testOrdinaryBlock(r, block, t, b1, b2);
    return __builtin_expect(r->marks != NULL, 0) ? testMarked(r, block, hits, t, b1, b2) : hits;
}

static inline vplBox boundLane(const vplTriangleBlock* block, int lane)
{
    vplFour corner[3];
    for (int i = 0; i < 3; i++) {
        corner[i] = (vplFour){block->p[i][0][lane], block->p[i][1][lane], block->p[i][2][lane], 0};
    }
    return vplBoundTriangle(corner);
}

// Clamps a hit distance to the triangle's bounds; +infinity where the ray misses them.
static __attribute__((noinline)) float clampToBox(const Prepared* r, const vplTriangleBlock* block, int lane,
                                                  float t)
{
    const vplBox box = boundLane(block, lane);
    const vplFour a = (box.low - r->origin) * r->inverse, b = (box.high - r->origin) * r->inverse;
    const vplFour in = vplFour_Min(a, b), out = vplFour_Max(a, b);
    const float entry = slabEntry(in[0], in[1], in[2]), exit = slabExit(out[0], out[1], out[2]);
    t = t > entry ? t : entry;
    t = t < exit ? t : exit;
    return entry <= exit && t > 0 ? t : INFINITY;
}

static inline bool hasHitBelow(const Prepared* r, const vplTriangleBlock* block, float limit)
{
    float t[WIDTH], b1[WIDTH], b2[WIDTH];
    for (uint32_t hits = testBlock(r, block, t, b1, b2); hits != 0; hits &= hits - 1) {
        const int i = __builtin_ctz(hits);
        if (clampToBox(r, block, i, t[i]) < limit) {
            return true;
        }
    }
    return false;
}

// True if the subtree of `child` has a hit. Visits children in their order: sorting by distance costs more
// than it saves.
static inline bool hasHitInTree(const Prepared* r, const vplBvh* bvh, int32_t child, float limit)
{
    int32_t stack[VPL_BVH_DEPTH * (WIDTH - 1) + 1];
    int height = 0;
    for (;;) {
        if (child >= 0) {
            const vplBvhNode* node = &bvh->nodes[child];
            float entry[WIDTH];
            uint32_t hits = testBoxes(r, node, limit, entry);
            if (hits != 0) {
                while ((hits & (hits - 1)) != 0) {
                    const int last = 31 - __builtin_clz(hits);
                    hits ^= 1u << last;
                    stack[height++] = node->child[last];
                }
                child = node->child[__builtin_ctz(hits)];
                continue;
            }
        } else if (hasHitBelow(r, &bvh->blocks[~child], limit)) {
            return true;
        }
        if (height == 0) {
            return false;
        }
        child = stack[--height];
    }
}

#endif
