// SPDX-License-Identifier: MIT
// Draws triangles into one tile, block by block. Compiled once per instruction set; all give the same bits.
// Based on: Juan Pineda, A Parallel Algorithm for Polygon Rasterization, SIGGRAPH 1988: edge functions. Ours
// are exact integers, so coverage cannot depend on where a block or a tile starts.
#include "raster/raster.h"
#include "base/isa.h"

#include <string.h>

// A triangle prepared for a tile. Edge i lies opposite corner i; its function is the area at that corner.
typedef struct Setup {
    int64_t e[3];                       // at the centre of the tile's first pixel, without the top-left bias
    int32_t a[3], b[3];                 // growth per sub-pixel in x and y
    int32_t bias[3];                    // -1 where a centre on the edge belongs to the neighbour
    int32_t laneStep[3][VPL_LANES];     // growth from lane 0 to each lane in whole pixels (e >> 8)
    double laneE[3][VPL_LANES];         // the same, exact
    double z, zx, zy, laneZ[VPL_LANES]; // depth at the tile's first pixel centre, and its growth per pixel
} Setup;

// Perspective-correct interpolation. Based on: Marc Olano and Trey Greer, Triangle Scan Conversion Using 2D
// Homogeneous Coordinates, Graphics Hardware 1997: with corners (X, Y, w) in homogeneous pixels, share i of
// the point seen at pixel p is proportional to (corner j x corner k) . (p, 1). No corner is divided by its w,
// and none is snapped: snapping decides coverage only, and moves no surface.
typedef struct Shares {
    double x[3], y[3], c[3];   // the three planes over pixel indices; their sum is 1/w
    double lane[3][VPL_LANES]; // growth from lane 0
    float v0[VPL_MAX_VARYINGS], d1[VPL_MAX_VARYINGS],
        d2[VPL_MAX_VARYINGS]; // corner 0 and differences from it
} Shares;

static void prepare(const vplTriangle* t, const vplTile* tile, Setup* s)
{
    const int64_t px = (int64_t)tile->x * 256 + 128, py = (int64_t)tile->y * 256 + 128;
    for (int i = 0; i < 3; i++) {
        const vplScreenVertex* p = &t->v[(i + 1) % 3];
        const vplScreenVertex* q = &t->v[(i + 2) % 3];
        int32_t dx = q->x - p->x, dy = q->y - p->y;
        s->a[i] = -dy;
        s->b[i] = dx;
        s->e[i] = (int64_t)dx * (py - p->y) - (int64_t)dy * (px - p->x);
        s->bias[i] = dy < 0 || (dy == 0 && dx > 0) ? 0 : -1; // left and top edges own their centres
        for (int l = 0; l < VPL_LANES; l++) {
            s->laneStep[i][l] = s->a[i] * (l & 3) + s->b[i] * (l >> 2);
            s->laneE[i][l] = 256.0 * s->laneStep[i][l];
        }
    }
    // Sum of the three edge functions anywhere is the doubled area.
    double inverse = 1 / (double)(s->e[0] + s->e[1] + s->e[2]);
    double z1 = (double)t->v[1].z - t->v[0].z, z2 = (double)t->v[2].z - t->v[0].z;
    s->zx = 256 * inverse * (z1 * s->a[1] + z2 * s->a[2]);
    s->zy = 256 * inverse * (z1 * s->b[1] + z2 * s->b[2]);
    s->z = t->v[0].z + inverse * (z1 * (double)s->e[1] + z2 * (double)s->e[2]);
    for (int l = 0; l < VPL_LANES; l++) {
        s->laneZ[l] = s->zx * (l & 3) + s->zy * (l >> 2);
    }
}

static inline int32_t clampEdge(int64_t e)
{
    // Within a block an edge grows by less than 2^28, so beyond 2^30 only the sign matters.
    return e > 1 << 30 ? 1 << 30 : e < -(1 << 30) ? -(1 << 30) : (int32_t)e;
}

// Lanes inside the triangle and the picture; 0 if there are none.
static int cover(const Setup* s, const int64_t e[3], const vplTile* tile, int x, int y,
                 int32_t covered[VPL_LANES])
{
    int32_t edge[3];
    for (int i = 0; i < 3; i++) {
        edge[i] = clampEdge((e[i] + s->bias[i]) >> 8);
    }
    int32_t any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        int32_t outside =
            (edge[0] + s->laneStep[0][l]) | (edge[1] + s->laneStep[1][l]) | (edge[2] + s->laneStep[2][l]);
        covered[l] = ~(outside >> 31);
        any |= covered[l];
    }
    if (any && (x + VPL_BLOCK_SIDE > tile->width || y + VPL_BLOCK_SIDE > tile->height)) {
        any = 0;
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= x + (l & 3) < tile->width && y + (l >> 2) < tile->height ? -1 : 0;
            any |= covered[l];
        }
    }
    return any;
}

