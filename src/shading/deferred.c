// SPDX-License-Identifier: MIT
// Deferred shading: one pass writes position and triangle of every visible pixel, then each tile is lit by
// all lights while it is in cache. Depth, normals and shadow factors are shown from the same G-buffer.
#include "shading/shading.h"

#include "math/scalar.h"
#include "raster/raster.h"

#include <stddef.h>
#include <string.h>

// ---- the G-buffer

void vplOpenGbuffer(vplShading* shading, vplFramebuffer* framebuffer, vplTileFcn* tileTask)
{
    const vplShadeDef* def = shading->def;
    shading->tileTask = tileTask;
    framebuffer->samples = vplShowsSamples(def->output) ? shading->samples : 0;
    framebuffer->planeCount = VPL_PLANE_POSITION + 3;
    shading->smoothsRims = framebuffer->samples > 0 && shading->direct.emitterCount > 0 &&
                           shading->direct.tree == NULL; // noise has no rims
    framebuffer->scratchBytes =
        offsetof(vplTileSums, emitted) + (shading->smoothsRims ? sizeof((vplTileSums*)0)->emitted : 0);
    for (int k = 0; k < 3; k++) { // the plane of triangles says where something was written
        framebuffer->planes[VPL_PLANE_NORMAL + k].scratch = true;
        framebuffer->planes[VPL_PLANE_POSITION + k].scratch = true;
    }
}

// ---- kept tiles

static float* keptTile(const vplGbuffer* g, const vplTile* tile)
{
    const int number = tile->y / VPL_TILE_SIDE * g->tilesX + tile->x / VPL_TILE_SIDE - g->firstTile;
    return g->tiles + (size_t)number * (size_t)(g->planeCount + g->samples) * VPL_TILE_PIXELS;
}

// Array k of a tile that is kept: a plane or, after the planes, the triangles of a sample.
static void* arrayOf(const vplGbuffer* g, const vplTile* tile, int k)
{
    return k < g->planeCount ? (void*)tile->planes[g->firstPlane + k]
                             : (void*)tile->samples[k - g->planeCount];
}

// Copies a tile to the G-buffer if `keeps`, else back.
static void copyTile(const vplGbuffer* g, const vplTile* tile, bool keeps)
{
    float* kept = keptTile(g, tile);
    for (int k = 0; k < g->planeCount + g->samples; k++, kept += VPL_TILE_PIXELS) {
        void* array = arrayOf(g, tile, k);
        memcpy(keeps ? (void*)kept : array, keeps ? array : (void*)kept, VPL_TILE_PIXELS * sizeof *kept);
    }
}

static void keepTile(void* data, vplTile* tile, int worker)
{
    (void)worker;
    copyTile(((const vplShading*)data)->state, tile, true);
}

static void takeTile(void* data, vplTile* tile, int worker)
{
    (void)worker;
    copyTile(((const vplShading*)data)->def->gbuffer, tile, false);
}

static vplResult openKept(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplGbuffer* g = shading->state;
    vplOpenGbuffer(shading, framebuffer, keepTile);
    // Interleaved shading filters with neighbouring rows, so these are kept, too.
    framebuffer->firstRow = vplMaxi(shading->firstRow - (VPL_MAX_INTERLEAVE - 1), 0);
    framebuffer->endRow = vplMini(shading->endRow + VPL_MAX_INTERLEAVE - 1, framebuffer->height);
    const int first = framebuffer->firstRow / VPL_TILE_SIDE,
              end = (framebuffer->endRow + VPL_TILE_SIDE - 1) / VPL_TILE_SIDE;
    g->tilesX = (framebuffer->width + VPL_TILE_SIDE - 1) / VPL_TILE_SIDE;
    g->firstTile = first * g->tilesX;
    g->firstRow = shading->firstRow;
    g->endRow = shading->endRow;
    g->samples = framebuffer->samples;
    g->firstPlane = shading->smooth ? VPL_PLANE_NORMAL : VPL_PLANE_TRIANGLE;
    g->planeCount = framebuffer->planeCount - g->firstPlane;
    g->tiles = vplAlloc(g->context, (size_t)(end - first) * (size_t)g->tilesX,
                        (size_t)(g->planeCount + g->samples) * VPL_TILE_PIXELS * sizeof *g->tiles);
    return g->tiles != NULL ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

// ---- drawing

static vplResult recordSurfaces(vplShading* shading, vplRaster* raster)
{
    for (int i = 0; i < shading->geometry->objectCount; i++) {
        vplPipeline pipeline = vplDefaultPipeline();
        vplSetCamera(shading, i, &pipeline);
        pipeline.surface = NULL; // normals are finished for visible pixels only, when they are lit
        pipeline.fragment = shading->kernels.gbuffer;
        pipeline.fragmentUniforms = &shading->objects[i];
        pipeline.planeMask = 15u << VPL_PLANE_TRIANGLE | (shading->smooth ? 7u << VPL_PLANE_NORMAL : 0);
        TRY(vplRaster_Draw(raster, &shading->meshes[i], &pipeline));
    }
    return shading->geometry->cutOuts != NULL ? vplRaster_TileTask(raster, vplShowCutOuts, shading)
                                              : VPL_SUCCESS;
}

vplResult vplRecordGbuffer(vplShading* shading, vplRaster* raster)
{
    const bool kept = shading->def->gbuffer != NULL && vplShowsSamples(shading->def->output);
    TRY(kept ? vplRaster_TileTask(raster, takeTile, shading) : recordSurfaces(shading, raster));
    return vplRaster_TileTask(raster, shading->tileTask, shading);
}

// ---- strategies

static vplResult openShow(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplOpenGbuffer(shading, framebuffer, shading->kernels.show);
    return VPL_SUCCESS;
}

static vplResult openDeferred(vplShading* shading, vplFramebuffer* framebuffer)
{
    vplOpenGbuffer(shading, framebuffer, shading->kernels.deferred);
    return vplMakeColumns(shading);
}

const vplStrategy vplShowStrategy = {.open = openShow, .record = vplRecordGbuffer};
const vplStrategy vplKeepStrategy = {.open = openKept, .record = vplRecordGbuffer};
const vplStrategy vplDeferredStrategy = {.open = openDeferred, .record = vplRecordGbuffer};
