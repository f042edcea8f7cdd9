// SPDX-License-Identifier: MIT
// A programmable tile rasterizer. Draws are recorded, then run tile by tile: all draws of one tile before the
// next tile, so that a tile's pixels stay in cache however many passes there are.
//
// Rules: 8 bits of sub-pixel precision, vertices snapped to nearest even, top-left rule: a pixel centre on a
// shared edge is covered exactly once. Depth is z/w in [0, 1] (or reversed), linear in screen space, and computed by one
// function for all passes, so that a LESS pass and an EQUAL pass get the same bits. Where snapping covers a pixel
// whose centre is outside of the triangle, w and varyings are those of the triangle's plane there, but at most
// 1/64 of the triangle's extent beyond it: only triangles thinner than 1/5 pixel are left further.
#ifndef VPL_RASTER_H
#define VPL_RASTER_H

#include <vpl/vecmath.h>

VPL_HEADER_BEGIN

enum {
    VPL_LANES = 16,        // fragments per block: 4 x 4 pixels, lane i at (i % 4, i / 4)
    VPL_BLOCK_SIDE = 4,    // pixels
    VPL_TILE_SIDE = 64,    // pixels
    VPL_TILE_BLOCKS = 16,  // blocks along a tile's side
    VPL_MAX_VARYINGS = 12, // floats per vertex, besides the position
    VPL_MAX_PLANES = 8,    // colour planes of a framebuffer
    VPL_MAX_SAMPLES_PER_PIXEL = 16
};

// Output of a vertex shader: element i - first of each array belongs to vertex i.
typedef struct vplVertices {
    float *x, *y, *z, *w; // clip space: inside when |x| <= w, |y| <= w and 0 <= z <= w
    float* varying[VPL_MAX_VARYINGS];
} vplVertices;

// Shades vertices first .. first + count - 1. Called from any worker.
typedef void vplVertexFcn(const void* uniforms, int first, int count, const vplVertices* out);

// A block of fragments of one triangle. It is public because a fragment shader of the caller receives it: a call per block
// costs a sixteenth of a call per fragment, and the shader's loop over lanes is vectorised. Lanes that are not covered hold
// finite numbers that are never written to planes.
typedef struct vplFragments {
    int32_t covered[VPL_LANES];                 // -1 where the lane is a fragment, else 0
    float depth[VPL_LANES];                     // z/w; a shader with writesDepth sets it
    float w[VPL_LANES];                         // clip-space w: distance along the view axis; see needsW
    float varying[VPL_MAX_VARYINGS][VPL_LANES]; // perspective-correct, see the rules above
    float plane[VPL_MAX_PLANES][VPL_LANES];     // out: colours; in, with readsPlanes: the framebuffer's
    int x, y;                                   // pixel of lane 0; x and y are multiples of 4
    int primitive;                              // index of the triangle in its mesh
    int element;                                // of lane 0 in the tile's storage
    void* scratch;                              // the tile's, see vplFramebuffer
} vplFragments;

// Shades one block. Called from any worker.
typedef void vplFragmentFcn(const void* uniforms, vplFragments* fragments);

// Shades one block by `count` fused passes, in order, with the uniforms of each. fragments->plane holds the
// framebuffer; the shader adds to it what the passes add one after another. The bits must be the same for any
// split into calls.
typedef void vplPassesFcn(const void* const* uniforms, int count, vplFragments* fragments);

typedef enum vplDepthCompare {
    VPL_DEPTH_LESS = 0,
    VPL_DEPTH_LESS_EQUAL,
    VPL_DEPTH_EQUAL,
    VPL_DEPTH_ALWAYS
} vplDepthCompare;

typedef enum vplBlend {
    VPL_BLEND_REPLACE = 0,
    VPL_BLEND_ADD // framebuffer + fragment
} vplBlend;

typedef enum vplCull {
    VPL_CULL_NONE = 0,
    VPL_CULL_BACK, // drop triangles that are clockwise on screen
    VPL_CULL_FRONT
} vplCull;

