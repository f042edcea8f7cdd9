// SPDX-License-Identifier: MIT
// Sorts triangles into tiles: a counting sort over chunks of triangles. Counts come first, then places, so
// that every tile lists its triangles in drawing order whatever the threads did.
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

static vplResult makeChunks(vplTriangleStage* stage, vplArena* scratch)
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
    stage->chunks = vplArena_Alloc(scratch, (size_t)stage->chunkCount, sizeof *stage->chunks);
    stage->counts = vplArena_AllocZero(scratch, (size_t)stage->chunkCount * (size_t)stage->tileCount,
                                       sizeof *stage->counts);
    TRY(vplArena_Check(scratch));
    for (int i = 0; i < stage->chunkCount; i++) {
        const int first = i * stage->chunkSize;
        stage->chunks[i] = (vplChunk){.first = first, .count = vplMini((int)total - first, stage->chunkSize)};
    }
    return VPL_SUCCESS;
}

// Makes room for the chunks' refs: a triangle that is cut becomes up to seven.
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
        r->extraStride = vplMaxi(r->extraStride, 3 + r->shaded[i].varyingCount);
        if (cuts * VPL_MAX_CLIPPED + r->shaded[i].mesh.vertexCount > INT32_MAX) {
            return vplFail(r->context, VPL_LIMIT, "more than %d vertices on screen", INT32_MAX);
        }
    }
    const size_t extras = (size_t)cuts * VPL_MAX_CLIPPED;
    r->refs = vplArena_Alloc(r->run, (size_t)refs, sizeof *r->refs);
    r->clipped = vplArena_Alloc(r->run, (size_t)cuts * VPL_MAX_PIECES, sizeof *r->clipped);
    r->extraScreen = vplArena_Alloc(r->run, extras, sizeof *r->extraScreen);
    r->extras = vplArena_Alloc(r->run, extras * (size_t)r->extraStride, sizeof *r->extras);
    return vplArena_Check(r->run);
}

// Turns the chunks' counts into places and makes room for the bins.
static vplResult reserveBins(vplTriangleStage* stage)
{
    vplRaster* r = stage->raster;
    int64_t total = 0;
    r->binStart = vplArena_Alloc(r->run, (size_t)stage->tileCount + 1, sizeof *r->binStart);
    TRY(vplArena_Check(r->run));
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
    r->bins = vplArena_Alloc(r->run, (size_t)total, sizeof *r->bins);
    return vplArena_Check(r->run);
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

static vplResult binTriangles(vplTriangleStage* stage, vplArena* scratch)
{
    vplContext* context = stage->raster->context;
    TRY(makeChunks(stage, scratch));
    TRY(vplParallelForAsking(context, stage->chunkCount, vplCountCuts, stage));
    TRY(reserveRefs(stage));
    TRY(vplParallelForAsking(context, stage->chunkCount, vplAssembleChunk, stage));
    TRY(reserveBins(stage));
    TRY(vplParallelForAsking(context, stage->chunkCount, binChunk, stage));
    finishRefs(stage);
    return VPL_SUCCESS;
}

vplResult vplBinTriangles(vplRaster* raster)
{
    vplTriangleStage stage = {.raster = raster, .tileCount = raster->tilesX * raster->tilesY};
    vplArena* scratch = vplArena_Create(raster->context);
    const vplResult result = binTriangles(&stage, scratch);
    vplArena_Destroy(scratch);
    return result;
}
