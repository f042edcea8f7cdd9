// SPDX-License-Identifier: MIT
// Runs all commands on one tile after another. A tile's pixels live in its worker's memory, in 4 x 4 blocks,
// and are copied from and to the row-major planes only at the start and the end.
#include "raster/kernels.h"

#include <math.h>
#include <string.h>

typedef struct Run {
    vplRaster* const* rasters;
    int rasterCount;
    int* firstTile;         // [rasterCount + 1]
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

static void loadPlane(const vplRaster* r, const vplTile* tile, const vplPlane* plane, float* storage)
{
    fill(storage, plane->clear);
    for (int y = 0; plane->load && plane->pixels && y < tile->height; y++) {
        const float* row = plane->pixels + (size_t)(tile->y + y) * (size_t)r->framebuffer.width + tile->x;
        for (int x = 0; x < tile->width; x++) {
            storage[vplTile_Element(x, y)] = row[x];
        }
    }
}

static void storePlane(const vplRaster* r, const vplTile* tile, const vplPlane* plane, const float* storage)
{
    for (int y = 0; plane->pixels && y < tile->height; y++) {
        float* row = plane->pixels + (size_t)(tile->y + y) * (size_t)r->framebuffer.width + tile->x;
        int x = 0;
        for (; x + VPL_BLOCK_SIDE <= tile->width; x += VPL_BLOCK_SIDE) {
            memcpy(row + x, storage + vplTile_Element(x, y), VPL_BLOCK_SIDE * sizeof(float));
        }
        for (; x < tile->width; x++) {
            row[x] = storage[vplTile_Element(x, y)];
        }
    }
}

// Finds where each mesh's triangles start in the tile's bin, which is sorted by mesh.
static void findMeshes(const vplRaster* r, const int* bin, int count, int* meshStart)
{
    int at = 0;
    for (int i = 0; i < r->shadedCount; i++) {
        while (at < count && bin[at] < r->shaded[i].firstRef) {
            at++;
        }
        meshStart[i] = at;
    }
    meshStart[r->shadedCount] = count;
}

// Runs a row of passes, mesh by mesh.
static void runPasses(const vplRaster* r, vplTileState* state, int first, const int* bin)
{
    for (int i = first; i < r->commands[first].passesEnd; i++) {
        const vplCommand* c = &r->commands[i];
        const int mesh = c->shaded, start = state->meshStart[mesh], end = state->meshStart[mesh + 1];
        if (start >= end || c->chainStart != i) {
            continue;
        }
        if (state->keptEpoch[mesh] != c->epoch) {
            state->keptEpoch[mesh] = c->epoch;
            state->keptStart[mesh] = state->keptCount;
            vplRasterKernels_Get(r->context->isa)->drawTile(state, r, c, bin + start, end - start, true);
            state->keptEnd[mesh] = state->keptCount;
        }
        vplRasterKernels_Get(r->context->isa)->runPasses(state, r, i);
    }
}

// Draws one sample after another of all pixels, by the draws before the first tile task that write depth.
static void drawSamples(const vplRaster* r, vplTileState* state, const int* bin)
{
    vplTileState sampler = *state;
    sampler.sampling = true;
    sampler.depth = state->sampleDepth;
    sampler.farthest = state->sampleFarthest;
    for (int k = 0; k < r->framebuffer.samples && vplTask_GoesOn(r->context); k++) {
        sampler.sample = vplSubPixel_OfSample(k, r->framebuffer.samples);
        sampler.owner = state->tile.samples[k];
        fill(sampler.depth, 1);
        for (int i = 0; i < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; i++) {
            sampler.farthest[i] = 1;
        }
        memset(sampler.owner, 0xff, VPL_TILE_PIXELS * sizeof(int32_t));
        for (int i = 0; i < r->commandCount && r->commands[i].shaded >= 0; i++) {
            const vplCommand* c = &r->commands[i];
            const int start = state->meshStart[c->shaded], end = state->meshStart[c->shaded + 1];
            if (start < end && r->pipelines[c->pipeline].depthWrite) {
                vplRasterKernels_Get(r->context->isa)
                    ->drawTile(&sampler, r, c, bin + start, end - start, false);
            }
        }
    }
}

static void runCommands(const vplRaster* r, vplTileState* state, const int* bin, int worker)
{
    int epoch = -1;
    if (r->framebuffer.samples > 0 && r->hasTasks) {
        drawSamples(r, state, bin);
        if (!vplTask_GoesOn(r->context)) {
            return; // not all samples are drawn
        }
    }
    for (int i = 0; i < r->commandCount;) {
        const vplCommand* c = &r->commands[i];
        if (c->isPass) {
            state->keptCount = c->epoch == epoch ? state->keptCount : 0;
            epoch = c->epoch;
            runPasses(r, state, i, bin);
            i = c->passesEnd;
            continue;
        }
        i++;
        if (c->shaded < 0) {
            c->tileFcn(c->data, &state->tile, worker);
            continue;
        }
        const int start = state->meshStart[c->shaded], end = state->meshStart[c->shaded + 1];
        if (start < end) {
            vplRasterKernels_Get(r->context->isa)->drawTile(state, r, c, bin + start, end - start, false);
        }
    }
}

static void loadPlanes(const vplRaster* r, vplTileState* state)
{
    const vplFramebuffer* f = &r->framebuffer;
    const vplTile* tile = &state->tile;
    loadPlane(r, tile, &f->depth, state->depth);
    for (int i = 0; i < VPL_TILE_BLOCKS * VPL_TILE_BLOCKS; i++) {
        state->farthest[i] = f->depth.load ? INFINITY : f->depth.clear;
    }
    for (int k = 0; k < f->planeCount; k++) {
        if (!f->planes[k].scratch) {
            loadPlane(r, tile, &f->planes[k], tile->planes[k]);
        }
    }
    if (r->keepsOwners) {
        memset(state->owner, 0xff, VPL_TILE_PIXELS * sizeof(int32_t));
    }
    memset(tile->scratch, 0, f->scratchBytes);
}

// A tile without draws is cleared, or left as it is, in the planes themselves.
static void clearTile(const vplRaster* r, const vplTile* tile)
{
    const vplFramebuffer* f = &r->framebuffer;
    for (int k = -1; k < f->planeCount; k++) {
        const vplPlane* plane = k < 0 ? &f->depth : &f->planes[k];
        for (int y = 0; plane->pixels && !plane->load && y < tile->height; y++) {
            float* row = plane->pixels + (size_t)(tile->y + y) * (size_t)f->width + tile->x;
            for (int x = 0; x < tile->width; x++) {
                row[x] = plane->clear;
            }
        }
    }
    for (int y = 0; f->triangles && y < tile->height; y++) {
        memset(f->triangles + (size_t)(tile->y + y) * (size_t)f->width + tile->x, 0xff,
               (size_t)tile->width * sizeof *f->triangles);
    }
}

static void runTile(void* data, int number, int worker)
{
    Run* run = data;
    int which = 0;
    while (number >= run->firstTile[which + 1]) {
        which++;
    }
    const vplRaster* r = run->rasters[which];
    const int index = number - run->firstTile[which];
    const vplFramebuffer* f = &r->framebuffer;
    vplTileState own = run->states[worker], *state = &own;
    vplTile* tile = &state->tile;
    tile->x = index % r->tilesX * VPL_TILE_SIDE;
    tile->y = index / r->tilesX * VPL_TILE_SIDE;
    tile->width = vplMini(f->width - tile->x, VPL_TILE_SIDE);
    tile->height = vplMini(f->height - tile->y, VPL_TILE_SIDE);
    if (f->endRow > 0 && (tile->y >= f->endRow || tile->y + tile->height <= f->firstRow)) {
        return;
    }
    const int* bin = r->bins + r->binStart[index];
    const int count = r->binStart[index + 1] - r->binStart[index];
    if (count == 0 && !r->hasTasks) {
        clearTile(r, tile);
        return;
    }
    state->owner = r->keepsOwners ? state->owner : NULL;
    tile->sampleCount = f->samples;
    loadPlanes(r, state);
    findMeshes(r, bin, count, state->meshStart);
    memset(state->keptEpoch, 0xff, (size_t)r->shadedCount * sizeof(int));
    runCommands(r, state, bin, worker);
    storePlane(r, tile, &f->depth, state->depth);
    if (f->triangles != NULL) {
        storePlane(r, tile, &(vplPlane){.pixels = (float*)f->triangles}, (const float*)state->owner);
    }
    for (int k = 0; k < f->planeCount; k++) {
        storePlane(r, tile, &f->planes[k], tile->planes[k]);
    }
    for (int i = 0; i < VPL_COUNTERS * VPL_LANES; i++) {
        state->fragments += state->fragmentLanes[i / VPL_LANES][i % VPL_LANES];
    }
    run->tileFragments[number] = state->fragments;
}

// Sizes of a worker's memory: the largest that any raster needs.
typedef struct Sizes {
    size_t planes, samples, scratch, meshes, kept, keptStride;
    bool owners;
} Sizes;

static size_t roundUp(size_t bytes)
{
    return (bytes + 63) & ~(size_t)63;
}

static size_t mostOf(size_t a, size_t b)
{
    return a > b ? a : b;
}

static Sizes findSizes(const Run* run)
{
    Sizes n = {0};
    for (int i = 0; i < run->rasterCount; i++) {
        const vplRaster* r = run->rasters[i];
        n.planes = mostOf(n.planes, (size_t)r->framebuffer.planeCount);
        n.samples = mostOf(n.samples, (size_t)r->framebuffer.samples);
        n.scratch = mostOf(n.scratch, roundUp(r->framebuffer.scratchBytes));
        n.meshes = mostOf(n.meshes, (size_t)r->shadedCount);
        n.owners |= r->keepsOwners;
        for (int k = 0; r->keepsPasses && k < r->shadedCount; k++) {
            const size_t floats = (2 + (size_t)r->shaded[k].surfaceCount) * VPL_LANES;
            n.keptStride = mostOf(n.keptStride, sizeof(vplKeptBlock) + floats * sizeof(float));
        }
    }
    n.kept = n.keptStride * VPL_TILE_PIXELS; // each pixel has one owner
    return n;
}

static void* take(char* memory, size_t* at, size_t bytes)
{
    char* taken = memory != NULL ? memory + *at : NULL;
    *at += roundUp(bytes);
    return taken;
}

// Places a worker's arrays in `memory` (NULL: only measures) and returns how many bytes they take. All start
// at a cache line, so that no vector straddles two.
static size_t layOut(const Sizes* n, vplTileState* state, char* memory)
{
    const size_t plane = VPL_TILE_PIXELS * sizeof(float), perMesh = (n->meshes + 1) * sizeof(int);
    size_t at = 0;
    state->tile.depth = state->depth = take(memory, &at, plane);
    for (size_t k = 0; k < n->planes; k++) {
        state->tile.planes[k] = take(memory, &at, plane);
    }
    state->owner = take(memory, &at, n->owners ? plane : 0);
    state->farthest = take(memory, &at, VPL_TILE_BLOCKS * VPL_TILE_BLOCKS * sizeof(float));
    for (size_t k = 0; k < n->samples; k++) {
        state->tile.samples[k] = take(memory, &at, plane);
    }
    state->sampleDepth = take(memory, &at, n->samples > 0 ? plane : 0);
    state->sampleFarthest =
        take(memory, &at, n->samples > 0 ? VPL_TILE_BLOCKS * VPL_TILE_BLOCKS * sizeof(float) : 0);
    state->tile.scratch = take(memory, &at, n->scratch);
    state->meshStart = take(memory, &at, perMesh);
    state->keptStart = take(memory, &at, perMesh);
    state->keptEnd = take(memory, &at, perMesh);
    state->keptEpoch = take(memory, &at, perMesh);
    state->keptStride = n->keptStride;
    state->kept = take(memory, &at, n->kept);
    return at;
}

static vplResult makeStates(Run* run, vplArena* scratch)
{
    const size_t workers = (size_t)run->rasters[0]->context->workerCount;
    const Sizes sizes = findSizes(run);
    vplTileState sample;
    const size_t perWorker = layOut(&sizes, &sample, NULL);
    run->firstTile = vplArena_Alloc(scratch, (size_t)run->rasterCount + 1, sizeof *run->firstTile);
    TRY(vplArena_Check(scratch));
    int tiles = 0;
    for (int i = 0; i < run->rasterCount; i++) {
        run->firstTile[i] = tiles;
        tiles += run->rasters[i]->tilesX * run->rasters[i]->tilesY;
    }
    run->firstTile[run->rasterCount] = tiles;
    run->states = vplArena_AllocZero(scratch, workers, sizeof *run->states);
    run->tileFragments = vplArena_AllocZero(scratch, (size_t)tiles, sizeof *run->tileFragments);
    run->memory = vplArena_Alloc(scratch, workers, perWorker);
    TRY(vplArena_Check(scratch));
    for (size_t i = 0; i < workers; i++) {
        layOut(&sizes, &run->states[i], run->memory + i * perWorker);
    }
    return VPL_SUCCESS;
}

static vplResult runTiles(Run* run, vplArena* scratch, vplProgressFcn* progress, void* user)
{
    vplContext* context = run->rasters[0]->context;
    TRY(makeStates(run, scratch));
    TRY(vplParallelForProgress(context, run->firstTile[run->rasterCount], runTile, run,
                               (vplProgressRange){progress, user, 0, 1}));
    for (int i = 0; i < run->rasterCount; i++) {
        for (int tile = run->firstTile[i]; tile < run->firstTile[i + 1]; tile++) {
            run->rasters[i]->stats.fragments += run->tileFragments[tile];
        }
    }
    return VPL_SUCCESS;
}

vplResult vplRunTiles(vplRaster* const* rasters, int count, vplProgressFcn* progress, void* user)
{
    Run run = {.rasters = rasters, .rasterCount = count};
    vplArena* scratch = vplArena_Create(rasters[0]->context);
    const vplResult result = runTiles(&run, scratch, progress, user);
    vplArena_Destroy(scratch);
    return result;
}