// All state of a draw.
typedef struct vplPipeline {
    vplVertexFcn* vertex;         // required
    const void* vertexUniforms;   // passed to it; must stay unchanged until the run ends
    int varyingCount;             // [0, VPL_MAX_VARYINGS]; default 0
    vplFragmentFcn* fragment;     // NULL (default): depth only
    const void* fragmentUniforms; // passed to it
    // Runs before the fragment shader, with vertexUniforms; may change and add varyings. Runs once per block
    // for all passes (ownerTest) over it. Default NULL.
    vplFragmentFcn* surface;
    int surfaceCount; // varyings after the surface shader, [varyingCount, VPL_MAX_VARYINGS]
    // Replaces `fragment` in draws with ownerTest, EQUAL, no depth write, ADD and no culling: one call then
    // shades a block for all such draws in a row. Default NULL.
    vplPassesFcn* passes;
    vplDepthCompare depthCompare; // default VPL_DEPTH_LESS
    bool depthWrite;              // default true
    // Not 0: depth is the distance from the eye of a view of 90 by 90 degrees, times this, instead of z/w.
    // Only for draws without fragment shader and with depthCompare LESS. Default 0.
    float distanceScale;
    bool
        distanceAlongAxis; // with distanceScale, for any view: the distance along the view axis; default false
    bool
        writesDepth; // `fragment`, which must not be NULL, replaces depth before the depth test; default false
    bool needsW;     // shaders read w; without it w is valid only where there are varyings; default false
    bool readsPlanes; // the fragment shader reads the framebuffer and blends by itself; default false
    // Draws only where the same triangle of the same mesh wrote depth last, so that one of coplanar surfaces
    // counts. Default false.
    bool ownerTest;
    vplBlend blend;     // default VPL_BLEND_REPLACE
    vplCull cull;       // default VPL_CULL_NONE
    uint32_t planeMask; // bit p: plane p is written; default all
    uint32_t cookie;    // set by vplDefaultPipeline
} vplPipeline;

vplPipeline vplDefaultPipeline(void);

// Triangles over `vertexCount` vertices. Draws of one mesh with one vertex shader and one uniforms pointer
// share the vertex work.
typedef struct vplMesh {
    const uint32_t* indices; // three per triangle, each < vertexCount
    int vertexCount, triangleCount;
} vplMesh;

// Storage of one value per pixel, rows top-down.
typedef struct vplPlane {
    float* pixels; // width * height floats; NULL: exists only while its tile is drawn
    bool load;     // starts from `pixels` instead of `clear`; default false
    bool scratch;  // starts undefined: draws write it before they read it; not for depth; default false
    float clear;   // default 1 for depth, 0 for colours
} vplPlane;

typedef struct vplFramebuffer {
    int width, height; // pixels, [1, VPL_MAX_IMAGE_SIZE]
    // Only tiles with a row in [firstRow, endRow) are drawn; other pixels stay as they are. endRow 0 (default): all.
    int firstRow, endRow;
    vplPlane depth;
    vplPlane planes[VPL_MAX_PLANES];
    int planeCount; // [0, VPL_MAX_PLANES]
    // Vertex shaders put the near plane at z = w and the far plane at z = 0, and depth is -z/w in [-1, 0], so that
    // LESS still means nearer. Floats are dense at 0: such depths tell surfaces apart that differ by 1e-6 of their
    // distance, however near the near plane is. Default false.
    bool reversedDepth;
    // Out, one per pixel: the triangle that wrote depth last, numbered through the meshes in the order in
    // which they are first drawn; -1: none. Not with ownerTest. NULL (default): not wanted.
    int32_t* triangles;
    // Multisampling: the triangle that each of this many sub-pixel samples shows is found besides that of the
    // pixel's centre, [0, VPL_MAX_SAMPLES_PER_PIXEL]; see vplTile_GetCoverage. Default 0. Samples see the
    // draws before the first tile task that write depth; these must compare LESS, and neither write depth nor
    // store distances by themselves.
    int samples;
    size_t scratchBytes; // private memory of a tile, zeroed at its start, for tile tasks; default 0
    uint32_t cookie;     // set by vplDefaultFramebuffer
} vplFramebuffer;

