// SPDX-License-Identifier: MIT
// Rims of shadows, for kernels: where emitters send different light to neighbours on one surface, the mean
// over the samples of a pixel replaces the light in its centre. The search begins at neighbours that differ,
// and at points on the corners of pixels that differ from the centre, which find shadows thinner than a
// pixel; it goes on with the neighbours of every pixel whose samples differ.
#ifndef VPL_SHADING_RIMS_H
#define VPL_SHADING_RIMS_H

#include "shading/edges.h"

// Light differs if the smaller is less than this share of the larger.
#define RIM_RATIO 0.875f

enum {
    RIM_PITCH = VPL_TILE_SIDE + 2, // pixels of the tile, and their neighbours around it
    RIM_CELLS = RIM_PITCH * RIM_PITCH
};

// A point whose light is wanted, and who asks.
typedef enum vplRimPoint {
    VPL_RIM_BORDER = 0, // the centre of a pixel outside the tile
    VPL_RIM_CORNER,     // a corner of a pixel
    VPL_RIM_SAMPLE      // a sample of a pixel
} vplRimPoint;

typedef struct vplRims {
    const vplShading* shading;
    const vplTile* tile;
    const uint16_t* own;    // samples of each element that show the surface in its centre
    float light[RIM_CELLS]; // from emitters in centres of pixels; NAN where nothing is seen
    uint8_t listed[RIM_CELLS];
    uint16_t list[VPL_TILE_SIDE * VPL_TILE_SIDE]; // cells of pixels to smooth
    int listCount;
    vplRimPoint kind; // of the points in the queue
    vplEdgeQueue queue;
    int cells[VPL_LANES]; // of the points in the queue
} vplRims;

// False for NAN.
static inline bool vplLightDiffers(float a, float b)
{
    return (a < RIM_RATIO * b) | (b < RIM_RATIO * a);
}

// ---- cells

// The cell of pixel (x, y) of the tile, -1 <= x, y <= VPL_TILE_SIDE.
static inline int vplRimCell(int x, int y)
{
    return (y + 1) * RIM_PITCH + x + 1;
}

static inline int vplRims_X(int cell)
{
    return cell % RIM_PITCH - 1;
}

static inline int vplRims_Y(int cell)
{
    return cell / RIM_PITCH - 1;
}

static inline int vplRims_Triangle(const vplRims* r, int cell)
{
    const int32_t* triangles = (const int32_t*)r->tile->planes[VPL_PLANE_TRIANGLE];
    return triangles[vplElementOf(vplRims_X(cell), vplRims_Y(cell))] - 1;
}

static inline bool vplRims_IsInside(const vplRims* r, int cell)
{
    const int x = vplRims_X(cell), y = vplRims_Y(cell);
    return x >= 0 && x < r->tile->width && y >= 0 && y < r->tile->height;
}

// Tests whether two neighbours show one surface. Those outside the tile are lit on the surface of the pixel
// inside.
static inline bool vplRims_ShowOneSurface(const vplRims* r, int a, int b)
{
    if (!vplRims_IsInside(r, a) || !vplRims_IsInside(r, b)) {
        return true;
    }
    const vplShading* s = r->shading;
    const int from = vplRims_Triangle(r, a), to = vplRims_Triangle(r, b);
    if (from == to) {
        return true;
    }
    const vplFacet first = *vplFacetCache_Get(s, from, r->queue.cache);
    const vplFacet second = *vplFacetCache_Get(s, to, r->queue.cache);
    const vplVec3 sight =
        vplSightOf(s->view, r->tile->x + vplRims_X(b), r->tile->y + vplRims_Y(b), (vplSubPixel){0, 0});
    return vplIsOneSurface(s, &first, &second, vplEdgeDistance(s, to, &second, sight), sight);
}

static inline void vplRims_List(vplRims* r, int cell)
{
    if (vplRims_IsInside(r, cell) && !r->listed[cell]) {
        r->listed[cell] = 1;
        r->list[r->listCount++] = (uint16_t)cell;
    }
}

// ---- light at points

