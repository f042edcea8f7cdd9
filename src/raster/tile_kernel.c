// SPDX-License-Identifier: MIT
// Draws triangles into one tile: 4 x 4 squares of 4 x 4 blocks of 4 x 4 pixels. Squares and blocks that a
// triangle does not touch are left out, in those it fills no pixel is asked. Compiled once per instruction set;
// all give the same bits.
// Based on: Michael Abrash, Rasterization on Larrabee, Game Developers Conference 2009: three levels of 4 x 4.
// Ned Greene, Michael Kass and Gavin Miller, Hierarchical Z-Buffer Visibility, SIGGRAPH 1993: a block knows the
// farthest depth in it, and what lies behind that is not looked at.
#include "base/isa.h"
#include "raster/setup.h"
#include "raster/shares.h"
#include "raster/tiny.h"

#include <math.h>
#include <string.h>

enum { SQUARE_SIDE = 4 * VPL_BLOCK_SIDE, SQUARES = VPL_TILE_SIDE / SQUARE_SIDE };

typedef struct Draw {
    vplTileState* state;
    const vplRaster* raster;
    const vplPipeline* pipeline;
    const vplShaded* shaded;
    const Batch* batch;
    int place, owner; // of the triangle: in its batch, and its name among owners
    Shares* shares;   // of the triangle, once they are needed
    float texel;      // of a view of 90 by 90 degrees, whose half is 1
    bool hasShares, keep, depthOnly, distances, rejects, tightens;
} Draw;

// ---- coverage

static inline void edgesAt(const Setup* s, int x, int y, int32_t edge[3])
{
    for (int i = 0; i < 3; i++) {
        edge[i] = edgeOf(s->e[i] + 256 * (s->a[i] * x + s->b[i] * y));
    }
}

// Lanes of the block at (x, y) that are inside the triangle and the picture; 0 if there are none. `edge`: its edge
// functions in lane 0.
static inline int32_t cover(const Draw* d, const Setup* s, const int32_t edge[3], int x, int y,
                            int32_t covered[restrict VPL_LANES])
{
    int32_t any = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        const int32_t outside =
            (edge[0] + s->steps[0][l]) | (edge[1] + s->steps[1][l]) | (edge[2] + s->steps[2][l]);
        covered[l] = ~(outside >> 31);
        any |= covered[l];
    }
    const vplTile* tile = &d->state->tile;
    if (any && (x + VPL_BLOCK_SIDE > tile->width || y + VPL_BLOCK_SIDE > tile->height)) {
        any = 0;
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= x + (l & 3) < tile->width && y + (l >> 2) < tile->height ? -1 : 0;
            any |= covered[l];
        }
    }
    return any;
}

// 4 x 4 cells, one bit each.
typedef struct Cells {
    uint32_t touched, filled;
} Cells;

static inline double least3(double a, double b, double c)
{
    const double ab = a < b ? a : b;
    return ab < c ? ab : c;
}

// Which cells of `side` pixels from (x, y) on a triangle touches, and which it fills. Doubles hold these integers
// exactly, and unlike 64-bit integers they have a minimum in every instruction set.
static inline Cells classify(const Setup* s, int x, int y, int side)
{
    double e[3], right[3], down[3], most[3], least[3];
    for (int i = 0; i < 3; i++) {
        const double a = 256.0 * s->a[i], b = 256.0 * s->b[i];
        e[i] = s->e[i] + (a * x + b * y);
        right[i] = a * side;
        down[i] = b * side;
        most[i] = (side - 1) * ((a > 0 ? a : 0) + (b > 0 ? b : 0)); // from a cell's first centre
        least[i] = (side - 1) * ((a < 0 ? a : 0) + (b < 0 ? b : 0));
    }
    float highest[VPL_LANES], lowest[VPL_LANES]; // only the sign is of interest
    for (int l = 0; l < VPL_LANES; l++) {
        const int column = l & 3, row = l >> 2;
        const double u = e[0] + (right[0] * column + down[0] * row);
        const double v = e[1] + (right[1] * column + down[1] * row);
        const double w = e[2] + (right[2] * column + down[2] * row);
        highest[l] = (float)least3(u + most[0], v + most[1], w + most[2]);
        lowest[l] = (float)least3(u + least[0], v + least[1], w + least[2]);
    }
    Cells cells = {0, 0};
    for (int l = 0; l < VPL_LANES; l++) {
        cells.touched |= (uint32_t)(highest[l] >= 0) << l;
        cells.filled |= (uint32_t)(lowest[l] >= 0) << l;
    }
    return cells;
}

