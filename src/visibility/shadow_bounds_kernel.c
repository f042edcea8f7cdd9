// SPDX-License-Identifier: MIT
// Tests 16 points against the bounds of a cube map. Compiled once per instruction set; all give the same
// bits.
//
// Let p be a point seen from the light, r its distance, R the reach of the samples' offsets, which are
// perpendicular to p, and m the largest of p's components, which picks the face. Texels: a sample at p + d,
// |d| <= R, lies in the face's plane at a distance of at most |d| sqrt(1 + s^2) / (m - R) from p's own s =
// right / m, and the same with u = up / m; sqrt(1 + s^2) is at most 1 + s^2 / 2. If that square lies inside
// the face, so do all samples. The regions that meet the squares of all 16 points bound every texel that is
// sampled. Shadowed: all samples are if the limit exceeds the farthest distance times far, the expression
// that every sample compares, which is monotone. Lit: the same with the nearest distance. Lit by the
// receiver's plane: let n be its normal and h > 0 the least n.q of all points q in the regions' box. A texel
// in direction d shows q = D d, so D >= h / n.d, and limit (n.d) <= h is enough. The angle between p and d is
// at most that of the offset, whose tangent is k = R / r, and that between the sample and its texel's centre.
// The latter has a tangent of at most e / (|c| - e sin c) where e = texelTangent, c = (s, u, 1) at the
// sample, and sin c is the sine of its angle to the middle of the face. The sample's |c| is at least p's own,
// r / m, less sin p times the R / (m - R) r / m that they are apart at most, because |c| is convex. With t
// the tangent of the latter, the angle a of both has tan a = (t + k) / (1 - t k) and cos a = (1 - t k) /
// sqrt((1 + t^2) (1 + k^2)). If n is further from p than a, n.d is at most along cos a + across sin a, with
// the normal's parts along p and across, otherwise at most its length. Rounding: the direction of a sample is
// known to some ten roundings of 2^-24 (9 of the angle, 8192 texels: 2^-9 texel), the frame of offsets to
// 2^-18 of their length (`reach` has 1e-5 more), `most` and `length` to twelve roundings of the normal's
// length, h to three of its terms. The margins below are 16 each, 4 for h.
#include "visibility/cube_bounds.h"
#include "visibility/cube_texel.h"
#include "visibility/kernels.h"

#include <string.h>

// Points in the axes of the faces that they fall on, and the squares of texels that their samples reach.
typedef struct Squares {
    float x[VPL_LANES], y[VPL_LANES], z[VPL_LANES];
    float left[VPL_LANES], top[VPL_LANES];     // first column and row, in texels
    float right[VPL_LANES], bottom[VPL_LANES]; // last ones, negated
    float spread[VPL_LANES];                   // least radius in units of the distance to the face's plane
} Squares;

static void findSquares(const vplShadow* shadow, vplShadowPoints* restrict p, Squares* restrict q)
{
    const float size = (float)shadow->map->size, half = 0.5f * size;
    const float slack = 0x1p-6f; // texels
    for (int l = 0; l < VPL_LANES; l++) {
        const float x = p->x[l], y = p->y[l], z = p->z[l];
        const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z);
        const int32_t isZ = (az >= ax) & (az >= ay), isY = !isZ & (ay >= ax);
        const float major = isZ ? az : isY ? ay : ax;
        const int32_t negative = (isZ ? z : isY ? y : x) < 0;
        const float sign = negative ? -1.0f : 1.0f; // a product vectorises where a choice of -x or x does not
        const float right = isZ ? x * sign : isY ? x : -z * sign, up = isY ? -z * sign : y;
        const float inverse = 1 / vplMaxf(major, 1e-30f);
        const float s = right * inverse, u = up * inverse, k = shadow->reach * p->radius[l] * inverse;
        // 1 / (1 - k) <= 1 + 4/3 k for k <= 1/4
        const float spread = k * (1 + 1.3334f * k);
        const float reachS = spread * (1 + 0.5f * s * s), reachU = spread * (1 + 0.5f * u * u);
        const float column = (s + 1 - reachS) * half - slack, columnEnd = (s + 1 + reachS) * half + slack;
        const float row = (1 - u - reachU) * half - slack, rowEnd = (1 - u + reachU) * half + slack;
        const float first = vplMinf(column, row), end = vplMaxf(columnEnd, rowEnd);
        const int32_t inside = (first >= 0) & (end <= size) & (k <= 0.25f) & (major > 1e-30f);
        const int32_t face = (isZ ? 4 : isY ? 2 : 0) + negative;
        q->x[l] = right;
        q->y[l] = up;
        q->z[l] = major;
        q->left[l] = column;
        q->top[l] = row;
        q->right[l] = -columnEnd;
        q->bottom[l] = -rowEnd;
        q->spread[l] = spread;
        p->face[l] = inside ? face : -1;
    }
}

