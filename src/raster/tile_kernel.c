// SPDX-License-Identifier: MIT
// Draws triangles into one tile: 4 x 4 squares of 4 x 4 blocks of 4 x 4 pixels. Squares and blocks that a
// triangle does not touch are skipped; in those that it fills no pixel is tested for coverage. Compiled once
// per instruction set; all give the same bits.
// Based on: Michael Abrash, Rasterization on Larrabee, Game Developers Conference 2009: three levels of 4 x
// 4. Ned Greene, Michael Kass and Gavin Miller, Hierarchical Z-Buffer Visibility, SIGGRAPH 1993: a block
// stores a bound of its depths, and triangles behind that are skipped.
#include "raster/blocks.h"
#include "raster/kernels.h"

enum { SQUARE_SIDE = 4 * VPL_BLOCK_SIDE, SQUARES = VPL_TILE_SIDE / SQUARE_SIDE };

static inline double depthAt(const Setup* s, int x, int y)
{
    return s->z + (s->zx * x + s->zy * y);
}

// Blocks of a square whose depths are all nearer than the triangle. z: its depths in lane 0 of each block.
static inline uint32_t hiddenBlocks(const Setup* s, const double z[VPL_LANES], float least,
                                    const float farthest[VPL_LANES])
{
    uint32_t hidden = 0;
    for (int i = 0; i < VPL_LANES; i++) {
        hidden |= (uint32_t)(clampDepth(z[i] + s->leastZ, least) > farthest[i]) << i;
    }
    return hidden;
}

// Lowers the bounds of blocks that the triangle fills: no lane keeps a depth beyond the triangle's.
static inline void tightenBlocks(const Setup* s, const double z[VPL_LANES], float leastDepth, uint32_t filled,
                                 float farthest[VPL_LANES])
{
    for (int i = 0; i < VPL_LANES; i++) {
        const float most = clampDepth(z[i] + s->mostZ, leastDepth), kept = farthest[i];
        const float least = most < kept ? most : kept;
        farthest[i] = (filled >> i & 1) != 0 ? least : kept;
    }
}

// Draws the blocks of a square whose bits are set in `within`.
static void drawSquare(Draw* d, const Setup* s, int x, int y, uint32_t within, bool filled)
{
    const vplTile* tile = &d->state->tile;
    Cells cells = {0xffff, 0xffff};
    double z[VPL_LANES];
    for (int i = 0; i < VPL_LANES; i++) {
        z[i] = depthAt(s, x + (i & 3) * VPL_BLOCK_SIDE, y + (i >> 2) * VPL_BLOCK_SIDE);
    }
    float* farthest = d->state->farthest + (y / SQUARE_SIDE * SQUARES + x / SQUARE_SIDE) * VPL_LANES;
    if (d->rejects) {
        within &= ~hiddenBlocks(s, z, d->leastDepth, farthest);
        if (within == 0) {
            return;
        }
    }
    if (!filled) {
        cells = classify(s, x, y, VPL_BLOCK_SIDE);
    }
    cells.touched &= within;
    if (x + SQUARE_SIDE > tile->width || y + SQUARE_SIDE > tile->height) {
        cells.filled &= cellsWithin(0, (tile->width - x) / VPL_BLOCK_SIDE - 1, 0,
                                    (tile->height - y) / VPL_BLOCK_SIDE - 1);
    }
    if (d->tightens) {
        tightenBlocks(s, z, d->leastDepth, cells.touched & cells.filled, farthest);
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

// True if all depths in blocks x0 to x1, y0 to y1 are nearer than the triangle.
static bool isHidden(const Draw* d, int x0, int y0, int x1, int y1)
{
    const Batch* t = d->batch;
    const double zx = t->zx[d->place], zy = t->zy[d->place];
    const double least = (zx < 0 ? zx * 3 : 0) + (zy < 0 ? zy * 3 : 0); // same bits as in boundDepth
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            const double z = t->planeZ[d->place] + (zx * (x * VPL_BLOCK_SIDE) + zy * (y * VPL_BLOCK_SIDE));
            const int square = y / 4 * SQUARES + x / 4, block = y % 4 * 4 + x % 4;
            if (!(clampDepth(z + least, d->leastDepth) > d->state->farthest[square * VPL_LANES + block])) {
                return false;
            }
        }
    }
    return true;
}

