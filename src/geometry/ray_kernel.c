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
#if defined(__AVX__)
#include <immintrin.h>
#endif
#include <string.h>

enum { WIDTH = VPL_BVH_WIDTH };

// Bit i of the result: flags[i] is not 0, but -1.
static inline uint32_t collectBits(const int32_t flags[WIDTH])
{
#if defined(__AVX__)
    return (uint32_t)_mm256_movemask_ps(_mm256_loadu_ps((const float*)flags));
#else
    uint32_t bits = 0;
    for (int i = 0; i < WIDTH; i++) {
        bits |= (uint32_t)(flags[i] & 1) << i;
    }
    return bits;
#endif
}

// A ray prepared for both tests. The triangle test works in axes (kx, ky, kz) where the ray runs along z.
typedef struct Prepared {
    float origin[3], inverse[3];
    int nearPlane[3], farPlane[3]; // rows of vplBvhNode.planes
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
        p.nearPlane[k] = p.inverse[k] < 0 ? k + 3 : k;
        p.farPlane[k] = p.inverse[k] < 0 ? k : k + 3;
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

// Tests the triangles of a block. Bit i of the result: lane i was hit.
static __attribute__((noinline)) uint32_t testBlock(const Prepared* r, const vplTriangleBlock* block,
                                                    float* restrict t, float* restrict b1, float* restrict b2)
{
    float x[3][WIDTH], y[3][WIDTH], z[3][WIDTH], u[WIDTH], v[WIDTH], w[WIDTH];
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
    int32_t flags[WIDTH];
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
        uint32_t id = (uint32_t)block->id[i]; // unused lanes: beyond all
        flags[i] = -(((least >= 0) | (most <= 0)) & (id - first >= count) & (id < 0x80000000u));
    }
    if (collectBits(flags) == 0) { // most blocks
        return 0;
    }
    for (int i = 0; i < WIDTH; i++) {
        float det = u[i] + v[i] + w[i];
        float inverse = 1 / (det != 0 ? det : 1);
        float distance = (u[i] * z[0][i] + v[i] * z[1][i] + w[i] * z[2][i]) * inverse;
        t[i] = distance;
        b1[i] = v[i] * inverse;
        b2[i] = w[i] * inverse;
        flags[i] &= -((det != 0) & (distance > 0) & (distance < INFINITY));
    }
    return collectBits(flags);
}

// Where a ray enters a box and where it leaves it: planes minus origin times the inverse of the direction.
static inline float slabEntry(float x, float y, float z)
{
    float t = x > y ? x : y;
    t = t > z ? t : z;
    return t > 0 ? t : 0;
}

// Later by 16 rounding units than the planes say: slabs are off by 6, the corners in the triangle test by 6 more
// (and by what vplBoundTriangle adds). Without it a ray from afar that the triangle test gives to one side of an
// edge misses the box of that side: 204 of the 96000 rays of SharedEdgesLetNothingThrough fell through.
static inline float slabExit(float x, float y, float z)
{
    float t = x < y ? x : y;
    return (t < z ? t : z) * (1 + 0x1p-20f);
}

