// SPDX-License-Identifier: MIT
// Records draws and runs them.
#include "raster/raster.h"
#include "base/clock.h"
#include "math/sampling.h"

#include <string.h>

enum { PIPELINE_COOKIE = 0x56504c40, FRAMEBUFFER_COOKIE };

vplPipeline vplDefaultPipeline(void)
{
    vplPipeline pipeline = {0};
    pipeline.depthWrite = true;
    pipeline.planeMask = UINT32_MAX;
    pipeline.cookie = PIPELINE_COOKIE;
    return pipeline;
}

vplFramebuffer vplDefaultFramebuffer(int width, int height)
{
    return (vplFramebuffer){.width = width, .height = height, .depth.clear = 1, .cookie = FRAMEBUFFER_COOKIE};
}

vplResult vplRaster_Create(vplContext* context, const vplFramebuffer* framebuffer, vplRaster** rasterOut)
{
    REQUIRE(context, context, framebuffer, rasterOut);
    if (framebuffer->cookie != FRAMEBUFFER_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplFramebuffer was not made by vplDefaultFramebuffer");
    }
    if (framebuffer->width < 1 || framebuffer->width > VPL_MAX_IMAGE_SIZE || framebuffer->height < 1 ||
        framebuffer->height > VPL_MAX_IMAGE_SIZE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplFramebuffer is %dx%d, each side must be in [1, %d]",
                       framebuffer->width, framebuffer->height, VPL_MAX_IMAGE_SIZE);
    }
    if (framebuffer->planeCount < 0 || framebuffer->planeCount > VPL_MAX_PLANES) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplFramebuffer.planeCount is %d, must be in [0, %d]",
                       framebuffer->planeCount, VPL_MAX_PLANES);
    }
    if (framebuffer->samples < 0 || framebuffer->samples > VPL_MAX_SAMPLES_PER_PIXEL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplFramebuffer.samples is %d, must be in [0, %d]",
                       framebuffer->samples, VPL_MAX_SAMPLES_PER_PIXEL);
    }
    vplRaster* raster = vplAllocZero(context, 1, sizeof *raster);
    if (raster == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    raster->context = context;
    raster->framebuffer = *framebuffer;
    raster->tilesX = (framebuffer->width + VPL_TILE_SIDE - 1) / VPL_TILE_SIDE;
    raster->tilesY = (framebuffer->height + VPL_TILE_SIDE - 1) / VPL_TILE_SIDE;
    *rasterOut = raster;
    return VPL_SUCCESS;
}

void vplRaster_Destroy(vplRaster* raster)
{
    if (raster != NULL) {
        vplContext* context = raster->context;
        vplFree(context, raster->commands);
        vplFree(context, raster->pipelines);
        vplFree(context, raster->shaded);
        vplFree(context, raster->slots);
        vplFree(context, raster);
    }
}

static vplResult checkDraw(const vplContext* context, const vplMesh* mesh, const vplPipeline* pipeline)
{
    if (pipeline->cookie != PIPELINE_COOKIE) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPipeline was not made by vplDefaultPipeline");
    }
    if (pipeline->vertex == NULL) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPipeline.vertex is NULL, must be a vertex shader");
    }
    if (pipeline->varyingCount < 0 || pipeline->varyingCount > VPL_MAX_VARYINGS) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPipeline.varyingCount is %d, must be in [0, %d]",
                       pipeline->varyingCount, VPL_MAX_VARYINGS);
    }
    if (pipeline->distanceScale != 0 &&
        (pipeline->fragment != NULL || pipeline->depthCompare != VPL_DEPTH_LESS || !pipeline->depthWrite)) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "vplPipeline.distanceScale is %g, must be 0 for draws that do more than write the least depth",
            (double)pipeline->distanceScale);
    }
    if (pipeline->writesDepth && pipeline->fragment == NULL) {
        return vplFail(
            context, VPL_INVALID_ARGUMENT,
            "vplPipeline.writesDepth is set, must not be without a fragment shader, which writes it");
    }
    if (pipeline->passes != NULL && !(vplIsPass(pipeline) && pipeline->blend == VPL_BLEND_ADD)) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplPipeline.passes is set, but the draw is not an additive pass with depth EQUAL");
    }
    const bool wrongSurface =
        pipeline->surfaceCount < pipeline->varyingCount || pipeline->surfaceCount > VPL_MAX_VARYINGS;
    if (pipeline->surface != NULL && wrongSurface) {
        return vplFail(context, VPL_INVALID_ARGUMENT, "vplPipeline.surfaceCount is %d, must be in [%d, %d]",
                       pipeline->surfaceCount, pipeline->varyingCount, VPL_MAX_VARYINGS);
    }
    if (mesh->vertexCount < 0 || mesh->triangleCount < 0) {
        return vplFail(context, VPL_INVALID_ARGUMENT,
                       "vplMesh has %d vertices and %d triangles, must not be negative", mesh->vertexCount,
                       mesh->triangleCount);
    }
    return VPL_SUCCESS;
}

