// SPDX-License-Identifier: MIT
// Fills one triangle into a paraboloid map. Included by the kernel that draws them.
//
// A texel at p = (x, y) in [-1, 1]^2 looks along d = (2x, 2y, 1 - p^2) in the map's frame, |d| = 1 + p^2. So
// a plane e.d is the function e.z (1 - p^2) + 2 e.x x + 2 e.y y: edges are exact circles, and nothing is
// subdivided. While triangles are drawn a texel holds 1/t of the nearest t d, which needs no division; at the
// end that of distance.
#ifndef VPL_VISIBILITY_PARABOLOID_FILL_H
#define VPL_VISIBILITY_PARABOLOID_FILL_H

#include "math/double3.h"
#include "visibility/map_fill.h"
#include "visibility/paraboloid_map.h"

// p x q as that of the nearer end and the difference: right to rounding also where one end is 10^5 times as
// far as the other, which moves edges by a hundredth where sum and difference are multiplied.
static inline vplVec3 edgeOf(vplVec3 p, vplVec3 q)
{
    const float pp = vplDot(p, p), qq = vplDot(q, q);
    const float a = pp < qq ? 1.0f : pp > qq ? 0.0f : 0.5f;
    const vplVec3 nearer = {a * p.x + (1 - a) * q.x, a * p.y + (1 - a) * q.y, a * p.z + (1 - a) * q.z};
    return vplCross(nearer, vplSub(q, p));
}

// The coefficients of e.d = a (1 - x^2 - y^2) + b x + c y.
static inline Coefficients quadricOf(vplVec3 e)
{
    return (Coefficients){e.z, 2 * e.x, 2 * e.y};
}

// A hemisphere that is drawn.
typedef struct Canvas {
    int32_t size;
    float rim; // how far from the middle texels count
    float* texels;
    int32_t* triangles; // may be NULL
    Eye eye;
    float slack; // directions count down to -slack |d| below the plane: 0 or what `rim` asks for
} Canvas;

// Fills one row of blocks. `ids`, a constant: stores triangles, too.
static inline __attribute__((always_inline)) void fillRow(const Filling* restrict f, BlockRow blocks,
                                                          bool ids, int32_t triangle, float* restrict texels,
                                                          int32_t* restrict triangles)
{
    const int32_t row = blocks.row;
    const float scale = blocks.scale;
    const Coefficients q0 = f->edge[0], q1 = f->edge[1], q2 = f->edge[2], qn = f->near;
    float e0[VPL_LANES], e1[VPL_LANES], e2[VPL_LANES], near[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        const float y = (float)(2 * (SIDE * row + l / SIDE) + 1) * scale - 1, above = 1 - y * y;
        e0[l] = q0.a * above + q0.c * y;
        e1[l] = q1.a * above + q1.c * y;
        e2[l] = q2.a * above + q2.c * y;
        near[l] = qn.a * above + qn.c * y;
    }
    for (int32_t i = blocks.first; i <= blocks.last; i++) {
        float old[VPL_LANES], now[VPL_LANES];
        int32_t oldId[VPL_LANES], nowId[VPL_LANES];
        memcpy(old, texels + (size_t)i * VPL_LANES, sizeof old);
        if (ids) {
            memcpy(oldId, triangles + (size_t)i * VPL_LANES, sizeof oldId);
        }
        for (int l = 0; l < VPL_LANES; l++) {
            const float x = (float)(2 * (SIDE * i + l % SIDE) + 1) * scale - 1, xx = x * x;
            const float a = e0[l] + (q0.b * x - q0.a * xx), b = e1[l] + (q1.b * x - q1.a * xx);
            const float c = e2[l] + (q2.b * x - q2.a * xx), value = near[l] + (qn.b * x - qn.a * xx);
            const float ab = a < b ? a : b, before = old[l];
            const float abc = ab < c ? ab : c;
            const int32_t nearer = (abc >= 0) & (value > before);
            now[l] = nearer ? value : before;
            if (ids) {
                const int32_t owner = oldId[l];
                nowId[l] = nearer ? triangle : owner;
            }
        }
        memcpy(texels + (size_t)i * VPL_LANES, now, sizeof now);
        if (ids) {
            memcpy(triangles + (size_t)i * VPL_LANES, nowId, sizeof nowId);
        }
    }
}