// Lists the neighbours of a pixel whose samples differ.
static inline void vplRims_Spread(vplRims* r, int cell)
{
    const int steps[] = {1, -1, RIM_PITCH, -RIM_PITCH};
    for (int k = 0; k < 4; k++) {
        const int next = cell + steps[k];
        if (!r->listed[next] && !isnan(r->light[next]) && vplRims_ShowOneSurface(r, cell, next)) {
            vplRims_List(r, next);
        }
    }
}

// Finds the light at the points that wait.
static inline void vplRims_Flush(vplRims* r)
{
    vplEdgeQueue* q = &r->queue;
    const vplShading* s = r->shading;
    const float share = 1 / (float)(r->tile->sampleCount + 1);
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    if (q->count > 0) {
        s->kernels.addEmitters(s, &s->direct, &q->block.points, part, q->rays);
    }
    for (int l = 0; l < q->count; l++) {
        const int cell = r->cells[l];
        const float light = part[0][l] + part[1][l] + part[2][l];
        const bool differs = vplLightDiffers(light, r->light[cell]);
        if (r->kind == VPL_RIM_BORDER) {
            r->light[cell] = light;
        } else if (r->kind == VPL_RIM_CORNER && differs) {
            vplRims_List(r, cell);
        } else if (r->kind == VPL_RIM_SAMPLE) {
            const vplReflector* to = &vplFacetCache_Get(s, q->block.points.triangle[l], q->cache)->reflector;
            for (int c = 0; c < 3; c++) {
                vplPixelOf(s, q->x[l], q->y[l])[c] += share * (float)(to->factor[c] * (double)part[c][l]);
            }
            if (differs) {
                vplRims_Spread(r, cell);
            }
        }
    }
    q->count = 0;
}

// Adds the point of a triangle that is seen through a point of pixel (x, y) of the tile, for a cell.
static inline void vplRims_Push(vplRims* r, int cell, int triangle, const int at[2], vplSubPixel point)
{
    vplEdgeQueue* q = &r->queue;
    q->x[q->count] = r->tile->x + at[0];
    q->y[q->count] = r->tile->y + at[1];
    r->cells[q->count] = cell;
    vplEdgeQueue_PutSeen(q, triangle, q->x[q->count], q->y[q->count], point);
    if (++q->count == VPL_LANES) {
        vplRims_Flush(r);
    }
}

// ---- where to begin

static inline void vplRims_ReadTile(vplRims* r)
{
    const vplTile* tile = r->tile;
    const vplTileSums* sums = tile->scratch;
    for (int block = 0; block < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; block++) {
        const int x = block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE, y = block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE;
        int triangles[VPL_LANES];
        if (x < tile->width && y < tile->height && vplReadTriangles(tile, block * VPL_LANES, triangles)) {
            for (int l = 0; l < VPL_LANES; l++) {
                const int at = block * VPL_LANES + l;
                const float light = sums->emitted[0][at] + sums->emitted[1][at] + sums->emitted[2][at];
                r->light[vplRimCell(x + l % VPL_BLOCK_SIDE, y + l / VPL_BLOCK_SIDE)] =
                    triangles[l] < 0 ? NAN : light;
            }
        }
    }
}

// Tries corners of pixels if some shadow is hard: each row and column of a block has one.
static inline void vplRims_TryCorners(vplRims* r)
{
    static const int columns[VPL_BLOCK_SIDE] = {1, 3, 0, 2};
    const vplDirectLight* direct = &r->shading->direct;
    bool hard = false;
    for (int i = 0; i < direct->emitterCount; i++) {
        hard |= vplDirectLight_CastsRays(direct, i);
    }
    for (int y = 0; hard && y < r->tile->height; y++) {
        for (int x = columns[y % VPL_BLOCK_SIDE]; x < r->tile->width; x += VPL_BLOCK_SIDE) {
            const int cell = vplRimCell(x, y), triangle = vplRims_Triangle(r, cell);
            if (triangle >= 0) {
                vplRims_Push(r, cell, triangle, (int[2]){x, y}, (vplSubPixel){127, 127});
            }
        }
    }
    vplRims_Flush(r);
}