// Draws of one mesh with one vertex shader and uniforms share their vertex work.
static vplResult shareVertices(vplRaster* raster, const vplMesh* mesh, const vplPipeline* pipeline,
                               int* indexOut)
{
    *indexOut = vplRaster_FindShaded(raster, mesh, pipeline);
    if (*indexOut >= 0) {
        return VPL_SUCCESS;
    }
    TRY(vplReserve(raster->context, &raster->shaded, &raster->shadedCapacity, (size_t)raster->shadedCount + 1,
                   sizeof *raster->shaded));
    raster->shaded[raster->shadedCount] = (vplShaded){
        .key = mesh,
        .mesh = *mesh,
        .vertexFcn = pipeline->vertex,
        .uniforms = pipeline->vertexUniforms,
        .varyingCount = pipeline->varyingCount,
        .surfaceFcn = pipeline->surface,
        .surfaceCount = pipeline->surface ? pipeline->surfaceCount : pipeline->varyingCount,
    };
    *indexOut = raster->shadedCount++;
    const vplResult result = vplRaster_IndexShaded(raster);
    raster->shadedCount -= result != VPL_SUCCESS;
    return result;
}

// Draws one after another often have the same pipeline.
static vplResult sharePipeline(vplRaster* raster, const vplPipeline* pipeline, int* indexOut)
{
    const int last = raster->pipelineCount - 1;
    *indexOut = last;
    if (last >= 0 && memcmp(&raster->pipelines[last], pipeline, sizeof *pipeline) == 0) {
        return VPL_SUCCESS;
    }
    TRY(vplReserve(raster->context, &raster->pipelines, &raster->pipelineCapacity,
                   (size_t)raster->pipelineCount + 1, sizeof *raster->pipelines));
    *indexOut = raster->pipelineCount++;
    raster->pipelines[*indexOut] = *pipeline;
    return VPL_SUCCESS;
}

static vplResult addCommand(vplRaster* raster, vplCommand command)
{
    TRY(vplReserve(raster->context, &raster->commands, &raster->commandCapacity,
                   (size_t)raster->commandCount + 1, sizeof *raster->commands));
    raster->commands[raster->commandCount++] = command;
    return VPL_SUCCESS;
}

vplResult vplRaster_Draw(vplRaster* raster, const vplMesh* mesh, const vplPipeline* pipeline)
{
    REQUIRE(CONTEXT_OF(raster), raster, mesh, pipeline);
    vplCommand command = {0};
    TRY(checkDraw(raster->context, mesh, pipeline));
    if (pipeline->ownerTest && raster->framebuffer.triangles != NULL) {
        return vplFail(raster->context, VPL_INVALID_ARGUMENT,
                       "vplPipeline.ownerTest is set, must not be with vplFramebuffer.triangles");
    }
    if (raster->framebuffer.samples > 0 && pipeline->depthWrite &&
        (pipeline->depthCompare != VPL_DEPTH_LESS || pipeline->writesDepth || pipeline->ownerTest ||
         pipeline->distanceScale != 0)) {
        return vplFail(raster->context, VPL_INVALID_ARGUMENT,
                       "vplPipeline writes depth by other means than the test LESS, must not with "
                       "vplFramebuffer.samples");
    }
    TRY(shareVertices(raster, mesh, pipeline, &command.shaded));
    TRY(sharePipeline(raster, pipeline, &command.pipeline));
    TRY(addCommand(raster, command));
    raster->stats.drawCalls++;
    return VPL_SUCCESS;
}

