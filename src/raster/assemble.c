// SPDX-License-Identifier: MIT
// From shaded vertices to the list of triangles to draw, in mesh order. Two passes over chunks of triangles,
// one that counts and one that writes, so that chunks run in parallel and the order does not depend on them.
#include "raster/raster.h"

#include <string.h>

enum { CHUNK = 2048 };

typedef struct Chunk {
    int shaded, first, count; // triangles of one mesh
    int triangles, extras;    // made; after the prefix sum: where they go
} Chunk;

typedef struct Assembly {
    vplRaster* raster;
    Chunk* chunks;
    int chunkCount;
    bool writing;
} Assembly;

// Writes (or only counts) one projected triangle. Nothing for zero area or where no pixel centre can lie.
static int emit(Assembly* a, int at, const vplScreenVertex v[3], const uint32_t vertex[3], int primitive)
{
    int64_t area =
        (int64_t)(v[1].x - v[0].x) * (v[2].y - v[0].y) - (int64_t)(v[2].x - v[0].x) * (v[1].y - v[0].y);
    vplPixelBox box = vplBoundTriangle(v);
    const vplFramebuffer* f = &a->raster->framebuffer;
    if (area == 0 || box.x1 < box.x0 || box.y1 < box.y0 || box.x1 < 0 || box.y1 < 0 || box.x0 >= f->width ||
        box.y0 >= f->height) {
        return 0;
    }
    if (a->writing) {
        bool clockwise = area > 0; // as seen, because y points down
        vplTriangle* t = &a->raster->triangles[at];
        int second = clockwise ? 1 : 2, third = clockwise ? 2 : 1;
        *t = (vplTriangle){{v[0], v[second], v[third]},
                           {vertex[0], vertex[second], vertex[third]},
                           clockwise ? primitive | VPL_CLOCKWISE : primitive};
    }
    return 1;
}

static int emitClipped(Assembly* a, const vplShaded* s, const uint32_t* index, int primitive, int planes,
                       int at, int* extras)
{
    vplClipVertex in[3], out[VPL_MAX_CLIPPED];
    for (int i = 0; i < 3; i++) {
        uint32_t v = index[i];
        in[i] = (vplClipVertex){s->clip.x[v], s->clip.y[v], s->clip.z[v], s->clip.w[v], {0}};
        for (int k = 0; k < s->varyingCount; k++) {
            in[i].varying[k] = s->clip.varying[k][v];
        }
    }
    int count = vplClipTriangle(a->raster, planes, s->varyingCount, in, out);
    vplScreenVertex screen[VPL_MAX_CLIPPED];
    for (int i = 0; i < count; i++) {
        if (!(out[i].w >= 1e-30)) {
            return 0; // only a point in the eye is left
        }
        double z = out[i].z < 0 ? 0 : out[i].z > out[i].w ? out[i].w : out[i].z; // rounding dust of the cuts
        screen[i] = vplProject(a->raster, out[i].x, out[i].y, z, out[i].w);
    }
    int made = 0;
    for (int i = 1; i + 1 < count; i++) { // a fan
        const vplScreenVertex v[3] = {screen[0], screen[i], screen[i + 1]};
        uint32_t base = (uint32_t)(s->mesh.vertexCount + *extras);
        const uint32_t vertex[3] = {base, base + (uint32_t)i, base + (uint32_t)i + 1};
        made += emit(a, at + made, v, vertex, primitive);
    }
    if (a->writing) {
        for (int i = 0; i < count; i++) {
            float* to = s->extras + (size_t)(*extras + i) * (size_t)(3 + s->varyingCount);
            to[0] = (float)out[i].x;
            to[1] = (float)out[i].y;
            to[2] = (float)out[i].w;
            memcpy(to + 3, out[i].varying, (size_t)s->varyingCount * sizeof(float));
        }
    }
    *extras += count;
    return made;
}

