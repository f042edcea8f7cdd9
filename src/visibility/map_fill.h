// SPDX-License-Identifier: MIT
// Shared by the rasterizers of hemi-octahedral and paraboloid maps. They walk down the ray tree as far
// as it reaches above a plane, take sixteen triangles side by side, turn them to the eye, and find planes
// through it.
// Based on: Marc Olano and Trey Greer, Triangle Scan Conversion using 2D Homogeneous Coordinates, Graphics
// Hardware 1997: inside is where three planes through the eye say so, so that nothing is clipped. The planes
// are Pluecker's (as in Embree): they are exact negatives for both triangles at an edge, and no texel between
// them is lost.
#ifndef VPL_VISIBILITY_MAP_FILL_H
#define VPL_VISIBILITY_MAP_FILL_H

#include <vpl/raster.h>

#include "geometry/bvh.h"
#include "math/vec.h"

#include <math.h>
#include <string.h>

enum { SIDE = VPL_BLOCK_SIDE };

// Columns i0 to i1 and rows j0 to j1.
typedef struct Texels {
    int32_t i0, i1, j0, j1;
} Texels;

// Blocks `first` to `last` of a row of blocks; scale is 1 / size.
typedef struct BlockRow {
    int32_t row, first, last;
    float scale;
} BlockRow;

// Bounds are wider by this much of a texel, which covers the rounding of projected corners.
static const float MARGIN = 0x1p-9f;

// The place and frame that a map is drawn from; right, up and forward are unit.
typedef struct Eye {
    vplVec3 position, right, up, forward;
} Eye;

// ---- one triangle, in the eye's frame

typedef struct Planes {
    vplVec3 edge[3]; // a direction d is inside where no edge.d is negative
    vplVec3 near;    // 1/t, where t d meets the triangle's plane, is near.d
} Planes;

// A multiple of p x q: odd in the exchange of its ends to the last bit.
typedef vplVec3 EdgeFcn(vplVec3 p, vplVec3 q);

// Returns whether it may be seen: from its edge a triangle hides nothing.
static inline __attribute__((always_inline)) int32_t planesOf(vplVec3 p0, vplVec3 p1, vplVec3 p2,
                                                              EdgeFcn* edge, Planes* planes)
{
    const vplVec3 n = vplCross(vplSub(p1, p0), vplSub(p2, p0));
    const float x = n.x * p0.x, y = n.y * p0.y, z = n.z * p0.z, k = x + y + z;
    const float sign = k > 0 ? 1.0f : -1.0f, inverse = 1 / k;
    planes->near = vplScale(inverse, n);
    planes->edge[0] = vplScale(sign, edge(p0, p1));
    planes->edge[1] = vplScale(sign, edge(p1, p2));
    planes->edge[2] = vplScale(sign, edge(p2, p0));
    return (fabsf(k) > 0x1p-20f * (fabsf(x) + fabsf(y) + fabsf(z))) & (fabsf(inverse) < INFINITY);
}

// The same planes as functions of a texel's column and row. The maps choose the functions; each has three
// coefficients.
typedef struct Coefficients {
    float a, b, c;
} Coefficients;

typedef struct Filling {
    Coefficients edge[3], near;
} Filling;

// ---- sixteen triangles

typedef struct Sixteen {
    float x[3][VPL_LANES], y[3][VPL_LANES],
        z[3][VPL_LANES]; // corners, first in the world, then in the eye's frame
    int32_t id[VPL_LANES];
} Sixteen;

// Sixteen Fillings, lane by lane, with the texels that each may cover and its kind, UNSEEN to CROSSING.
typedef struct Fillings {
    float edge[3][3][VPL_LANES], near[3][VPL_LANES];
    int32_t box[4][VPL_LANES], kind[VPL_LANES];
} Fillings;

enum { UNSEEN = 0, INSIDE, CROSSING };

