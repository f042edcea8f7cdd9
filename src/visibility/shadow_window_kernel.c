// SPDX-License-Identifier: MIT
// One look instead of many samples: from the window of the cube map that holds all samples of a point, whether
// they all say lit or all say shadowed. Compiled once per instruction set.
//
// Let p be the point seen from the light, r its distance, R the reach of the samples' offsets, which are
// perpendicular to p, and m the largest of p's components, which picks the face.
// Which texels: a sample at p + d, |d| <= R, lies in the face's plane at a distance of at most
// |d| sqrt(1 + s^2) / (m - R) from p's own s = right / m, and the same with u = up / m; sqrt(1 + s^2) is at most
// 1 + s^2 / 2. If that square lies inside the face, so do all samples, and the window at its corner, of a level
// where windows start at least every width of the square, holds it.
// Shadowed: all samples are if the limit exceeds the window's farthest distance times far, the expression that
// every sample compares, which is monotone.
// Lit: a texel in direction d at distance D lies behind the plane, (plane . d) D >= 1, so limit (plane . d) <= 1 is
// enough. The angle between p and d is at most that of the offset, whose tangent is k = R / r, and that between the
// sample and its texel's centre. The latter has a tangent of at most e / (|c| - e sin c) where e = texelTangent,
// c = (s, u, 1) at the sample, and sin c is the sine of its angle to the middle of the face. The sample's |c| is at
// least p's own, r / m, less sin p times the R / (m - R) r / m that they are apart at most, because |c| is convex.
// With t the tangent of the latter, the angle a of both has tan a = (t + k) / (1 - t k) and
// cos a = (1 - t k) / sqrt((1 + t^2) (1 + k^2)). If the plane's normal is further from p than a, plane . d is at most
// along cos a + across sin a, with the normal's parts along p and across, otherwise at most its length.
// Rounding: the direction of a sample is known to some ten roundings of 2^-24 (9 of the angle, 8192 texels: 2^-9
// texel), the frame of offsets to 2^-18 of their length (`reach` has 1e-5 more), `most` and `length` to twelve
// roundings of the normal's length. The margins below are 16 each.
#include "base/isa.h"
#include "visibility/cube_bounds.h"
#include "visibility/gather.h"
#include "visibility/shadow.h"

#include <math.h>
#include <string.h>

static inline float maxOf(float a, float b)
{
    return a > b ? a : b;
}

// Points in the axes of the faces that they fall on, and the squares of texels that their samples reach.
typedef struct Squares {
    float right[VPL_LANES], up[VPL_LANES], major[VPL_LANES];
    float column[VPL_LANES], row[VPL_LANES]; // first, in texels
    float width[VPL_LANES];                  // in texels; 0 where the square is of no use
    float spread[VPL_LANES];                 // least radius in units of the distance to the face's plane
    int32_t face[VPL_LANES];
} Squares;

// The bounds of the points' windows.
typedef struct Windows {
    float planes[2][3][VPL_LANES], farthest[VPL_LANES];
    int32_t kind[VPL_LANES];
} Windows;