static void assembleChunk(void* data, int chunkIndex, int worker)
{
    (void)worker;
    Assembly* a = data;
    Chunk* chunk = &a->chunks[chunkIndex];
    const vplShaded* s = &a->raster->shaded[chunk->shaded];
    int triangles = a->writing ? chunk->triangles : 0, extras = a->writing ? chunk->extras : 0;
    for (int i = chunk->first; i < chunk->first + chunk->count; i++) {
        const uint32_t* index = s->mesh.indices + 3 * (size_t)i;
        int c0 = s->outcodes[index[0]], c1 = s->outcodes[index[1]], c2 = s->outcodes[index[2]];
        int any = c0 | c1 | c2;
        if ((any & VPL_OUT_BAD) || (c0 & c1 & c2 & ~VPL_OUT_GUARD)) {
            continue;
        }
        int planes = any & (VPL_OUT_NEAR | VPL_OUT_FAR | VPL_OUT_GUARD);
        if (planes) {
            triangles += emitClipped(a, s, index, i, planes, triangles, &extras);
        } else {
            const vplScreenVertex v[3] = {s->screen[index[0]], s->screen[index[1]], s->screen[index[2]]};
            triangles += emit(a, triangles, v, index, i);
        }
    }
    if (!a->writing) {
        chunk->triangles = triangles;
        chunk->extras = extras;
    }
}

static vplResult makeChunks(Assembly* a)
{
    vplRaster* r = a->raster;
    for (int i = 0; i < r->shadedCount; i++) {
        a->chunkCount += (r->shaded[i].mesh.triangleCount + CHUNK - 1) / CHUNK;
    }
    a->chunks = vplAlloc(r->context, (size_t)a->chunkCount, sizeof *a->chunks);
    if (a->chunks == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    int at = 0;
    for (int i = 0; i < r->shadedCount; i++) {
        int total = r->shaded[i].mesh.triangleCount;
        for (int first = 0; first < total; first += CHUNK) {
            a->chunks[at++] = (Chunk){i, first, total - first < CHUNK ? total - first : CHUNK, 0, 0};
        }
    }
    return VPL_SUCCESS;
}

// Turns the chunks' counts into places and makes room for what they will write.
static vplResult placeChunks(Assembly* a)
{
    vplRaster* r = a->raster;
    int64_t triangles = 0;
    for (int i = 0, chunk = 0; i < r->shadedCount; i++) {
        vplShaded* s = &r->shaded[i];
        int64_t extras = 0;
        s->firstTriangle = (int)triangles;
        for (; chunk < a->chunkCount && a->chunks[chunk].shaded == i; chunk++) {
            Chunk* c = &a->chunks[chunk];
            int64_t madeTriangles = c->triangles, madeExtras = c->extras;
            c->triangles = (int)triangles;
            c->extras = (int)extras;
            triangles += madeTriangles;
            extras += madeExtras;
        }
        if (triangles > INT32_MAX || extras + s->mesh.vertexCount > INT32_MAX) {
            return vplFail(r->context, VPL_LIMIT, "more than %d triangles on screen", INT32_MAX);
        }
        s->triangleCount = (int)triangles - s->firstTriangle;
        s->extras = vplAlloc(r->context, (size_t)extras * (size_t)(3 + s->varyingCount), sizeof(float));
        if (s->extras == NULL) {
            return VPL_OUT_OF_MEMORY;
        }
    }
    r->triangleCount = (int)triangles;
    r->triangles = vplAlloc(r->context, (size_t)triangles, sizeof *r->triangles);
    return r->triangles ? VPL_SUCCESS : VPL_OUT_OF_MEMORY;
}

vplResult vplAssembleTriangles(vplRaster* raster)
{
    Assembly a = {raster, NULL, 0, false};
    vplResult result = makeChunks(&a);
    if (result == VPL_SUCCESS) {
        vplParallelFor(raster->context, a.chunkCount, assembleChunk, &a);
        result = placeChunks(&a);
    }
    if (result == VPL_SUCCESS) {
        a.writing = true;
        vplParallelFor(raster->context, a.chunkCount, assembleChunk, &a);
    }
    vplFree(raster->context, a.chunks);
    return result;
}
