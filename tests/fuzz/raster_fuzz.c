// SPDX-License-Identifier: MIT
// Draws triangles of any floats by the rasterizer in states made from bytes: with plain code on one worker, and with the
// widest instructions on three workers whose tasks run in the opposite order. Both must be refused alike, or give the same
// bits.
#include "fuzz.h"

#include "base/hash.h"

#include <math.h>
#include <string.h>

enum { VERTICES = 24, TRIANGLES = 12, PLANES = 4, DRAWS = 4, LONGEST = 140 };

typedef struct Vertex {
    float x, y, z, w;
    float varying[VPL_MAX_VARYINGS];
} Vertex;

static void shadeVertices(const void* uniforms, int first, int count, const vplVertices* out)
{
    const Vertex* v = (const Vertex*)uniforms + first;
    for (int i = 0; i < count; i++) {
        out->x[i] = v[i].x;
        out->y[i] = v[i].y;
        out->z[i] = v[i].z;
        out->w[i] = v[i].w;
        for (int k = 0; k < VPL_MAX_VARYINGS && out->varying[k] != NULL; k++) {
            out->varying[k][i] = v[i].varying[k];
        }
    }
}

// What a fragment shader is told.
typedef struct Shader {
    int varyingCount;
    bool blends, writesDepth, readsW;
} Shader;

static void shadeFragments(const void* uniforms, vplFragments* f)
{
    const Shader* s = uniforms;
    for (int l = 0; l < VPL_LANES; l++) {
        f->plane[0][l] = (s->blends ? 0.5f * f->plane[0][l] : 0) + 1 + (float)(f->primitive & 7);
        f->plane[1][l] = s->varyingCount > 0 ? f->varying[0][l] : 2;
        f->plane[2][l] = s->varyingCount > 2 ? f->varying[2][l] : 3;
        f->plane[3][l] = s->readsW ? f->w[l] : 4;
        f->depth[l] = s->writesDepth ? 0.25f + 0.5f * f->depth[l] : f->depth[l];
    }
}

// A coordinate: near the picture, exact, far away, or any bits.
static float coordinate(Bytes* b)
{
    static const float some[] = {0, 1, -1, 0.5f, 1e-30f, 1e30f, -1e30f, 0x1p-149f, 1e9f, -3, INFINITY, NAN};
    uint32_t bits;
    float any;
    switch (pick(b, 8)) {
    case 0:
        return some[pick(b, sizeof some / sizeof *some)];
    case 1:
        bits = pick(b, 256) | pick(b, 256) << 8 | pick(b, 256) << 16 | pick(b, 256) << 24;
        memcpy(&any, &bits, sizeof any);
        return any;
    case 2:
        return (float)(1000 * unit(b) - 500);
    default:
        return (float)(2.2 * unit(b) - 1.1);
    }
}

typedef struct Input {
    Vertex vertices[VERTICES];
    uint32_t indices[DRAWS][3 * TRIANGLES];
    vplMesh meshes[DRAWS];
    vplPipeline pipelines[DRAWS];
    Shader shaders[DRAWS];
    vplFramebuffer framebuffer;
    int drawCount;
} Input;

static void makePipeline(Bytes* b, Input* in, int i)
{
    vplPipeline* p = &in->pipelines[i];
    Shader* s = &in->shaders[i];
    const unsigned flags = pick(b, 256);
    *p = vplDefaultPipeline();
    p->vertex = shadeVertices;
    p->vertexUniforms = in->vertices;
    p->varyingCount = p->surfaceCount = (int)pick(b, VPL_MAX_VARYINGS + 1);
    p->fragment = flags & 1 ? NULL : shadeFragments;
    p->fragmentUniforms = s;
    p->depthCompare = (vplDepthCompare)pick(b, 4);
    p->depthWrite = (flags & 2) == 0;
    p->writesDepth = (flags & 12) == 12;
    p->needsW = (flags & 16) != 0;
    p->readsPlanes = (flags & 32) != 0;
    p->ownerTest = (flags & 192) == 192;
    p->distanceScale = pick(b, 6) == 5 ? coordinate(b) : 0;
    p->distanceAlongAxis = (flags & 64) != 0;
    p->blend = (vplBlend)pick(b, 2);
    p->cull = (vplCull)pick(b, 3);
    p->planeMask = pick(b, 3) ? ~0u : pick(b, 256);
    *s = (Shader){p->varyingCount, p->readsPlanes, p->writesDepth, p->needsW || p->varyingCount > 0};
}