static int compareDepth(vplDepthCompare compare, const float* restrict old, const float* restrict depth,
                        int32_t* restrict covered)
{
    int32_t any = 0;
    switch (compare) {
    case VPL_DEPTH_LESS:
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= depth[l] < old[l] ? -1 : 0;
            any |= covered[l];
        }
        return any;
    case VPL_DEPTH_LESS_EQUAL:
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= depth[l] <= old[l] ? -1 : 0;
            any |= covered[l];
        }
        return any;
    case VPL_DEPTH_EQUAL:
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= depth[l] == old[l] ? -1 : 0;
            any |= covered[l];
        }
        return any;
    case VPL_DEPTH_ALWAYS:
        break;
    }
    return 1;
}

static void crossPlanes(const double p[3][3], Shares* s)
{
    for (int i = 0; i < 3; i++) {
        const double *u = p[(i + 1) % 3], *v = p[(i + 2) % 3];
        s->x[i] = u[1] * v[2] - u[2] * v[1];
        s->y[i] = u[2] * v[0] - u[0] * v[2];
        s->c[i] = u[0] * v[1] - u[1] * v[0];
    }
}

static void prepareShares(const vplTriangle* t, const vplShaded* shaded, const vplFramebuffer* f, Shares* s)
{
    double p[3][3];
    float varyings[3][VPL_MAX_VARYINGS];
    for (int i = 0; i < 3; i++) {
        float clip[3];
        vplFetchVertex(shaded, t->vertex[i], clip, varyings[i]);
        p[i][0] = 0.5 * f->width * ((double)clip[2] + clip[0]);
        p[i][1] = 0.5 * f->height * ((double)clip[2] - clip[1]);
        p[i][2] = clip[2];
    }
    crossPlanes(p, s);
    double determinant = p[0][0] * s->x[0] + p[0][1] * s->y[0] + p[0][2] * s->c[0];
    if (!(determinant > 0)) {
        // Only snapping gave it an area: then the snapped corners are the triangle.
        for (int i = 0; i < 3; i++) {
            p[i][0] = t->v[i].x / 256.0 * p[i][2];
            p[i][1] = t->v[i].y / 256.0 * p[i][2];
        }
        crossPlanes(p, s);
        determinant = p[0][0] * s->x[0] + p[0][1] * s->y[0] + p[0][2] * s->c[0];
    }
    // Scaled so that floats hold the planes whatever the unit of w.
    double scale = 1 / determinant;
    for (int i = 0; i < 3; i++) {
        s->x[i] *= scale;
        s->y[i] *= scale;
        s->c[i] = s->c[i] * scale + 0.5 * (s->x[i] + s->y[i]); // pixel centres
        for (int l = 0; l < VPL_LANES; l++) {
            s->lane[i][l] = s->x[i] * (l & 3) + s->y[i] * (l >> 2);
        }
    }
    for (int k = 0; k < shaded->varyingCount; k++) {
        s->v0[k] = varyings[0][k];
        s->d1[k] = varyings[1][k] - varyings[0][k];
        s->d2[k] = varyings[2][k] - varyings[0][k];
    }
}

// Shares are clamped at 0: that keeps points of the outline within the triangle, and lanes that are not covered
// finite.
static void interpolate(const Shares* s, int varyingCount, int x, int y, vplFragments* f)
{
    double at[3];
    for (int i = 0; i < 3; i++) {
        at[i] = s->x[i] * x + (s->y[i] * y + s->c[i]);
    }
    float b1[VPL_LANES], b2[VPL_LANES];
    for (int l = 0; l < VPL_LANES; l++) {
        float s0 = (float)(at[0] + s->lane[0][l]);
        float s1 = (float)(at[1] + s->lane[1][l]);
        float s2 = (float)(at[2] + s->lane[2][l]);
        s0 = s0 > 0 ? s0 : 0;
        s1 = s1 > 0 ? s1 : 0;
        s2 = s2 > 0 ? s2 : 0;
        float w = 1 / (s0 + s1 + s2);
        f->w[l] = w;
        b1[l] = s1 * w;
        b2[l] = s2 * w;
    }
    for (int k = 0; k < varyingCount; k++) {
        // From corner 0, so that what is equal at all corners stays equal in every bit.
        const float v0 = s->v0[k], d1 = s->d1[k], d2 = s->d2[k];
        for (int l = 0; l < VPL_LANES; l++) {
            f->varying[k][l] = v0 + (b1[l] * d1 + b2[l] * d2);
        }
    }
}

static void blendPlanes(vplTileState* state, const vplPipeline* p, int at, int planeCount)
{
    vplFragments* f = &state->block;
    for (int k = 0; k < planeCount; k++) {
        if ((p->planeMask >> k & 1) == 0) {
            continue;
        }
        float* restrict to = state->tile.planes[k] + at;
        const float* restrict from = f->plane[k];
        if (p->blend == VPL_BLEND_ADD) {
            for (int l = 0; l < VPL_LANES; l++) {
                float sum = to[l] + from[l];
                to[l] = f->covered[l] ? sum : to[l];
            }
        } else {
            for (int l = 0; l < VPL_LANES; l++) {
                to[l] = f->covered[l] ? from[l] : to[l];
            }
        }
    }
}