static inline void fill(const Canvas* c, const Filling* f, int32_t triangle, Texels box)
{
    const float scale = 1 / (float)c->size;
    const size_t stride = (size_t)vplHemiMap_Blocks(c->size) * VPL_LANES;
    for (int32_t row = box.j0 / SIDE; row <= box.j1 / SIDE; row++) {
        const size_t at = (size_t)row * stride;
        const BlockRow blocks = {row, box.i0 / SIDE, box.i1 / SIDE, scale};
        if (c->triangles != NULL) {
            fillRow(f, blocks, true, triangle, c->texels + at, c->triangles + at);
        } else {
            fillRow(f, blocks, false, triangle, c->texels + at, NULL);
        }
    }
}

// ---- the exact bounds of a triangle: of its corners, and of the arcs between them where they turn round

typedef struct Box {
    double low[2], high[2];
} Box;

static inline void widen(Box* box, int axis, double at)
{
    box->low[axis] = at < box->low[axis] ? at : box->low[axis];
    box->high[axis] = at > box->high[axis] ? at : box->high[axis];
}

// The image of the edge from a to b lies on the circle around (e.x, e.y) / e.z of radius |e| / |e.z|, e = a x
// b. Its ends on each axis count where they lie between a and b.
static inline void widenByArc(Box* box, const double a[3], const double b[3], const double e[3])
{
    const double length = sqrt(vplDot3(e, e));
    if (!(fabs(e[2]) > 1e-12 * length)) { // a straight line
        return;
    }
    for (int axis = 0; axis < 2; axis++) {
        const double middle = e[axis] / e[2], other = e[1 - axis] / e[2], radius = length / fabs(e[2]);
        // One end without cancellation; the product of both is known.
        const double far = middle + copysign(radius, middle), near = -(other * other + 1) / far;
        for (int end = 0; end < 2; end++) {
            const double at = end ? near : far;
            double m[3], am[3], mb[3];
            m[axis] = 2 * at;
            m[1 - axis] = 2 * other;
            m[2] = 1 - at * at - other * other;
            vplCross3(a, m, am);
            vplCross3(m, b, mb);
            if (vplDot3(am, e) >= 0 && vplDot3(mb, e) >= 0) {
                widen(box, axis, at);
            }
        }
    }
}

static inline int32_t firstCentre(double low, int32_t size)
{
    const double at = (low + 1) * 0.5 * size + 0.5 - (double)MARGIN;
    return at > 0 ? at < size ? (int32_t)at : size : 0;
}

static inline int32_t lastCentre(double high, int32_t size)
{
    const double at = (high + 1) * 0.5 * size + 0.5 + (double)MARGIN;
    return at > 0 ? at < size ? (int32_t)at - 1 : size - 1 : -1;
}

// Texels whose centres may lie in a triangle, anywhere.
static Texels boundsOf(const vplVec3 corner[3], int32_t size)
{
    const Texels all = {0, size - 1, 0, size - 1};
    Box box = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}};
    double p[3][3], e[3][3], n[3];
    for (int k = 0; k < 3; k++) {
        vplToDouble3(corner[k], p[k]);
        const double across = p[k][0] * p[k][0] + p[k][1] * p[k][1], z = p[k][2];
        const double length = sqrt(across + z * z);
        if (!(across > 0) && !(z > 0)) { // the eye itself, or straight behind it
            return all;
        }
        const double scale = z >= 0 ? 1 / (length + z) : (length - z) / across;
        widen(&box, 0, p[k][0] * scale);
        widen(&box, 1, p[k][1] * scale);
    }
    bool behind = true; // is what lies straight behind the eye in the triangle?
    vplCross3(p[1], p[2], n);
    const double side = vplDot3(n, p[0]) > 0 ? 1 : -1;
    for (int k = 0; k < 3; k++) {
        vplCross3(p[k], p[(k + 1) % 3], e[k]);
        behind = behind && -side * e[k][2] >= -1e-9 * sqrt(vplDot3(e[k], e[k]));
        widenByArc(&box, p[k], p[(k + 1) % 3], e[k]);
    }
    return behind ? all
                  : (Texels){firstCentre(box.low[0], size), lastCentre(box.high[0], size),
                             firstCentre(box.low[1], size), lastCentre(box.high[1], size)};
}

#endif