// ---- blocks

// -1 where a depth passes the test against the one that is there.
static inline int32_t passes(vplDepthCompare compare, float depth, float old)
{
    switch (compare) {
    case VPL_DEPTH_LESS:
        return depth < old ? -1 : 0;
    case VPL_DEPTH_LESS_EQUAL:
        return depth <= old ? -1 : 0;
    case VPL_DEPTH_EQUAL:
        return depth == old ? -1 : 0;
    case VPL_DEPTH_ALWAYS:
        break;
    }
    return -1;
}

// Lanes that pass owner and depth test stay covered; 0 if there are none. `compare` is a constant where this is
// called, so that each test is a loop without branches.
static inline int32_t testLanes(vplTileState* state, vplDepthCompare compare, bool ownerTest, int owner,
                                int at)
{
    vplFragments* f = &state->block;
    int32_t covered[VPL_LANES], owners[VPL_LANES], any = 0;
    float depth[VPL_LANES], old[VPL_LANES];
    memcpy(covered, f->covered, sizeof covered);
    memcpy(depth, f->depth, sizeof depth);
    memcpy(old, state->depth + at, sizeof old);
    if (ownerTest) {
        memcpy(owners, state->owner + at, sizeof owners);
        for (int l = 0; l < VPL_LANES; l++) {
            covered[l] &= owners[l] == owner ? -1 : 0;
        }
    }
    for (int l = 0; l < VPL_LANES; l++) {
        covered[l] &= passes(compare, depth[l], old[l]);
        any |= covered[l];
    }
    memcpy(f->covered, covered, sizeof covered);
    return any;
}

static inline int32_t testFragments(vplTileState* state, const vplPipeline* p, int owner, int at)
{
    switch (p->depthCompare) {
    case VPL_DEPTH_LESS:
        return testLanes(state, VPL_DEPTH_LESS, p->ownerTest, owner, at);
    case VPL_DEPTH_LESS_EQUAL:
        return testLanes(state, VPL_DEPTH_LESS_EQUAL, p->ownerTest, owner, at);
    case VPL_DEPTH_EQUAL:
        return testLanes(state, VPL_DEPTH_EQUAL, p->ownerTest, owner, at);
    case VPL_DEPTH_ALWAYS:
        break;
    }
    return testLanes(state, VPL_DEPTH_ALWAYS, p->ownerTest, owner, at);
}

static inline void blendPlane(vplBlend blend, const int32_t covered[VPL_LANES], const float* drawn,
                              float* plane)
{
    float from[VPL_LANES], to[VPL_LANES];
    memcpy(from, drawn, sizeof from);
    memcpy(to, plane, sizeof to);
    for (int l = 0; l < VPL_LANES; l++) {
        const float kept = to[l], sum = kept + from[l]; // made for all lanes: a choice then, not a branch
        to[l] = covered[l] ? (blend == VPL_BLEND_ADD ? sum : from[l]) : kept;
    }
    memcpy(plane, to, sizeof to);
}

static inline void blendPlanes(const vplPipeline* p, const vplFragments* f, float* const planes[],
                               int planeCount)
{
    int32_t covered[VPL_LANES];
    memcpy(covered, f->covered, sizeof covered);
    for (int k = 0; k < planeCount; k++) {
        if ((p->planeMask >> k & 1) == 0) {
            continue;
        }
        if (p->blend == VPL_BLEND_ADD) {
            blendPlane(VPL_BLEND_ADD, covered, f->plane[k], planes[k] + f->element);
        } else {
            blendPlane(VPL_BLEND_REPLACE, covered, f->plane[k], planes[k] + f->element);
        }
    }
}