// Regions along a side that are read at most: fewer are larger and bound less tightly.
enum { READ_SIDE = 4 };

// Bounds all texels that the points' samples may reach. False where these do not lie in one face.
static bool findRegion(const vplCubeMap* map, const vplShadowPoints* p, const Squares* q,
                       vplCubeRegion* restrict region)
{
    int32_t different = p->face[0] < 0;
    for (int l = 0; l < VPL_LANES; l++) {
        different |= p->face[l] ^ p->face[0];
    }
    if (different) {
        return false;
    }
    const vplCubeBounds* bounds = map->bounds;
    const int last = map->size - 1, i0 = (int)vplLeastLane(q->left), j0 = (int)vplLeastLane(q->top);
    const int i1 = vplMini((int)-vplLeastLane(q->right), last),
              j1 = vplMini((int)-vplLeastLane(q->bottom), last);
    int shift = VPL_REGION_SHIFT, level = 0;
    while ((i1 >> shift) - (i0 >> shift) >= READ_SIDE || (j1 >> shift) - (j0 >> shift) >= READ_SIDE) {
        shift++;
        level++;
    }
    const int side = bounds->side[level];
    const vplCubeRegion* first = bounds->regions + bounds->first[level] + p->face[0] * side * side;
    float all[VPL_REGION_VALUES];
    memcpy(all, first[(j0 >> shift) * side + (i0 >> shift)].least, sizeof all);
    for (int j = j0 >> shift; j <= j1 >> shift; j++) {
        for (int i = i0 >> shift; i <= i1 >> shift; i++) {
            const float* restrict least = first[j * side + i].least;
#pragma GCC unroll 1 // gcc would unroll it before it thinks of a vector
            for (int k = 0; k < VPL_REGION_VALUES; k++) {
                all[k] = vplMinf(least[k], all[k]);
            }
        }
    }
    memcpy(region->least, all, sizeof all);
    return true;
}

// The directions and angles that planes are compared with, by lane; the top of the file derives them.
typedef struct Cones {
    float x[VPL_LANES], y[VPL_LANES], z[VPL_LANES]; // unit direction of the point, in the axes of its face
    float cosine[VPL_LANES], sine[VPL_LANES];       // of a, times `length`
    float length[VPL_LANES];
    int32_t usable[VPL_LANES];
} Cones;

static void findCones(const vplShadow* shadow, const vplShadowPoints* p, const Squares* q, Cones* restrict c)
{
    const float texel = shadow->texelTangent;
    for (int l = 0; l < VPL_LANES; l++) {
        const float inverse = p->inverse[l];
        const float dx = q->x[l] * inverse, dy = q->y[l] * inverse, dz = q->z[l] * inverse;
        // The face is nearest in its middle: a step towards it brings it nearer by the step times the slant.
        // sqrt(a^2 + b^2) <= a + 0.4143 b for a >= b >= 0
        const float ax = fabsf(dx), ay = fabsf(dy);
        const float oblique = vplMaxf(ax, ay) + 0.4143f * vplMinf(ax, ay), moved = q->spread[l] + texel * dz;
        const float nearer = (oblique + texel) * moved + 0x1p-20f;
        const float t = texel * dz * (1 + 1.3334f * nearer) + 0x1p-20f,
                    k = shadow->reach * p->radius[l] * inverse;
        const float more = t * t + k * k * (1 + t * t);
        c->x[l] = dx;
        c->y[l] = dy;
        c->z[l] = dz;
        c->cosine[l] = 1 - t * k;
        c->sine[l] = t + k;
        c->length[l] = 1 + more * (0.5f - 0.125f * more); // not more than sqrt(1 + more)
        c->usable[l] = nearer <= 0.25f;
    }
}

