// SPDX-License-Identifier: MIT
// Fills one triangle into a hemi-octahedral map. Included by the kernel that draws them.
//
// A texel at (u, v) in [-1, 1]^2 has the direction d = (p, q, 1 - |p| - |q|), p = (u + v) / 2, q = (u - v) /
// 2, in the light's frame; where p and q keep their signs d is linear in u and v. A point t d lies on a
// triangle's plane where 1/t = n.d / n.corner, which is linear, too, and the nearest is the largest.
#ifndef VPL_VISIBILITY_HEMI_FILL_H
#define VPL_VISIBILITY_HEMI_FILL_H

#include "math/double3.h"
#include "visibility/hemi_map.h"
#include "visibility/map_fill.h"

// ---- one triangle

// The coefficients of e.d = a + b u + c v in one quadrant, where p has the sign of `right` and q that of
// `up`.
static inline Coefficients linearOf(vplVec3 e, float right, float up)
{
    const float p = e.x - right * e.z, q = e.y - up * e.z;
    return (Coefficients){e.z, 0.5f * (p + q), 0.5f * (p - q)};
}

// Twice a x b.
static inline vplVec3 edgeOf(vplVec3 a, vplVec3 b)
{
    return vplCross(vplSub(a, b), vplAdd(a, b));
}

// The signs of a quadrant, or 0 for triangles that lie within theirs, whose texels need no test.
typedef struct Quadrant {
    float right, up;
} Quadrant;

// Returns whether the triangle may be seen: seen along its own plane it hides nothing.
static inline int32_t setUp(vplVec3 p0, vplVec3 p1, vplVec3 p2, float right, float up, Filling* f)
{
    Planes planes;
    const int32_t seen = planesOf(p0, p1, p2, edgeOf, &planes);
    f->near = linearOf(planes.near, right, up);
    for (int e = 0; e < 3; e++) {
        f->edge[e] = linearOf(planes.edge[e], right, up);
    }
    return seen;
}

// Fills the texels of one row of blocks that lie in the quadrant.
static inline void fillRow(const Filling* restrict f, BlockRow blocks, Quadrant quadrant,
                           float* restrict texels)
{
    const int32_t row = blocks.row;
    const float scale = blocks.scale;
    const float u0 = f->edge[0].b, u1 = f->edge[1].b, u2 = f->edge[2].b, nearU = f->near.b;
    const float right = quadrant.right, up = quadrant.up;
    float v[VPL_LANES], e0[VPL_LANES], e1[VPL_LANES], e2[VPL_LANES], near[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        v[l] = (float)(2 * (SIDE * row + l / SIDE) + 1) * scale - 1;
        e0[l] = f->edge[0].a + f->edge[0].c * v[l];
        e1[l] = f->edge[1].a + f->edge[1].c * v[l];
        e2[l] = f->edge[2].a + f->edge[2].c * v[l];
        near[l] = f->near.a + f->near.c * v[l];
    }
    for (int32_t i = blocks.first; i <= blocks.last; i++) {
        float old[VPL_LANES], now[VPL_LANES];
        memcpy(old, texels + (size_t)i * VPL_LANES, sizeof old);
        for (int l = 0; l < VPL_LANES; l++) {
            const float u = (float)(2 * (SIDE * i + l % SIDE) + 1) * scale - 1;
            const float a = e0[l] + u0 * u, b = e1[l] + u1 * u, c = e2[l] + u2 * u;
            const float p = right * (u + v[l]), q = up * (u - v[l]), value = near[l] + nearU * u;
            const float ab = a < b ? a : b, pq = p < q ? p : q;
            const float abc = ab < c ? ab : c;
            const float before = old[l];
            const float nearer = value > before ? value : before;
            now[l] = ((abc >= 0) & (pq >= 0)) ? nearer : before;
        }
        memcpy(texels + (size_t)i * VPL_LANES, now, sizeof now);
    }
}

