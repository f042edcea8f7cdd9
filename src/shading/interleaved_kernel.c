// SPDX-License-Identifier: MIT
// The first step of interleaved shading: pixels of one class, collected from a region of the tile, are lit by
// the lights of that class, 16 pixels at a time.
#include "base/isa.h"
#include "shading/accumulate.h"
#include "shading/interleave_filter_edges.h"
#include "shading/edges.h"

enum {
    SQUARE = 4,                      // blocks along a side that are read and lit directly together
    MAX_CHUNKS = 11,                 // 13 x 13 pixels, of 64 x 64 at K = 5
    BORDER = SQUARE * VPL_BLOCK_SIDE // rows beside those that are wanted; windows reach less far
};
_Static_assert(BORDER >= VPL_MAX_INTERLEAVE - 1, "windows of the filter reach beyond the border");

// A square of pixels of the tile, of a side that gives a class 16 pixels or more and keeps points in the
// first-level cache.
typedef struct Region {
    int x, y, width, height; // in the tile
    vplBounds bounds;        // of the visible points
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

// Writes direct light to the picture, and finished positions and normals to the planes.
static void prepareBlock(const vplShading* s, vplTile* tile, int block, vplFacetCache* cache, vplBlock* b)
{
    const int element = block * VPL_LANES;
    const float nothing[VPL_LANES] = {0};
    if (!vplReadBlock(s, tile, element, cache, b)) {
        for (int k = 0; k < 3; k++) {
            storeLanes(tile, VPL_PLANE_INDIRECT + k, element, nothing);
        }
    } else {
        _Alignas(64) float part[3][VPL_LANES] = {{0}};
        if (!s->irradiance) {
            vplStartDirect(s, tile, element, &b->points, part);
        }
        vplStartSums(b, part);
        for (int k = 0; k < 3; k++) {
            storeLanes(tile, VPL_PLANE_POSITION + k, element, b->columns[k]);
            storeLanes(tile, VPL_PLANE_NORMAL + k, element, b->columns[3 + k]);
        }
    }
    vplWriteLit(s, tile, block, cache, b);
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

// Prepares all blocks of a region, square by square.
static void prepareRegion(const vplShading* s, vplTile* tile, Region* r, vplFacetCache* cache)
{
    vplBlock blocks[SQUARE * SQUARE];
    const int side = SQUARE * VPL_BLOCK_SIDE, across = (r->width + side - 1) / side;
    for (int square = 0; square < across * ((r->height + side - 1) / side); square++) {
        const int x = (r->x + square % across * side) / VPL_BLOCK_SIDE;
        const int y = (r->y + square / across * side) / VPL_BLOCK_SIDE;
        int lit[SQUARE * SQUARE], litCount = 0;
        for (int i = 0; i < SQUARE * SQUARE; i++) {
            vplBlock* b = &blocks[i];
            prepareBlock(s, tile, (y + i / SQUARE) * VPL_TILE_BLOCKS + x + i % SQUARE, cache, b);
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

// Lists elements that show something among every K-th pixel from (x0, y0) on. Returns their number, at most
// 16 MAX_CHUNKS.
static int listPixels(const vplTile* tile, const Region* r, int x0, int y0, int step, int* elements)
{
    const int32_t* triangles = (const int32_t*)tile->planes[VPL_PLANE_TRIANGLE];
    int count = 0;
    for (int y = y0; y < r->y + r->height; y += step) {
        for (int x = x0; x < r->x + r->width; x += step) {
            const int element = vplElementOf(x, y);
            elements[count] = element;
            count += triangles[element] != 0;
        }
    }
    return count;
}

// Pixels of one class in a region. Elements are those of the tile's planes.
typedef struct Class {
    const vplShading* shading;
    vplTile* tile;
    const Region* region;
    vplFacetCache* cache;
    int elements[(MAX_CHUNKS + 1) * VPL_LANES], count;
} Class;

// Tests whether shadows or rays of the points read the points' triangles and planes.
static bool needsPoints(const vplShading* s)
{
    const vplLightList* list = &s->lights;
    return list->maps != NULL || list->castsRays || vplFindsLightByRays(s) ||
           (list->clusters != NULL && (s->smooth || s->geometry->cutOuts != NULL));
}

// Copies `count` pixels from elements[0] on into a block. Lanes behind the last repeat the first, and cast no
// rays.
static void collect(const Class* class, int* elements, int count, vplBlock* b)
{
    const vplShading* s = class->shading;
    const vplTile* tile = class->tile;
    for (int l = count; l < VPL_LANES; l++) {
        elements[l] = elements[0];
    }
    for (int k = 0; k < 3; k++) {
        const float* position = tile->planes[VPL_PLANE_POSITION + k];
        const float* normal = tile->planes[VPL_PLANE_NORMAL + k];
        float *p = b->columns[k], *n = b->columns[3 + k];
        for (int l = 0; l < VPL_LANES; l++) {
            p[l] = position[elements[l]];
        }
        const float low = class->region->bounds.low[3 + k], high = class->region->bounds.high[3 + k];
        for (int l = 0; l < VPL_LANES; l++) {
            n[l] = low;
        }
        for (int l = 0; low != high && l < VPL_LANES; l++) {
            n[l] = normal[elements[l]];
        }
    }
    for (int c = 0; c < 3; c++) {
        memset(b->sums[c], 0,
               sizeof b->sums[c]); // one memset of all becomes `rep stos`, which is slow to start
    }
    b->points.surface = b->points.plane = &b->surface;
    b->cluster = VPL_NO_CLUSTER;
    if (!needsPoints(s)) {
        return;
    }
    const int32_t* triangles = (const int32_t*)tile->planes[VPL_PLANE_TRIANGLE];
    for (int l = 0; l < VPL_LANES; l++) {
        b->points.triangle[l] = l < count ? triangles[elements[l]] - 1 : -1;
    }
    if (s->smooth) {
        int32_t smooth[VPL_LANES];
        memcpy(&b->plane, &b->surface, 3 * sizeof b->surface.px);
        vplReadFacets(s, b->points.triangle, class->cache, &b->plane, smooth);
        b->points.plane = &b->plane;
    }
}

// Adds what the points find by rays to the light of the class: both are filtered.
static void addLightOfRays(const Class* class, int side, const int* elements, vplBlock* b, int64_t* rays)
{
    const vplTile* tile = class->tile;
    uint32_t pixels[VPL_LANES];
    float part[3][VPL_LANES] = {{0}};
    for (int l = 0; l < VPL_LANES; l++) {
        const int block = elements[l] / VPL_LANES, lane = elements[l] % VPL_LANES;
        const int x = tile->x + block % VPL_TILE_BLOCKS * VPL_BLOCK_SIDE + lane % VPL_BLOCK_SIDE;
        const int y = tile->y + block / VPL_TILE_BLOCKS * VPL_BLOCK_SIDE + lane / VPL_BLOCK_SIDE;
        pixels[l] = (uint32_t)y << 16 | (uint32_t)x;
    }
    vplAddLightOfRays(class->shading, &b->points, pixels, part, rays);
    for (int c = 0; c < 3; c++) {
        for (int l = 0; l < VPL_LANES; l++) {
            b->sums[c][l] += (double)part[c][l] / (side * side);
        }
    }
}

// Writes irradiance over positions, which no other class reads.
static void scatter(vplTile* tile, const int* elements, int count, double factor, const vplBlock* b)
{
    for (int c = 0; c < 3; c++) {
        float* plane = tile->planes[VPL_PLANE_INDIRECT + c];
        for (int l = 0; l < count; l++) {
            plane[elements[l]] = (float)(factor * b->sums[c][l]);
        }
    }
}

// Lights the pixels of the class of (x, y), a pixel of the tile.
static void lightClass(Class* class, int x, int y)
{
    static const int all[MAX_CHUNKS] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
    const vplShading* s = class->shading;
    const vplInterleave* w = s->state;
    vplTile* tile = class->tile;
    vplTileSums* tileSums = tile->scratch;
    const int side = w->side, which = (tile->y + y) % side * side + (tile->x + x) % side;
    const int first = w->classStart[which], end = w->classStart[which + 1];
    class->count = listPixels(tile, class->region, x, y, side, class->elements);
    vplBlock blocks[MAX_CHUNKS];
    vplLitBlocks to = {.blocks = blocks, .lit = all, .count = (class->count + VPL_LANES - 1) / VPL_LANES};
    for (int i = 0; i < to.count; i++) {
        const int left = class->count - i * VPL_LANES;
        int* elements = class->elements + i * VPL_LANES;
        collect(class, elements, left < VPL_LANES ? left : VPL_LANES, &blocks[i]);
        if (vplFindsLightByRays(s)) {
            addLightOfRays(class, side, elements, &blocks[i], &tileSums->shadowRays);
        }
    }
    to.culls = s->lights.columns[0] != NULL;
    to.bounds = class->region->bounds;
    vplAddLights(s, &to, first, end - first, &tileSums->shadowRays);
    for (int i = 0; i < to.count; i++) {
        const int left = class->count - i * VPL_LANES;
        scatter(tile, class->elements + i * VPL_LANES, left < VPL_LANES ? left : VPL_LANES, side * side,
                &blocks[i]);
    }
}

// ---- edges

// The edges of one tile. The filter finds the indirect light of the first mostEdges surfaces; all light of
// the others is found now.
typedef struct TileEdges {
    vplKeptEdge* kept;
    int* keptCount;
    vplEdgeQueue direct, all;
} TileEdges;

static void lightEdgePixel(const vplShading* s, void* user, const vplEdgePixel* p)
{
    const vplInterleave* w = s->state;
    TileEdges* t = user;
    w->centres[(size_t)p->y * (size_t)s->image->width + (size_t)p->x] = p->share;
    for (int i = 0; i < p->count; i++) {
        const bool keep = *t->keptCount < w->mostEdges;
        if (keep) {
            t->kept[(*t->keptCount)++] = (vplKeptEdge){(uint16_t)p->x, (uint16_t)p->y, p->others[i]};
        }
        vplEdgeQueue_Push(keep ? &t->direct : &t->all, &p->others[i], p->x, p->y);
    }
}

static void lightTileEdges(const vplShading* s, vplTile* tile, vplFacetCache* cache)
{
    const vplInterleave* w = s->state;
    vplTileSums* tileSums = tile->scratch;
    const int number = tile->y / VPL_TILE_SIDE * w->rasterTilesX + tile->x / VPL_TILE_SIDE;
    int turn = number; // of the classes
    TileEdges edges = {
        .kept = w->edges + (size_t)number * (size_t)w->mostEdges,
        .keptCount = &w->edgeCounts[number],
        .direct = {s, cache, NULL, NULL, &tileSums->shadowRays, .direct = true},
        .all = {s, cache, vplAddSomeClasses, &turn, &tileSums->shadowRays, .direct = true, .indirect = true}};
    *edges.keptCount = 0;
    for (int y = tile->y; y < tile->y + tile->height; y++) {
        for (int x = tile->x; x < tile->x + tile->width; x++) {
            w->centres[(size_t)y * (size_t)s->image->width + (size_t)x] = 1;
        }
    }
    vplVisitEdges(s, tile, cache, lightEdgePixel, &edges);
    vplEdgeQueue_Flush(&edges.direct);
    vplEdgeQueue_Flush(&edges.all);
}

void VPL_KERNEL(vplInterleaveTile)(void* data, vplTile* tile, int worker)
{
    const vplShading* s = data;
    const vplInterleave* w = s->state;
    const vplTileSums* tileSums = tile->scratch;
    const int side = sideOf(w->side);
    // A tile above or below the rows that are wanted only serves the filter's windows.
    const bool above = tile->y + tile->height <= s->firstRow, below = tile->y >= s->endRow;
    const int first = above ? tile->height - BORDER : 0,
              last = below && BORDER < tile->height ? BORDER : tile->height;
    // Sixteen near hits of a final gather share their lights, so its regions are those of the whole tile.
    const bool whole = s->gather != NULL;
    const int start = whole ? first / side * side : first, bottom = whole ? tile->height : last;
    for (int y = start; y < last; y += side) {
        for (int x = 0; x < tile->width; x += side) {
            Region r = {.x = x, .y = y};
            r.width = tile->width - x < side ? tile->width - x : side;
            r.height = bottom - y < side ? bottom - y : side;
            Class class;
            class.shading = s;
            class.tile = tile;
            class.region = &r;
            class.cache = &w->scratch[worker].facets;
            prepareRegion(s, tile, &r, class.cache);
            for (int k = 0; r.any && k < w->side * w->side; k++) {
                lightClass(&class, x + k % w->side, y + k / w->side);
            }
        }
    }
    if (tile->sampleCount > 0 && !above && !below) {
        lightTileEdges(s, tile, &w->scratch[worker].facets);
    }
    __atomic_fetch_add(s->shadowRays, tileSums->shadowRays, __ATOMIC_RELAXED);
}