// Tests whether the receiver's plane at each point lies before all points of the region, as seen from the
// light.
static void testPlanes(const vplShadowPoints* p, const Cones* c, const vplSurface* axes,
                       const vplCubeRegion* region, int32_t lit[restrict VPL_LANES])
{
    const float* low = region->least + VPL_LEAST_POINT;
    const float* high = region->least + VPL_LEAST_NEGATED; // negated
    for (int l = 0; l < VPL_LANES; l++) {
        const float dx = c->x[l], dy = c->y[l], dz = c->z[l];
        const float towards = axes->nx[l] * dx + axes->ny[l] * dy + axes->nz[l] * dz;
        const float sign = towards < 0 ? -1.0f : 1.0f; // away from the light
        const float nx = axes->nx[l] * sign, ny = axes->ny[l] * sign, nz = axes->nz[l] * sign;
        const float along = towards * sign;
        const float cx = nx - along * dx, cy = ny - along * dy, cz = nz - along * dz;
        const float square = cx * cx + cy * cy + cz * cz, across = sqrtf(square);
        const bool steep = across * c->cosine[l] >= along * c->sine[l];
        const float slanted = along * c->cosine[l] + across * c->sine[l];
        const float whole = sqrtf(along * along + square) * c->length[l];
        const float most = (steep ? slanted : whole) + (along + across) * 0x1p-21f;
        const float hx = vplMinf(nx * low[0], -nx * high[0]), hy = vplMinf(ny * low[1], -ny * high[1]);
        const float hz = vplMinf(nz * low[2], -nz * high[2]);
        const float h = hx + hy + hz - (fabsf(hx) + fabsf(hy) + fabsf(hz)) * 0x1p-22f;
        lit[l] = (h > 1e-30f) & (p->limit[l] * most <= c->length[l] * h * (1 - 0x1p-21f));
    }
}

// The surface's normals in the axes of a face.
static void turnNormals(int32_t face, const vplSurface* surface, vplSurface* restrict axes)
{
    for (int l = 0; l < VPL_LANES; l++) {
        const vplInFace n = vplTurnToFace(face, surface->nx[l], surface->ny[l], surface->nz[l]);
        axes->nx[l] = n.right;
        axes->ny[l] = n.up;
        axes->nz[l] = n.major;
    }
}

int VPL_KERNEL(vplTestBounds)(const vplShadow* shadow, const vplSurface* surface, vplShadowPoints* restrict p,
                              int32_t known[restrict VPL_LANES], float shadowed[restrict VPL_LANES])
{
    Squares q;
    vplCubeRegion region;
    findSquares(shadow, p, &q);
    memset(known, 0, VPL_LANES * sizeof *known);
    if (shadow->map->bounds == NULL || !findRegion(shadow->map, p, &q, &region)) {
        return 0;
    }
    Cones cones;
    vplSurface axes;
    int32_t lit[VPL_LANES], count = 0;
    findCones(shadow, p, &q, &cones);
    turnNormals(p->face[0], surface, &axes);
    testPlanes(p, &cones, &axes, &region, lit);
    const float nearest = region.least[VPL_LEAST_DISTANCE] * shadow->map->farPlane;
    const float farthest = -region.least[VPL_LEAST_NEGATED_DISTANCE] * shadow->map->farPlane,
                samples = (float)shadow->def.pcfSamples;
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t dark = p->limit[l] > farthest, free = p->limit[l] <= nearest;
        known[l] = dark | free | (lit[l] & cones.usable[l]);
        shadowed[l] = dark ? samples : 0;
        count += known[l];
    }
    return count;
}
