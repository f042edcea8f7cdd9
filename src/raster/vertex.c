// SPDX-License-Identifier: MIT
// Vertex stage: every vertex is shaded and projected once, however many triangles and draws use it.
#include "raster/raster.h"

#include <math.h>

enum { CHUNK = 4096 };

// Below this w a vertex is as good as in the eye: 1/w would near the end of float's range.
static const double SMALLEST_W = 1e-30;

vplScreenVertex vplProject(const vplRaster* raster, double x, double y, double z, double w)
{
    double px = (x / w * 0.5 + 0.5) * raster->framebuffer.width;
    double py = (0.5 - y / w * 0.5) * raster->framebuffer.height;
    double scale = 1 << VPL_SUBPIXEL_BITS;
    vplScreenVertex v;
    v.x = (int32_t)rint(px * scale); // nearest even, as Direct3D snaps; both sides of an edge agree
    v.y = (int32_t)rint(py * scale);
    v.z = (float)(z / w);
    return v;
}

static uint8_t outcodeOf(const vplRaster* raster, double x, double y, double z, double w)
{
    if (!(isfinite(x) && isfinite(y) && isfinite(z) && isfinite(w))) {
        return VPL_OUT_BAD;
    }
    int code = (x < -w ? VPL_OUT_LEFT : 0) | (x > w ? VPL_OUT_RIGHT : 0) | (y < -w ? VPL_OUT_BOTTOM : 0) |
               (y > w ? VPL_OUT_TOP : 0) | (z < 0 ? VPL_OUT_NEAR : 0) | (z > w ? VPL_OUT_FAR : 0);
    double limit = (double)VPL_FIXED_LIMIT / (1 << VPL_SUBPIXEL_BITS);
    bool guarded = false;
    if (w >= SMALLEST_W) {
        double px = (x / w * 0.5 + 0.5) * raster->framebuffer.width;
        double py = (0.5 - y / w * 0.5) * raster->framebuffer.height;
        guarded = fabs(px) <= limit && fabs(py) <= limit;
    }
    return (uint8_t)(code | (guarded ? 0 : VPL_OUT_GUARD));
}

typedef struct Job {
    vplRaster* raster;
    vplShaded* shaded;
} Job;

static void shadeChunk(void* data, int index, int worker)
{
    (void)worker;
    Job* job = data;
    vplShaded* s = job->shaded;
    int first = index * CHUNK;
    int count = s->mesh.vertexCount - first < CHUNK ? s->mesh.vertexCount - first : CHUNK;
    vplVertices part = {s->clip.x + first, s->clip.y + first, s->clip.z + first, s->clip.w + first, {NULL}};
    for (int k = 0; k < s->varyingCount; k++) {
        part.varying[k] = s->clip.varying[k] + first;
    }
    s->vertexFcn(s->uniforms, first, count, &part);
    for (int i = 0; i < count; i++) {
        double x = part.x[i], y = part.y[i], z = part.z[i], w = part.w[i];
        uint8_t code = outcodeOf(job->raster, x, y, z, w);
        s->outcodes[first + i] = code;
        if ((code & (VPL_OUT_BAD | VPL_OUT_GUARD)) == 0) {
            s->screen[first + i] = vplProject(job->raster, x, y, z, w);
        }
    }
}

vplResult vplShadeVertices(vplRaster* raster, vplShaded* shaded)
{
    size_t count = (size_t)shaded->mesh.vertexCount;
    shaded->storage = vplAlloc(raster->context, count * (size_t)(4 + shaded->varyingCount), sizeof(float));
    shaded->screen = vplAlloc(raster->context, count, sizeof *shaded->screen);
    shaded->outcodes = vplAlloc(raster->context, count, 1);
    if (!shaded->storage || !shaded->screen || !shaded->outcodes) {
        return VPL_OUT_OF_MEMORY;
    }
    float* at = shaded->storage;
    shaded->clip.x = at;
    shaded->clip.y = at + count;
    shaded->clip.z = at + 2 * count;
    shaded->clip.w = at + 3 * count;
    for (int k = 0; k < shaded->varyingCount; k++) {
        shaded->clip.varying[k] = at + (4 + (size_t)k) * count;
    }
    Job job = {raster, shaded};
    vplParallelFor(raster->context, (shaded->mesh.vertexCount + CHUNK - 1) / CHUNK, shadeChunk, &job);
    return VPL_SUCCESS;
}
