// SPDX-License-Identifier: MIT
// Based on: Eric Haines and John Wallace, Shaft Culling for Efficient Ray-Cast Radiosity, Eurographics
// Workshop on Rendering 1991. Departs: a triangle that has both blocks on one side, such as a wall of their
// room, is no blocker.
#include "radiosity/factors/shaft.h"

#include "geometry/bvh.h"
#include "geometry/triangle.h"
#include "math/scalar.h"

enum { MOST_PLANES = 12 };

// A plane parallel to one axis that touches both boxes and has them behind it.
typedef struct ShaftPlane {
    int u, v; // the other axes
    double nu, nv, offset;
} ShaftPlane;

// The space between two blocks, or two ends: inside the bounds of both, and behind all planes.
typedef struct Shaft {
    const vplGeometry* geometry;
    const vplFactorBlock *a, *b; // NULL: two ends
    const vplShaftEnd* ends[2];  // NULL: two blocks
    const float *lows[2], *highs[2];
    float tolerance;
    float low[3], high[3];
    ShaftPlane planes[MOST_PLANES];
    int planeCount;
    vplBlockers* out; // NULL: the search ends at the first blocker
    int32_t found;    // the triangle at which the search ended
} Shaft;

// Adds the plane through the same corner of both boxes, if both lie behind it.
static void addPlane(Shaft* shaft, int u, int v, int corner)
{
    const float *const *us = corner & 1 ? shaft->highs : shaft->lows, *const *vs = corner & 2 ? shaft->highs
                                                                                              : shaft->lows;
    const double au = (double)us[0][u], av = (double)vs[0][v];
    const double du = (double)us[1][u] - au, dv = (double)vs[1][v] - av;
    const double outU = corner & 1 ? 1 : -1, outV = corner & 2 ? 1 : -1;
    if (du * outU * (dv * outV) < 0) {
        const double nu = fabs(dv) * outU, nv = fabs(du) * outV;
        shaft->planes[shaft->planeCount++] = (ShaftPlane){u, v, nu, nv, nu * au + nv * av};
    }
}

static void addPlanes(Shaft* shaft)
{
    for (int k = 0; k < 3; k++) {
        shaft->low[k] = vplMinf(shaft->lows[0][k], shaft->lows[1][k]);
        shaft->high[k] = vplMaxf(shaft->highs[0][k], shaft->highs[1][k]);
        for (int corner = 0; corner < 4; corner++) {
            addPlane(shaft, k, (k + 1) % 3, corner);
        }
    }
}

static bool missesBox(const Shaft* shaft, const float low[3], const float high[3])
{
    for (int k = 0; k < 3; k++) {
        if (low[k] > shaft->high[k] || high[k] < shaft->low[k]) {
            return true;
        }
    }
    for (int i = 0; i < shaft->planeCount; i++) {
        const ShaftPlane* p = &shaft->planes[i];
        const double u = (double)(p->nu > 0 ? low : high)[p->u], v = (double)(p->nv > 0 ? low : high)[p->v];
        if (p->nu * u + p->nv * v > p->offset) {
            return true;
        }
    }
    return false;
}

static bool missesTriangle(const Shaft* shaft, const float p[3][3])
{
    for (int k = 0; k < 3; k++) {
        if ((p[0][k] > shaft->high[k] && p[1][k] > shaft->high[k] && p[2][k] > shaft->high[k]) ||
            (p[0][k] < shaft->low[k] && p[1][k] < shaft->low[k] && p[2][k] < shaft->low[k])) {
            return true;
        }
    }
    for (int i = 0; i < shaft->planeCount; i++) {
        const ShaftPlane* s = &shaft->planes[i];
        bool all = true;
        for (int c = 0; c < 3; c++) {
            all = all && s->nu * (double)p[c][s->u] + s->nv * (double)p[c][s->v] > s->offset;
        }
        if (all) {
            return true;
        }
    }
    return false;
}

// Extends `range` by the signed distances of a block's corners from a plane.
static void extendRange(const vplFactorBlock* block, const float n[3], const float at[3], float range[2])
{
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_SIDE_LANES; l++) {
            const float h = n[0] * (block->corner[c][0][l] - at[0]) +
                            n[1] * (block->corner[c][1][l] - at[1]) + n[2] * (block->corner[c][2][l] - at[2]);
            const bool counts = block->area[l] > 0;
            range[0] = counts && h < range[0] ? h : range[0];
            range[1] = counts && h > range[1] ? h : range[1];
        }
    }
}

// Extends `range` by the signed distances of a box's corners from a plane.
static void extendByBox(const vplShaftEnd* end, const float n[3], const float at[3], float range[2])
{
    float low = 0, high = 0;
    for (int k = 0; k < 3; k++) {
        const float a = n[k] * (end->low[k] - at[k]), b = n[k] * (end->high[k] - at[k]);
        low += vplMinf(a, b);
        high += vplMaxf(a, b);
    }
    range[0] = vplMinf(range[0], low);
    range[1] = vplMaxf(range[1], high);
}

// Tests whether a triangle is behind a flat end, or in its plane. Rays from there do not meet it.
static bool isBehindEnd(const Shaft* shaft, const vplShaftEnd* end, const float p[3][3])
{
    float most = -INFINITY;
    for (int c = 0; c < 3; c++) {
        const vplVec3 from = vplSub(vplVec(p[c][0], p[c][1], p[c][2]), end->at);
        most = vplMaxf(most, vplDot(end->normal, from));
    }
    return end->flat && most <= shaft->tolerance;
}