static inline void readPlanes(vplFragments* f, float* const planes[], uint32_t mask, int planeCount)
{
    for (int k = 0; k < planeCount; k++) {
        if (mask >> k & 1) {
            memcpy(f->plane[k], planes[k] + f->element, sizeof f->plane[k]);
        }
    }
}

static inline void runFragmentShader(const vplPipeline* p, vplFragments* f, float* const planes[],
                                     int planeCount)
{
    if (p->readsPlanes) {
        readPlanes(f, planes, UINT32_MAX, planeCount);
    }
    p->fragment(p->fragmentUniforms, f);
}

// Several passes in one call.
static inline void runPassShader(const vplPipeline* p, const void* const* uniforms, int count,
                                 vplFragments* f, float* const planes[], int planeCount)
{
    readPlanes(f, planes, p->planeMask, planeCount);
    p->passes(uniforms, count, f);
    for (int k = 0; k < planeCount; k++) {
        if (p->planeMask >> k & 1) {
            blendPlane(VPL_BLEND_REPLACE, f->covered, f->plane[k], planes[k] + f->element);
        }
    }
}

static inline void needShares(Draw* d)
{
    if (!d->hasShares) {
        const vplTriangle t = triangleOf(d->batch, d->place);
        setUpShares(d->raster, &t, d->shaded, d->shares);
        d->hasShares = true;
    }
}

// Interpolates, and runs the surface shader.
static void makeSurface(Draw* d)
{
    vplFragments* f = &d->state->block;
    if (d->shaded->varyingCount == 0 && !d->pipeline->needsW) {
        return;
    }
    needShares(d);
    interpolate(d->shares, d->shaded->varyingCount, f->x, f->y, f);
    if (d->pipeline->surface != NULL) {
        d->pipeline->surface(d->pipeline->vertexUniforms, f);
    }
}

static int keptVaryings(const vplTileState* state)
{
    return (int)((state->keptStride - sizeof(vplKeptBlock)) / sizeof(float)) / VPL_LANES - 2;
}

static void keepBlock(vplTileState* state)
{
    const vplFragments* f = &state->block;
    vplKeptBlock* kept = (vplKeptBlock*)(state->kept + (size_t)state->keptCount++ * state->keptStride);
    float* to = (float*)(kept + 1);
    kept->x = f->x;
    kept->y = f->y;
    kept->element = f->element;
    kept->primitive = f->primitive;
    kept->count = 0;
    for (int l = 0; l < VPL_LANES; l++) {
        kept->covered[l] = f->covered[l];
        kept->count -= f->covered[l];
    }
    memcpy(to, f->depth, sizeof f->depth);
    memcpy(to + VPL_LANES, f->w, sizeof f->w);
    memcpy(to + 2 * VPL_LANES, f->varying, (size_t)keptVaryings(state) * sizeof f->varying[0]);
}

// Fragments by lane. Neighbouring blocks count in different places: none waits for the one before.
static inline int32_t* countersOf(vplTileState* state, int at)
{
    return state->fragmentLanes[at / VPL_LANES % VPL_COUNTERS];
}

// Depth and nothing else. Lanes are copied first, so that the compiler need not ask whether arrays overlap.
static inline void drawDepth(vplTileState* state, const Setup* s, double z, int at, bool filled)
{
    int32_t* counts = countersOf(state, at);
    float depth[VPL_LANES];
    int32_t covered[VPL_LANES];
    memcpy(depth, state->depth + at, sizeof depth);
    memcpy(covered, state->block.covered, sizeof covered);
    for (int l = 0; l < VPL_LANES; l++) {
        const float v = clampDepth(z + s->laneZ[l]), kept = depth[l];
        const int32_t passed = (filled ? -1 : covered[l]) & (v < kept ? -1 : 0);
        depth[l] = passed ? v : kept;
        counts[l] -= passed;
    }
    memcpy(state->depth + at, depth, sizeof depth);
}

