// SPDX-License-Identifier: MIT
// The triangles that can be hit, with boxes around them.
#include "base/context.h"
#include "geometry/bvh_build.h"
#include "geometry/triangle.h"

#include <string.h>

// A chunk of triangles: items are written from its first triangle on.
typedef struct Collection {
    const vplBuilder* builder;
    vplBuildRange* ranges; // by chunk
} Collection;

static void boxTriangle(const vplGeometry* g, int triangle, vplBuildBox* box)
{
    const vplTriangleCorners t = vplGeometry_Corners(g, triangle);
    float p[3][3];
    for (int i = 0; i < 3; i++) {
        p[i][0] = t.corner[i].x;
        p[i][1] = t.corner[i].y;
        p[i][2] = t.corner[i].z;
    }
    float low[3], high[3];
    vplBoundTriangle(p, low, high);
    box->low = (vplFour){low[0], low[1], low[2], 0};
    box->high = (vplFour){high[0], high[1], high[2], (float)vplTriangle_Area(&t)};
}

static void collectChunk(void* data, int chunk, int worker)
{
    (void)worker;
    const Collection* c = data;
    const vplGeometry* g = c->builder->geometry;
    const int first = chunk * VPL_BUILD_CHUNK;
    int count = 0;
    for (int i = first; i < g->triangleCount && i < first + VPL_BUILD_CHUNK; i++) {
        if (vplCanBeHit(g, i)) {
            boxTriangle(g, i, &c->builder->items[first + count]);
            c->builder->ids[first + count++] = i;
        }
    }
    c->ranges[chunk] = vplMakeRange(c->builder, first, count);
}

// All of them, moved together.
static vplBuildRange joinChunks(const Collection* c, int chunks)
{
    vplBuildRange all = {vplNoBox(), vplNoBox(), 0, 0};
    for (int i = 0; i < chunks; i++) {
        const vplBuildRange* part = &c->ranges[i];
        const vplBuilder* b = c->builder;
        if (part->first != all.count) {
            memmove(b->items + all.count, b->items + part->first, (size_t)part->count * sizeof *b->items);
            memmove(b->ids + all.count, b->ids + part->first, (size_t)part->count * sizeof *b->ids);
        }
        all.box = vplJoinBoxes(all.box, part->box);
        all.centres = vplJoinBoxes(all.centres, part->centres);
        all.count += part->count;
    }
    return all;
}

vplResult vplCollectItems(const vplBuilder* b, vplBuildRange* allOut)
{
    vplContext* context = b->geometry->context;
    const int chunks = (b->geometry->triangleCount + VPL_BUILD_CHUNK - 1) / VPL_BUILD_CHUNK;
    Collection c = {b, vplAlloc(context, (size_t)chunks, sizeof *c.ranges)};
    if (c.ranges == NULL) {
        return VPL_OUT_OF_MEMORY;
    }
    vplBuilder_Run(b, chunks, collectChunk, &c);
    *allOut = joinChunks(&c, chunks);
    vplFree(context, c.ranges);
    return VPL_SUCCESS;
}
