// SPDX-License-Identifier: MIT
// Rays through the hierarchy. Compiled once per instruction set; all give the same bits.
// Based on: Sven Woop, Carsten Benthin and Ingo Wald, Watertight Ray/Triangle Intersection, JCGT 2013; Thiago
// Ize, Robust BVH Ray Traversal, JCGT 2013 (rounding of the box test); Holger Dammertz, Johannes Hanika and
// Alexander Keller, Shallow Bounding Volume Hierarchies, EGSR 2008 (wide nodes).
// Departs: a hit must also lie in its triangle's own box, by the very arithmetic that tests nodes. That
// arithmetic is monotone, so the box of a node is never missed by a ray that meets a box inside: the tree
// gives the same bits as testing every triangle, for all rays.
#include "base/isa.h"
#include "geometry/bvh.h"

#include <math.h>
#include <string.h>

enum { WIDTH = VPL_BVH_WIDTH };

// A ray prepared for both tests. The triangle test works in axes (kx, ky, kz) where the ray runs along z.
typedef struct Prepared {
    float origin[3], inverse[3];
    float sx, sy, sz;
    int kx, ky, kz;
    int skipFirst, skipCount;
} Prepared;

static Prepared prepare(const vplRay* ray)
{
    Prepared p;
    const float d[3] = {ray->direction.x, ray->direction.y, ray->direction.z};
    p.origin[0] = ray->origin.x;
    p.origin[1] = ray->origin.y;
    p.origin[2] = ray->origin.z;
    p.kz =
        fabsf(d[0]) > fabsf(d[1]) ? (fabsf(d[0]) > fabsf(d[2]) ? 0 : 2) : (fabsf(d[1]) > fabsf(d[2]) ? 1 : 2);
    p.kx = (p.kz + 1) % 3;
    p.ky = (p.kx + 1) % 3;
    p.sx = d[p.kx] / d[p.kz];
    p.sy = d[p.ky] / d[p.kz];
    p.sz = 1 / d[p.kz];
    for (int k = 0; k < 3; k++) {
        // Not 1/0: 0 times infinity is no number. A slab that the ray does not leave is made too wide to decide.
        p.inverse[k] = 1 / (fabsf(d[k]) > 0x1p-126f ? d[k] : copysignf(0x1p-126f, d[k]));
    }
    p.skipFirst = ray->skip.first;
    p.skipCount = ray->skip.count;
    return p;
}

// Edge functions of one triangle again in double where a float came out as exactly 0: rounding never turns a
// sign, but it can hide one.
static void edgesInDouble(const float a[2], const float b[2], const float c[2], float* u, float* v, float* w)
{
    *u = (float)((double)c[0] * b[1] - (double)c[1] * b[0]);
    *v = (float)((double)a[0] * c[1] - (double)a[1] * c[0]);
    *w = (float)((double)b[0] * a[1] - (double)b[1] * a[0]);
}

// Tests the triangles of a block; t is +infinity where one is missed. Returns whether any was hit.
static int32_t testBlock(const Prepared* r, const vplTriangleBlock* block, float t[WIDTH], float b1[WIDTH],
                         float b2[WIDTH])
{
    float x[3][WIDTH], y[3][WIDTH], z[3][WIDTH], u[WIDTH], v[WIDTH], w[WIDTH];
    int32_t anyZero = 0;
    for (int corner = 0; corner < 3; corner++) {
        const float* restrict px = block->p[corner][r->kx];
        const float* restrict py = block->p[corner][r->ky];
        const float* restrict pz = block->p[corner][r->kz];
        for (int i = 0; i < WIDTH; i++) {
            float dz = pz[i] - r->origin[r->kz];
            x[corner][i] = (px[i] - r->origin[r->kx]) - r->sx * dz;
            y[corner][i] = (py[i] - r->origin[r->ky]) - r->sy * dz;
            z[corner][i] = r->sz * dz;
        }
    }
    for (int i = 0; i < WIDTH; i++) {
        u[i] = x[2][i] * y[1][i] - y[2][i] * x[1][i];
        v[i] = x[0][i] * y[2][i] - y[0][i] * x[2][i];
        w[i] = x[1][i] * y[0][i] - y[1][i] * x[0][i];
        anyZero |= (u[i] == 0) | (v[i] == 0) | (w[i] == 0);
    }
    for (int i = 0; anyZero && i < WIDTH; i++) {
        if (u[i] == 0 || v[i] == 0 || w[i] == 0) {
            const float a[2] = {x[0][i], y[0][i]}, b[2] = {x[1][i], y[1][i]}, c[2] = {x[2][i], y[2][i]};
            edgesInDouble(a, b, c, &u[i], &v[i], &w[i]);
        }
    }
    int32_t any = 0;
    for (int i = 0; i < WIDTH; i++) {
        int32_t negative = (u[i] < 0) | (v[i] < 0) | (w[i] < 0),
                positive = (u[i] > 0) | (v[i] > 0) | (w[i] > 0);
        float det = u[i] + v[i] + w[i];
        float inverse = 1 / (det != 0 ? det : 1);
        float distance = (u[i] * z[0][i] + v[i] * z[1][i] + w[i] * z[2][i]) * inverse;
        int32_t skipped = (uint32_t)(block->id[i] - r->skipFirst) < (uint32_t)r->skipCount;
        int32_t hit = !(negative & positive) & (det != 0) & (distance > 0) & (distance < INFINITY) &
                      (block->id[i] >= 0) & !skipped;
        t[i] = hit ? distance : INFINITY;
        b1[i] = v[i] * inverse;
        b2[i] = w[i] * inverse;
        any |= hit;
    }
    return any;
}