// Distance from the eye and nothing else. Based on: Franchi and Ferrante, Virtual Point Lights, "Rendering the
// Cube Shadow Map"; departs: w is turned into a distance by the texel's own direction.
static inline void drawDistance(const Draw* d, int x, int y, int at, bool filled)
{
    vplTileState* state = d->state;
    const float scale = d->pipeline->distanceScale, texel = d->texel;
    const float left = (float)(state->tile.x + x), top = (float)(state->tile.y + y);
    int32_t* counts = countersOf(state, at);
    float depth[VPL_LANES], share0[VPL_LANES], share1[VPL_LANES], share2[VPL_LANES];
    int32_t covered[VPL_LANES];
    memcpy(depth, state->depth + at, sizeof depth);
    memcpy(covered, state->block.covered, sizeof covered);
    shareOf(d->shares, 0, state->tile.x + x, state->tile.y + y, share0);
    shareOf(d->shares, 1, state->tile.x + x, state->tile.y + y, share1);
    shareOf(d->shares, 2, state->tile.x + x, state->tile.y + y, share2);
    for (int l = 0; l < VPL_LANES; l++) {
        const float s = (left + (float)(l & 3) + 0.5f) * texel - 1;
        const float t = 1 - (top + (float)(l >> 2) + 0.5f) * texel;
        const float w = 1 / (share0[l] + share1[l] + share2[l]);
        const float v = w * sqrtf(1 + s * s + t * t) * scale, kept = depth[l];
        const int32_t passed = (filled ? -1 : covered[l]) & (v < kept ? -1 : 0);
        depth[l] = passed ? v : kept;
        counts[l] -= passed;
    }
    memcpy(state->depth + at, depth, sizeof depth);
}

static inline void writeDepth(vplTileState* state, int owner, int at)
{
    const vplFragments* f = &state->block;
    float depth[VPL_LANES];
    memcpy(depth, state->depth + at, sizeof depth);
    for (int l = 0; l < VPL_LANES; l++) {
        const float drawn = f->depth[l], kept = depth[l];
        depth[l] = f->covered[l] ? drawn : kept;
    }
    memcpy(state->depth + at, depth, sizeof depth);
    if (state->owner != NULL) {
        int32_t owners[VPL_LANES];
        memcpy(owners, state->owner + at, sizeof owners);
        for (int l = 0; l < VPL_LANES; l++) {
            const int32_t kept = owners[l];
            owners[l] = f->covered[l] ? owner : kept;
        }
        memcpy(state->owner + at, owners, sizeof owners);
    }
}

// Depth, owners and planes, as the pipeline says, of the lanes in f->covered.
static void drawFragments(Draw* d, const Setup* s, double z)
{
    vplTileState* state = d->state;
    const vplPipeline* p = d->pipeline;
    vplFragments* f = &state->block;
    const int at = f->element;
    if (p->writesDepth) {
        makeSurface(d);
        runFragmentShader(p, f, state->tile.planes, d->raster->framebuffer.planeCount);
    } else {
        for (int l = 0; l < VPL_LANES; l++) {
            f->depth[l] = clampDepth(z + s->laneZ[l]);
        }
    }
    if (!testFragments(state, p, d->owner, at)) {
        return;
    }
    if (d->keep) {
        makeSurface(d);
        keepBlock(state);
        return;
    }
    int32_t* counts = countersOf(state, at);
    for (int l = 0; l < VPL_LANES; l++) {
        counts[l] -= f->covered[l];
    }
    if (p->depthWrite) {
        writeDepth(state, d->owner, at);
    }
    if (p->fragment != NULL) {
        if (!p->writesDepth) {
            makeSurface(d);
            runFragmentShader(p, f, state->tile.planes, d->raster->framebuffer.planeCount);
        }
        blendPlanes(p, f, state->tile.planes, d->raster->framebuffer.planeCount);
    }
}

