// SPDX-License-Identifier: MIT
// Rims of shadows. Where two neighbours on one surface receive different light from emitters, the light in
// the centre of each is replaced by the mean over the samples of the pixel. The search starts at such
// neighbours, and at some corners of pixels whose light differs from that in the centre, which finds shadows
// thinner than a pixel. It spreads to the neighbours of every pixel whose samples differ. Where many emitters cast shadow
// rays, only four samples of a pixel are lit: a rim belongs to one emitter, which is a small part of the light.
#include "shading/edges.h"

// Light differs if the smaller is less than this share of the larger.
#define RIM_RATIO 0.875f

enum {
    RIM_PITCH = VPL_TILE_SIDE + 2, // pixels of the tile, and their neighbours around it
    RIM_CELLS = RIM_PITCH * RIM_PITCH
};

// The place of a point whose light is to be found.
typedef enum PointKind {
    BORDER, // the centre of a pixel outside the tile
    CORNER, // a corner of a pixel
    SAMPLE  // a sample of a pixel
} PointKind;

// If more than FEW_EMITTERS emitters cast shadow rays, only four samples of a pixel are lit.
enum { FEW_EMITTERS = 64 };

// The four of 8 or 16 samples that are lit, as bits. Of all sets of four samples, these, together with the pixel's centre, give the
// least error of the area that an edge in a random direction covers.
enum { FOUR_OF_8 = 1 << 0 | 1 << 2 | 1 << 5 | 1 << 7, FOUR_OF_16 = 1 << 1 | 1 << 3 | 1 << 12 | 1 << 14 };

typedef struct Rims {
    const vplShading* shading;
    const vplTile* tile;
    uint16_t lit;           // bits of the samples that are lit
    const uint16_t* own;    // samples of each element that show the surface in its centre
    float light[RIM_CELLS]; // from emitters in centres of pixels; NAN where nothing is seen
    uint8_t listed[RIM_CELLS];
    uint16_t list[VPL_TILE_SIDE * VPL_TILE_SIDE]; // cells of pixels to smooth
    int listCount;
    PointKind kind; // of the points in the queue
    vplEdgeQueue queue;
    int cells[VPL_LANES];    // of the points in the queue
    float shares[VPL_LANES]; // of its pixel's light that each sample in the queue stands for
} Rims;

// False for NAN.
static bool isDifferent(float a, float b)
{
    return (a < RIM_RATIO * b) | (b < RIM_RATIO * a);
}

// ---- cells

// The cell of pixel (x, y) of the tile, -1 <= x, y <= VPL_TILE_SIDE.
static int cellOf(int x, int y)
{
    return (y + 1) * RIM_PITCH + x + 1;
}

static int xOf(int cell)
{
    return cell % RIM_PITCH - 1;
}

static int yOf(int cell)
{
    return cell / RIM_PITCH - 1;
}

static int triangleOf(const Rims* r, int cell)
{
    const int32_t* triangles = (const int32_t*)r->tile->planes[VPL_PLANE_TRIANGLE];
    return triangles[vplElementOf(xOf(cell), yOf(cell))] - 1;
}

static bool isInside(const Rims* r, int cell)
{
    const int x = xOf(cell), y = yOf(cell);
    return x >= 0 && x < r->tile->width && y >= 0 && y < r->tile->height;
}

// Tests whether two neighbours show one surface. Those outside the tile are lit on the surface of the pixel
// inside.
static bool showOneSurface(const Rims* r, int a, int b)
{
    if (!isInside(r, a) || !isInside(r, b)) {
        return true;
    }
    const vplShading* s = r->shading;
    const int from = triangleOf(r, a), to = triangleOf(r, b);
    if (from == to) {
        return true;
    }
    const vplFacet first = *vplFacetCache_Get(s, from, r->queue.cache);
    const vplFacet second = *vplFacetCache_Get(s, to, r->queue.cache);
    const vplVec3 sight = vplSightOf(s->view, r->tile->x + xOf(b), r->tile->y + yOf(b), (vplSubPixel){0, 0});
    return vplIsOneSurface(s, &first, &second, vplEdgeDistance(s, to, &second, sight), sight);
}