static void drawTriangle(Draw* d)
{
    const Batch* t = d->batch;
    const int x0 = t->left[d->place] / VPL_BLOCK_SIDE, x1 = t->right[d->place] / VPL_BLOCK_SIDE;
    const int y0 = t->top[d->place] / VPL_BLOCK_SIDE, y1 = t->bottom[d->place] / VPL_BLOCK_SIDE;
    Setup s;
    if (d->rejects && x1 - x0 <= 1 && y1 - y0 <= 1 && isHidden(d, x0, y0, x1, y1)) {
        return;
    }
    setUp(t, d->place, &s);
    if (d->distances) {
        needBarycentrics(d);
    }
    if (x1 == x0 && y1 == y0) {
        const int32_t edge[3] = {t->edge[0][d->place], t->edge[1][d->place], t->edge[2][d->place]};
        const int x = x0 * VPL_BLOCK_SIDE, y = y0 * VPL_BLOCK_SIDE;
        drawBlock(d, &s, x, y, depthAt(&s, x, y), edge);
        return;
    }
    if (x1 - x0 <= 1 && y1 - y0 <= 1) { // testing pixels directly is less work than classifying blocks
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

static Draw startDraw(vplTileState* state, const vplRaster* raster, const vplCommand* command)
{
    const vplPipeline* p = &raster->pipelines[command->pipeline];
    const bool less = p->depthCompare == VPL_DEPTH_LESS || p->depthCompare == VPL_DEPTH_LESS_EQUAL;
    const bool byPlane = less && !p->writesDepth && p->distanceScale == 0; // depth is the triangle's plane
    return (Draw){.state = state,
                  .raster = raster,
                  .pipeline = p,
                  .shaded = &raster->shaded[command->shaded],
                  .distances = p->distanceScale != 0,
                  .names = state->sampling || raster->framebuffer.triangles != NULL,
                  .leastDepth = raster->framebuffer.reversedDepth ? -1 : 0,
                  .texel = 2.0f / (float)raster->framebuffer.width,
                  .rejects = byPlane,
                  .tightens = byPlane && p->depthWrite && !p->ownerTest,
                  .depthOnly = (p->fragment == NULL || state->sampling) && p->distanceScale == 0 &&
                               p->depthCompare == VPL_DEPTH_LESS && p->depthWrite && !p->ownerTest};
}

// Draws the first `count` triangles of a batch, the refs list[0] to list[count - 1].
static void drawBatch(Draw* d, Batch* batch, const int* list, int count)
{
    vplTileState* state = d->state;
    const vplCull cull = d->pipeline->cull;
    Tiny tiny;
    for (int k = 0; k < count; k++) {
        fetchTriangle(d->raster, d->shaded, list[k], batch, k);
    }
    setUpBatch(&state->tile, state->sample, batch);
    const bool anyTiny = d->depthOnly && cull == VPL_CULL_NONE && hasTiny(batch, count);
    if (anyTiny) {
        testTiny(batch, d->leastDepth, &tiny);
    }
    for (int k = 0; k < count; k++) {
        d->owner = d->names ? d->shaded->firstTriangle + batch->primitive[k] : list[k];
        d->place = k;
        d->hasBarycentrics = false;
        state->block.primitive = batch->primitive[k];
        if (anyTiny && isTiny(batch, k)) {
            state->fragments += drawTiny(&tiny, k, state->depth, state->owner, d->owner);
        } else if (cull == VPL_CULL_NONE || (cull == VPL_CULL_BACK) != (batch->clockwise[k] != 0)) {
            drawTriangle(d);
        }
    }
}

void VPL_KERNEL(vplDrawTile)(vplTileState* state, const vplRaster* raster, const vplCommand* command,
                             const int* list, int count, bool keep)
{
    Barycentrics barycentrics;
    Batch batch;
    memset(batch.x, 0, sizeof batch.x); // the arithmetic runs over unused places, too
    memset(batch.y, 0, sizeof batch.y);
    memset(batch.z, 0, sizeof batch.z);
    memset(batch.vertex, 0, sizeof batch.vertex);
    Draw d = startDraw(state, raster, command);
    d.barycentrics = &barycentrics;
    d.batch = &batch;
    d.keep = keep;
    state->block.scratch = state->tile.scratch;
    for (int first = 0; first < count; first += BATCH) {
        drawBatch(&d, &batch, list + first, count - first < BATCH ? count - first : BATCH);
    }
    if (d.pipeline->depthWrite && d.pipeline->depthCompare == VPL_DEPTH_ALWAYS) {
        for (int i = 0; i < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; i++) {
            state->farthest[i] = INFINITY;
        }
    }
}
