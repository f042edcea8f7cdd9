// SPDX-License-Identifier: MIT
// Runs all commands on one tile after another. A tile's pixels live in memory of its worker, blocks of 4x4 in
// a row, and meet the row-major planes only at the start and the end.
#include "raster/raster.h"
#include "base/isa.h"

#include <string.h>

VPL_KERNEL_TABLE(DRAW_TILE, vplDrawTileFcn, vplDrawTile);

typedef struct Run {
    vplRaster* raster;
    vplTileState* states;   // one per worker
    int64_t* tileFragments; // one per tile
    char* memory;           // of all states
} Run;

static void fill(float* storage, float value)
{
    for (int i = 0; i < VPL_TILE_PIXELS; i++) {
        storage[i] = value;
    }
}

// Element of the tile storage that holds pixel (x, y) of the tile.
static int swizzle(int x, int y)
{
    return ((y >> 2) * VPL_TILE_BLOCKS + (x >> 2)) * VPL_LANES + (y & 3) * VPL_BLOCK_SIDE + (x & 3);
}

static void loadPlane(const vplRaster* r, const vplTile* tile, const vplPlane* plane, float* storage)
{
    fill(storage, plane->clear);
    for (int y = 0; plane->load && plane->pixels && y < tile->height; y++) {
        const float* row = plane->pixels + (size_t)(tile->y + y) * (size_t)r->framebuffer.width + tile->x;
        for (int x = 0; x < tile->width; x++) {
            storage[swizzle(x, y)] = row[x];
        }
    }
}

static void storePlane(const vplRaster* r, const vplTile* tile, const vplPlane* plane, const float* storage)
{
    for (int y = 0; plane->pixels && y < tile->height; y++) {
        float* row = plane->pixels + (size_t)(tile->y + y) * (size_t)r->framebuffer.width + tile->x;
        int x = 0;
        for (; x + VPL_BLOCK_SIDE <= tile->width; x += VPL_BLOCK_SIDE) {
            memcpy(row + x, storage + swizzle(x, y), VPL_BLOCK_SIDE * sizeof(float));
        }
        for (; x < tile->width; x++) {
            row[x] = storage[swizzle(x, y)];
        }
    }
}

// Where each mesh's triangles begin in the tile's bin, which is sorted by mesh.
static void findMeshes(const vplRaster* r, const int* bin, int count, int* meshStart)
{
    int at = 0;
    for (int i = 0; i < r->shadedCount; i++) {
        while (at < count && bin[at] < r->shaded[i].firstTriangle) {
            at++;
        }
        meshStart[i] = at;
    }
    meshStart[r->shadedCount] = count;
}

static void runTile(void* data, int index, int worker)
{
    Run* run = data;
    vplRaster* r = run->raster;
    const vplFramebuffer* f = &r->framebuffer;
    vplTileState* state = &run->states[worker];
    vplTile* tile = &state->tile;
    tile->x = index % r->tilesX * VPL_TILE_SIDE;
    tile->y = index / r->tilesX * VPL_TILE_SIDE;
    tile->width = f->width - tile->x < VPL_TILE_SIDE ? f->width - tile->x : VPL_TILE_SIDE;
    tile->height = f->height - tile->y < VPL_TILE_SIDE ? f->height - tile->y : VPL_TILE_SIDE;
    state->fragments = 0;
    loadPlane(r, tile, &f->depth, tile->depth);
    for (int k = 0; k < f->planeCount; k++) {
        loadPlane(r, tile, &f->planes[k], tile->planes[k]);
    }
    memset(state->owner, 0xff, VPL_TILE_PIXELS * sizeof(int32_t));
    memset(tile->scratch, 0, f->scratchBytes);
    const int* bin = r->bins + r->binStart[index];
    findMeshes(r, bin, r->binStart[index + 1] - r->binStart[index], state->meshStart);
    vplDrawTileFcn* draw = DRAW_TILE[r->context->isa];
    for (int i = 0; i < r->commandCount; i++) {
        const vplCommand* c = &r->commands[i];
        if (c->shaded < 0) {
            c->tileFcn(c->data, tile, worker);
            continue;
        }
        int first = state->meshStart[c->shaded], end = state->meshStart[c->shaded + 1];
        if (first < end) {
            draw(state, &r->pipelines[c->pipeline], &r->shaded[c->shaded], r->triangles, bin + first,
                 end - first, f);
        }
    }
    storePlane(r, tile, &f->depth, tile->depth);
    for (int k = 0; k < f->planeCount; k++) {
        storePlane(r, tile, &f->planes[k], tile->planes[k]);
    }
    run->tileFragments[index] = state->fragments;
}

static size_t roundUp(size_t bytes)
{
    return (bytes + 63) & ~(size_t)63;
}

static vplResult makeStates(Run* run)
{
    vplRaster* r = run->raster;
    size_t plane = VPL_TILE_PIXELS * sizeof(float);
    size_t scratch = roundUp(r->framebuffer.scratchBytes);
    size_t meshes = roundUp(((size_t)r->shadedCount + 1) * sizeof(int));
    size_t perWorker = plane * (2 + (size_t)r->framebuffer.planeCount) + scratch + meshes;
    size_t workers = (size_t)r->context->workerCount;
    run->states = vplAllocZero(r->context, workers, sizeof *run->states);
    run->tileFragments =
        vplAllocZero(r->context, (size_t)(r->tilesX * r->tilesY), sizeof *run->tileFragments);
    run->memory = vplAlloc(r->context, workers, perWorker);
    if (!run->states || !run->tileFragments || !run->memory) {
        return VPL_OUT_OF_MEMORY;
    }
    for (size_t i = 0; i < workers; i++) {
        char* at = run->memory + i * perWorker;
        vplTileState* state = &run->states[i];
        state->tile.depth = (float*)at;
        state->owner = (int32_t*)(at += plane);
        for (int k = 0; k < r->framebuffer.planeCount; k++) {
            state->tile.planes[k] = (float*)(at += plane);
        }
        state->tile.scratch = at += plane;
        state->meshStart = (int*)(at + scratch);
    }
    return VPL_SUCCESS;
}

vplResult vplRunTiles(vplRaster* raster, vplProgressFcn* progress, void* user)
{
    Run run = {raster, NULL, NULL, NULL};
    int tileCount = raster->tilesX * raster->tilesY;
    vplResult result = makeStates(&run);
    if (result == VPL_SUCCESS) {
        result = vplParallelForProgress(raster->context, tileCount, runTile, &run, progress, user, 0, 1);
    }
    for (int i = 0; i < tileCount && result == VPL_SUCCESS; i++) {
        raster->stats.fragments += run.tileFragments[i];
    }
    vplFree(raster->context, run.memory);
    vplFree(raster->context, run.tileFragments);
    vplFree(raster->context, run.states);
    return result;
}