static inline void fill(const vplHemiMap* map, const Filling* f, Texels box, Quadrant quadrant, float* texels)
{
    const float scale = 1 / (float)map->size;
    const size_t stride = (size_t)vplHemiMap_Blocks(map->size) * VPL_LANES;
    for (int32_t row = box.j0 / SIDE; row <= box.j1 / SIDE; row++) {
        fillRow(f, (BlockRow){row, box.i0 / SIDE, box.i1 / SIDE, scale}, quadrant,
                texels + (size_t)row * stride);
    }
}

// ---- triangles that cross the horizon or the axes: cut for their bounds, then filled whole

enum { MAX_CUT = 6 };

// Cuts a polygon down to where side . point >= 0.
static int cut(double (*restrict points)[3], int count, const double side[3])
{
    double from[MAX_CUT][3];
    int kept = 0;
    memcpy(from, points, (size_t)count * sizeof *from);
    for (int i = 0; i < count; i++) {
        const double *a = from[i], *b = from[(i + 1) % count];
        const double da = vplDot3(side, a), db = vplDot3(side, b);
        if (da >= 0) {
            memcpy(points[kept++], a, sizeof from[0]);
        }
        if ((da >= 0) != (db >= 0)) {
            const double t = da / (da - db);
            for (int k = 0; k < 3; k++) {
                points[kept][k] = a[k] + t * (b[k] - a[k]);
            }
            kept++;
        }
    }
    return kept;
}

static Texels boundsOf(double (*points)[3], int count, int size)
{
    double low[2] = {2, 2}, high[2] = {-2, -2};
    for (int i = 0; i < count; i++) {
        const double x = points[i][0], y = points[i][1], w = fabs(x) + fabs(y) + fabs(points[i][2]);
        if (!(w > 0)) { // the eye itself: in every direction
            return (Texels){0, size - 1, 0, size - 1};
        }
        const double at[2] = {(x + y) / w, (x - y) / w};
        for (int k = 0; k < 2; k++) {
            low[k] = at[k] < low[k] ? at[k] : low[k];
            high[k] = at[k] > high[k] ? at[k] : high[k];
        }
    }
    const double half = 0.5 * size, least = 0.5 - (double)MARGIN, most = 0.5 + (double)MARGIN;
    return (Texels){(int32_t)((low[0] + 1) * half + least), (int32_t)((high[0] + 1) * half + most) - 1,
                    (int32_t)((low[1] + 1) * half + least), (int32_t)((high[1] + 1) * half + most) - 1};
}

static bool reaches(const vplVec3 corner[3], float right, float up)
{
    return (corner[0].x * right > 0 || corner[1].x * right > 0 || corner[2].x * right > 0) &&
           (corner[0].y * up > 0 || corner[1].y * up > 0 || corner[2].y * up > 0);
}

static void fillCut(const vplHemiMap* map, const vplVec3 corner[3], float* texels)
{
    for (int quadrant = 0; quadrant < 4; quadrant++) {
        const float right = quadrant & 1 ? -1 : 1, up = quadrant & 2 ? -1 : 1;
        if (!reaches(corner, right, up)) {
            continue;
        }
        double points[MAX_CUT][3];
        for (int i = 0; i < 3; i++) {
            vplToDouble3(corner[i], points[i]);
        }
        int count = cut(points, 3, (const double[]){0, 0, 1});
        count = count > 0 ? cut(points, count, (const double[]){(double)right, 0, 0}) : 0;
        count = count > 0 ? cut(points, count, (const double[]){0, (double)up, 0}) : 0;
        Filling f;
        const Texels box = boundsOf(points, count, map->size);
        if (count > 0 && box.i0 <= box.i1 && box.j0 <= box.j1 &&
            setUp(corner[0], corner[1], corner[2], right, up, &f)) {
            fill(map, &f, box, (Quadrant){right, up}, texels);
        }
    }
}

#endif
