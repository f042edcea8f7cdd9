// SPDX-License-Identifier: MIT
// Draws plain lists of clip-space triangles.
#ifndef VPL_TESTS_RASTER_SUPPORT_H
#define VPL_TESTS_RASTER_SUPPORT_H

#include "test.h"

typedef struct ClipVertex {
    float x, y, z, w;
    float varying[3];
} ClipVertex;

// Vertex shader that reads an array of ClipVertex (the uniforms).
void passVertices(const void* uniforms, int first, int count, const vplVertices* out);

// Fragment shader that writes 1 to plane 0, the primitive to plane 1, the varyings to planes 2 to 4 and w to
// plane 5. It reads no uniforms.
void showFragments(const void* uniforms, vplFragments* fragments);
enum { SHOWN_PLANES = 6 };

// Returns a pipeline of both shaders over `vertices`, with three varyings.
vplPipeline showPipeline(const ClipVertex* vertices);

// Depth and planes of one picture. All planes are cleared to `clear`.
typedef struct Canvas {
    vplFramebuffer framebuffer;
    float* depth;
    float* planes[SHOWN_PLANES];
} Canvas;

Canvas makeCanvas(int width, int height, float clear);
void freeCanvas(Canvas* canvas);

// Draws triangles (indices NULL: three consecutive vertices each) in one draw and returns its statistics.
vplRasterStats drawList(vplContext* context, const Canvas* canvas, const vplPipeline* pipeline,
                        const uint32_t* indices, int vertexCount, int triangleCount);

// A vertex that projects exactly onto a point given in 1/256 pixels, y down, at depth z.
ClipVertex fixedVertex(int x, int y, float z, int width, int height);

// Makes a random soup of clip-space triangles of many sizes, some of which cross every clip plane. The caller
// frees it.
ClipVertex* makeSoup(uint64_t seed, int triangles);

// Returns the hash of depth and all planes.
uint64_t hashCanvas(const Canvas* canvas);

#endif