static void findSquares(const vplShadow* shadow, const vplShadowPoints* p, Squares* restrict q)
{
    const float reach = shadow->reach, size = (float)shadow->map->size, half = 0.5f * size;
    const float slack = 0x1p-6f; // texels
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = p->x[l], y = p->y[l], z = p->z[l];
        const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
        const int32_t isZ = (az >= ax) & (az >= ay), isY = !isZ & (ay >= ax);
        const float major = isZ ? az : isY ? ay : ax;
        const int32_t negative = (isZ ? z : isY ? y : x) < 0;
        const float sign = negative ? -1.0f : 1.0f; // a product vectorises where a choice of -x or x does not
        const float right = isZ ? x * sign : isY ? x : -z * sign, up = isY ? -z * sign : y;
        const float inverse = 1 / maxOf(major, 1e-30f);
        const float s = right * inverse, u = up * inverse, k = reach * inverse;
        // 1 / (1 - k) <= 1 + 4/3 k for k <= 1/4
        const float spread = k * (1 + 1.3334f * k);
        const float reachS = spread * (1 + 0.5f * s * s), reachU = spread * (1 + 0.5f * u * u);
        const float column = (s + 1 - reachS) * half - slack, columnEnd = (s + 1 + reachS) * half + slack;
        const float row = (1 - u - reachU) * half - slack, rowEnd = (1 - u + reachU) * half + slack;
        const float first = column < row ? column : row, end = maxOf(columnEnd, rowEnd);
        float width = maxOf(columnEnd - column, rowEnd - row);
        width = first >= 0 ? width : 0;
        width = end <= size ? width : 0;
        width = k <= 0.25f ? width : 0;
        q->right[l] = right;
        q->up[l] = up;
        q->major[l] = major;
        q->column[l] = column;
        q->row[l] = row;
        q->width[l] = width;
        q->spread[l] = spread;
        q->face[l] = (isZ ? 4 : isY ? 2 : 0) + negative;
    }
}

// The lowest level with windows at least every width of the widest square; -1 where there is none.
static int findLevel(const vplCubeBounds* bounds, const Squares* q)
{
    int32_t widest = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t width = (int32_t)q->width[l] + 1;
        widest = width > widest ? width : widest;
    }
    int level = 0;
    while (level < bounds->levelCount && (bounds->tile << level) < widest) {
        level++;
    }
    return level < bounds->levelCount ? level : -1;
}

// The bounds of the points' windows. Returns whether any has two planes.
static bool findWindows(const vplCubeBounds* bounds, int level, const Squares* q, Windows* restrict w)
{
    const int shift = bounds->tileShift + level, side = bounds->side[level];
    int32_t index[VPL_LANES], different = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const float column = q->width[l] > 0 ? q->column[l] : 0, row = q->width[l] > 0 ? q->row[l] : 0;
        index[l] = (q->face[l] * side + ((int32_t)row >> shift)) * side + ((int32_t)column >> shift);
    }
    for (int l = 0; l < VPL_LANES; l++) {
        different |= index[l] ^ index[0];
    }
    const vplCubeBound* first = bounds->bounds + bounds->first[level];
    if (!different) { // two of three blocks
        const vplCubeBound b = first[index[0]];
        for (int l = 0; l < VPL_LANES; l++) {
            for (int c = 0; c < 3; c++) {
                w->planes[0][c][l] = b.planes[0][c];
                w->planes[1][c][l] = b.planes[1][c];
            }
            w->farthest[l] = b.farthest;
            w->kind[l] = b.kind;
        }
        return b.kind != VPL_BOUND_ONE;
    }
    int32_t kinds = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        w->kind[l] = first[index[l]].kind;
        kinds |= w->kind[l];
        index[l] *= sizeof *first / sizeof(float);
    }
    const float* entries = first->planes[0];
    for (int c = 0; c < 3; c++) {
        vplGather(entries + c, index, w->planes[0][c]);
        vplGather(entries + 3 + c, index, w->planes[1][c]);
    }
    vplGather(entries + 6, index, w->farthest);
    return kinds != 0;
}

// What a plane is compared with, by lane: see the top of the file.
typedef struct Cones {
    float x[VPL_LANES], y[VPL_LANES], z[VPL_LANES]; // unit direction of the point, in the axes of its face
    float cosine[VPL_LANES], sine[VPL_LANES];       // of a, times `length`
    float length[VPL_LANES];
    int32_t usable[VPL_LANES];
} Cones;

