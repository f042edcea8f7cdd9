// SPDX-License-Identifier: MIT
// Makes references to the triangles that may be visible, in drawing order. Chunks of triangles run in
// parallel; each knows beforehand where its results go, so that the order does not depend on threads.
#include "raster/raster.h"

#include <string.h>

// Moves *mesh to the mesh of triangle `first`. Returns where its part of the triangles `first` to `end` - 1
// ends.
static int meshPart(const vplRaster* r, int first, int end, int* mesh)
{
    while (*mesh + 1 < r->shadedCount && r->shaded[*mesh + 1].firstTriangle <= first) {
        ++*mesh;
    }
    const int meshEnd = r->shaded[*mesh].firstTriangle + r->shaded[*mesh].mesh.triangleCount;
    return meshEnd < end ? meshEnd : end;
}

// Outcode bits of the planes that must cut a triangle; -1 where it is dropped.
static int planesOf(const vplShaded* s, const uint32_t* index)
{
    const int c0 = s->outcodes[index[0]], c1 = s->outcodes[index[1]], c2 = s->outcodes[index[2]];
    const int any = c0 | c1 | c2;
    if ((any & VPL_OUT_BAD) || (c0 & c1 & c2 & ~VPL_OUT_GUARD)) {
        return -1;
    }
    return any & VPL_OUT_CUT;
}

void vplCountCuts(void* data, int chunkIndex, int worker)
{
    (void)worker;
    const vplTriangleStage* stage = data;
    const vplRaster* r = stage->raster;
    vplChunk* chunk = &stage->chunks[chunkIndex];
    chunk->cut = 0;
    const int end = chunk->first + chunk->count;
    for (int i = chunk->first, mesh = 0, partEnd; i < end; i = partEnd) {
        partEnd = meshPart(r, i, end, &mesh);
        const vplShaded* s = &r->shaded[mesh];
        const bool mayCut = s->outcodesTogether & VPL_OUT_CUT;
        for (; mayCut && i < partEnd; i++) {
            chunk->cut += planesOf(s, s->mesh.indices + 3 * (size_t)(i - s->firstTriangle)) > 0;
        }
    }
}

// The places that a chunk writes to.
typedef struct Writer {
    const vplRaster* raster;
    vplTriangleRef* next;
    int* counts; // by tile
    int tilesX, tilesY, width, height;
    bool sampled;
    int clipped, extras;
} Writer;

// Keeps one projected triangle; false for zero area or where no pixel centre or sample can lie.
static inline bool emit(Writer* w, const vplScreenVertex v[3], uint32_t source)
{
    const int64_t area =
        (int64_t)(v[1].x - v[0].x) * (v[2].y - v[0].y) - (int64_t)(v[2].x - v[0].x) * (v[1].y - v[0].y);
    const vplPixelBox box = vplTriangle_PixelBox(v, w->sampled);
    if (area == 0 || box.x1 < box.x0 || box.y1 < box.y0 || (box.x1 | box.y1) < 0 || box.x0 >= w->width ||
        box.y0 >= w->height) {
        return false;
    }
    const int shift = 6;
    _Static_assert(VPL_TILE_SIDE == 1 << 6, "the shift is for 64-pixel tiles");
    const int x0 = vplMaxi(box.x0 >> shift, 0), y0 = vplMaxi(box.y0 >> shift, 0);
    const int x1 = vplMini(box.x1 >> shift, w->tilesX - 1), y1 = vplMini(box.y1 >> shift, w->tilesY - 1);
    *w->next++ = (vplTriangleRef){source, (uint8_t)x0, (uint8_t)y0, (uint8_t)x1, (uint8_t)y1};
    for (int y = y0; y <= y1; y++) {
        for (int x = x0; x <= x1; x++) {
            w->counts[y * w->tilesX + x]++;
        }
    }
    return true;
}

static void emitClipped(Writer* writer, const vplShaded* s, const uint32_t* index, int primitive, int planes)
{
    const vplRaster* r = writer->raster;
    vplClipVertex in[3], out[VPL_MAX_CLIPPED];
    for (int i = 0; i < 3; i++) {
        const uint32_t v = index[i];
        in[i] = (vplClipVertex){{s->clip.x[v], s->clip.y[v], s->clip.z[v], s->clip.w[v]}, {0}};
        for (int k = 0; k < s->varyingCount; k++) {
            in[i].varying[k] = s->clip.varying[k][v];
        }
    }
    const int count = vplClipTriangle(r, planes, s->varyingCount, in, out);
    vplScreenVertex* screen = r->extraScreen + writer->extras;
    for (int i = 0; i < count; i++) {
        const double x = out[i].at[0], y = out[i].at[1], w = out[i].at[3];
        if (!(w >= VPL_SMALLEST_W)) {
            return; // only a point in the eye is left
        }
        // The cuts round.
        const double z = out[i].at[2] < 0 ? 0 : out[i].at[2] > w ? w : out[i].at[2];
        screen[i] = vplProject(r, x, y, z, w);
        float* to = r->extras + (size_t)(writer->extras + i) * (size_t)r->extraStride;
        to[0] = (float)x;
        to[1] = (float)y;
        to[2] = (float)w;
        memcpy(to + 3, out[i].varying, (size_t)s->varyingCount * sizeof(float));
    }
    const uint32_t base = (uint32_t)(s->mesh.vertexCount + writer->extras);
    for (int i = 1; i + 1 < count; i++) { // a fan
        const vplScreenVertex v[3] = {screen[0], screen[i], screen[i + 1]};
        if (emit(writer, v, (uint32_t)VPL_CLIPPED | (uint32_t)writer->clipped)) {
            r->clipped[writer->clipped++] =
                (vplClippedTriangle){{base, base + (uint32_t)i, base + (uint32_t)i + 1}, primitive};
        }
    }
    writer->extras += count;
}

void vplAssembleChunk(void* data, int chunkIndex, int worker)
{
    (void)worker;
    const vplTriangleStage* stage = data;
    const vplRaster* r = stage->raster;
    vplChunk* chunk = &stage->chunks[chunkIndex];
    vplTriangleRef* refs = r->refs + chunk->firstRef;
    Writer w = {.raster = r,
                .next = refs,
                .counts = stage->counts + (size_t)chunkIndex * (size_t)stage->tileCount,
                .tilesX = r->tilesX,
                .tilesY = r->tilesY,
                .width = r->framebuffer.width,
                .height = r->framebuffer.height,
                .sampled = r->framebuffer.samples > 0,
                .clipped = chunk->firstClipped,
                .extras = chunk->firstClipped / VPL_MAX_PIECES * VPL_MAX_CLIPPED};
    const int end = chunk->first + chunk->count;
    for (int i = chunk->first, mesh = 0, partEnd; i < end;) {
        partEnd = meshPart(r, i, end, &mesh);
        vplShaded* s = &r->shaded[mesh];
        if (i == s->firstTriangle) {
            s->firstRef = (int)(w.next - r->refs);
        }
        for (; i < partEnd; i++) {
            const uint32_t* index = s->mesh.indices + 3 * (size_t)(i - s->firstTriangle);
            const int planes = planesOf(s, index);
            if (planes > 0) {
                emitClipped(&w, s, index, i - s->firstTriangle, planes);
            } else if (planes == 0) {
                const vplScreenVertex v[3] = {s->screen[index[0]], s->screen[index[1]], s->screen[index[2]]};
                emit(&w, v, (uint32_t)i);
            }
        }
    }
    chunk->refCount = (int)(w.next - refs);
}
