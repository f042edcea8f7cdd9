// SPDX-License-Identifier: MIT
// The rasterizer from the inside: vertices -> clip -> triangles -> bins -> tiles.
#ifndef VPL_RASTER_RASTER_H
#define VPL_RASTER_RASTER_H

#include <vpl/raster.h>

#include "base/arena.h"
#include "math/scalar.h"

enum {
    VPL_SUBPIXEL_BITS = 8,
    VPL_FIXED_LIMIT = 1 << 23, // 32768 pixels in 24.8: an edge function then needs 50 bits
    VPL_TILE_PIXELS = VPL_TILE_SIDE * VPL_TILE_SIDE
};

// A vertex after projection.
typedef struct vplScreenVertex {
    int32_t x, y; // 24.8 fixed point, y down
    float z;      // z/w, or -z/w
} vplScreenVertex;

// A triangle that may be visible. Each tile that it touches looks its corners up again: this writes 8 bytes
// instead of 52, and a million small triangles are limited by memory.
typedef struct vplTriangleRef {
    uint32_t source;        // number among all meshes' triangles, or VPL_CLIPPED | index in `clipped`
    uint8_t x0, y0, x1, y1; // tiles that its pixel box touches
} vplTriangleRef;

enum { VPL_CLIPPED = INT32_MIN };
_Static_assert(VPL_MAX_IMAGE_SIZE / VPL_TILE_SIDE <= 256, "tile numbers are bytes");

// A piece of a clipped triangle.
typedef struct vplClippedTriangle {
    uint32_t vertex[3]; // index of clip-space position and varyings: the mesh's vertices, then the extras
    int32_t primitive;
} vplClippedTriangle;

// Pixels whose centres, or with `sampled` any of whose points, may lie in a triangle: columns x0 to x1, rows
// y0 to y1; empty if x1 < x0 or y1 < y0. The centre of pixel i lies at 256 i + 128.
typedef struct vplPixelBox {
    int x0, x1, y0, y1;
} vplPixelBox;

static inline vplPixelBox vplTriangle_PixelBox(const vplScreenVertex v[3], bool sampled)
{
    const int32_t minX = vplMini(vplMini(v[0].x, v[1].x), v[2].x);
    const int32_t maxX = vplMaxi(vplMaxi(v[0].x, v[1].x), v[2].x);
    const int32_t minY = vplMini(vplMini(v[0].y, v[1].y), v[2].y);
    const int32_t maxY = vplMaxi(vplMaxi(v[0].y, v[1].y), v[2].y);
    const int32_t before = sampled ? 0 : 127, after = sampled ? 0 : 128;
    return (vplPixelBox){(minX + before) >> 8, (maxX - after) >> 8, (minY + before) >> 8,
                         (maxY - after) >> 8};
}

// The element of a tile's storage, blocks of 4 x 4, that holds pixel (x, y) of the tile.
static inline int32_t vplTile_Element(int32_t x, int32_t y)
{
    return ((y >> 2) * VPL_TILE_BLOCKS + (x >> 2)) * VPL_LANES + (y & 3) * VPL_BLOCK_SIDE + (x & 3);
}

// The result of the vertex stage for one mesh, vertex shader and uniforms.
typedef struct vplShaded {
    const vplMesh* key;
    vplMesh mesh;
    vplVertexFcn* vertexFcn;
    vplFragmentFcn* surfaceFcn;
    const void* uniforms;
    int varyingCount, surfaceCount;
    vplVertices clip;        // output of the vertex shader
    vplScreenVertex* screen; // one per mesh vertex
    uint8_t* outcodes;       // one per mesh vertex
    uint8_t outcodesTogether;
    int firstTriangle; // number of its first triangle among all meshes'
    int firstRef;      // start of its part of raster->refs
} vplShaded;

// A recorded draw or tile task.
typedef struct vplCommand {
    int shaded;   // index, or -1 for a tile task
    int pipeline; // index
    vplTileFcn* tileFcn;
    void* data;
    // For passes: draws that change neither depth nor owner and shade what is visible (see fused_passes.c).
    bool isPass;
    int epoch;      // all passes of one epoch see the same depths and owners
    int passesEnd;  // at the first pass of a row: one behind the last
    int chainStart; // first pass of this row over the same mesh
    int chainNext;  // next one, or -1
    int fused;      // at the start of a chain: how many passes one call may shade, all or 0
    int uniforms;   // start of their uniforms in raster->passUniforms
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
    int* slots; // hash table of `shaded`: 1 + index; 0: empty
    size_t slotCapacity;

    vplArena* run;        // owns the arrays below and those of `shaded` while a run lasts
    vplTriangleRef* refs; // in drawing order, with gaps between the chunks that made them
    vplClippedTriangle* clipped;
    vplScreenVertex* extraScreen; // the extras: vertices made by clipping
    float* extras;                // their x, y, w and varyings, extraStride each
    int extraStride;
    int* bins;     // indices in refs by tile, ascending within a tile
    int* binStart; // [tilesX * tilesY + 1]
    bool keepsOwners, keepsPasses, hasTasks;
    const void** passUniforms; // chain by chain
    vplRasterStats stats;
};