// Finds the light in neighbours around the tile, on the triangle that the pixel inside shows.
static inline void vplRims_ReadBorder(vplRims* r)
{
    const vplTile* tile = r->tile;
    const vplView* v = r->shading->view;
    const int w = tile->width, h = tile->height;
    for (int i = 0; i < 2 * (w + h); i++) {
        const bool column = i >= 2 * w;
        const int k = column ? i - 2 * w : i, length = column ? h : w, along = k % length;
        const bool far = k >= length;
        const int in[2] = {column ? (far ? w - 1 : 0) : along, column ? along : (far ? h - 1 : 0)};
        const int out[2] = {column ? (far ? w : -1) : along, column ? along : (far ? h : -1)};
        const int triangle = vplRims_Triangle(r, vplRimCell(in[0], in[1]));
        const int x = tile->x + out[0], y = tile->y + out[1];
        if (triangle >= 0 && x >= 0 && x < v->width && y >= 0 && y < v->height) {
            vplRims_Push(r, vplRimCell(out[0], out[1]), triangle, out, (vplSubPixel){0, 0});
        }
    }
    vplRims_Flush(r);
}

// Lists pixels whose light differs from that of the neighbour to the right or below, and this neighbour.
static inline void vplRims_Compare(vplRims* r)
{
    uint8_t differs[2][RIM_CELLS];
    const int steps[2] = {1, RIM_PITCH}, count = RIM_CELLS - RIM_PITCH;
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < count; i++) {
            differs[k][i] = vplLightDiffers(r->light[i], r->light[i + steps[k]]);
        }
    }
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 2; k++) {
            if (differs[k][i] && vplRims_ShowOneSurface(r, i, i + steps[k])) {
                vplRims_List(r, i);
                vplRims_List(r, i + steps[k]);
            }
        }
    }
}

// ---- smoothing

static inline void vplRims_SmoothPixel(vplRims* r, int cell)
{
    const vplShading* s = r->shading;
    const vplTile* tile = r->tile;
    const vplTileSums* sums = tile->scratch;
    const int at[2] = {vplRims_X(cell), vplRims_Y(cell)}, element = vplElementOf(at[0], at[1]);
    const vplReflector* to = &vplFacetCache_Get(s, vplRims_Triangle(r, cell), r->queue.cache)->reflector;
    const float share = (float)__builtin_popcount(r->own[element]) / (float)(tile->sampleCount + 1);
    float* pixel = vplPixelOf(s, tile->x + at[0], tile->y + at[1]);
    for (int c = 0; c < 3; c++) {
        const float rest = pixel[c] - share * (float)(to->factor[c] * (double)sums->emitted[c][element]);
        pixel[c] = rest > 0 ? rest : 0; // rounding may leave less than nothing
    }
    for (uint32_t left = r->own[element]; left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        vplRims_Push(r, cell, tile->samples[i][element], at, vplSubPixel_OfSample(i, tile->sampleCount));
    }
}

// Smooths the rims in a tile whose pixels are written.
static inline void vplSmoothRims(const vplShading* s, const vplTile* tile, vplFacetCache* cache,
                                 const uint16_t own[VPL_TILE_SIDE * VPL_TILE_SIDE])
{
    vplTileSums* sums = tile->scratch;
    vplRims r;
    r.shading = s;
    r.tile = tile;
    r.own = own;
    r.listCount = 0;
    r.queue = (vplEdgeQueue){.shading = s, .cache = cache, .rays = &sums->shadowRays};
    memset(r.listed, 0, sizeof r.listed);
    for (int i = 0; i < RIM_CELLS; i++) {
        r.light[i] = NAN;
    }
    r.kind = VPL_RIM_BORDER;
    vplRims_ReadBorder(&r);
    vplRims_ReadTile(&r);
    vplRims_Compare(&r);
    r.kind = VPL_RIM_CORNER;
    vplRims_TryCorners(&r);
    r.kind = VPL_RIM_SAMPLE;
    for (int next = 0; next < r.listCount; next++) {
        vplRims_SmoothPixel(&r, r.list[next]);
        if (next + 1 == r.listCount) { // the samples that wait may list more
            vplRims_Flush(&r);
        }
    }
}

#endif
