// SPDX-License-Identifier: MIT
// Which triangles touch which tile: a counting sort over chunks of triangles. Counts first, then places, so
// every tile lists its triangles in drawing order whatever the threads did.
#include "raster/raster.h"

typedef struct Binning {
    vplRaster* raster;
    int* counts; // [chunk][tile]; after the prefix sum: the place of the chunk's next entry
    int tileCount, chunkSize;
    bool writing;
} Binning;

static void binChunk(void* data, int chunk, int worker)
{
    (void)worker;
    Binning* b = data;
    vplRaster* r = b->raster;
    int* counts = b->counts + (size_t)chunk * (size_t)b->tileCount;
    int first = chunk * b->chunkSize;
    int end = r->triangleCount - first < b->chunkSize ? r->triangleCount : first + b->chunkSize;
    for (int i = first; i < end; i++) {
        vplPixelBox box = vplBoundTriangle(r->triangles[i].v);
        const int shift = 6;
        _Static_assert(VPL_TILE_SIDE == 1 << 6, "the shift is for 64-pixel tiles");
        int x0 = box.x0 >> shift, x1 = box.x1 >> shift, y0 = box.y0 >> shift, y1 = box.y1 >> shift;
        x0 = x0 < 0 ? 0 : x0;
        y0 = y0 < 0 ? 0 : y0;
        x1 = x1 >= r->tilesX ? r->tilesX - 1 : x1;
        y1 = y1 >= r->tilesY ? r->tilesY - 1 : y1;
        for (int y = y0; y <= y1; y++) {
            for (int x = x0; x <= x1; x++) {
                int* count = &counts[y * r->tilesX + x];
                if (b->writing) {
                    r->bins[*count] = i;
                }
                ++*count;
            }
        }
    }
}

vplResult vplBinTriangles(vplRaster* raster)
{
    Binning b = {raster, NULL, raster->tilesX * raster->tilesY, 4096, false};
    // The table of counts is chunks * tiles: few, large chunks where there are many of both.
    while ((int64_t)(raster->triangleCount / b.chunkSize) * b.tileCount > 1 << 22) {
        b.chunkSize *= 2;
    }
    int chunks = (raster->triangleCount + b.chunkSize - 1) / b.chunkSize;
    b.counts = vplAllocZero(raster->context, (size_t)chunks * (size_t)b.tileCount, sizeof(int));
    raster->binStart = vplAlloc(raster->context, (size_t)b.tileCount + 1, sizeof(int));
    vplResult result = b.counts && raster->binStart ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
    if (result == VPL_SUCCESS) {
        vplParallelFor(raster->context, chunks, binChunk, &b);
        int64_t total = 0;
        for (int tile = 0; tile < b.tileCount && total <= INT32_MAX; tile++) {
            raster->binStart[tile] = (int)total;
            for (int chunk = 0; chunk < chunks; chunk++) {
                int* count = &b.counts[(size_t)chunk * (size_t)b.tileCount + (size_t)tile];
                int n = *count;
                *count = (int)total;
                total += n;
            }
        }
        if (total > INT32_MAX) {
            result =
                vplFail(raster->context, VPL_LIMIT, "more than %d triangle-tile pairs on screen", INT32_MAX);
        } else {
            raster->binStart[b.tileCount] = (int)total;
            raster->bins = vplAlloc(raster->context, (size_t)total, sizeof(int));
            result = raster->bins ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
        }
    }
    if (result == VPL_SUCCESS) {
        b.writing = true;
        vplParallelFor(raster->context, chunks, binChunk, &b);
    }
    vplFree(raster->context, b.counts);
    return result;
}