static void makeInput(Bytes* b, Input* in)
{
    const int width = 1 + (int)pick(b, LONGEST), height = 1 + (int)pick(b, LONGEST);
    in->framebuffer = vplDefaultFramebuffer(width, height);
    in->framebuffer.planeCount = (int)pick(b, PLANES + 1);
    in->framebuffer.samples = pick(b, 4) == 3 ? (int)pick(b, VPL_MAX_SAMPLES_PER_PIXEL + 1) : 0;
    in->framebuffer.reversedDepth = pick(b, 3) == 2;
    in->framebuffer.depth.clear = in->framebuffer.reversedDepth ? 0 : 1;
    in->drawCount = 1 + (int)pick(b, DRAWS);
    for (int i = 0; i < in->drawCount; i++) {
        makePipeline(b, in, i);
        in->meshes[i] = (vplMesh){in->indices[i], VERTICES, (int)pick(b, TRIANGLES + 1)};
        for (int k = 0; k < 3 * TRIANGLES; k++) {
            in->indices[i][k] = pick(b, VERTICES);
        }
    }
    for (int i = 0; i < VERTICES; i++) {
        Vertex* v = &in->vertices[i];
        v->x = coordinate(b);
        v->y = coordinate(b);
        v->z = pick(b, 3) ? (float)unit(b) : coordinate(b);
        v->w = pick(b, 3) ? 1 : coordinate(b);
        for (int k = 0; k < VPL_MAX_VARYINGS; k++) {
            v->varying[k] = k < 3 ? (float)(10 * unit(b)) : 1;
        }
    }
}

static vplContext* openContext(FuzzLog* log, bool wide)
{
    vplContextDef def = vplDefaultContextDef();
    vplContext* context = NULL;
    def.log = fuzzLog;
    def.logUser = log;
    def.workerCount = wide ? 3 : 1;
    def.parallelFor = backwards;
    def.isa = wide ? VPL_ISA_AUTO : VPL_ISA_SCALAR;
    MUST(vplContext_Create(&def, &context) == VPL_SUCCESS);
    return context;
}

static vplResult drawAll(vplContext* context, const Input* in)
{
    vplRaster* raster = NULL;
    vplRasterStats stats;
    vplResult result = vplRaster_Create(context, &in->framebuffer, &raster);
    for (int i = 0; i < in->drawCount && result == VPL_SUCCESS; i++) {
        result = vplRaster_Draw(raster, &in->meshes[i], &in->pipelines[i]);
    }
    result = result == VPL_SUCCESS ? vplRaster_Run(raster, NULL, NULL, &stats) : result;
    vplRaster_Destroy(raster);
    return result;
}

// Draws and returns a hash of the result, depth and planes.
static uint64_t draw(Input* in, bool wide)
{
    static float pixels[1 + PLANES][LONGEST * LONGEST];
    FuzzLog log = {{0}, 0};
    vplContext* context = openContext(&log, wide);
    const size_t count = (size_t)in->framebuffer.width * (size_t)in->framebuffer.height;
    memset(pixels, 0, sizeof pixels);
    in->framebuffer.depth.pixels = pixels[0];
    for (int k = 0; k < in->framebuffer.planeCount; k++) {
        in->framebuffer.planes[k].pixels = pixels[1 + k];
    }
    const vplResult result = drawAll(context, in);
    MUST(result == VPL_SUCCESS || result == VPL_INVALID_ARGUMENT);
    MUST(log.errors == (result != VPL_SUCCESS) && isPrintable(log.message));
    uint64_t hash = (uint64_t)result;
    for (int k = 0; k <= in->framebuffer.planeCount && result == VPL_SUCCESS; k++) {
        for (size_t i = 0; i < count; i++) {
            MUST(!isnan(pixels[k][i]));
        }
        hash = vplHashFloats(hash, pixels[k], count);
    }
    closeFuzzContext(context);
    return hash;
}

int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size)
{
    static Input in;
    Bytes b = {bytes, size};
    makeInput(&b, &in);
    MUST(draw(&in, false) == draw(&in, true));
    return 0;
}