typedef struct Draw {
    vplTileState* state;
    const vplPipeline* pipeline;
    const vplShaded* shaded;
    const vplTriangle* triangle;
    const vplFramebuffer* framebuffer;
    Shares* shares; // of the triangle, once they are needed
    int owner, planeCount;
    bool hasShares;
} Draw;

static void shade(Draw* d, int at)
{
    vplFragments* f = &d->state->block;
    if (!d->hasShares) {
        prepareShares(d->triangle, d->shaded, d->framebuffer, d->shares);
        d->hasShares = true;
    }
    interpolate(d->shares, d->shaded->varyingCount, f->x, f->y, f);
    f->primitive = d->triangle->primitive & ~VPL_CLOCKWISE;
    f->scratch = d->state->tile.scratch;
    f->element = at;
    for (int k = 0; d->pipeline->readsPlanes && k < d->planeCount; k++) {
        memcpy(f->plane[k], d->state->tile.planes[k] + at, sizeof f->plane[k]);
    }
    d->pipeline->fragment(d->pipeline->fragmentUniforms, f);
}

static void drawBlock(Draw* d, const Setup* s, const int64_t e[3], int x, int y)
{
    vplTileState* state = d->state;
    const vplPipeline* p = d->pipeline;
    vplFragments* f = &state->block;
    if (!cover(s, e, &state->tile, x, y, f->covered)) {
        return;
    }
    const int at = ((y >> 2) * VPL_TILE_BLOCKS + (x >> 2)) * VPL_LANES;
    float* restrict depth = state->tile.depth + at;
    int32_t* restrict owner = state->owner + at;
    const double z = s->z + (s->zx * x + s->zy * y);
    for (int l = 0; l < VPL_LANES; l++) {
        float v = (float)(z + s->laneZ[l]);
        v = v > 0 ? v : 0;
        f->depth[l] = v < 1 ? v : 1;
    }
    f->x = state->tile.x + x;
    f->y = state->tile.y + y;
    if (p->writesDepth) {
        shade(d, at);
    }
    if (p->ownerTest) {
        for (int l = 0; l < VPL_LANES; l++) {
            f->covered[l] &= owner[l] == d->owner ? -1 : 0;
        }
    }
    if (!compareDepth(p->depthCompare, depth, f->depth, f->covered)) {
        return;
    }
    int count = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        count -= f->covered[l];
    }
    state->fragments += count;
    if (p->depthWrite) {
        for (int l = 0; l < VPL_LANES; l++) {
            depth[l] = f->covered[l] ? f->depth[l] : depth[l];
            owner[l] = f->covered[l] ? d->owner : owner[l];
        }
    }
    if (p->fragment != NULL && !p->writesDepth) {
        shade(d, at);
    }
    if (p->fragment != NULL) {
        blendPlanes(state, p, at, d->planeCount);
    }
}

static int minOf(int a, int b)
{
    return a < b ? a : b;
}

static int maxOf(int a, int b)
{
    return a > b ? a : b;
}

static void drawTriangle(Draw* d)
{
    const vplTriangle* t = d->triangle;
    const vplTile* tile = &d->state->tile;
    Setup s;
    prepare(t, tile, &s);
    const vplPixelBox box = vplBoundTriangle(t->v);
    const int x0 = maxOf(box.x0 - tile->x, 0) & ~3, x1 = minOf(box.x1 - tile->x, tile->width - 1);
    const int y0 = maxOf(box.y0 - tile->y, 0) & ~3, y1 = minOf(box.y1 - tile->y, tile->height - 1);
    int64_t reach[3]; // from a block's first centre to the one where the edge function is largest
    for (int i = 0; i < 3; i++) {
        reach[i] = 768 * ((int64_t)maxOf(s.a[i], 0) + maxOf(s.b[i], 0)) + s.bias[i];
    }
    for (int y = y0; y <= y1; y += VPL_BLOCK_SIDE) {
        for (int x = x0; x <= x1; x += VPL_BLOCK_SIDE) {
            int64_t e[3];
            bool outside = false;
            for (int i = 0; i < 3; i++) {
                e[i] = s.e[i] + 256 * ((int64_t)s.a[i] * x + (int64_t)s.b[i] * y);
                outside |= e[i] + reach[i] < 0;
            }
            if (!outside) {
                drawBlock(d, &s, e, x, y);
            }
        }
    }
}

vplDrawTileFcn VPL_KERNEL(vplDrawTile);

void VPL_KERNEL(vplDrawTile)(vplTileState* state, const vplPipeline* pipeline, const vplShaded* shaded,
                             const vplTriangle* triangles, const int* list, int count,
                             const vplFramebuffer* framebuffer)
{
    Shares shares;
    Draw d = {state, pipeline, shaded, NULL, framebuffer, &shares, 0, framebuffer->planeCount, false};
    for (int i = 0; i < count; i++) {
        d.owner = list[i];
        d.hasShares = false;
        d.triangle = &triangles[list[i]];
        bool clockwise = (d.triangle->primitive & VPL_CLOCKWISE) != 0;
        if (pipeline->cull == VPL_CULL_NONE || (pipeline->cull == VPL_CULL_BACK) != clockwise) {
            drawTriangle(&d);
        }
    }
}
