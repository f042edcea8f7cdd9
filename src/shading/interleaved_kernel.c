// SPDX-License-Identifier: MIT
// The first step of interleaved shading: pixels of one class, collected from a region of the tile, meet the lights
// of that class 16 at a time.
#include "base/isa.h"
#include "shading/add_lights.h"
#include "shading/gather.h"

enum {
    SQUARE = 4,     // blocks along a side: what is read and lit directly at once
    MAX_CHUNKS = 11 // 13 x 13 pixels, of 64 x 64 at K = 5
};

vplTileFcn VPL_KERNEL(vplInterleaveTile);

// A square of pixels of the tile. Its side is chosen so that classes fill vectors and points stay in the first
// cache: 16 pixels of a class or more.
typedef struct Region {
    int x, y, width, height; // in the tile
    vplBounds bounds;        // of what is visible in it
    bool any;
} Region;

static int sideOf(int interleave)
{
    return interleave <= 2 ? 16 : interleave <= 4 ? 32 : 64;
}

static inline void storeLanes(vplTile* tile, int plane, int element, const float values[VPL_LANES])
{
    memcpy(tile->planes[plane] + element, values, VPL_LANES * sizeof values[0]);
}

// Direct light becomes pixels; what lights and windows will ask for becomes planes.
static void prepareBlock(const vplShading* s, vplTile* tile, int block, vplSeen* seen, vplBlock* b,
                         int64_t* rays)
{
    const int element = block * VPL_LANES;
    const float nothing[VPL_LANES] = {0};
    if (!vplReadBlock(s, tile, element, seen, b)) {
        for (int k = 0; k < 3; k++) {
            storeLanes(tile, VPL_PLANE_INDIRECT + k, element, nothing);
        }
    } else {
        _Alignas(64) float part[3][VPL_LANES] = {{0}};
        if (!s->irradiance) {
            vplDirectIrradiance(s, &b->points, part, rays);
        }
        vplStartSums(b, part);
        const vplSurface* p = &b->surface;
        for (int k = 0; k < 3; k++) {
            storeLanes(tile, VPL_PLANE_POSITION + k, element, p->px + k * VPL_LANES);
            storeLanes(tile, VPL_PLANE_NORMAL + k, element, p->nx + k * VPL_LANES);
        }
    }
    vplWriteLit(s, tile, block, seen, b);
}

static void addBounds(const vplBounds* more, Region* r)
{
    for (int k = 0; k < 6; k++) {
        const float low = more->low[k], high = more->high[k];
        r->bounds.low[k] = r->any && r->bounds.low[k] < low ? r->bounds.low[k] : low;
        r->bounds.high[k] = r->any && r->bounds.high[k] > high ? r->bounds.high[k] : high;
    }
    r->any = true;
}

// All blocks of a region, square by square.
static void prepareRegion(const vplShading* s, vplTile* tile, Region* r, vplSeen* seen)
{
    vplTileSums* tileSums = tile->scratch;
    vplBlock blocks[SQUARE * SQUARE];
    const int side = SQUARE * VPL_BLOCK_SIDE, across = (r->width + side - 1) / side;
    for (int square = 0; square < across * ((r->height + side - 1) / side); square++) {
        const int x = (r->x + square % across * side) / VPL_BLOCK_SIDE;
        const int y = (r->y + square / across * side) / VPL_BLOCK_SIDE;
        int lit[SQUARE * SQUARE], litCount = 0;
        for (int i = 0; i < SQUARE * SQUARE; i++) {
            vplBlock* b = &blocks[i];
            prepareBlock(s, tile, (y + i / SQUARE) * VPL_TILE_BLOCKS + x + i % SQUARE, seen, b,
                         &tileSums->shadowRays);
            if (!b->same || b->points.triangle[0] >= 0) {
                lit[litCount++] = i;
            }
        }
        if (litCount > 0) {
            const vplBounds bounds = vplFindBounds(blocks, lit, litCount);
            addBounds(&bounds, r);
        }
    }
}

// Element of the tile's planes that holds pixel (x, y).
static inline int elementOf(int x, int y)
{
    const unsigned u = (unsigned)x, v = (unsigned)y; // division is a shift
    const unsigned block = v / VPL_BLOCK_SIDE * VPL_TILE_BLOCKS + u / VPL_BLOCK_SIDE;
    return (int)(block * VPL_LANES + v % VPL_BLOCK_SIDE * VPL_BLOCK_SIDE + u % VPL_BLOCK_SIDE);
}

// Elements that show something, of every K-th pixel from (x, y) on. Returns their number, at most 16 MAX_CHUNKS.
static int listPixels(const vplTile* tile, const Region* r, int x0, int y0, int step, int* elements)
{
    const int32_t* triangles = (const int32_t*)tile->planes[VPL_PLANE_TRIANGLE];
    int count = 0;
    for (int y = y0; y < r->y + r->height; y += step) {
        for (int x = x0; x < r->x + r->width; x += step) {
            const int element = elementOf(x, y);
            elements[count] = element;
            count += triangles[element] != 0;
        }
    }
    return count;
}

