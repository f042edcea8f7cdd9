// SPDX-License-Identifier: MIT
#include "raster_support.h"

#include "base/hash.h"

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

ClipVertex* makeSoup(uint64_t seed, int triangles)
{
    ClipVertex* v = malloc(3 * (size_t)triangles * sizeof *v);
    for (int i = 0; i < triangles; i++) {
        double centre[3], size = pow(10, -3 + 3.5 * uniformAt(seed, (uint64_t)i * 64));
        for (int k = 0; k < 3; k++) {
            centre[k] = 2.4 * uniformAt(seed, (uint64_t)i * 64 + 1 + (uint64_t)k) - 1.2;
        }
        for (int j = 0; j < 3; j++) {
            uint64_t at = (uint64_t)i * 64 + 8 + 8 * (uint64_t)j;
            double w = 0.2 + 2 * uniformAt(seed, at);
            if (uniformAt(seed, at + 1) < 0.05) {
                w = -w; // behind the eye
            }
            v[3 * i + j] = (ClipVertex){
                (float)(w * (centre[0] + size * (uniformAt(seed, at + 2) - 0.5))),
                (float)(w * (centre[1] + size * (uniformAt(seed, at + 3) - 0.5))),
                (float)(w * (0.5 + 0.5 * centre[2] + 0.5 * size * (uniformAt(seed, at + 4) - 0.5))),
                (float)w,
                {(float)uniformAt(seed, at + 5), (float)j, 1}};
        }
    }
    return v;
}

uint64_t hashCanvas(const Canvas* c)
{
    size_t count = (size_t)c->framebuffer.width * (size_t)c->framebuffer.height;
    uint64_t hash = vplHashFloats(0, c->depth, count);
    for (int k = 0; k < SHOWN_PLANES; k++) {
        hash = vplHashFloats(hash, c->planes[k], count);
    }
    return hash;
}