// Where a ray is inside a box; entry above exit where it misses.
typedef struct Span {
    float entry, exit;
} Span;

static inline Span clipSlabs(const Prepared* r, const float nearPlane[3], const float farPlane[3])
{
    float x0 = (nearPlane[0] - r->origin[0]) * r->inverse[0],
          x1 = (farPlane[0] - r->origin[0]) * r->inverse[0];
    float y0 = (nearPlane[1] - r->origin[1]) * r->inverse[1],
          y1 = (farPlane[1] - r->origin[1]) * r->inverse[1];
    float z0 = (nearPlane[2] - r->origin[2]) * r->inverse[2],
          z1 = (farPlane[2] - r->origin[2]) * r->inverse[2];
    float entry = x0 > y0 ? x0 : y0, exit = x1 < y1 ? x1 : y1;
    entry = entry > z0 ? entry : z0;
    exit = exit < z1 ? exit : z1;
    return (Span){entry > 0 ? entry : 0, exit};
}

// Entry distances of a node's children, +infinity where the ray misses or enters beyond `limit`.
static int32_t testBoxes(const Prepared* r, const vplBvhNode* node, float limit, float entry[WIDTH])
{
    const float* restrict nearX = r->inverse[0] < 0 ? node->high[0] : node->low[0];
    const float* restrict farX = r->inverse[0] < 0 ? node->low[0] : node->high[0];
    const float* restrict nearY = r->inverse[1] < 0 ? node->high[1] : node->low[1];
    const float* restrict farY = r->inverse[1] < 0 ? node->low[1] : node->high[1];
    const float* restrict nearZ = r->inverse[2] < 0 ? node->high[2] : node->low[2];
    const float* restrict farZ = r->inverse[2] < 0 ? node->low[2] : node->high[2];
    int32_t any = 0;
    for (int i = 0; i < WIDTH; i++) {
        const float nearPlane[3] = {nearX[i], nearY[i], nearZ[i]}, farPlane[3] = {farX[i], farY[i], farZ[i]};
        const Span span = clipSlabs(r, nearPlane, farPlane);
        int32_t hit = (span.entry <= span.exit) & (span.entry <= limit);
        entry[i] = hit ? span.entry : INFINITY;
        any |= hit;
    }
    return any;
}

// Moves a hit into its triangle's box; +infinity where the ray misses the box.
static float clampToBox(const Prepared* r, const vplTriangleBlock* block, int lane, float t)
{
    float corner[3][3], low[3], high[3], nearPlane[3], farPlane[3];
    for (int i = 0; i < 9; i++) {
        corner[i / 3][i % 3] = block->p[i / 3][i % 3][lane];
    }
    vplBoundTriangle(corner, low, high);
    for (int axis = 0; axis < 3; axis++) {
        nearPlane[axis] = r->inverse[axis] < 0 ? high[axis] : low[axis];
        farPlane[axis] = r->inverse[axis] < 0 ? low[axis] : high[axis];
    }
    const Span span = clipSlabs(r, nearPlane, farPlane);
    t = t > span.entry ? t : span.entry;
    t = t < span.exit ? t : span.exit;
    return span.entry <= span.exit && t > 0 ? t : INFINITY;
}

