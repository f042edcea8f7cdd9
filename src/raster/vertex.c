// SPDX-License-Identifier: MIT
// Vertex stage: every vertex is shaded and projected once, however many triangles and draws use it.
#include "raster/raster.h"

#include <math.h>

enum { CHUNK = 4096 };

typedef struct Pixel {
    double x, y;
} Pixel;

static Pixel toPixel(const vplRaster* raster, double x, double y, double w)
{
    return (Pixel){(x / w * 0.5 + 0.5) * raster->framebuffer.width,
                   (0.5 - y / w * 0.5) * raster->framebuffer.height};
}

// Rounds to the nearest even, as Direct3D snaps, so that both sides of an edge agree. Adding 1.5 * 2^52
// leaves no bits below 1; rint does the same, but is a function call on plain x86-64.
static int32_t nearest(double v)
{
    return (int32_t)((v + 0x1.8p52) - 0x1.8p52);
}

static vplScreenVertex snap(Pixel p, double z)
{
    const double scale = 1 << VPL_SUBPIXEL_BITS;
    return (vplScreenVertex){nearest(p.x * scale), nearest(p.y * scale), (float)z};
}

static double depthOf(const vplRaster* raster, double z, double w)
{
    return raster->framebuffer.reversedDepth ? -z / w : z / w;
}

vplScreenVertex vplProject(const vplRaster* raster, double x, double y, double z, double w)
{
    return snap(toPixel(raster, x, y, w), depthOf(raster, z, w));
}

// Returns the outcode of a clip-space position. Sets *screenOut where the position is within range.
static uint8_t projectVertex(const vplRaster* raster, double x, double y, double z, double w,
                             vplScreenVertex* screenOut)
{
    if (!(isfinite(x) && isfinite(y) && isfinite(z) && isfinite(w))) {
        return VPL_OUT_BAD;
    }
    int code = (x < -w ? VPL_OUT_LEFT : 0) | (x > w ? VPL_OUT_RIGHT : 0) | (y < -w ? VPL_OUT_BOTTOM : 0) |
               (y > w ? VPL_OUT_TOP : 0) | (z < 0 ? VPL_OUT_NEAR : 0) | (z > w ? VPL_OUT_FAR : 0);
    if (w < VPL_SMALLEST_W) {
        return (uint8_t)(code | VPL_OUT_GUARD);
    }
    const double limit = (double)VPL_FIXED_LIMIT / (1 << VPL_SUBPIXEL_BITS);
    const Pixel p = toPixel(raster, x, y, w);
    if (!(fabs(p.x) <= limit && fabs(p.y) <= limit)) {
        return (uint8_t)(code | VPL_OUT_GUARD);
    }
    *screenOut = snap(p, depthOf(raster, z, w));
    return (uint8_t)code;
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
    int count = vplMini(s->mesh.vertexCount - first, CHUNK);
    vplVertices part = {s->clip.x + first, s->clip.y + first, s->clip.z + first, s->clip.w + first, {NULL}};
    for (int k = 0; k < s->varyingCount; k++) {
        part.varying[k] = s->clip.varying[k] + first;
    }
    s->vertexFcn(s->uniforms, first, count, &part);
    uint8_t together = 0;
    for (int i = 0; i < count; i++) {
        double x = part.x[i], y = part.y[i], z = part.z[i], w = part.w[i];
        uint8_t code = projectVertex(job->raster, x, y, z, w, &s->screen[first + i]);
        s->outcodes[first + i] = code;
        together |= code;
    }
    __atomic_fetch_or(&s->outcodesTogether, together, __ATOMIC_RELAXED);
}

vplResult vplShadeVertices(vplRaster* raster, vplShaded* shaded)
{
    size_t count = (size_t)shaded->mesh.vertexCount;
    float* at = vplArena_Alloc(raster->run, count * (size_t)(4 + shaded->varyingCount), sizeof *at);
    shaded->screen = vplArena_Alloc(raster->run, count, sizeof *shaded->screen);
    shaded->outcodes = vplArena_Alloc(raster->run, count, 1);
    TRY(vplArena_Check(raster->run));
    shaded->clip.x = at;
    shaded->clip.y = at + count;
    shaded->clip.z = at + 2 * count;
    shaded->clip.w = at + 3 * count;
    for (int k = 0; k < shaded->varyingCount; k++) {
        shaded->clip.varying[k] = at + (4 + (size_t)k) * count;
    }
    shaded->outcodesTogether = 0;
    Job job = {raster, shaded};
    return vplParallelForAsking(raster->context, (shaded->mesh.vertexCount + CHUNK - 1) / CHUNK, shadeChunk,
                                &job);
}