static void list(Rims* r, int cell)
{
    if (isInside(r, cell) && !r->listed[cell]) {
        r->listed[cell] = 1;
        r->list[r->listCount++] = (uint16_t)cell;
    }
}

// ---- light at points

// Lists the neighbours of a pixel whose samples differ.
static void spread(Rims* r, int cell)
{
    const int steps[] = {1, -1, RIM_PITCH, -RIM_PITCH};
    for (int k = 0; k < 4; k++) {
        const int next = cell + steps[k];
        if (!r->listed[next] && !isnan(r->light[next]) && showOneSurface(r, cell, next)) {
            list(r, next);
        }
    }
}

// Finds the light at the points that wait.
static void flush(Rims* r)
{
    vplEdgeQueue* q = &r->queue;
    const vplShading* s = r->shading;
    _Alignas(64) float part[3][VPL_LANES] = {{0}};
    if (q->count > 0) {
        s->kernels.addEmitters(s, &s->direct, &q->block.points, part, q->rays);
    }
    for (int l = 0; l < q->count; l++) {
        const int cell = r->cells[l];
        const float light = part[0][l] + part[1][l] + part[2][l];
        const bool differs = isDifferent(light, r->light[cell]);
        if (r->kind == BORDER) {
            r->light[cell] = light;
        } else if (r->kind == CORNER && differs) {
            list(r, cell);
        } else if (r->kind == SAMPLE) {
            const vplReflector* to = &vplFacetCache_Get(s, q->block.points.triangle[l], q->cache)->reflector;
            const float share = r->shares[l];
            double factor[3];
            vplFactorAtPoint(s, to, q->block.points.triangle[l], vplSurface_At(&q->block.surface, l), factor);
            for (int c = 0; c < 3; c++) {
                vplPixelOf(s, q->x[l], q->y[l])[c] += share * (float)(factor[c] * (double)part[c][l]);
            }
            if (differs) {
                spread(r, cell);
            }
        }
    }
    q->count = 0;
}

// Adds the point of a triangle that is seen through a point of pixel (x, y) of the tile, for a cell.
static void push(Rims* r, int cell, int triangle, const int at[2], vplSubPixel point)
{
    vplEdgeQueue* q = &r->queue;
    q->x[q->count] = r->tile->x + at[0];
    q->y[q->count] = r->tile->y + at[1];
    r->cells[q->count] = cell;
    vplEdgeQueue_PutSeen(q, triangle, q->x[q->count], q->y[q->count], point);
    if (++q->count == VPL_LANES) {
        flush(r);
    }
}

// ---- where to begin

static void readTile(Rims* r)
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
                r->light[cellOf(x + l % VPL_BLOCK_SIDE, y + l / VPL_BLOCK_SIDE)] =
                    triangles[l] < 0 ? NAN : light;
            }
        }
    }
}

// Compares corners of pixels with their centres if some shadow is hard: one corner in each row and column of
// a block.
static void tryCorners(Rims* r)
{
    static const int columns[VPL_BLOCK_SIDE] = {1, 3, 0, 2};
    const vplDirectLight* direct = &r->shading->direct;
    bool hard = false;
    for (int i = 0; i < direct->emitterCount; i++) {
        hard |= vplDirectLight_CastsRays(direct, i);
    }
    for (int y = 0; hard && y < r->tile->height; y++) {
        for (int x = columns[y % VPL_BLOCK_SIDE]; x < r->tile->width; x += VPL_BLOCK_SIDE) {
            const int cell = cellOf(x, y), triangle = triangleOf(r, cell);
            if (triangle >= 0) {
                push(r, cell, triangle, (int[2]){x, y}, (vplSubPixel){127, 127});
            }
        }
    }
    flush(r);
}

// Finds the light in neighbours around the tile, on the triangle that the pixel inside shows.
static void readBorder(Rims* r)
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
        const int triangle = triangleOf(r, cellOf(in[0], in[1]));
        const int x = tile->x + out[0], y = tile->y + out[1];
        if (triangle >= 0 && x >= 0 && x < v->width && y >= 0 && y < v->height) {
            push(r, cellOf(out[0], out[1]), triangle, out, (vplSubPixel){0, 0});
        }
    }
    flush(r);
}