// z: depth in lane 0. `edge`: edge functions there; NULL: all lanes are inside the triangle and the picture.
static inline __attribute__((always_inline)) void drawBlock(Draw* d, const Setup* s, int x, int y, double z,
                                                            const int32_t edge[3])
{
    vplTileState* state = d->state;
    vplFragments* f = &state->block;
    const bool filled = edge == NULL;
    const int block = (y / VPL_BLOCK_SIDE) * VPL_TILE_BLOCKS + x / VPL_BLOCK_SIDE;
    if (!filled && !cover(d, s, edge, x, y, f->covered)) {
        return;
    }
    if (d->distances) {
        if (filled) {
            drawDistance(d, x, y, block * VPL_LANES, true);
        } else {
            drawDistance(d, x, y, block * VPL_LANES, false);
        }
        return;
    }
    if (d->depthOnly) {
        if (filled) {
            drawDepth(state, s, z, block * VPL_LANES, true);
        } else {
            drawDepth(state, s, z, block * VPL_LANES, false);
        }
        return;
    }
    if (filled) {
        memset(f->covered, 0xff, sizeof f->covered);
    }
    f->x = state->tile.x + x;
    f->y = state->tile.y + y;
    f->element = block * VPL_LANES;
    drawFragments(d, s, z);
}

// ---- triangles

static inline int minOf(int a, int b)
{
    return a < b ? a : b;
}

static inline int maxOf(int a, int b)
{
    return a > b ? a : b;
}

// Cells of 4 x 4 between two columns and two rows.
static inline uint32_t cellsWithin(int x0, int x1, int y0, int y1)
{
    x0 = maxOf(x0, 0);
    y0 = maxOf(y0, 0);
    x1 = minOf(x1, 3);
    y1 = minOf(y1, 3);
    if (x1 < x0 || y1 < y0) {
        return 0;
    }
    const uint32_t row = (2u << x1) - (1u << x0);
    const uint32_t rows = (0x1111u << 4 * y0) & (0x1111u >> 4 * (3 - y1));
    return row * rows;
}

static inline double depthAt(const Setup* s, int x, int y)
{
    return s->z + (s->zx * x + s->zy * y);
}

// Blocks of a square in which all that is there is nearer than the triangle. z: its depths in lane 0 of each.
static inline uint32_t hiddenBlocks(const Setup* s, const double z[VPL_LANES],
                                    const float farthest[VPL_LANES])
{
    uint32_t hidden = 0;
    for (int i = 0; i < VPL_LANES; i++) {
        hidden |= (uint32_t)(clampDepth(z[i] + s->leastZ) > farthest[i]) << i;
    }
    return hidden;
}

// In blocks that the triangle fills no lane keeps a depth beyond the triangle's.
static inline void tightenBlocks(const Setup* s, const double z[VPL_LANES], uint32_t filled,
                                 float farthest[VPL_LANES])
{
    for (int i = 0; i < VPL_LANES; i++) {
        const float most = clampDepth(z[i] + s->mostZ), kept = farthest[i];
        const float least = most < kept ? most : kept;
        farthest[i] = (filled >> i & 1) != 0 ? least : kept;
    }
}