vplResult vplRaster_TileTask(vplRaster* raster, vplTileFcn* fcn, void* data)
{
    REQUIRE(CONTEXT_OF(raster), raster, fcn);
    return addCommand(raster, (vplCommand){.shaded = -1, .tileFcn = fcn, .data = data});
}

// Passes, vertices, triangles and bins.
static vplResult prepare(vplRaster* raster)
{
    raster->run = vplArena_Create(raster->context);
    TRY(vplFindPasses(raster));
    const double start = vplClockMs();
    raster->stats = (vplRasterStats){.drawCalls = raster->stats.drawCalls};
    for (int i = 0; i < raster->shadedCount; i++) {
        TRY(vplShadeVertices(raster, &raster->shaded[i]));
        raster->stats.trianglesIn += raster->shaded[i].mesh.triangleCount;
    }
    TRY(vplBinTriangles(raster));
    raster->stats.vertexMs = vplClockMs() - start;
    return VPL_SUCCESS;
}

static vplResult runAll(vplRaster* const* rasters, int count, vplProgressFcn* progress, void* user)
{
    for (int i = 0; i < count; i++) {
        TRY(prepare(rasters[i]));
    }
    const double start = vplClockMs();
    TRY(vplRunTiles(rasters, count, progress, user));
    for (int i = 0; i < count; i++) {
        rasters[i]->stats.tilesMs = (vplClockMs() - start) / count;
    }
    return VPL_SUCCESS;
}

vplResult vplRaster_RunAll(vplRaster* const* rasters, int count, vplProgressFcn* progress, void* user,
                           vplRasterStats* statsOut)
{
    PLAIN_FLOATS;
    REQUIRE_ARRAY(NULL, rasters, count);
    const vplResult result = runAll(rasters, count, progress, user);
    for (int i = 0; i < count; i++) {
        vplArena_Destroy(rasters[i]->run);
        rasters[i]->run = NULL;
        if (result == VPL_SUCCESS && statsOut != NULL) {
            statsOut[i] = rasters[i]->stats;
        }
    }
    return result;
}

vplResult vplRaster_Run(vplRaster* raster, vplProgressFcn* progress, void* user, vplRasterStats* statsOut)
{
    REQUIRE(CONTEXT_OF(raster), raster);
    return vplRaster_RunAll(&raster, 1, progress, user, statsOut);
}

void vplRasterStats_Add(vplRasterStats* sum, const vplRasterStats* stats)
{
    if (sum == NULL || stats == NULL) {
        return;
    }
    sum->drawCalls += stats->drawCalls;
    sum->fragments += stats->fragments;
    sum->trianglesIn += stats->trianglesIn;
    sum->trianglesBinned += stats->trianglesBinned;
    sum->vertexMs += stats->vertexMs;
    sum->tilesMs += stats->tilesMs;
}

// ---- samples of pixels

vplSubPixel vplSubPixel_OfSample(int i, int count)
{
    const int even = count % 2 == 0; // the centre is one more point, in the middle of the list
    double x, y;
    if (i < 0 || i >= count) {
        return (vplSubPixel){0, 0};
    }
    vplPixelPoint(i + (even && i >= count / 2), count + even, &x, &y);
    return (vplSubPixel){(int)(256 * x) - 128, (int)(256 * y) - 128};
}

int vplTile_GetCoverage(const vplTile* tile, int element, vplCoverage out[VPL_MAX_SAMPLES_PER_PIXEL])
{
    int found = 0;
    for (int i = 0; i < tile->sampleCount; i++) {
        const int32_t triangle = tile->samples[i][element];
        int at = 0;
        while (at < found && out[at].triangle != triangle) {
            at++;
        }
        if (at == found) {
            out[found++] = (vplCoverage){triangle, 0};
        }
        out[at].samples |= 1u << i;
    }
    return found;
}