// Corners in the eye's frame.
static inline void turn(Eye eye, Sixteen* restrict s)
{
    const vplVec3 o = eye.position, r = eye.right, u = eye.up, f = eye.forward;
    for (int k = 0; k < 3; k++) {
        for (int l = 0; l < VPL_LANES; l++) {
            const float x = s->x[k][l] - o.x, y = s->y[k][l] - o.y, z = s->z[k][l] - o.z;
            s->x[k][l] = x * r.x + y * r.y + z * r.z;
            s->y[k][l] = x * u.x + y * u.y + z * u.z;
            s->z[k][l] = x * f.x + y * f.y + z * f.z;
        }
    }
}

static inline vplVec3 cornerOf(const Sixteen* s, int k, int l)
{
    return vplVec(s->x[k][l], s->y[k][l], s->z[k][l]);
}

static inline void storeFilling(const Filling* f, int l, Fillings* restrict all)
{
    for (int e = 0; e < 3; e++) {
        all->edge[e][0][l] = f->edge[e].a;
        all->edge[e][1][l] = f->edge[e].b;
        all->edge[e][2][l] = f->edge[e].c;
    }
    all->near[0][l] = f->near.a;
    all->near[1][l] = f->near.b;
    all->near[2][l] = f->near.c;
}

static inline Filling loadFilling(const Fillings* all, int l)
{
    Filling f = {.near = {all->near[0][l], all->near[1][l], all->near[2][l]}};
    for (int e = 0; e < 3; e++) {
        f.edge[e] = (Coefficients){all->edge[e][0][l], all->edge[e][1][l], all->edge[e][2][l]};
    }
    return f;
}

// Two blocks of eight become sixteen; `second` may be NULL.
static inline void pair(const vplTriangleBlock* first, const vplTriangleBlock* second, Sixteen* s)
{
    const vplTriangleBlock* other = second != NULL ? second : first;
    for (int k = 0; k < 3; k++) {
        float* to[3] = {s->x[k], s->y[k], s->z[k]};
        for (int axis = 0; axis < 3; axis++) {
            memcpy(to[axis], first->p[k][axis], sizeof first->p[k][axis]);
            memcpy(to[axis] + VPL_BVH_WIDTH, other->p[k][axis], sizeof other->p[k][axis]);
        }
    }
    memcpy(s->id, first->id, sizeof first->id);
    memcpy(s->id + VPL_BVH_WIDTH, other->id, sizeof other->id);
}

// ---- the tree

typedef uint32_t ChooseChildrenFcn(const void* data, const vplBvhNode* node);
typedef void DrawSixteenFcn(const void* data, Sixteen* sixteen);

// Draws all triangles of the chosen children. Inlined, calls and all.
static inline __attribute__((always_inline)) void walk(const vplBvh* bvh, ChooseChildrenFcn* choose,
                                                       DrawSixteenFcn* draw, const void* data)
{
    const vplTriangleBlock* waiting = NULL;
    int32_t stack[VPL_BVH_DEPTH * VPL_BVH_WIDTH];
    int depth = 0;
    Sixteen s;
    for (int i = 0; bvh->nodes == NULL && i < bvh->blockCount; i++) {
        stack[depth++] = ~i;
    }
    if (bvh->nodes != NULL) {
        stack[depth++] = 0;
    }
    while (depth > 0) {
        const int32_t at = stack[--depth];
        if (at >= 0) {
            const vplBvhNode* node = &bvh->nodes[at];
            for (uint32_t above = choose(data, node); above != 0; above &= above - 1) {
                stack[depth++] = node->child[__builtin_ctz(above)];
            }
        } else if (waiting == NULL) {
            waiting = &bvh->blocks[~at];
        } else {
            pair(waiting, &bvh->blocks[~at], &s);
            draw(data, &s);
            waiting = NULL;
        }
    }
    if (waiting != NULL) {
        pair(waiting, NULL, &s);
        draw(data, &s);
    }
}

#endif