// The blocks of a square whose bits are set in `within`.
static void drawSquare(Draw* d, const Setup* s, int x, int y, uint32_t within, bool filled)
{
    const vplTile* tile = &d->state->tile;
    Cells cells = {0xffff, 0xffff};
    if (!filled) {
        cells = classify(s, x, y, VPL_BLOCK_SIDE);
    }
    cells.touched &= within;
    if (x + SQUARE_SIDE > tile->width || y + SQUARE_SIDE > tile->height) {
        cells.filled &= cellsWithin(0, (tile->width - x) / VPL_BLOCK_SIDE - 1, 0,
                                    (tile->height - y) / VPL_BLOCK_SIDE - 1);
    }
    double z[VPL_LANES];
    for (int i = 0; i < VPL_LANES; i++) {
        z[i] = depthAt(s, x + (i & 3) * VPL_BLOCK_SIDE, y + (i >> 2) * VPL_BLOCK_SIDE);
    }
    float* farthest = d->state->farthest + (y / SQUARE_SIDE * SQUARES + x / SQUARE_SIDE) * VPL_LANES;
    if (d->rejects) {
        cells.touched &= ~hiddenBlocks(s, z, farthest);
    }
    if (d->tightens) {
        tightenBlocks(s, z, cells.touched & cells.filled, farthest);
    }
    for (uint32_t blocks = cells.touched; blocks != 0; blocks &= blocks - 1) {
        const int i = __builtin_ctz(blocks);
        const int bx = x + (i & 3) * VPL_BLOCK_SIDE, by = y + (i >> 2) * VPL_BLOCK_SIDE;
        if (cells.filled >> i & 1) {
            drawBlock(d, s, bx, by, z[i], NULL);
        } else {
            int32_t edge[3];
            edgesAt(s, bx, by, edge);
            drawBlock(d, s, bx, by, z[i], edge);
        }
    }
}

static void drawTriangle(Draw* d)
{
    const Batch* t = d->batch;
    const int x0 = t->x0[d->place], x1 = t->x1[d->place], y0 = t->y0[d->place], y1 = t->y1[d->place];
    Setup s;
    setUp(t, d->place, &s);
    if (d->distances) {
        needShares(d);
    }
    if (x1 == x0 && y1 == y0) {
        const int32_t edge[3] = {t->edge[0][d->place], t->edge[1][d->place], t->edge[2][d->place]};
        const int x = x0 * VPL_BLOCK_SIDE, y = y0 * VPL_BLOCK_SIDE;
        drawBlock(d, &s, x, y, depthAt(&s, x, y), edge);
        return;
    }
    if (x1 - x0 <= 1 && y1 - y0 <= 1) { // asking pixels at once is less work
        for (int row = y0; row <= y1; row++) {
            for (int column = x0; column <= x1; column++) {
                const int x = column * VPL_BLOCK_SIDE, y = row * VPL_BLOCK_SIDE;
                int32_t edge[3];
                edgesAt(&s, x, y, edge);
                drawBlock(d, &s, x, y, depthAt(&s, x, y), edge);
            }
        }
        return;
    }
    boundDepth(&s);
    Cells squares = {0xffff, 0};
    if (x1 - x0 >= 4 || y1 - y0 >= 4) {
        squares = classify(&s, 0, 0, SQUARE_SIDE);
    }
    squares.touched &= cellsWithin(x0 / 4, x1 / 4, y0 / 4, y1 / 4);
    for (; squares.touched != 0; squares.touched &= squares.touched - 1) {
        const int i = __builtin_ctz(squares.touched), x = i & 3, y = i >> 2;
        drawSquare(d, &s, x * SQUARE_SIDE, y * SQUARE_SIDE,
                   cellsWithin(x0 - 4 * x, x1 - 4 * x, y0 - 4 * y, y1 - 4 * y), squares.filled >> i & 1);
    }
}

vplDrawTileFcn VPL_KERNEL(vplDrawTile);