// Lanes in order, so among equal t of a block the lowest triangle stays; across blocks it is compared.
static void keepClosest(const Prepared* r, const vplTriangleBlock* block, vplRawHit* best)
{
    float t[WIDTH], b1[WIDTH], b2[WIDTH];
    if (!testBlock(r, block, t, b1, b2)) {
        return;
    }
    for (int i = 0; i < WIDTH; i++) {
        float at = t[i] < INFINITY ? clampToBox(r, block, i, t[i]) : INFINITY;
        if (at < best->t || (at == best->t && best->triangle > block->id[i])) {
            best->t = at;
            best->b1 = b1[i];
            best->b2 = b2[i];
            best->triangle = block->id[i];
        }
    }
}

static bool hasHitBelow(const Prepared* r, const vplTriangleBlock* block, float limit)
{
    float t[WIDTH], b1[WIDTH], b2[WIDTH];
    if (testBlock(r, block, t, b1, b2)) {
        for (int i = 0; i < WIDTH; i++) {
            if (t[i] < INFINITY && clampToBox(r, block, i, t[i]) < limit) {
                return true;
            }
        }
    }
    return false;
}

typedef struct Entry {
    float t;
    int32_t child;
} Entry;

// Pushes the children that were hit, nearest last. Returns the new height of the stack.
static int push(const vplBvhNode* node, const float entry[WIDTH], Entry* stack, int height)
{
    const int base = height;
    for (int i = 0; i < WIDTH; i++) {
        if (entry[i] < INFINITY) {
            int at = height++;
            while (at > base && stack[at - 1].t < entry[i]) { // insertion sort: few are hit
                stack[at] = stack[at - 1];
                at--;
            }
            stack[at] = (Entry){entry[i], node->child[i]};
        }
    }
    return height;
}

vplTraceClosestFcn VPL_KERNEL(vplTraceClosest);

void VPL_KERNEL(vplTraceClosest)(const vplBvh* bvh, const vplRay* ray, float tMax, vplRawHit* hitOut)
{
    const Prepared r = prepare(ray);
    vplRawHit best = {tMax, 0, 0, -1, 0};
    Entry stack[VPL_BVH_DEPTH * (WIDTH - 1) + 1];
    int height = 0;
    if (bvh->nodes != NULL) {
        stack[height++] = (Entry){0, 0};
    }
    for (int i = 0; bvh->nodes == NULL && i < bvh->blockCount; i++, best.blocks++) {
        keepClosest(&r, &bvh->blocks[i], &best);
    }
    while (height > 0) {
        const Entry top = stack[--height];
        if (top.t > best.t) {
            continue;
        }
        if (top.child < 0) {
            keepClosest(&r, &bvh->blocks[~top.child], &best);
            best.blocks++;
            continue;
        }
        float entry[WIDTH];
        const vplBvhNode* node = &bvh->nodes[top.child];
        if (testBoxes(&r, node, best.t, entry)) {
            height = push(node, entry, stack, height);
        }
    }
    *hitOut = best;
}

vplTraceAnyFcn VPL_KERNEL(vplTraceAny);

bool VPL_KERNEL(vplTraceAny)(const vplBvh* bvh, const vplRay* ray, float tMax)
{
    const Prepared r = prepare(ray);
    int32_t stack[VPL_BVH_DEPTH * (WIDTH - 1) + 1];
    int height = 0;
    if (bvh->nodes != NULL) {
        stack[height++] = 0;
    }
    for (int i = 0; bvh->nodes == NULL && i < bvh->blockCount; i++) {
        if (hasHitBelow(&r, &bvh->blocks[i], tMax)) {
            return true;
        }
    }
    while (height > 0) {
        const int32_t child = stack[--height];
        if (child < 0) {
            if (hasHitBelow(&r, &bvh->blocks[~child], tMax)) {
                return true;
            }
            continue;
        }
        float entry[WIDTH];
        const vplBvhNode* node = &bvh->nodes[child];
        if (testBoxes(&r, node, tMax, entry)) {
            for (int i = 0; i < WIDTH; i++) {
                if (entry[i] < INFINITY) {
                    stack[height++] = node->child[i];
                }
            }
        }
    }
    return false;
}