vplFramebuffer vplDefaultFramebuffer(int width, int height);

// One tile's storage, for tile tasks. Lane l of block b lies at element 16 * b + l; block b covers the pixels
// from (x + 4 * (b % 16), y + 4 * (b / 16)).
typedef struct vplTile {
    int x, y;          // pixel of the upper left corner
    int width, height; // pixels inside the picture, up to VPL_TILE_SIDE
    const float* depth;
    float* planes[VPL_MAX_PLANES];
    // The triangle that sample i of each pixel shows, numbered as in vplFramebuffer.triangles; -1: none.
    int32_t* samples[VPL_MAX_SAMPLES_PER_PIXEL];
    int sampleCount;
    void* scratch;
} vplTile;

// A point of a pixel.
typedef struct vplSubPixel {
    int x, y; // 1/256 pixel from the centre, y down
} vplSubPixel;

// Sample i of `count` in every pixel. No two samples have the same x or the same y. The samples of an even
// count and the centre, which every pixel shows anyway, are count + 1 points of one lattice. Other numbers i give the centre.
vplSubPixel vplSubPixel_OfSample(int i, int count);

// A triangle that a pixel shows.
typedef struct vplCoverage {
    int32_t triangle; // as in vplFramebuffer.triangles; -1: nothing
    uint32_t samples; // bit i: sample i shows it
} vplCoverage;

// Resolves a pixel, an element of the tile: lists the triangles that its samples show, in the order of the
// first sample of each. Returns their number. Every sample of a pixel shows one triangle or nothing; of two
// triangles with a common edge one covers a sample on that edge.
// Not checked, for speed: pointers must not be NULL.
int vplTile_GetCoverage(const vplTile* tile, int element, vplCoverage out[VPL_MAX_SAMPLES_PER_PIXEL]);

// A tile task: works on a whole tile between draws. Called from any worker.
typedef void vplTileFcn(void* data, vplTile* tile, int worker);

typedef struct vplRasterStats {
    int64_t drawCalls;        // draws recorded
    int64_t fragments;        // fragments that passed all tests
    int64_t trianglesIn;      // triangles of the meshes whose vertices were shaded
    int64_t trianglesBinned;  // that may cover a pixel, facing either way; clipped ones count by their pieces
    double vertexMs, tilesMs; // time of the vertex stage (with clipping and binning) and of the tiles
} vplRasterStats;

// Adds the statistics of another run.
void vplRasterStats_Add(vplRasterStats* sum, const vplRasterStats* stats);

// A recorded list of draws on one framebuffer.
typedef struct vplRaster vplRaster;

vplResult vplRaster_Create(vplContext* context, const vplFramebuffer* framebuffer, vplRaster** rasterOut);

// NULL is allowed.
void vplRaster_Destroy(vplRaster* raster);

// Records a draw. The mesh, its indices and all uniforms must stay unchanged until the run ends.
vplResult vplRaster_Draw(vplRaster* raster, const vplMesh* mesh, const vplPipeline* pipeline);

// Records work on every tile.
vplResult vplRaster_TileTask(vplRaster* raster, vplTileFcn* fcn, void* data);

// Runs everything recorded, in order. `progress` (may be NULL) gets fractions from 0 to 1. May be called
// again. statsOut may be NULL.
vplResult vplRaster_Run(vplRaster* raster, vplProgressFcn* progress, void* user, vplRasterStats* statsOut);

// The same for several rasters of one context, whose tiles run in parallel. statsOut: one per raster, or
// NULL.
vplResult vplRaster_RunAll(vplRaster* const* rasters, int count, vplProgressFcn* progress, void* user,
                           vplRasterStats* statsOut);

VPL_HEADER_END

#endif