void VPL_KERNEL(vplDrawTile)(vplTileState* state, const vplRaster* raster, const vplCommand* command,
                             const int* list, int count, bool keep)
{
    const vplPipeline* p = &raster->pipelines[command->pipeline];
    const bool nearer = p->depthCompare == VPL_DEPTH_LESS || p->depthCompare == VPL_DEPTH_LESS_EQUAL;
    const bool byPlane = nearer && !p->writesDepth && p->distanceScale == 0; // depth is the triangle's plane
    Shares shares;
    Batch batch;
    Tiny tiny;
    memset(batch.x, 0, sizeof batch.x); // places that stay empty are computed, too
    memset(batch.y, 0, sizeof batch.y);
    memset(batch.z, 0, sizeof batch.z);
    memset(batch.vertex, 0, sizeof batch.vertex);
    Draw d = {.state = state,
              .raster = raster,
              .pipeline = p,
              .shaded = &raster->shaded[command->shaded],
              .shares = &shares,
              .batch = &batch,
              .keep = keep,
              .distances = p->distanceScale != 0,
              .texel = 2.0f / (float)raster->framebuffer.width,
              .rejects = byPlane,
              .tightens = byPlane && p->depthWrite && !p->ownerTest};
    d.depthOnly = p->fragment == NULL && p->distanceScale == 0 && p->depthCompare == VPL_DEPTH_LESS &&
                  p->depthWrite && !p->ownerTest && state->owner == NULL;
    state->block.scratch = state->tile.scratch;
    for (int first = 0; first < count; first += BATCH) {
        const int some = count - first < BATCH ? count - first : BATCH;
        for (int k = 0; k < some; k++) {
            fetchTriangle(raster, d.shaded, list[first + k], &batch, k);
        }
        setUpBatch(&state->tile, &batch);
        if (d.depthOnly) {
            testTiny(&batch, &tiny);
        }
        for (int k = 0; k < some; k++) {
            d.owner = list[first + k];
            d.place = k;
            d.hasShares = false;
            state->block.primitive = batch.primitive[k];
            if (d.depthOnly && p->cull == VPL_CULL_NONE && isTiny(&batch, k)) {
                state->fragments += drawTiny(&tiny, k, state->depth);
            } else if (p->cull == VPL_CULL_NONE || (p->cull == VPL_CULL_BACK) != (batch.clockwise[k] != 0)) {
                drawTriangle(&d);
            }
        }
    }
    if (p->depthWrite && p->depthCompare == VPL_DEPTH_ALWAYS) {
        for (int i = 0; i < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; i++) {
            state->farthest[i] = INFINITY;
        }
    }
}

vplRunPassesFcn VPL_KERNEL(vplRunPasses);

void VPL_KERNEL(vplRunPasses)(vplTileState* state, const vplRaster* raster, int first)
{
    vplFragments* f = &state->block;
    const vplCommand* start = &raster->commands[first];
    const int mesh = start->shaded, planeCount = raster->framebuffer.planeCount;
    const size_t varyings = (size_t)keptVaryings(state);
    float* planes[VPL_MAX_PLANES];
    memcpy(planes, state->tile.planes, sizeof planes);
    int64_t fragments = 0;
    for (int i = state->keptStart[mesh]; i < state->keptEnd[mesh]; i++) {
        const vplKeptBlock* kept = (const vplKeptBlock*)(state->kept + (size_t)i * state->keptStride);
        const float* from = (const float*)(kept + 1);
        f->x = kept->x;
        f->y = kept->y;
        f->element = kept->element;
        f->primitive = kept->primitive;
        memcpy(f->covered, kept->covered, sizeof f->covered);
        memcpy(f->depth, from, sizeof f->depth);
        memcpy(f->w, from + VPL_LANES, sizeof f->w);
        memcpy(f->varying, from + 2 * VPL_LANES, varyings * sizeof f->varying[0]);
        if (start->fused > 0) {
            runPassShader(&raster->pipelines[start->pipeline], raster->passUniforms + start->uniforms,
                          start->fused, f, planes, planeCount);
            fragments += (int64_t)kept->count * start->fused;
            continue;
        }
        for (int c = first; c >= 0; c = raster->commands[c].chainNext) {
            const vplPipeline* p = &raster->pipelines[raster->commands[c].pipeline];
            if (p->passes != NULL) {
                runPassShader(p, &p->fragmentUniforms, 1, f, planes, planeCount);
            } else {
                runFragmentShader(p, f, planes, planeCount);
                blendPlanes(p, f, planes, planeCount);
            }
            fragments += kept->count;
        }
    }
    state->fragments += fragments;
}
