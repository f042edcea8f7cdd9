// SPDX-License-Identifier: MIT
#include "raster_support.h"

#include <stdlib.h>

void passVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const ClipVertex* v = (const ClipVertex*)uniforms + first;
    for (int i = 0; i < count; i++) {
        out->x[i] = v[i].x;
        out->y[i] = v[i].y;
        out->z[i] = v[i].z;
        out->w[i] = v[i].w;
        for (int k = 0; k < 3; k++) {
            out->varying[k][i] = v[i].varying[k];
        }
    }
}

void showFragments(const void* uniforms, vplFragments* f)
{
    (void)uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        f->plane[0][l] = 1;
        f->plane[1][l] = (float)f->primitive;
        f->plane[2][l] = f->varying[0][l];
        f->plane[3][l] = f->varying[1][l];
        f->plane[4][l] = f->varying[2][l];
        f->plane[5][l] = f->w[l];
    }
}

vplPipeline showPipeline(const ClipVertex* vertices)
{
    vplPipeline p = vplDefaultPipeline();
    p.vertex = passVertices;
    p.vertexUniforms = vertices;
    p.varyingCount = 3;
    p.fragment = showFragments;
    return p;
}

Canvas makeCanvas(int width, int height, float clear)
{
    Canvas c = {vplDefaultFramebuffer(width, height), NULL, {NULL}};
    size_t count = (size_t)width * (size_t)height;
    c.framebuffer.planeCount = SHOWN_PLANES;
    c.depth = c.framebuffer.depth.pixels = calloc(count, sizeof(float));
    for (int k = 0; k < SHOWN_PLANES; k++) {
        c.planes[k] = c.framebuffer.planes[k].pixels = calloc(count, sizeof(float));
        c.framebuffer.planes[k].clear = clear;
    }
    return c;
}

void freeCanvas(Canvas* canvas)
{
    free(canvas->depth);
    for (int k = 0; k < SHOWN_PLANES; k++) {
        free(canvas->planes[k]);
    }
}

vplRasterStats drawList(vplContext* context, const Canvas* canvas, const vplPipeline* pipeline,
                        const uint32_t* indices, int vertexCount, int triangleCount)
{
    uint32_t* own = NULL;
    if (indices == NULL) {
        own = malloc(3 * (size_t)triangleCount * sizeof *own + 4);
        for (int i = 0; i < 3 * triangleCount; i++) {
            own[i] = (uint32_t)i;
        }
    }
    vplMesh mesh = {indices ? indices : own, vertexCount, triangleCount};
    vplRaster* raster;
    vplRasterStats stats;
    assert_int_equal(vplRaster_Create(context, &canvas->framebuffer, &raster), VPL_SUCCESS);
    assert_int_equal(vplRaster_Draw(raster, &mesh, pipeline), VPL_SUCCESS);
    assert_int_equal(vplRaster_Run(raster, NULL, NULL, &stats), VPL_SUCCESS);
    vplRaster_Destroy(raster);
    free(own);
    return stats;
}

ClipVertex fixedVertex(int x, int y, float z, int width, int height)
{
    ClipVertex v = {
        (float)x / (128.0f * (float)width) - 1, 1 - (float)y / (128.0f * (float)height), z, 1, {0}};
    return v;
}