static bool blocks(const Shaft* shaft, const float p[3][3], int triangle)
{
    float range[2] = {0, 0};
    const bool ends = shaft->a == NULL;
    if (missesTriangle(shaft, p) ||
        (ends && (isBehindEnd(shaft, shaft->ends[0], p) || isBehindEnd(shaft, shaft->ends[1], p)))) {
        return false;
    }
    const vplVec3 normal = shaft->geometry->normals[triangle];
    const float n[3] = {normal.x, normal.y, normal.z};
    if (ends) {
        extendByBox(shaft->ends[0], n, p[0], range);
        extendByBox(shaft->ends[1], n, p[0], range);
    } else {
        extendRange(shaft->a, n, p[0], range);
        extendRange(shaft->b, n, p[0], range);
    }
    return range[0] < -shaft->tolerance && range[1] > shaft->tolerance;
}

static bool isBlocker(const Shaft* shaft, const vplTriangleBlock* block, int lane)
{
    float p[3][3];
    for (int i = 0; i < 9; i++) {
        p[i / 3][i % 3] = block->p[i / 3][i % 3][lane];
    }
    return blocks(shaft, p, block->id[lane]);
}

static bool isBlockedBy(const Shaft* shaft, int32_t triangle)
{
    const vplTriangleCorners t = vplGeometry_Corners(shaft->geometry, triangle);
    float p[3][3];
    for (int i = 0; i < 9; i++) {
        p[i / 3][i % 3] = vplComponent(t.corner[i / 3], i % 3);
    }
    return blocks(shaft, p, triangle);
}

// False if there are too many blockers.
static bool addBlockers(Shaft* shaft, const vplTriangleBlock* block)
{
    vplBlockers* out = shaft->out;
    for (int lane = 0; lane < VPL_BVH_WIDTH && block->id[lane] >= 0; lane++) {
        if (!isBlocker(shaft, block, lane)) {
            continue;
        }
        if (out == NULL || out->count == VPL_MOST_BLOCKERS) {
            shaft->found = block->id[lane];
            return false;
        }
        int k = out->count++;
        for (; k > 0 && out->ids[k - 1] > block->id[lane]; k--) {
            out->ids[k] = out->ids[k - 1];
        }
        out->ids[k] = block->id[lane];
    }
    return true;
}

// Searches the tree or, where it has no nodes, its few blocks. False if there are too many blockers.
static bool search(Shaft* shaft, const vplBvh* bvh)
{
    int32_t stack[VPL_BVH_DEPTH * (VPL_BVH_WIDTH - 1) + 1] = {0};
    int count = bvh->nodes != NULL ? 1 : bvh->blockCount;
    for (int i = 0; i < count && bvh->nodes == NULL; i++) {
        stack[i] = ~i;
    }
    while (count > 0) {
        const int32_t next = stack[--count];
        if (next < 0) {
            if (!addBlockers(shaft, &bvh->blocks[~next])) {
                return false;
            }
            continue;
        }
        const vplBvhNode* node = &bvh->nodes[next];
        for (int k = 0; k < node->count; k++) {
            const float low[3] = {node->planes[0][k], node->planes[1][k], node->planes[2][k]};
            const float high[3] = {node->planes[3][k], node->planes[4][k], node->planes[5][k]};
            if (!missesBox(shaft, low, high)) {
                stack[count++] = node->child[k];
            }
        }
    }
    return true;
}

void vplBlockers_Find(const vplGeometry* g, const vplFactorBlock* a, const vplFactorBlock* b, float tolerance,
                      vplBlockers* out)
{
    const vplBvh* bvh = g->rayTree;
    Shaft shaft = {.geometry = g,
                   .a = a,
                   .b = b,
                   .lows = {a->low, b->low},
                   .highs = {a->high, b->high},
                   .tolerance = tolerance,
                   .out = out};
    addPlanes(&shaft);
    out->count = 0;
    if (bvh == NULL || bvh->marks != NULL || g->cutOuts != NULL || !search(&shaft, bvh)) {
        out->count = -1;
        return;
    }
    out->bvh = (vplBvh){.blocks = out->blocks};
    for (int first = 0; first < out->count; first += VPL_BVH_WIDTH) {
        vplTriangleBlock_Fill(&out->blocks[out->bvh.blockCount++], g, out->ids + first,
                              vplMini(VPL_BVH_WIDTH, out->count - first));
    }
}

bool vplShaft_IsClear(const vplGeometry* g, const vplShaftEnd* a, const vplShaftEnd* b, float tolerance,
                      int32_t* blocker)
{
    const vplBvh* bvh = g->rayTree;
    Shaft shaft = {.geometry = g,
                   .ends = {a, b},
                   .lows = {a->low, b->low},
                   .highs = {a->high, b->high},
                   .tolerance = tolerance};
    addPlanes(&shaft);
    if (bvh == NULL || (*blocker >= 0 && isBlockedBy(&shaft, *blocker))) {
        return false;
    }
    const bool clear = search(&shaft, bvh); // the tree's marks are about rays only
    *blocker = clear ? -1 : shaft.found;
    return clear;
}