// The vertex work that the draw shares with others: an index of raster->shaded, -1 if there is none.
int vplRaster_FindShaded(const vplRaster* raster, const vplMesh* mesh, const vplPipeline* pipeline);

// Lets the last of raster->shaded be found.
vplResult vplRaster_IndexShaded(vplRaster* raster);

// Vertex stage of one mesh: shading, projection, outcodes.
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
    VPL_OUT_BAD = 128,
    VPL_OUT_CUT = VPL_OUT_NEAR | VPL_OUT_FAR | VPL_OUT_GUARD // planes that triangles are clipped against
};

// Below this w a vertex is as good as in the eye: 1/w would near the end of float's range.
#define VPL_SMALLEST_W 1e-30

typedef struct vplClipVertex {
    double at[4]; // x, y, z, w
    float varying[VPL_MAX_VARYINGS];
} vplClipVertex;

// Corners and triangles of a triangle that was cut by six planes.
enum { VPL_MAX_CLIPPED = 9, VPL_MAX_PIECES = VPL_MAX_CLIPPED - 2 };

// Sutherland-Hodgman in homogeneous coordinates against the planes in `planes` (outcode bits; GUARD means the
// four sides of the guard band). Returns the number of vertices, 0 or 3 to 9.
int vplClipTriangle(const vplRaster* raster, int planes, int varyingCount, const vplClipVertex in[3],
                    vplClipVertex out[VPL_MAX_CLIPPED]);

// Projects one clip-space position that needs no clipping.
vplScreenVertex vplProject(const vplRaster* raster, double x, double y, double z, double w);

// A piece of work of the triangle stage: a range of all meshes' triangles.
typedef struct vplChunk {
    int first, count;       // triangles
    int cut;                // how many of them may have to be clipped
    int firstRef, refCount; // refs made
    int firstClipped;       // start of its part of raster->clipped; its extras start at 9 / 7 of that
} vplChunk;

typedef struct vplTriangleStage {
    vplRaster* raster;
    vplChunk* chunks;
    int chunkCount, chunkSize, tileCount;
    int* counts; // [chunk][tile]; after the prefix sum: where the chunk's next entry goes
} vplTriangleStage;

// Tasks of vplParallelFor. The first counts a chunk's triangles that may have to be clipped; the second makes
// its refs, clips, and counts refs by tile.
void vplCountCuts(void* stage, int chunk, int worker);
void vplAssembleChunk(void* stage, int chunk, int worker);

// Makes refs and bins from all shaded meshes.
vplResult vplBinTriangles(vplRaster* raster);

// Finds passes among the commands (see fused_passes.c).
vplResult vplFindPasses(vplRaster* raster);

bool vplIsPass(const vplPipeline* pipeline);

// A block that passed depth and owner tests, stored for the passes over it. Depths, w and varyings follow, 16
// floats each.
typedef struct vplKeptBlock {
    int32_t x, y, element, primitive, count;
    _Alignas(64) int32_t covered[VPL_LANES];
} vplKeptBlock;

enum { VPL_COUNTERS = 4 };

// Storage of the tile being drawn by one worker.
typedef struct vplTileState {
    vplTile tile;
    float* depth;    // the tile's
    float* farthest; // one per block, square by square: not less than any depth in it
    // Draws one sample of every pixel: depth, and the triangle's number in `owner`. False: the centres.
    bool sampling;
    vplSubPixel sample;
    float *sampleDepth, *sampleFarthest; // in place of depth and farthest while samples are drawn
    // The triangle that wrote depth last: index of its ref, or where the framebuffer wants triangles, its
    // number among all meshes'. -1: none. NULL where nobody asks.
    int32_t* owner;
    int* meshStart; // [shadedCount + 1] into the tile's bin
    char* kept;     // vplKeptBlocks of `keptStride` bytes, at most one per pixel
    // By mesh: its kept blocks, keptStart to keptEnd - 1, and the epoch they were made in, -1: none.
    int *keptStart, *keptEnd, *keptEpoch;
    int keptCount;
    size_t keptStride;
    int64_t fragments;
    _Alignas(64) int32_t fragmentLanes[VPL_COUNTERS][VPL_LANES]; // fragments by lane
    _Alignas(64) vplFragments block;                             // scratch of the kernel
} vplTileState;

// Runs the tiles of several rasters side by side.
vplResult vplRunTiles(vplRaster* const* rasters, int count, vplProgressFcn* progress, void* user);

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