// Entry distances of a node's children. Bit i of the result: child i is met, and before `limit`.
static inline uint32_t testBoxes(const Prepared* r, const vplBvhNode* node, float limit,
                                 float* restrict entry)
{
    const float* restrict nearX = node->planes[r->nearPlane[0]];
    const float* restrict nearY = node->planes[r->nearPlane[1]];
    const float* restrict nearZ = node->planes[r->nearPlane[2]];
    const float* restrict farX = node->planes[r->farPlane[0]];
    const float* restrict farY = node->planes[r->farPlane[1]];
    const float* restrict farZ = node->planes[r->farPlane[2]];
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

// Moves a hit into its triangle's box; +infinity where the ray misses the box.
static float clampToBox(const Prepared* r, const vplTriangleBlock* block, int lane, float t)
{
    float corner[3][3], planes[2][3], in[3], out[3];
    for (int i = 0; i < 9; i++) {
        corner[i / 3][i % 3] = block->p[i / 3][i % 3][lane];
    }
    vplBoundTriangle(corner, planes[0], planes[1]);
    for (int axis = 0; axis < 3; axis++) {
        int side = r->nearPlane[axis] >= 3;
        in[axis] = (planes[side][axis] - r->origin[axis]) * r->inverse[axis];
        out[axis] = (planes[1 - side][axis] - r->origin[axis]) * r->inverse[axis];
    }
    const float entry = slabEntry(in[0], in[1], in[2]), exit = slabExit(out[0], out[1], out[2]);
    t = t > entry ? t : entry;
    t = t < exit ? t : exit;
    return entry <= exit && t > 0 ? t : INFINITY;
}

// Lanes in order, so among equal t of a block the lowest triangle stays; across blocks it is compared.
static inline void keepClosest(const Prepared* r, const vplTriangleBlock* block, vplRawHit* best)
{
    float t[WIDTH], b1[WIDTH], b2[WIDTH];
    for (uint32_t hits = testBlock(r, block, t, b1, b2); hits != 0; hits &= hits - 1) {
        const int i = __builtin_ctz(hits);
        const float at = clampToBox(r, block, i, t[i]);
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
    for (uint32_t hits = testBlock(r, block, t, b1, b2); hits != 0; hits &= hits - 1) {
        const int i = __builtin_ctz(hits);
        if (clampToBox(r, block, i, t[i]) < limit) {
            return true;
        }
    }
    return false;
}

typedef struct Entry {
    float t;
    int32_t child;
} Entry;

// Pushes the children that were hit but the nearest, which is returned; there must be one.
static Entry pushOthers(const vplBvhNode* node, uint32_t hits, const float entry[WIDTH], Entry* stack,
                        int* height)
{
    int i = __builtin_ctz(hits);
    Entry nearest = {entry[i], node->child[i]};
    const int base = *height;
    for (hits &= hits - 1; hits != 0; hits &= hits - 1) {
        i = __builtin_ctz(hits);
        Entry other = {entry[i], node->child[i]};
        if (other.t < nearest.t) {
            Entry swap = nearest;
            nearest = other;
            other = swap;
        }
        int at = (*height)++;
        for (; at > base && stack[at - 1].t < other.t; at--) { // insertion sort: few are hit
            stack[at] = stack[at - 1];
        }
        stack[at] = other;
    }
    return nearest;
}

vplTraceClosestFcn VPL_KERNEL(vplTraceClosest);

void VPL_KERNEL(vplTraceClosest)(const vplBvh* bvh, const vplRay* ray, float tMax, vplRawHit* hitOut)
{
    const Prepared r = prepare(ray);
    vplRawHit best = {tMax, 0, 0, -1, 0};
    for (int i = 0; bvh->nodes == NULL && i < bvh->blockCount; i++, best.blocks++) {
        keepClosest(&r, &bvh->blocks[i], &best);
    }
    Entry stack[VPL_BVH_DEPTH * (WIDTH - 1) + 1], top = {0, 0};
    int height = 0;
    for (bool more = bvh->nodes != NULL; more;) {
        float entry[WIDTH];
        uint32_t hits = 0;
        if (top.child < 0) {
            keepClosest(&r, &bvh->blocks[~top.child], &best);
            best.blocks++;
        } else {
            hits = testBoxes(&r, &bvh->nodes[top.child], best.t, entry);
        }
        if (hits != 0) {
            top = pushOthers(&bvh->nodes[top.child], hits, entry, stack, &height);
            continue;
        }
        do {
            more = height > 0;
            top = stack[more ? --height : 0];
        } while (more && top.t > best.t);
    }
    *hitOut = best;
}

vplTraceAnyFcn VPL_KERNEL(vplTraceAny);

bool VPL_KERNEL(vplTraceAny)(const vplBvh* bvh, const vplRay* ray, float tMax)
{
    const Prepared r = prepare(ray);
    for (int i = 0; bvh->nodes == NULL && i < bvh->blockCount; i++) {
        if (hasHitBelow(&r, &bvh->blocks[i], tMax)) {
            return true;
        }
    }
    int32_t stack[VPL_BVH_DEPTH * (WIDTH - 1) + 1], child = 0;
    int height = 0;
    for (bool more = bvh->nodes != NULL; more;) {
        if (child >= 0) {
            float entry[WIDTH];
            const vplBvhNode* node = &bvh->nodes[child];
            uint32_t hits = testBoxes(&r, node, tMax, entry);
            if (hits != 0) {
                child = node->child[__builtin_ctz(hits)];
                for (hits &= hits - 1; hits != 0; hits &= hits - 1) {
                    stack[height++] = node->child[__builtin_ctz(hits)];
                }
                continue;
            }
        } else if (hasHitBelow(&r, &bvh->blocks[~child], tMax)) {
            return true;
        }
        more = height > 0;
        child = stack[more ? --height : 0];
    }
    return false;
}