// Brings 16 pixels together. Lanes behind the last repeat the first, and show nothing that casts a ray.
static void collect(const vplShading* s, const vplTile* tile, const Region* r, int* elements, int count,
                    vplSeen* seen, vplBlock* b)
{
    for (int l = count; l < VPL_LANES; l++) {
        elements[l] = elements[0];
    }
    for (int k = 0; k < 3; k++) {
        const float* position = tile->planes[VPL_PLANE_POSITION + k];
        const float* normal = tile->planes[VPL_PLANE_NORMAL + k];
        float *p = b->surface.px + k * VPL_LANES, *n = b->surface.nx + k * VPL_LANES;
        for (int l = 0; l < VPL_LANES; l++) {
            p[l] = position[elements[l]];
        }
        const float low = r->bounds.low[3 + k], high = r->bounds.high[3 + k];
        for (int l = 0; l < VPL_LANES; l++) {
            n[l] = low;
        }
        for (int l = 0; low != high && l < VPL_LANES; l++) {
            n[l] = normal[elements[l]];
        }
    }
    for (int c = 0; c < 3; c++) {
        memset(b->sums[c], 0, sizeof b->sums[c]); // all at once becomes `rep stos`, which is slow to start
    }
    b->points.surface = b->points.plane = &b->surface;
    b->cluster = VPL_NO_CLUSTER;
    const bool asksPlane = s->smooth && s->def->lightClusters != NULL;
    if (s->def->lightShadows == NULL && !s->def->lightRays && s->nearLight == NULL && !asksPlane) {
        return;
    }
    const int32_t* triangles = (const int32_t*)tile->planes[VPL_PLANE_TRIANGLE];
    for (int l = 0; l < VPL_LANES; l++) {
        b->points.triangle[l] = l < count ? triangles[elements[l]] - 1 : -1;
    }
    if (s->smooth) {
        int32_t smooth[VPL_LANES];
        memcpy(&b->plane, &b->surface, 3 * sizeof b->surface.px);
        vplReadFacets(s, b->points.triangle, seen, &b->plane, smooth);
        b->points.plane = &b->plane;
    }
}

// What short rays find is gathered with the light of the class, which it is part of.
static void addNearLight(const vplShading* s, const vplTile* tile, const int* elements, vplBlock* b,
                         int64_t* rays)
{
    uint32_t pixels[VPL_LANES];
    float part[3][VPL_LANES] = {{0}};
    const int side = s->interleave->side;
    for (int l = 0; l < VPL_LANES; l++) {
        const int block = elements[l] / VPL_LANES, lane = elements[l] % VPL_LANES;
        const int x = tile->x + block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE + lane % VPL_BLOCK_SIDE;
        const int y = tile->y + block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE + lane / VPL_BLOCK_SIDE;
        pixels[l] = (uint32_t)y << 16 | (uint32_t)x;
    }
    vplAddNearLight(s, &b->points, pixels, part, rays);
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] += (double)part[c][l] / (side * side);
        }
    }
}

// Irradiance goes where positions were: no other class wants these.
static void scatter(vplTile* tile, const int* elements, int count, double factor, const vplBlock* b)
{
    for (int c = 0; c < 3; c++) {
        float* plane = tile->planes[VPL_PLANE_INDIRECT + c];
        for (int l = 0; l < count; l++) {
            plane[elements[l]] = (float)(factor * b->sums[c][l]);
        }
    }
}

// The pixels of one class by the lights of that class.
static void lightClass(const vplShading* s, vplTile* tile, const Region* r, int x, int y, vplSeen* seen)
{
    static const int all[MAX_CHUNKS] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    const int side = s->interleave->side, classes = side * side;
    const int which = (tile->y + y) % side * side + (tile->x + x) % side;
    const int first = s->interleave->classStart[which];
    const int end = s->interleave->classStart[which + 1];
    vplTileSums* tileSums = tile->scratch;
    int elements[(MAX_CHUNKS + 1) * VPL_LANES];
    const int count = listPixels(tile, r, x, y, side, elements);
    const int chunks = (count + VPL_LANES - 1) / VPL_LANES;
    vplBlock blocks[MAX_CHUNKS];
    for (int i = 0; i < chunks; i++) {
        const int left = count - i * VPL_LANES;
        collect(s, tile, r, elements + i * VPL_LANES, left < VPL_LANES ? left : VPL_LANES, seen, &blocks[i]);
        if (s->nearLight != NULL) {
            addNearLight(s, tile, elements + i * VPL_LANES, &blocks[i], &tileSums->shadowRays);
        }
    }
    vplAddLights(s, blocks, all, chunks, s->columns[0] != NULL ? &r->bounds : NULL, first, end - first,
                 &tileSums->shadowRays);
    for (int i = 0; i < chunks; i++) {
        const int left = count - i * VPL_LANES;
        scatter(tile, elements + i * VPL_LANES, left < VPL_LANES ? left : VPL_LANES, classes, &blocks[i]);
    }
}

void VPL_KERNEL(vplInterleaveTile)(void* data, vplTile* tile, int worker)
{
    const vplShading* s = data;
    const vplTileSums* tileSums = tile->scratch;
    const int side = sideOf(s->interleave->side);
    vplSeen* seen = &s->interleave->rooms[worker].seen;
    for (int y = 0; y < tile->height; y += side) {
        for (int x = 0; x < tile->width; x += side) {
            Region r = {.x = x, .y = y};
            r.width = tile->width - x < side ? tile->width - x : side;
            r.height = tile->height - y < side ? tile->height - y : side;
            prepareRegion(s, tile, &r, seen);
            for (int k = 0; r.any && k < s->interleave->side * s->interleave->side; k++) {
                lightClass(s, tile, &r, x + k % s->interleave->side, y + k / s->interleave->side, seen);
            }
        }
    }
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
}
