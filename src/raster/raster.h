// SPDX-License-Identifier: MIT
// The rasterizer from the inside: vertices -> clip -> triangles -> bins -> tiles.
#ifndef VPL_RASTER_RASTER_H
#define VPL_RASTER_RASTER_H

#include <vpl/raster.h>

#include "base/context.h"

enum {
    VPL_SUBPIXEL_BITS = 8,
    VPL_FIXED_LIMIT = 1 << 23, // 32768 pixels in 24.8: an edge function then needs 50 bits
    VPL_TILE_PIXELS = VPL_TILE_SIDE * VPL_TILE_SIDE
};

// A vertex after projection.
typedef struct vplScreenVertex {
    int32_t x, y; // 24.8 fixed point, y down
    float z;      // z/w
} vplScreenVertex;

// Less than a cache line per triangle; edges and planes are set up again in each tile it touches, which costs
// less than reading them from memory.
typedef struct vplTriangle {
    vplScreenVertex v[3]; // turned so that the area is > 0 with y down: clockwise as seen
    uint32_t vertex[3];   // where its clip-space position and varyings are
    int32_t primitive;    // with VPL_CLOCKWISE if it was so before turning
} vplTriangle;

enum { VPL_CLOCKWISE = INT32_MIN };

// Pixels whose centres may lie in a triangle: columns x0 to x1, rows y0 to y1; empty if x1 < x0 or y1 < y0. The
// centre of pixel i lies at 256 i + 128.
typedef struct vplPixelBox {
    int x0, x1, y0, y1;
} vplPixelBox;

static inline vplPixelBox vplBoundTriangle(const vplScreenVertex v[3])
{
    int32_t minX = v[0].x, maxX = v[0].x, minY = v[0].y, maxY = v[0].y;
    for (int i = 1; i < 3; i++) {
        minX = v[i].x < minX ? v[i].x : minX;
        maxX = v[i].x > maxX ? v[i].x : maxX;
        minY = v[i].y < minY ? v[i].y : minY;
        maxY = v[i].y > maxY ? v[i].y : maxY;
    }
    return (vplPixelBox){(minX + 127) >> 8, (maxX - 128) >> 8, (minY + 127) >> 8, (maxY - 128) >> 8};
}

// The result of the vertex stage for one mesh, vertex shader and uniforms.
typedef struct vplShaded {
    const vplMesh* key;
    vplMesh mesh;
    vplVertexFcn* vertexFcn;
    const void* uniforms;
    int varyingCount;
    vplVertices clip;        // what the vertex shader wrote, one array each in `storage`
    vplScreenVertex* screen; // one per mesh vertex
    uint8_t* outcodes;       // one per mesh vertex
    float* extras;           // vertices made by clipping: x, y, w, varyings each; numbered from vertexCount
    int firstTriangle, triangleCount;
    float* storage;
} vplShaded;

typedef struct vplCommand {
    int shaded;   // index, or -1 for a tile task
    int pipeline; // index
    vplTileFcn* tileFcn;
    void* data;
} vplCommand;

struct vplRaster {
    vplContext* context;
    vplFramebuffer framebuffer;
    int tilesX, tilesY;

    vplCommand* commands;
    vplPipeline* pipelines;
    vplShaded* shaded;
    int commandCount, pipelineCount, shadedCount;
    size_t commandCapacity, pipelineCapacity, shadedCapacity;

    vplTriangle* triangles; // all meshes', in order
    int triangleCount;
    int* bins;     // triangle indices by tile, ascending within a tile
    int* binStart; // tilesX * tilesY + 1
    vplRasterStats stats;
};

// Vertex stage of one mesh: shading, projection, outcodes. Memory is made by vplRaster_Draw.
vplResult vplShadeVertices(vplRaster* raster, vplShaded* shaded);

// Bits of outcodes. A vertex with NaN or infinity is BAD, and its triangles are dropped.
enum {
    VPL_OUT_LEFT = 1,
    VPL_OUT_RIGHT = 2,
    VPL_OUT_BOTTOM = 4,
    VPL_OUT_TOP = 8,
    VPL_OUT_NEAR = 16,
    VPL_OUT_FAR = 32,
    VPL_OUT_GUARD = 64, // outside the guard band, or w <= 0: must be clipped before projection
    VPL_OUT_BAD = 128
};

typedef struct vplClipVertex {
    double x, y, z, w;
    float varying[VPL_MAX_VARYINGS];
} vplClipVertex;

enum { VPL_MAX_CLIPPED = 9 }; // a triangle cut by six planes

// Sutherland-Hodgman in homogeneous coordinates against the planes in `planes` (outcode bits; GUARD means the
// four sides of the guard band). Returns the number of vertices, 0 or 3 to 9.
int vplClipTriangle(const vplRaster* raster, int planes, int varyingCount, const vplClipVertex in[3],
                    vplClipVertex out[VPL_MAX_CLIPPED]);

// Projects one clip-space position that needs no clipping.
vplScreenVertex vplProject(const vplRaster* raster, double x, double y, double z, double w);

// Makes raster->triangles from all shaded meshes.
vplResult vplAssembleTriangles(vplRaster* raster);

// Makes raster->bins.
vplResult vplBinTriangles(vplRaster* raster);

// Storage of the tile being drawn by one worker.
typedef struct vplTileState {
    vplTile tile;
    int32_t* owner; // index of the triangle that wrote depth last, -1: none
    int* meshStart; // [shadedCount + 1] into the tile's bin
    int64_t fragments;
    vplFragments block; // scratch of the kernel
} vplTileState;

vplResult vplRunTiles(vplRaster* raster, vplProgressFcn* progress, void* user);

// Draws triangles[list[0 .. count)] of one command into one tile.
typedef void vplDrawTileFcn(vplTileState* state, const vplPipeline* pipeline, const vplShaded* shaded,
                            const vplTriangle* triangles, const int* list, int count,
                            const vplFramebuffer* framebuffer);

// Clip-space x, y, w and varyings of vertex `at`, which may be one of the extras.
static inline void vplFetchVertex(const vplShaded* s, uint32_t at, float position[3], float* varyings)
{
    const uint32_t own = (uint32_t)s->mesh.vertexCount;
    if (at < own) {
        position[0] = s->clip.x[at];
        position[1] = s->clip.y[at];
        position[2] = s->clip.w[at];
        for (int k = 0; k < s->varyingCount; k++) {
            varyings[k] = s->clip.varying[k][at];
        }
        return;
    }
    const float* extra = s->extras + (size_t)(at - own) * (size_t)(3 + s->varyingCount);
    for (int k = 0; k < 3; k++) {
        position[k] = extra[k];
    }
    for (int k = 0; k < s->varyingCount; k++) {
        varyings[k] = extra[3 + k];
    }
}

#endif
