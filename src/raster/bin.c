// SPDX-License-Identifier: MIT
// Which triangles touch which tile: a counting sort over chunks of triangles. Counts first, then places, so
// every tile lists its triangles in drawing order whatever the threads did.
#include "raster/raster.h"

static void binChunk(void* data, int chunkIndex, int worker)
{
    (void)worker;
    const vplTriangleStage* stage = data;
    const vplRaster* r = stage->raster;
    const vplChunk* chunk = &stage->chunks[chunkIndex];
    int* next = stage->counts + (size_t)chunkIndex * (size_t)stage->tileCount;
    for (int i = chunk->firstRef; i < chunk->firstRef + chunk->refCount; i++) {
        const vplTriangleRef ref = r->refs[i];
        for (int y = ref.y0; y <= ref.y1; y++) {
            for (int x = ref.x0; x <= ref.x1; x++) {
                r->bins[next[y * r->tilesX + x]++] = i;
            }
        }
    }
}

static vplResult makeChunks(vplTriangleStage* stage)
{
    vplRaster* r = stage->raster;
    int64_t total = 0;
    for (int i = 0; i < r->shadedCount; i++) {
        r->shaded[i].firstTriangle = (int)total;
        total += r->shaded[i].mesh.triangleCount;
        if (total > INT32_MAX) {
            return vplFail(r->context, VPL_LIMIT, "more than %d triangles on screen", INT32_MAX);
        }
    }
    stage->chunkSize = 4096;
    // The table of counts is chunks * tiles: few, large chunks where there are many of both.
    while (total / stage->chunkSize * stage->tileCount > 1 << 22) {
        stage->chunkSize *= 2;
    }
    stage->chunkCount = (int)((total + stage->chunkSize - 1) / stage->chunkSize);
    stage->chunks = vplAlloc(r->context, (size_t)stage->chunkCount, sizeof *stage->chunks);
    stage->counts =
        vplAllocZero(r->context, (size_t)stage->chunkCount * (size_t)stage->tileCount, sizeof *stage->counts);
    for (int i = 0; stage->chunks != NULL && i < stage->chunkCount; i++) {
        const int first = i * stage->chunkSize;
        const int count = (int)total - first < stage->chunkSize ? (int)total - first : stage->chunkSize;
        stage->chunks[i] = (vplChunk){.first = first, .count = count};
    }
    return stage->chunks && stage->counts ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// Room for what the chunks may make: a triangle that is cut becomes up to seven.
static vplResult reserveRefs(vplTriangleStage* stage)
{
    vplRaster* r = stage->raster;
    int64_t refs = 0, cuts = 0;
    for (int i = 0; i < stage->chunkCount; i++) {
        vplChunk* chunk = &stage->chunks[i];
        chunk->firstRef = (int)refs;
        chunk->firstClipped = (int)(cuts * VPL_MAX_PIECES);
        refs += chunk->count + (int64_t)chunk->cut * (VPL_MAX_PIECES - 1);
        cuts += chunk->cut;
        if (refs > INT32_MAX || cuts * VPL_MAX_CLIPPED > INT32_MAX) {
            return vplFail(r->context, VPL_LIMIT, "more than %d triangles on screen", INT32_MAX);
        }
    }
    r->extraStride = 3;
    for (int i = 0; i < r->shadedCount; i++) {
        const int stride = 3 + r->shaded[i].varyingCount;
        r->extraStride = r->extraStride > stride ? r->extraStride : stride;
        if (cuts * VPL_MAX_CLIPPED + r->shaded[i].mesh.vertexCount > INT32_MAX) {
            return vplFail(r->context, VPL_LIMIT, "more than %d vertices on screen", INT32_MAX);
        }
    }
    const size_t extras = (size_t)cuts * VPL_MAX_CLIPPED;
    r->refs = vplAlloc(r->context, (size_t)refs, sizeof *r->refs);
    r->clipped = vplAlloc(r->context, (size_t)cuts * VPL_MAX_PIECES, sizeof *r->clipped);
    r->extraScreen = vplAlloc(r->context, extras, sizeof *r->extraScreen);
    r->extras = vplAlloc(r->context, extras * (size_t)r->extraStride, sizeof *r->extras);
    return r->refs && r->clipped && r->extraScreen && r->extras ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// Turns the chunks' counts into places and makes room for the bins.
static vplResult reserveBins(vplTriangleStage* stage)
{
    vplRaster* r = stage->raster;
    int64_t total = 0;
    r->binStart = vplAlloc(r->context, (size_t)stage->tileCount + 1, sizeof *r->binStart);
    if (r->binStart == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    for (int tile = 0; tile < stage->tileCount && total <= INT32_MAX; tile++) {
        r->binStart[tile] = (int)total;
        for (int chunk = 0; chunk < stage->chunkCount; chunk++) {
            int* count = &stage->counts[(size_t)chunk * (size_t)stage->tileCount + (size_t)tile];
            const int n = *count;
            *count = (int)total;
            total += n;
        }
    }
    if (total > INT32_MAX) {
        return vplFail(r->context, VPL_LIMIT, "more than %d triangle-tile pairs on screen", INT32_MAX);
    }
    r->binStart[stage->tileCount] = (int)total;
    r->bins = vplAlloc(r->context, (size_t)total, sizeof *r->bins);
    return r->bins ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// Meshes without triangles begin where the next one does.
static void finishRefs(const vplTriangleStage* stage)
{
    vplRaster* r = stage->raster;
    for (int i = 0; i < stage->chunkCount; i++) {
        r->stats.trianglesBinned += stage->chunks[i].refCount;
    }
    for (int i = r->shadedCount - 1, next = INT32_MAX; i >= 0; i--) {
        vplShaded* s = &r->shaded[i];
        s->firstRef = s->mesh.triangleCount > 0 ? s->firstRef : next;
        next = s->firstRef;
    }
}

vplResult vplBinTriangles(vplRaster* raster)
{
    vplContext* context = raster->context;
    vplTriangleStage stage = {.raster = raster, .tileCount = raster->tilesX * raster->tilesY};
    vplResult result = makeChunks(&stage);
    if (result == VPL_SUCCESS) {
        vplParallelFor(context, stage.chunkCount, vplCountCuts, &stage);
        result = reserveRefs(&stage);
    }
    if (result == VPL_SUCCESS) {
        vplParallelFor(context, stage.chunkCount, vplAssembleChunk, &stage);
        result = reserveBins(&stage);
    }
    if (result == VPL_SUCCESS) {
        vplParallelFor(context, stage.chunkCount, binChunk, &stage);
        finishRefs(&stage);
    }
    vplFree(context, stage.counts);
    vplFree(context, stage.chunks);
    return result;
}
