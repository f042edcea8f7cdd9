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

// What is kept of a triangle that may be seen. Corners are looked up again in each tile that it touches: 8 bytes
// instead of 52 are written, and a million small triangles are limited by memory.
typedef struct vplTriangleRef {
    uint32_t source;        // number among all meshes' triangles, or VPL_CLIPPED | index in `clipped`
    uint8_t x0, y0, x1, y1; // tiles that its pixel box touches
} vplTriangleRef;

enum { VPL_CLIPPED = INT32_MIN };
_Static_assert(VPL_MAX_IMAGE_SIZE / VPL_TILE_SIDE <= 256, "tile numbers are bytes");

// A piece of a triangle that was cut.
typedef struct vplClippedTriangle {
    uint32_t vertex[3]; // where its clip-space position and varyings are: of the mesh, then of the extras
    int32_t primitive;
} vplClippedTriangle;

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
    vplFragmentFcn* surfaceFcn;
    const void* uniforms;
    int varyingCount, surfaceCount;
    vplVertices clip;        // what the vertex shader wrote, one array each in `storage`
    vplScreenVertex* screen; // one per mesh vertex
    uint8_t* outcodes;       // one per mesh vertex
    uint8_t outcodesTogether;
    int firstTriangle; // number of its first triangle among all meshes'
    int firstRef;      // where its part of raster->refs begins
    float* storage;
} vplShaded;

typedef struct vplCommand {
    int shaded;   // index, or -1 for a tile task
    int pipeline; // index
    vplTileFcn* tileFcn;
    void* data;
    // Passes: draws that leave depth and owners alone and meet what is visible (see repeat.c).
    bool repeats;
    int epoch;      // passes of one epoch see the same depths and owners
    int passesEnd;  // of the first pass in a row: behind the last
    int chainStart; // first pass of this row with the same mesh
    int chainNext;  // next one, or -1
    int fused;      // of a chain's first: how many passes one call may shade, all or 0;
    int uniforms;   // theirs begin here in raster->passUniforms
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

    vplTriangleRef* refs; // in drawing order, with gaps between the chunks that made them
    vplClippedTriangle* clipped;
    vplScreenVertex* extraScreen; // vertices made by clipping,
    float* extras;                // and their x, y, w and varyings, extraStride each
    int extraStride;
    int* bins;     // indices in refs by tile, ascending within a tile
    int* binStart; // tilesX * tilesY + 1
    bool keepsOwners, keepsPasses, hasTasks;
    const void** passUniforms; // chain by chain
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

// A piece of work of the triangle stage: a range of all meshes' triangles.
typedef struct vplChunk {
    int first, count;       // triangles
    int cut;                // of these, how many may have to be clipped
    int firstRef, refCount; // made
    int firstClipped;       // its part of raster->clipped; its extras begin at 9 / 7 of that
} vplChunk;

typedef struct vplTriangleStage {
    vplRaster* raster;
    vplChunk* chunks;
    int chunkCount, chunkSize, tileCount;
    int* counts; // [chunk][tile]; after the prefix sum: the place of the chunk's next entry
} vplTriangleStage;

enum { VPL_MAX_PIECES = VPL_MAX_CLIPPED - 2 };

// Makes refs, and what clipping makes, of one chunk; counts them by tile. A task of vplParallelFor.
void vplAssembleChunk(void* stage, int chunk, int worker);

// Counts a chunk's triangles that may have to be clipped.
void vplCountCuts(void* stage, int chunk, int worker);

// Makes refs and bins from all shaded meshes.
vplResult vplBinTriangles(vplRaster* raster);

// Finds passes among the commands (see repeat.c).
vplResult vplFindPasses(vplRaster* raster);

// A block that passed depth and owner tests, kept to be shaded by pass after pass. Depths, w and varyings
// follow, 16 floats each.
typedef struct vplKeptBlock {
    int32_t x, y, element, primitive, count;
    _Alignas(64) int32_t covered[VPL_LANES];
} vplKeptBlock;

enum { VPL_COUNTERS = 4 };

// Storage of the tile being drawn by one worker.
typedef struct vplTileState {
    vplTile tile;
    float* depth;    // the tile's
    float* farthest; // per block, square by square: no depth in it is larger
    // The triangle that wrote depth last: index of its ref; where the framebuffer wants triangles, its number among all
    // meshes'. -1: none. NULL where nobody asks.
    int32_t* owner;
    int* meshStart; // [shadedCount + 1] into the tile's bin
    char* kept;     // vplKeptBlocks of `keptStride` bytes, at most one per pixel
    int* keptStart; // [shadedCount] first kept block of a mesh,
    int* keptEnd;   // behind its last,
    int* keptEpoch; // and the epoch they were made in, -1: none
    int keptCount;
    size_t keptStride;
    int64_t fragments;
    _Alignas(64) int32_t fragmentLanes[VPL_COUNTERS][VPL_LANES]; // fragments by lane
    _Alignas(64) vplFragments block;                             // scratch of the kernel
} vplTileState;

// Runs the tiles of several rasters, one after another.
vplResult vplRunTiles(vplRaster* const* rasters, int count, vplProgressFcn* progress, void* user);

// Draws refs list[0 .. count) of one command into one tile; `keep`: keeps the blocks instead of shading them.
typedef void vplDrawTileFcn(vplTileState* state, const vplRaster* raster, const vplCommand* command,
                            const int* list, int count, bool keep);

// Shades the kept blocks of a mesh by all passes of a chain.
typedef void vplRunPassesFcn(vplTileState* state, const vplRaster* raster, int firstCommand);

bool vplIsPass(const vplPipeline* pipeline);

// Clip-space x, y, w and varyings of vertex `at`, which may be one of the extras.
static inline void vplFetchVertex(const vplRaster* raster, const vplShaded* s, uint32_t at, float position[3],
                                  float* varyings)
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
    const float* extra = raster->extras + (size_t)(at - own) * (size_t)raster->extraStride;
    for (int k = 0; k < 3; k++) {
        position[k] = extra[k];
    }
    for (int k = 0; k < s->varyingCount; k++) {
        varyings[k] = extra[3 + k];
    }
}

#endif