static void findCones(const vplShadow* shadow, const vplShadowPoints* p, const Squares* q, Cones* restrict c)
{
    const float texel = shadow->texelTangent, reach = shadow->reach;
    for (int l = 0; l < VPL_LANES; l++) {
        const float inverse = p->inverse[l];
        const float dx = q->right[l] * inverse, dy = q->up[l] * inverse, dz = q->major[l] * inverse;
        // The face is nearest in its middle: a step towards it brings it nearer by the step times the slant.
        // sqrt(a^2 + b^2) <= a + 0.4143 b for a >= b >= 0
        const float ax = fabsf(dx), ay = fabsf(dy);
        const float oblique = maxOf(ax, ay) + 0.4143f * (ax < ay ? ax : ay),
                    moved = q->spread[l] + texel * dz;
        const float nearer = (oblique + texel) * moved + 0x1p-20f;
        const float t = texel * dz * (1 + 1.3334f * nearer) + 0x1p-20f, k = reach * inverse;
        c->x[l] = dx;
        c->y[l] = dy;
        c->z[l] = dz;
        c->cosine[l] = 1 - t * k;
        c->sine[l] = t + k;
        const float more = t * t + k * k * (1 + t * t);
        c->length[l] = 1 + more * (0.5f - 0.125f * more); // not more than sqrt(1 + more)
        c->usable[l] = (q->width[l] > 0) & (nearer <= 0.25f);
    }
}

// Whether the cones of the points lie before a plane.
static void testPlane(const vplShadowPoints* p, const Cones* c, const float plane[3][VPL_LANES],
                      int32_t lit[restrict VPL_LANES])
{
    for (int l = 0; l < VPL_LANES; l++) {
        const float dx = c->x[l], dy = c->y[l], dz = c->z[l];
        const float nx = plane[0][l], ny = plane[1][l], nz = plane[2][l];
        const float along = nx * dx + ny * dy + nz * dz;
        const float cx = nx - along * dx, cy = ny - along * dy, cz = nz - along * dz;
        const float square = cx * cx + cy * cy + cz * cz, across = sqrtf(square);
        const bool steep = across * c->cosine[l] >= along * c->sine[l];
        const float slanted = along * c->cosine[l] + across * c->sine[l];
        const float whole = sqrtf(along * along + square) * c->length[l];
        const float most = (steep ? slanted : whole) + (fabsf(along) + across) * 0x1p-21f;
        lit[l] = p->limit[l] * most <= c->length[l] * (1 - 0x1p-21f);
    }
}

vplShadowWindowFcn VPL_KERNEL(vplShadowWindow);

int VPL_KERNEL(vplShadowWindow)(const vplShadow* shadow, vplShadowPoints* restrict p,
                                int32_t known[restrict VPL_LANES], float shadowed[restrict VPL_LANES])
{
    const vplCubeBounds* bounds = shadow->map->bounds;
    Squares q;
    findSquares(shadow, p, &q);
    for (int l = 0; l < VPL_LANES; l++) {
        known[l] = 0;
        p->face[l] = q.width[l] > 0 ? q.face[l] : -1;
    }
    const int level = findLevel(bounds, &q);
    if (level < 0) {
        return 0;
    }
    Windows w;
    Cones cones;
    int32_t lit[VPL_LANES];
    const bool twoPlanes = findWindows(bounds, level, &q, &w);
    findCones(shadow, p, &q, &cones);
    testPlane(p, &cones, w.planes[0], lit);
    if (twoPlanes) {
        int32_t second[VPL_LANES];
        testPlane(p, &cones, w.planes[1], second);
        for (int l = 0; l < VPL_LANES; l++) {
            lit[l] = w.kind[l] == VPL_BOUND_BOTH ? lit[l] & second[l] : lit[l] | second[l];
        }
    }
    const float far = shadow->map->far, samples = (float)shadow->def.pcfSamples;
    int32_t count = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t dark = p->limit[l] > w.farthest[l] * far;
        known[l] = cones.usable[l] & (lit[l] | dark);
        shadowed[l] = dark ? samples : 0;
        count += known[l];
    }
    return count;
}
