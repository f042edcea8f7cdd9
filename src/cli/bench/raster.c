// SPDX-License-Identifier: MIT
// Stages of the rasterizer alone: fill rate, and the cost of triangles that hardly cover a pixel.
#include "cli/bench/bench.h"
#include "cli/bench/cover.h"

#include <stdlib.h>
#include <string.h>

// ---- whole pictures: triangles that cover all of it, one layer nearer than the other

enum { LAYERS = 8 };

// Runs the recorded draws, unless recording failed, and destroys the raster. Its first plane is b->image's
// floats.
static vplResult finish(vplRaster* raster, vplResult result, const Bench* b, Outcome* outcome)
{
    if (result == VPL_SUCCESS) {
        result = vplRaster_Run(raster, NULL, NULL, &outcome->raster);
    }
    if (result == VPL_SUCCESS) {
        const int count = b->image->width * b->image->height;
        outcome->work = (double)outcome->raster.fragments;
        outcome->unit = "fragments";
        for (int i = 0; i < count; i += 97) {
            addFloat(&outcome->hash, b->image->pixels[i]);
        }
    }
    vplRaster_Destroy(raster);
    return result;
}

// Without planes, draws layers into the depth buffer, each nearer than the one before. With planes, draws one
// layer of depth, and then adds up layers of equal depth.
static vplResult fill(const Bench* b, int planes, Outcome* outcome)
{
    const float depth = 0.5f; // one place, so that the rasterizer sets the triangle up once
    float depths[LAYERS + 1];
    vplFramebuffer framebuffer = vplDefaultFramebuffer(b->image->width, b->image->height);
    vplPipeline pipeline = vplDefaultPipeline();
    vplRaster* raster;
    vplResult result = VPL_SUCCESS;
    framebuffer.planeCount = planes;
    *(planes > 0 ? &framebuffer.planes[0].pixels : &framebuffer.depth.pixels) =
        b->image->pixels; // room for three
    TRY(vplRaster_Create(b->context, &framebuffer, &raster));
    pipeline.vertex = coverVertices;
    for (int i = 0; i < LAYERS + (planes > 0) && result == VPL_SUCCESS; i++) {
        depths[i] = (float)(LAYERS - i) / (LAYERS + 1);
        pipeline.vertexUniforms = planes > 0 ? &depth : &depths[i];
        result = vplRaster_Draw(raster, &COVER, &pipeline);
        if (planes > 0) {
            pipeline.depthCompare = VPL_DEPTH_EQUAL;
            pipeline.depthWrite = false;
            pipeline.blend = VPL_BLEND_ADD;
            pipeline.fragment = coverFragments;
        }
    }
    return finish(raster, result, b, outcome);
}

vplResult runFill(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    return fill(b, 0, outcome);
}

vplResult runAdditiveFill(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    return fill(b, 4, outcome);
}

// ---- small triangles: squares of 2 x 2 pixels, two triangles each

typedef struct Grid {
    int columns; // of vertices
    float stepX, stepY;
} Grid;

// Depth varies from vertex to vertex, so that triangles have a depth slope.
static void gridVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const Grid* g = uniforms;
    for (int i = 0; i < count; i++) {
        int column = (first + i) % g->columns, row = (first + i) / g->columns;
        out->x[i] = -1 + g->stepX * (float)column;
        out->y[i] = 1 - g->stepY * (float)row;
        out->z[i] = 0.25f + 1e-4f * (float)(column % 8 + row % 4);
        out->w[i] = 1;
    }
}

static void fillGrid(int columns, int rows, uint32_t* indices)
{
    for (int y = 0; y + 1 < rows; y++) {
        for (int x = 0; x + 1 < columns; x++) {
            uint32_t at = (uint32_t)(y * columns + x), below = at + (uint32_t)columns;
            const uint32_t corners[6] = {at, below, at + 1, at + 1, below, below + 1};
            memcpy(indices, corners, sizeof corners);
            indices += 6;
        }
    }
}

vplResult runSmallTriangles(Bench* b, const Stage* stage, Outcome* outcome)
{
    (void)stage;
    const int width = b->image->width, height = b->image->height;
    const int columns = width / 2 + 1, rows = height / 2 + 1, triangles = 2 * (columns - 1) * (rows - 1);
    const Grid grid = {columns, 4.0f / (float)width, 4.0f / (float)height};
    uint32_t* indices = malloc(3 * (size_t)triangles * sizeof *indices + 1);
    if (indices == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    fillGrid(columns, rows, indices);
    vplFramebuffer framebuffer = vplDefaultFramebuffer(width, height);
    framebuffer.depth.pixels = b->image->pixels;
    const vplMesh mesh = {indices, columns * rows, triangles};
    vplPipeline pipeline = vplDefaultPipeline();
    pipeline.vertex = gridVertices;
    pipeline.vertexUniforms = &grid;
    vplRaster* raster = NULL;
    vplResult result = vplRaster_Create(b->context, &framebuffer, &raster);
    if (result == VPL_SUCCESS) {
        result = vplRaster_Draw(raster, &mesh, &pipeline);
    }
    result = finish(raster, result, b, outcome);
    outcome->work = (double)outcome->raster.trianglesIn;
    outcome->unit = "triangles";
    free(indices);
    return result;
}
