// SPDX-License-Identifier: MIT
// Draws plain lists of clip-space triangles.
#ifndef VPL_TESTS_RASTER_SUPPORT_H
#define VPL_TESTS_RASTER_SUPPORT_H

#include "test.h"

typedef struct ClipVertex {
    float x, y, z, w;
    float varying[3];
} ClipVertex;

// Vertex shader over an array of ClipVertex (the uniforms).
void passVertices(const void* uniforms, int first, int count, const vplVertices* out);

// Fragment shader: plane 0 is 1, plane 1 the primitive, planes 2 to 4 the varyings, plane 5 w. Uniforms
// unused.
void showFragments(const void* uniforms, vplFragments* fragments);
enum { SHOWN_PLANES = 6 };

// A pipeline with both shaders over `vertices` and three varyings.
vplPipeline showPipeline(const ClipVertex* vertices);

// Planes and depth of one picture, all planes cleared to `clear`.
typedef struct Canvas {
    vplFramebuffer framebuffer;
    float* depth;
    float* planes[SHOWN_PLANES];
} Canvas;

Canvas makeCanvas(int width, int height, float clear);
void freeCanvas(Canvas* canvas);

// Draws triangles (indices NULL: three vertices after three) in one draw and returns its statistics.
vplRasterStats drawList(vplContext* context, const Canvas* canvas, const vplPipeline* pipeline,
                        const uint32_t* indices, int vertexCount, int triangleCount);

// A vertex that projects exactly onto a point given in 1/256 pixels, y down, at depth z.
ClipVertex fixedVertex(int x, int y, float z, int width, int height);

// A random soup: clip-space triangles of many sizes, some crossing every clip plane. The caller frees it.
ClipVertex* makeSoup(uint64_t seed, int triangles);

// Of depth and all planes.
uint64_t hashCanvas(const Canvas* canvas);

#endif