// Lists pixels whose light differs from that of the neighbour to the right or below, and this neighbour.
static void compare(Rims* r)
{
    uint8_t differs[2][RIM_CELLS];
    const int steps[2] = {1, RIM_PITCH}, count = RIM_CELLS - RIM_PITCH;
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < count; i++) {
            differs[k][i] = isDifferent(r->light[i], r->light[i + steps[k]]);
        }
    }
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 2; k++) {
            if (differs[k][i] && showOneSurface(r, i, i + steps[k])) {
                list(r, i);
                list(r, i + steps[k]);
            }
        }
    }
}

// ---- smoothing

static void smoothPixel(Rims* r, int cell)
{
    const vplShading* s = r->shading;
    const vplTile* tile = r->tile;
    const vplTileSums* sums = tile->scratch;
    const int at[2] = {xOf(cell), yOf(cell)}, element = vplElementOf(at[0], at[1]);
    const vplReflector* to = &vplFacetCache_Get(s, triangleOf(r, cell), r->queue.cache)->reflector;
    const uint32_t own = r->own[element], few = own & r->lit;
    const uint32_t lit = __builtin_popcount(few) > 1 ? few : own;
    const int count = __builtin_popcount(lit);
    // Each lit sample, and the centre, stands for so many of the samples that show this surface.
    const float weight = (float)(__builtin_popcount(own) + 1) / (float)(count + 1);
    const float all = (float)(tile->sampleCount + 1), share = (float)count * weight / all;
    float* pixel = vplPixelOf(s, tile->x + at[0], tile->y + at[1]);
    double factor[3];
    vplFactorInPixel(s, to, triangleOf(r, cell), tile->x + at[0], tile->y + at[1], factor);
    for (int c = 0; c < 3; c++) {
        const float rest = pixel[c] - share * (float)(factor[c] * (double)sums->emitted[c][element]);
        pixel[c] = rest > 0 ? rest : 0; // rounding may leave less than nothing
    }
    for (uint32_t left = lit; left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        r->shares[r->queue.count] = weight / all;
        push(r, cell, tile->samples[i][element], at, vplSubPixel_OfSample(i, tile->sampleCount));
    }
}

// The samples that are lit, as bits.
static uint16_t samplesToLight(const vplDirectLight* direct, int samples)
{
    bool many = direct->emitterCount > FEW_EMITTERS && direct->shadows == NULL && direct->maps == NULL;
    for (int i = 0; many && i < direct->emitterCount; i++) {
        many = !direct->rays[i].parallel; // the sun is a large part of the light
    }
    return (uint16_t)(!many           ? UINT16_MAX
                      : samples == 8  ? FOUR_OF_8
                      : samples == 16 ? FOUR_OF_16
                                      : UINT16_MAX);
}

void vplSmoothRims(const vplShading* s, const vplTile* tile, vplFacetCache* cache,
                   const uint16_t own[VPL_TILE_SIDE * VPL_TILE_SIDE])
{
    vplTileSums* sums = tile->scratch;
    Rims r;
    r.shading = s;
    r.tile = tile;
    r.lit = samplesToLight(&s->direct, tile->sampleCount);
    r.own = own;
    r.listCount = 0;
    r.queue = (vplEdgeQueue){.shading = s, .cache = cache, .rays = &sums->shadowRays};
    memset(r.listed, 0, sizeof r.listed);
    for (int i = 0; i < RIM_CELLS; i++) {
        r.light[i] = NAN;
    }
    r.kind = BORDER;
    readBorder(&r);
    readTile(&r);
    compare(&r);
    r.kind = CORNER;
    tryCorners(&r);
    r.kind = SAMPLE;
    for (int next = 0; next < r.listCount; next++) {
        smoothPixel(&r, r.list[next]);
        if (next + 1 == r.listCount) { // the samples that wait may list more
            flush(&r);
        }
    }
}
